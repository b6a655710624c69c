"""The manifest of a folder: what determines its results, and an identity made of that."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from breakaway._core import __version__
from breakaway.base.reading import read_json
from breakaway.errors import StudyError

MANIFEST = "manifest.json"
FORMAT = 4
"""Number of the folder's layout."""
DESCRIBING = ("name", "description")
"""Keys of what is asked that results do not depend on."""
MOST_MANIFEST_BYTES = 16 * 2**20
"""Most bytes of a manifest: that of a study with many points has 100 kB."""


@dataclass(frozen=True)
class Kind:
    """A kind of work that a folder can hold."""

    called: str
    """What it is, in a word."""
    opener: str
    """What opens it."""


STUDY = Kind("study", "open_study")
TUNING = Kind("tuning", "open_tuning")
COMPARISON = Kind("comparison", "compare_methods and resume=True")
OTHERS = {"tune": TUNING, "comparison": COMPARISON}
"""Kinds of what is asked that are no study."""


class Checked(BaseModel):
    """What is read from a manifest; what is more than its fields stays as it is."""

    model_config = ConfigDict(strict=True)


class _Layout(Checked):
    """What a manifest of any format has."""

    format: int
    breakaway_version: str


class _Asked(Checked):
    kind: str
    name: str = ""


class _Manifest(_Layout):
    """What a manifest has, whatever its kind."""

    identity: str
    libraries: dict[str, str]
    asked: _Asked


def manifest_with(
    asked: Mapping[str, Any],
    libraries: Iterable[str],
    **more: Any,  # noqa: ANN401 - any JSON
) -> dict[str, Any]:
    """Give the manifest of what is asked, with the versions of what computes it.

    Examples
    --------
    >>> one = manifest_with({"kind": "sweep", "name": "a"}, ["numpy"], seed=0)
    >>> other = manifest_with({"kind": "sweep", "name": "b"}, ["numpy"], seed=0)
    >>> one["identity"] == other["identity"]
    True

    """
    manifest = {
        "format": FORMAT,
        "breakaway_version": __version__,
        "libraries": {name: version(name) for name in libraries},
        "asked": _as_words(dict(asked)),
        **more,
    }
    return manifest | {"identity": identity_of(manifest)}


def _as_words(content: Any) -> Any:  # noqa: ANN401 - any JSON
    """Give infinite ends, such as those of a bound, as words: JSON has no number for them.

    >>> _as_words({"stiffness_n_per_m": [1e6, float("inf")]})
    {'stiffness_n_per_m': [1000000.0, 'inf']}
    """
    if isinstance(content, dict):
        return {name: _as_words(value) for name, value in content.items()}
    if isinstance(content, list):
        return [_as_words(value) for value in content]
    return str(content) if isinstance(content, float) and not isfinite(content) else content


def read_manifest(folder: Path, called: str) -> dict[str, Any]:
    """Read the manifest of a folder, whatever kind it is of; ``called`` is what is looked for.

    Raises
    ------
    StudyError
        There is none, it cannot be read, or its identity does not match its content.

    """
    path = folder / MANIFEST
    try:
        manifest: dict[str, Any] = read_json(path, MOST_MANIFEST_BYTES)
        check_types(_Layout, manifest)
    except (FileNotFoundError, NotADirectoryError):
        raise StudyError(
            f"{folder}: holds no {called} ({MANIFEST} is missing); give the --out folder of a "
            f"{called}"
        ) from None
    except (OSError, ValueError) as error:
        raise _unreadable(path, error, called) from None
    if manifest["format"] != FORMAT:
        raise StudyError(
            f"{path}: has the format {manifest['format']}, not {FORMAT}; open it with breakaway "
            f"{manifest['breakaway_version']}, which wrote it, or start again in another folder"
        )
    try:
        check_types(_Manifest, manifest)
    except ValueError as error:
        raise _unreadable(path, error, called) from None
    if manifest["identity"] != identity_of(manifest):
        raise StudyError(
            f"{path}: was changed: its identity does not match its content; restore it, or start "
            "again in another folder"
        )
    return manifest


def manifest_of_kind(folder: Path, kind: Kind, model: type[Checked] = _Manifest) -> dict[str, Any]:
    """Read a manifest that has to be of a kind, and have what the model says.

    Raises
    ------
    StudyError
        It is of another kind, or cannot be read.

    """
    manifest = read_manifest(folder, kind.called)
    found, path = kind_of(manifest), folder / MANIFEST
    if found != kind:
        raise StudyError(
            f"{path}: belongs to a {found.called}, not to a {kind.called}; open it with "
            f"{found.opener}"
        )
    try:
        check_types(model, manifest)
    except ValueError as error:
        raise _unreadable(path, error, kind.called) from None
    return manifest


def _unreadable(path: Path, error: Exception, called: str) -> StudyError:
    return StudyError(
        f"{path}: cannot be read as a manifest: {error}; give the --out folder of a {called}"
    )


def kind_of(manifest: Mapping[str, Any]) -> Kind:
    """Give the kind of what a folder holds."""
    return OTHERS.get(manifest["asked"]["kind"], STUDY)


def check_types(model: type[Checked], manifest: object) -> None:
    """Raise ValueError unless everything in a manifest that is read has its type."""
    try:
        model.model_validate(manifest)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise ValueError(f"{where or 'all of it'}: {first['msg']}") from None


def identity_of(manifest: Mapping[str, Any]) -> str:
    """Give a digest of all in a manifest that results depend on."""
    text = json.dumps(deciding(manifest))  # in the order of the keys, on which draws depend
    return hashlib.sha256(text.encode()).hexdigest()


def deciding(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Give what of a manifest results depend on."""
    asked = {k: v for k, v in manifest["asked"].items() if k not in DESCRIBING}
    return {**{k: v for k, v in manifest.items() if k != "identity"}, "asked": asked}
