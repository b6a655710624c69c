"""The manifest of a folder: what determines its results, and an identity made of that."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from breakaway._core import __version__
from breakaway.ask.studies.parts import label_types, part_schema
from breakaway.ask.studies.plan import Plan
from breakaway.ask.studies.study import Study
from breakaway.base.reading import read_json
from breakaway.errors import StudyError
from breakaway.run.resolution import resolve

MANIFEST = "manifest.json"
FORMAT = 2
"""Number of the folder's layout."""
DESCRIBING = ("name", "description")
"""Keys of a study that its results do not depend on."""
MOST_MANIFEST_BYTES = 16 * 2**20
"""Most bytes of a manifest: that of a study with many points has 100 kB."""
OTHERS = {"tune": "tuning", "comparison": "comparison"}
"""Kinds of folders beside studies, and what they are called."""


class _Checked(BaseModel):
    model_config = ConfigDict(strict=True)  # what is more than this stays as it is


class _Asked(_Checked):
    kind: str
    name: str = ""


class _Column(_Checked):
    name: str
    type: str
    unit: str


class _Manifest(_Checked):
    """What a manifest has, whatever its kind."""

    format: int
    identity: str
    breakaway_version: str
    libraries: dict[str, str]
    study: _Asked


class _StudyManifest(_Manifest):
    """What that of a study has beside."""

    seed: int
    labels: dict[str, Literal["bool", "int64", "double", "string"]]
    varied: list[str]
    metrics: list[str]
    columns: list[_Column]


def manifest_of(study: Study, plan: Plan) -> dict[str, Any]:
    """Give what determines the results of a study, and what they look like.

    Examples
    --------
    >>> import breakaway as bk
    >>> from breakaway.ask.studies.study import SweepStudy
    >>> from breakaway.ask.studies.sweep import SweepPlan
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


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read the manifest of a study, a tuning or a comparison.

    Raises
    ------
    StudyError
        There is none, it can not be read, or its identity is not that of its content.

    """
    path = folder / MANIFEST
    try:
        manifest: dict[str, Any] = read_json(path, MOST_MANIFEST_BYTES)
        _check_types(manifest)
    except (FileNotFoundError, NotADirectoryError):
        raise StudyError(
            f"{folder}: holds no study ({MANIFEST} is missing); give the --out of a study"
        ) from None
    except (OSError, ValueError) as error:
        raise StudyError(
            f"{path}: can not be read as a manifest: {error}; give the --out of a study"
        ) from None
    if manifest["format"] != FORMAT:
        raise StudyError(
            f"{path}: has the format {manifest['format']}, not {FORMAT}; open it with breakaway "
            f"{manifest['breakaway_version']}"
        )
    if manifest["identity"] != identity_of(manifest):
        raise StudyError(
            f"{path}: was changed: its identity is not that of its content; put back what was "
            "there, or begin again in another folder"
        )
    return manifest


def kind_of(manifest: Mapping[str, Any]) -> str:
    """Give what a folder holds, in a word."""
    return OTHERS.get(manifest["study"]["kind"], "study")


def _check_types(manifest: object) -> None:
    """Raise ValueError unless everything in a manifest that is read has its type."""
    try:
        kind = _Manifest.model_validate(manifest).study.kind
        if kind not in OTHERS:
            _StudyManifest.model_validate(manifest)
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
    study = {k: v for k, v in manifest["study"].items() if k not in DESCRIBING}
    return {**{k: v for k, v in manifest.items() if k != "identity"}, "study": study}
