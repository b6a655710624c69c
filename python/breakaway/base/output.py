"""Writing results: a file is there whole or not at all."""

from __future__ import annotations

import os
import re
import secrets
import shutil
import stat
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from breakaway.base.ownership import Kind, refuse_files_of_others, refuse_links, refuse_other_kinds
from breakaway.base.reading import is_folder, is_there
from breakaway.errors import OutputError

STAGING_FOLDER = re.compile(r"\.writing\.[a-z0-9_]{8}")
"""Names of the folders in which files are collected."""
STAGING_FILE = re.compile(r"\..+\.[0-9a-f]{16}")
"""Names under which files are written."""
UNUSABLE = (OSError, ValueError, RuntimeError)
"""What making a place raises: a path may have a null character, or be a link to itself."""


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file that a user named; make missing folders.

    It is written under a temporary name in its folder, then renamed. Devices and pipes, such as
    ``/dev/stdout``, are written to and stay what they are. A link stays a link, and what it leads
    to is written: the user named it. Within the folder of a result, `write_inside` follows none.

    Raises
    ------
    OutputError
        The folder cannot be made or written to, or the disk is full.

    """
    try:
        path = path.resolve()  # a link stays a link: what it leads to is written
        if path.exists() and not path.is_file():
            path.write_bytes(content)
            return
        with suppress(FileExistsError):  # a file in the way is told below
            path.parent.mkdir(parents=True)
    except UNUSABLE as error:
        raise not_written(path, error) from None
    _write_and_rename(path, content)


def write_inside(path: Path, content: bytes) -> None:
    """Write a file of a result's folder under a temporary name, then rename it.

    Raises
    ------
    OutputError
        The file is a symbolic link, the folder cannot be written to, or the disk is full.

    """
    refuse_links(path)
    _write_and_rename(path, content)


def append_inside(path: Path, line: bytes) -> None:
    """Append to a file of a result's folder; the line is on the disk before anything follows.

    Raises
    ------
    OutputError
        The file is a symbolic link, the disk is full, or it cannot be written; it is as it was
        before.

    """
    refuse_links(path)
    before: int | None = None
    try:
        with open_inside(path) as descriptor:
            before = os.fstat(descriptor).st_size
            try:
                if os.write(descriptor, line) != len(line):
                    raise OSError("the disk is full")  # noqa: TRY301 - handled as any failure
                os.fsync(descriptor)
            except BaseException:
                with suppress(OSError):
                    os.ftruncate(descriptor, before)
                raise
    except OSError as error:
        raise not_written(path, error) from None


@contextmanager
def open_inside(path: Path) -> Iterator[int]:
    """Open a regular file of a result's folder to append to it, through no link; give its number.

    Raises
    ------
    OSError
        It is a link or not a regular file, or cannot be opened.

    """
    flags = os.O_RDWR | os.O_APPEND | os.O_CREAT
    for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY"):
        flags |= getattr(os, name, 0)  # each system has some of them
    descriptor = os.open(path, flags, 0o666)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError("is not a regular file")
        yield descriptor
    finally:
        os.close(descriptor)


def remove_inside(path: Path) -> None:
    """Remove a file of a result's folder, if it is there.

    Raises
    ------
    OutputError
        It is a symbolic link, or cannot be removed.

    """
    refuse_links(path)
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: cannot be removed: {error.strerror or error}") from None


def remove_leftovers(folder: Path) -> None:
    """Remove what a killed process was writing to a folder: by our names, through no link."""
    for path in folder.iterdir():
        if path.is_symlink():
            continue
        if STAGING_FOLDER.fullmatch(path.name):
            shutil.rmtree(path, ignore_errors=True)
        elif STAGING_FILE.fullmatch(path.name) and path.is_file():
            with suppress(OSError):
                path.unlink()


def _write_and_rename(path: Path, content: bytes) -> None:
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
            raise not_written(path, error) from None
        raise


def refuse_to_overwrite(source: Path, target: Path) -> None:
    """Refuse a target that is the very file that was read.

    Raises
    ------
    OutputError
        Both are the same file.

    """
    if is_there(source) and is_there(target) and source.samefile(target):
        raise OutputError(f"{target}: is the file that was read; give another place for the result")


@contextmanager
def output_folder(folder: Path, kind: Kind, names: Collection[str] = ()) -> Iterator[Path]:
    """Collect files in a hidden folder and move them to ``folder`` once all are written.

    Whatever ends the block early, Ctrl-C included, leaves ``folder`` as it was, and absent where
    it was absent. Names that are given are looked at before the block, all others after it.

    Raises
    ------
    OutputError
        The folder cannot be written to, or holds a result of another kind; a name is taken by a
        folder, a symbolic link, or a file that is of no result of this kind.

    """
    existed = is_there(folder)
    claim(folder, kind, names)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(dir=folder, prefix=".writing."))
    except UNUSABLE as error:
        raise not_written(folder, error) from None
    moved = False
    try:
        yield staging
        _move_all(staging, folder, kind)
        moved = True
    except OSError as error:
        raise not_written(folder, error) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)
        if not (moved or existed):
            with suppress(OSError):
                folder.rmdir()


def _move_all(staging: Path, folder: Path, kind: Kind) -> None:
    """Move every file, after a look that no target is in the way."""
    paths = sorted(staging.iterdir())
    claim(folder, kind, [path.name for path in paths])
    for path in paths:
        path.replace(folder / path.name)


def claim(folder: Path, kind: Kind, names: Collection[str] = ()) -> None:
    """Refuse a folder of another kind of result, and names that are not to be replaced in it.

    Raises
    ------
    OutputError
        A name is taken by a folder, a symbolic link, or a file that is of no result of this kind.

    """
    refuse_other_kinds(folder, kind)
    for target in (folder / name for name in names):
        refuse_links(target)
        if is_folder(target):
            raise OutputError(f"{target}: is a folder where a file has to go; move it away")
    refuse_files_of_others(folder, kind, names)


def not_written(path: Path, error: Exception) -> OutputError:
    """Say that a place cannot be written, and why."""
    reason = getattr(error, "strerror", None) or str(error)
    if isinstance(error, FileExistsError):
        reason = "is a file, not a folder"
    return OutputError(f"{path}: cannot be written: {reason}; give a folder that you can write to")


def _mode(path: Path) -> int:
    """Permissions of the file that is replaced, or those of a new one."""
    if path.exists():
        return stat.S_IMODE(path.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
