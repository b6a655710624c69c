"""The folder of a study: whether it is its own, and whether it can go on."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from io import StringIO
from itertools import zip_longest
from pathlib import Path
from typing import Any

from breakaway.ask.studies.manifest import MANIFEST, deciding, kind_of, read_manifest
from breakaway.ask.studies.part_files import PARTS, parts_in
from breakaway.ask.studies.pieces import Pieces
from breakaway.base.output import (
    STAGING_FILE,
    STAGING_FOLDER,
    UNUSABLE,
    not_written,
    open_inside,
    remove_leftovers,
    write_inside,
)
from breakaway.base.ownership import refuse_links
from breakaway.base.reading import is_folder, is_there, read_json
from breakaway.base.text import csv_cell
from breakaway.errors import OutputError, StudyError

SUMMARY, LOCK = "summary.json", ".lock"
MOST_SUMMARY_BYTES = 2**30
"""Most bytes of a summary; nothing is read that has no digest."""


@contextmanager
def prepared(folder: Path, manifest: Mapping[str, Any], *, resume: bool) -> Iterator[Pieces]:
    """Hold a folder for a study, tuning or comparison: a new one, or the same one to go on with.

    The folder itself may be a symbolic link, and nothing in it. Give its finished files.

    Raises
    ------
    StudyError
        The folder holds the same and is not to be resumed, another one, files of others, a
        symbolic link, or what another process is running.
    OutputError
        The folder can not be written.

    """
    called = kind_of(manifest)
    existed = is_there(folder)
    try:
        _refuse_links_in(folder)
        found = is_there(folder / MANIFEST)
        if found:
            _refuse_other(folder, read_manifest(folder), manifest, resume=resume)
        else:
            _refuse_filled(folder, called)
        (folder / PARTS).mkdir(parents=True, exist_ok=True)
    except UNUSABLE as error:
        raise not_written(folder, error) from None
    with _locked(folder, called):
        remove_leftovers(folder)
        remove_leftovers(folder / PARTS)
        if not found:
            try:
                write_inside(folder / MANIFEST, as_json(manifest))
            except OutputError:
                _remove_made(folder, existed=existed)
                raise
        pieces = Pieces(folder, manifest["identity"])
        pieces.settle(pieces.names())
        yield pieces


def _refuse_links_in(folder: Path) -> None:
    for inside in (folder, folder / PARTS):
        if is_folder(inside):
            try:
                refuse_links(*sorted(inside.iterdir()))
            except OutputError as error:  # nothing can be gone on with
                raise StudyError(str(error)) from None


def _refuse_filled(folder: Path, called: str) -> None:
    """Refuse a folder in which something is, but for what a start leaves that was killed."""
    for inside in (folder, folder / PARTS):
        for path in sorted(inside.iterdir()) if is_folder(inside) else ():
            ours = STAGING_FILE.fullmatch(path.name) or STAGING_FOLDER.fullmatch(path.name)
            if not ours and path not in (folder / LOCK, folder / PARTS):
                raise StudyError(
                    f"{folder}: holds {path.relative_to(folder)} but no {MANIFEST}; a {called} "
                    "begins in a new or empty folder: give one"
                )


def _refuse_other(
    folder: Path,
    found: Mapping[str, Any],
    manifest: Mapping[str, Any],
    *,
    resume: bool,
) -> None:
    called = kind_of(manifest)
    if kind_of(found) != called:
        raise StudyError(
            f"{folder}: holds a {kind_of(found)}, and this is a {called}; give another folder"
        )
    if found["identity"] != manifest["identity"]:
        differences = list(_differences(deciding(found), deciding(manifest), ""))
        said = "; ".join(differences[:3]) or "the order of its keys"
        more = f"; and {len(differences) - 3} more" if len(differences) > 3 else ""
        raise StudyError(
            f"{folder}: holds another {called}: {said}{more}; give another folder, or the "
            f"{called} that was begun"
        )
    if not resume:
        raise StudyError(
            f"{folder}: already holds this {called}; go on with --resume, or give another folder"
        )


def _differences(found: Any, asked: Any, path: str) -> Iterator[str]:  # noqa: ANN401 - any JSON
    if isinstance(found, Mapping) and isinstance(asked, Mapping):
        for key in [*found, *(key for key in asked if key not in found)]:
            inner = f"{path}.{key}" if path else key
            yield from _differences(found.get(key), asked.get(key), inner)
    elif _has_tables(found) and _has_tables(asked):
        for number, (there, now) in enumerate(zip_longest(found, asked)):
            yield from _differences(there, now, f"{path}.{number}")
    elif found != asked:
        yield f"{path} is {_short(found)} there and {_short(asked)} now"


def _has_tables(value: object) -> bool:
    return isinstance(value, list) and any(isinstance(inner, Mapping) for inner in value)


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


@contextmanager
def _locked(folder: Path, called: str) -> Iterator[None]:
    """Keep other processes out; the lock ends with the process, however that ends."""
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


def _remove_made(folder: Path, *, existed: bool) -> None:
    with suppress(OSError):
        (folder / LOCK).unlink()
        (folder / PARTS).rmdir()
        if not existed:
            folder.rmdir()


def finished_names(pieces: Pieces) -> list[str]:
    """Give the names of the summary and of all parts, where no part is to come any more."""
    there = parts_in(pieces.folder)  # before the digests, which come first
    pieces.reread()
    return [*sorted({*there, *pieces.names(PARTS)}), SUMMARY]


def is_finished(pieces: Pieces) -> bool:
    """Whether there is a summary, and it and all parts are as they were written."""
    return all(pieces.flaw(name) is None for name in finished_names(pieces))


def read_summary(pieces: Pieces) -> dict[str, Any]:
    """Read the summary of a finished folder.

    Raises
    ------
    StudyError
        The summary, or a part of what it sums up, is missing or not as it was written.

    """
    for name in finished_names(pieces):
        pieces.refuse_flawed(name)
    path = pieces.folder / SUMMARY
    summary = read_json(path, MOST_SUMMARY_BYTES)
    if not isinstance(summary, dict):
        raise StudyError(f"{path}: is no table; go on with --resume to have it again")
    return summary


def as_json(content: object) -> bytes:
    """Give a JSON document, the same for the same content."""
    return (json.dumps(content, indent=2, allow_nan=False) + "\n").encode()


def as_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """Give rows as a table with all their columns; what is None is empty, no text a formula."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(csv_cell, names))
    writer.writerows([csv_cell(row.get(name)) for name in names] for row in rows)
    return text.getvalue()
