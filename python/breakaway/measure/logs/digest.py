"""The digest of a log file, and that it is the file that was read."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from breakaway.base.reading import open_regular, why
from breakaway.errors import LogError


@contextmanager
def digested(path: Path) -> Iterator[str]:
    """Give the SHA-256 of a log file; whoever reads it inside the block reads the same file.

    Raises
    ------
    LogError
        The file is missing, no regular file, cannot be read, or is empty; at the end of the
        block, it is another file, or its size or time of change is another.

    """
    try:
        with open_regular(path) as file:
            before = _identity(os.fstat(file.fileno()))
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            size = file.tell()
    except FileNotFoundError:
        raise LogError(f"{path}: there is no such file; check the path") from None
    except (OSError, ValueError) as error:
        raise LogError(f"{path}: cannot be read: {why(error)}") from None
    if not size:
        raise LogError(f"{path.name}: the file is empty; export the log again")
    yield digest
    if not path.exists() or _identity(path.stat()) != before:
        raise LogError(
            f"{path.name}: changed while it was read; read it once it is completely written"
        )


def _identity(status: os.stat_result) -> tuple[int, int, int, int]:
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns
