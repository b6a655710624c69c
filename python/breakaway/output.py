"""Writing results: a file is there whole or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from breakaway.errors import OutputError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name in its folder, then rename it; make missing folders.

    Devices and pipes, such as ``/dev/stdout``, are written to and stay what they are.

    Raises
    ------
    OutputError
        The folder can not be made or not be written to, or the disk is full.

    """
    try:
        path = path.resolve()  # a link stays a link: what it leads to is written
        if path.exists() and not path.is_file():
            path.write_bytes(content)
            return
        with suppress(FileExistsError):  # a file in the way is told below
            path.parent.mkdir(parents=True)
    except OSError as error:
        raise _not_written(path, error) from None
    # The name is known before the file is there, so that a Ctrl-C at any moment leaves none behind.
    staging = path.with_name(f".{path.name}.{secrets.token_hex(8)}")
    try:
        with staging.open("xb") as file:
            file.write(content)
        staging.chmod(_mode(path))
        staging.replace(path)
    except BaseException as error:
        with suppress(OSError):
            staging.unlink()
        if isinstance(error, OSError):
            raise _not_written(path, error) from None
        raise


def refuse_to_overwrite(source: Path, target: Path) -> None:
    """Refuse a target that is the very file that was read.

    Raises
    ------
    OutputError
        Both are the same file.

    """
    if source.exists() and target.exists() and source.samefile(target):
        raise OutputError(f"{target}: is what was read; give another place for the result")


@contextmanager
def output_folder(folder: Path) -> Iterator[Path]:
    """Collect files in a hidden folder and move them to ``folder`` once all are written.

    Whatever ends the block early, Ctrl-C included, leaves ``folder`` as it was, and absent where
    it was absent.
    """
    existed = folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(dir=folder, prefix=".writing."))
    except OSError as error:
        raise _not_written(folder, error) from None
    moved = False
    try:
        yield staging
        _move_all(staging, folder)
        moved = True
    except OSError as error:
        raise _not_written(folder, error) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)
        if not (moved or existed):
            with suppress(OSError):
                folder.rmdir()


def _move_all(staging: Path, folder: Path) -> None:
    """Move every file, after a look that no target is in the way."""
    paths = sorted(staging.iterdir())
    for path in paths:
        target = folder / path.name
        if target.is_dir():
            raise OutputError(f"{target}: is a folder where a file has to go; move it away")
    for path in paths:
        path.replace(folder / path.name)


def _not_written(path: Path, error: OSError) -> OutputError:
    reason = error.strerror or str(error)
    if isinstance(error, FileExistsError):
        reason = "is a file, not a folder"
    return OutputError(f"{path}: can not be written: {reason}; give a folder that you can write to")


def _mode(path: Path) -> int:
    """Permissions of the file that is replaced, or those of a new one."""
    if path.exists():
        return stat.S_IMODE(path.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
