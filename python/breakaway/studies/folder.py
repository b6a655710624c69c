"""The folder of a study: its manifest, and whether it can go on."""

from __future__ import annotations

import csv
import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from typing import Any

from breakaway._core import __version__
from breakaway.errors import OutputError, StudyError
from breakaway.output import write_atomically
from breakaway.resolution import resolve
from breakaway.studies.parts import PARTS, label_types, part_schema
from breakaway.studies.plan import Plan
from breakaway.studies.study import Study
from breakaway.text import csv_cell

MANIFEST, SUMMARY, LOCK = "manifest.json", "summary.json", ".lock"
FORMAT = 1
"""Number of the folder's layout."""
DESCRIBING = ("name", "description")
"""Keys of a study that its results do not depend on."""


def manifest_of(study: Study, plan: Plan) -> dict[str, Any]:
    """Give what determines the results of a study, and what they look like.

    Examples
    --------
    >>> import breakaway as bk
    >>> from breakaway.studies.study import SweepStudy
    >>> from breakaway.studies.sweep import SweepPlan
    >>> study = SweepStudy(
    ...     scenario="paper_as_computed", changes={"disturbance.var": 0.1}, runs=10
    ... )
    >>> manifest_of(study, SweepPlan(study))["seed"]
    0

    """
    labels = label_types(plan.points)
    schema = part_schema(labels, plan.varied, study.recorded)
    manifest = {
        "format": FORMAT,
        "breakaway_version": __version__,
        "libraries": _libraries(study),
        "study": study.model_dump(mode="json"),
        "scenario": resolve(study.base).model_dump(mode="json"),
        "seed": study.base.seed,
        "runs_max": plan.runs_max,
        "runs_per_part": study.runs_per_part,
        "labels": labels,
        "varied": plan.varied,
        "metrics": list(study.recorded),
        "columns": [
            {"name": f.name, "type": str(f.type), "unit": f.metadata[b"unit"].decode()}
            for f in schema
        ],
    }
    return manifest | {"identity": identity_of(manifest)}


def _libraries(study: Study) -> dict[str, str]:
    """Give the versions of what draws are computed with."""
    names = ["numpy", "scipy", *(["SALib"] if study.kind == "sensitivity" else [])]
    return {name: version(name) for name in names}


def identity_of(manifest: Mapping[str, Any]) -> str:
    """Give a digest of all in a manifest that results depend on."""
    text = json.dumps(_deciding(manifest))  # in the order of the keys, on which draws depend
    return hashlib.sha256(text.encode()).hexdigest()


def _deciding(manifest: Mapping[str, Any]) -> dict[str, Any]:
    study = {k: v for k, v in manifest["study"].items() if k not in DESCRIBING}
    return {**{k: v for k, v in manifest.items() if k != "identity"}, "study": study}


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read the manifest of a study.

    Raises
    ------
    StudyError
        There is none, or it can not be read.

    """
    path = folder / MANIFEST
    try:
        manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        found = manifest["format"], manifest["identity"], manifest["study"]["kind"]
    except (FileNotFoundError, NotADirectoryError):
        raise StudyError(
            f"{folder}: holds no study ({MANIFEST} is missing); give the --out of a study"
        ) from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StudyError(f"{path}: can not be read as a manifest: {error!r}") from None
    if found[0] != FORMAT:
        raise StudyError(
            f"{path}: has the format {found[0]!r}, not {FORMAT}; open it with breakaway "
            f"{manifest.get('breakaway_version')}"
        )
    return manifest


@contextmanager
def prepared(
    folder: Path, manifest: Mapping[str, Any], *, resume: bool, called: str = "study"
) -> Iterator[None]:
    """Hold a folder for a study: a new one, or the same one to go on with.

    What it is ``called`` stands in errors.

    Raises
    ------
    StudyError
        The folder holds a study and is not to be resumed, another study, or one that another
        process is running.
    OutputError
        The folder can not be written.

    """
    existed = folder.exists()
    found = (folder / MANIFEST).exists()
    if found:
        _refuse_other(folder, read_manifest(folder), manifest, resume=resume, called=called)
    elif (folder / PARTS).exists() and any((folder / PARTS).iterdir()):
        raise StudyError(
            f"{folder}: holds parts of a {called} but no {MANIFEST}; give another folder"
        )
    try:
        (folder / PARTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise not_written(folder, error) from None
    with _locked(folder, called):
        _remove_leftovers(folder)
        if not found:
            try:
                write_atomically(folder / MANIFEST, as_json(manifest))
            except OutputError:
                _remove_made(folder, existed=existed)
                raise
        yield


def _refuse_other(
    folder: Path,
    found: Mapping[str, Any],
    manifest: Mapping[str, Any],
    *,
    resume: bool,
    called: str,
) -> None:
    if found["identity"] != manifest["identity"]:
        differences = list(_differences(_deciding(found), _deciding(manifest), ""))
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
    elif found != asked:
        yield f"{path} is {_short(found)} there and {_short(asked)} now"


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
    try:
        file = path.open("ab")
    except OSError as error:
        raise not_written(folder, error) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StudyError(
                f"{folder}: another process is running this {called}; wait for it, or end it"
            ) from None
        except OSError:  # a file system without locks
            pass
        yield


def _remove_leftovers(folder: Path) -> None:
    """Remove what a killed process was writing."""
    import shutil

    for pattern in (f"{PARTS}/.part-*", ".manifest.json.*", ".summary.json.*"):
        for path in folder.glob(pattern):
            with suppress(OSError):
                path.unlink()
    for path in folder.glob(".writing.*"):
        shutil.rmtree(path, ignore_errors=True)


def _remove_made(folder: Path, *, existed: bool) -> None:
    with suppress(OSError):
        (folder / LOCK).unlink()
        (folder / PARTS).rmdir()
        if not existed:
            folder.rmdir()


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


def not_written(path: Path, error: OSError) -> OutputError:
    """Say that a place can not be written, and why."""
    reason = os.strerror(error.errno) if error.errno else str(error)
    if isinstance(error, FileExistsError):
        reason = "is a file, not a folder"
    return OutputError(f"{path}: can not be written: {reason}; give a folder that you can write to")
