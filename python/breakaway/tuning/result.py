"""The folder of a tuning, read as far as it is wanted."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from breakaway.errors import StudyError
from breakaway.scenario.files import load_method
from breakaway.scenario.method import Method
from breakaway.studies.folder import MANIFEST, SUMMARY, read_manifest
from breakaway.studies.parts import PARTS
from breakaway.tuning.evaluation import Evaluation
from breakaway.tuning.problem import Tuning
from breakaway.tuning.records import Records

TRIALS, UNSEEN = "trials.jsonl", "unseen.jsonl"
"""Finished trials, and scores on unseen parts, among the parts of the folder."""


class TuningResult:
    """A tuning in a folder, finished or not."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        """Where it is."""
        self.manifest: Mapping[str, Any] = read_manifest(folder)
        """What determines it: the tuning, seeds, versions."""
        if self.manifest["study"]["kind"] != "tune":
            raise StudyError(
                f"{folder / MANIFEST}: is of a study of the kind "
                f"{self.manifest['study']['kind']!r}; open it with open_study"
            )

    def __repr__(self) -> str:
        state = "finished" if self.finished else "not finished"
        return f"<tuning {self.tuning.name!r}, {len(self.evaluations)} trials, {state}>"

    @property
    def finished(self) -> bool:
        """Whether the tuning came to its end."""
        return (self.folder / SUMMARY).is_file()

    @cached_property
    def tuning(self) -> Tuning:
        """What was asked, with as many trials as are finished."""
        values = dict(self.manifest["study"])
        return Tuning.parse(values | {"trials": max(1, len(self.evaluations))})

    @cached_property
    def evaluations(self) -> list[Evaluation]:
        """All finished trials: their numbers, and their scores under every law."""
        return [Evaluation.of_json(r) for r in Records(self.folder / PARTS / TRIALS).read()]

    @property
    def summary(self) -> dict[str, Any]:
        """What was found: result, notes, front, scores on training and unseen parts.

        Raises
        ------
        StudyError
            The tuning is not finished.

        """
        if not self.finished:
            raise StudyError(
                f"{self.folder}: is not finished, {len(self.evaluations)} trials are; go on with "
                "--resume"
            )
        summary: dict[str, Any] = json.loads((self.folder / SUMMARY).read_text(encoding="utf-8"))
        return summary

    @property
    def best(self) -> Method:
        """The recommended method.

        Raises
        ------
        StudyError
            The tuning is not finished, or no trial met the constraints.

        """
        return load_method(self.folder / self._recommended["file"])

    @property
    def best_numbers(self) -> dict[str, float]:
        """The tuned numbers of the recommended method, by dotted path.

        Raises
        ------
        StudyError
            The tuning is not finished, or no trial met the constraints.

        """
        numbers: dict[str, float] = self._recommended["numbers"]
        return numbers

    @property
    def front(self) -> list[Method]:
        """The methods that none is better than, best in the first objective first.

        Raises
        ------
        StudyError
            The tuning is not finished.

        """
        return [load_method(self.folder / row["file"]) for row in self.summary["front"]]

    @property
    def _recommended(self) -> dict[str, Any]:
        summary = self.summary
        if summary["recommended"] is None:
            raise StudyError(f"{self.folder}: {summary['result'][0]}")
        recommended: dict[str, Any] = summary["recommended"]
        return recommended


def open_tuning(folder: str | Path) -> TuningResult:
    """Open a tuning's folder, finished or not.

    Parameters
    ----------
    folder : str or Path
        The folder that was tuned into.

    Returns
    -------
    TuningResult

    Raises
    ------
    StudyError
        The folder holds no tuning.

    Examples
    --------
    >>> open_tuning("nowhere")
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: nowhere: holds no study (manifest.json is missing); give ...

    """
    return TuningResult(Path(folder))
