"""Writing results: a file is there whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from breakaway.errors import OutputError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name in its folder, then rename it.

    Devices and pipes, such as ``/dev/stdout``, are written to and stay what they are.

    Raises
    ------
    OutputError
        The folder is missing or not writable, or the disk is full.

    """
    try:
        if path.is_char_device() or path.is_fifo():
            path.write_bytes(content)
            return
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise _not_written(path, error) from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o666 & ~_umask())
        os.replace(name, path)  # noqa: PTH105 - the one atomic step
    except BaseException as error:
        with suppress(OSError):
            Path(name).unlink()
        if isinstance(error, OSError):
            raise _not_written(path, error) from None
        raise


@contextmanager
def output_folder(folder: Path) -> Iterator[Path]:
    """Collect files in a hidden folder and move them to ``folder`` once all are written.

    Whatever ends the block early, Ctrl-C included, leaves ``folder`` as it was.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(dir=folder, prefix=".writing."))
    except OSError as error:
        raise _not_written(folder, error) from None
    try:
        yield staging
        for path in sorted(staging.iterdir()):
            path.replace(folder / path.name)
    except OSError as error:
        raise _not_written(folder, error) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _not_written(path: Path, error: OSError) -> OutputError:
    reason = error.strerror or str(error)
    return OutputError(f"{path}: can not be written: {reason}; give a folder that you can write to")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
