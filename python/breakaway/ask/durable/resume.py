"""The folder of long work: whether it is its own, and whether it can go on."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import zip_longest
from pathlib import Path
from typing import Any

from breakaway.ask.durable.documents import as_json
from breakaway.ask.durable.journal import PIECES, Journal
from breakaway.ask.durable.lock import LOCK, locked
from breakaway.ask.durable.manifest import MANIFEST, deciding, kind_of, read_manifest
from breakaway.base.output import (
    STAGING_FILE,
    STAGING_FOLDER,
    UNUSABLE,
    not_written,
    remove_leftovers,
    write_inside,
)
from breakaway.base.ownership import refuse_links
from breakaway.base.reading import is_folder, is_there
from breakaway.errors import OutputError, StudyError


@contextmanager
def prepared(folder: Path, manifest: Mapping[str, Any], *, resume: bool) -> Iterator[Journal]:
    """Hold a folder for some work: a new one, or the same one to go on with.

    The folder itself may be a symbolic link, and nothing in it. Give the journal of its finished
    files, which stay whatever ends the block.

    Raises
    ------
    StudyError
        The folder holds the same and is not to be resumed, another one, files of others, a
        symbolic link, or what another process is running.
    OutputError
        The folder cannot be written.

    """
    called = kind_of(manifest).called
    existed = is_there(folder)
    try:
        _refuse_file(folder)
        _refuse_links_in(folder)
        found = is_there(folder / MANIFEST)
        if found:
            _refuse_other(folder, read_manifest(folder, called), manifest, resume=resume)
        else:
            _refuse_filled(folder, called)
        (folder / PIECES).mkdir(parents=True, exist_ok=True)
    except UNUSABLE as error:
        raise not_written(folder, error) from None
    with locked(folder, called):
        remove_leftovers(folder)
        remove_leftovers(folder / PIECES)
        if not found:
            try:
                write_inside(folder / MANIFEST, as_json(manifest))
            except OutputError:
                _remove_made(folder, existed=existed)
                raise
        journal = Journal(folder, manifest["identity"])
        journal.settle(journal.names())
        try:
            yield journal
        except OutputError as error:
            raise OutputError(f"{error}; what is finished stays: resume it to go on") from None


def _refuse_file(folder: Path) -> None:
    if is_there(folder) and not is_folder(folder):
        raise FileExistsError


def _refuse_links_in(folder: Path) -> None:
    for inside in (folder, folder / PIECES):
        if is_folder(inside):
            try:
                refuse_links(*sorted(inside.iterdir()))
            except OutputError as error:  # nothing can be gone on with
                raise StudyError(str(error)) from None


def _refuse_filled(folder: Path, called: str) -> None:
    """Refuse a folder in which something is, but for what a start leaves that was killed."""
    for inside in (folder, folder / PIECES):
        for path in sorted(inside.iterdir()) if is_folder(inside) else ():
            ours = STAGING_FILE.fullmatch(path.name) or STAGING_FOLDER.fullmatch(path.name)
            if not ours and path not in (folder / LOCK, folder / PIECES):
                raise StudyError(
                    f"{folder}: holds {path.relative_to(folder)} but no {MANIFEST}; a {called} "
                    "starts in a new or empty folder: give one"
                )


def _refuse_other(
    folder: Path,
    found: Mapping[str, Any],
    manifest: Mapping[str, Any],
    *,
    resume: bool,
) -> None:
    called, there = kind_of(manifest).called, kind_of(found).called
    if there != called:
        raise StudyError(f"{folder}: holds a {there}, and this is a {called}; give another folder")
    if found["identity"] != manifest["identity"]:
        differences = list(_differences(_named(found, called), _named(manifest, called), ""))
        said = "; ".join(differences[:3]) or "the order of its keys"
        more = f"; and {len(differences) - 3} more" if len(differences) > 3 else ""
        raise StudyError(
            f"{folder}: holds another {called}: {said}{more}; give another folder, or the {called} "
            "that was started there"
        )
    if not resume:
        raise StudyError(
            f"{folder}: already holds this {called}; go on with --resume, or give another folder"
        )


def _named(manifest: Mapping[str, Any], called: str) -> dict[str, Any]:
    """Give what decides, what is asked under the name that users know."""
    return {called if key == "asked" else key: v for key, v in deciding(manifest).items()}


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


def _remove_made(folder: Path, *, existed: bool) -> None:
    with suppress(OSError):
        (folder / LOCK).unlink()
        (folder / PIECES).rmdir()
        if not existed:
            folder.rmdir()
