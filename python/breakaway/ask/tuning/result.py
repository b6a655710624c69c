"""The folder of a tuning, read as far as it is wanted."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from breakaway.ask.studies.folder import SUMMARY, is_finished, read_summary
from breakaway.ask.studies.manifest import MANIFEST, kind_of, read_manifest
from breakaway.ask.studies.pieces import Pieces
from breakaway.ask.tuning.evaluation import Evaluation
from breakaway.ask.tuning.problem import Tuning
from breakaway.ask.tuning.records import TRIALS, Records
from breakaway.base.one_line import OneLine
from breakaway.base.reading import is_file
from breakaway.errors import StudyError
from breakaway.model.scenario.files import load_method
from breakaway.model.scenario.method import Method


class TuningResult(OneLine):
    """A tuning in a folder, finished or not."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        """Where it is."""
        self.manifest: Mapping[str, Any] = read_manifest(folder)
        """What determines it: the tuning, seeds, versions."""
        if kind_of(self.manifest) != "tuning":
            kind = self.manifest["study"]["kind"]
            raise StudyError(
                f"{folder / MANIFEST}: is of a study of the kind {kind!r}; open it with open_study"
            )
        self._pieces = Pieces(folder, self.manifest["identity"])

    def __repr__(self) -> str:
        state = "finished" if self.finished else "not finished"
        return f"<tuning {self.tuning.name!r}, {len(self.evaluations)} trials, {state}>"

    @property
    def finished(self) -> bool:
        """Whether it came to its end, and its trials and the summary are as it wrote them."""
        return is_finished(self._pieces)

    @cached_property
    def tuning(self) -> Tuning:
        """What was asked, with as many trials as are finished."""
        values = dict(self.manifest["study"])
        return Tuning.parse(values | {"trials": max(1, len(self.evaluations))})

    @cached_property
    def evaluations(self) -> list[Evaluation]:
        """All finished trials: their numbers, and their scores under every law.

        Raises
        ------
        StudyError
            A trial is not as it was written.

        """
        records = Records(self.folder, TRIALS, self._pieces.identity)
        return [Evaluation.of_json(record) for record in records.read_whole()]

    @property
    def summary(self) -> dict[str, Any]:
        """What was found: result, notes, front, scores on training and unseen parts.

        Raises
        ------
        StudyError
            The tuning is not finished, or its trials or the summary are not as it wrote them.

        """
        if not is_file(self.folder / SUMMARY):
            raise StudyError(
                f"{self.folder}: is not finished, {len(self.evaluations)} trials are; go on with "
                "--resume"
            )
        return read_summary(self._pieces)

    @property
    def best(self) -> Method:
        """The recommended method.

        Raises
        ------
        StudyError
            The tuning is not finished, no trial met the constraints, or the method's file is not
            as it was written.

        """
        return self._method(self._recommended["file"])

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
        return [self._method(row["file"]) for row in self.summary["front"]]

    def _method(self, name: str) -> Method:
        self._pieces.refuse_flawed(name)
        return load_method(self.folder / name)

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
