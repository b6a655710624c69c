"""One process at a time in a folder."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from breakaway.base.output import not_written, open_inside
from breakaway.errors import StudyError

LOCK = ".lock"


@contextmanager
def locked(folder: Path, called: str) -> Iterator[None]:
    """Keep other processes out; the lock ends with the process, however that ends.

    Raises
    ------
    StudyError
        Another process is in the folder.
    OutputError
        The folder cannot be written.

    """
    try:
        fcntl: Any = import_module("fcntl")
    except ImportError:  # not on Windows
        yield
        return
    path = folder / LOCK
    with ExitStack() as opened:
        try:
            file = opened.enter_context(open_inside(path))
        except OSError as error:
            raise not_written(path, error) from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StudyError(
                f"{folder}: another process is running this {called}; wait for it, or end it"
            ) from None
        except OSError:  # a file system without locks
            pass
        yield
