"""The folder of a tuning; only what is asked for is read."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

from breakaway.ask.durable.finished import DurableFolder
from breakaway.ask.durable.manifest import TUNING
from breakaway.ask.durable.records import Records
from breakaway.ask.tuning.evaluation import Evaluation
from breakaway.ask.tuning.problem import Tuning
from breakaway.ask.tuning.writing import EVALUATIONS
from breakaway.base.one_line import OneLine
from breakaway.errors import StudyError
from breakaway.model.scenario.files import load_method
from breakaway.model.scenario.method import Method


class TuningResult(OneLine, DurableFolder):
    """A tuning in a folder, finished or not."""

    _kind = TUNING

    def __repr__(self) -> str:
        state = "finished" if self.finished else "not finished"
        return f"<tuning {self.tuning.name!r}, {self._kept}, {state}>"

    @property
    def _kept(self) -> str:
        return f"{len(self.evaluations)} evaluations"

    @cached_property
    def tuning(self) -> Tuning:
        """What was asked, with as many evaluations as are finished."""
        values = dict(self.manifest["asked"])
        return Tuning.parse(values | {"evaluations": max(1, len(self.evaluations))})

    @cached_property
    def evaluations(self) -> list[Evaluation]:
        """All finished evaluations: their numbers, and their scores under every law.

        Raises
        ------
        StudyError
            An evaluation is not as it was written.

        """
        records = Records(self.folder, EVALUATIONS, self._journal.identity)
        return [Evaluation.of_json(record) for record in records.read_whole()]

    @property
    def best(self) -> Method:
        """The recommended method.

        Raises
        ------
        StudyError
            The tuning is not finished, no evaluation met the constraints, or the method's file is
            not as it was written.

        """
        return self._method(self._recommended["file"])

    @property
    def best_numbers(self) -> dict[str, float]:
        """The tuned numbers of the recommended method, by dotted path.

        Raises
        ------
        StudyError
            The tuning is not finished, or no evaluation met the constraints.

        """
        numbers: dict[str, float] = self._recommended["numbers"]
        return numbers

    @property
    def front(self) -> list[Method]:
        """The methods that no other beats, best in the first objective first.

        Raises
        ------
        StudyError
            The tuning is not finished.

        """
        return [self._method(row["file"]) for row in self.summary["front"]]

    def _method(self, name: str) -> Method:
        self._journal.refuse_flawed(name)
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
    breakaway.errors.StudyError: nowhere: holds no tuning (manifest.json is missing); give ...

    """
    return TuningResult(folder)
