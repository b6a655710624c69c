"""Figure 10's simulations: many runs at each level of the disturbance, kept level by level."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.durable.progress import Progress
from breakaway.ask.studies import (
    StudyResult,
    SweepStudy,
    SweepTable,
    open_study,
    run_study,
)
from breakaway.ask.studies.statistics import upper_bound
from breakaway.errors import StudyError
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch import simulate_many

Values = NDArray[np.float64]
Counts = NDArray[np.int64]

CONTROLS = {
    "without_vibration": "paper_as_computed",
    "with_vibration": "paper_as_computed_vibration",
    "with_vibration_bounded": "paper_as_computed_vibration_bounded",
}
"""The two controllers of the paper, and the reading of the second that stays bounded."""

NAMES = {
    "without_vibration": "without vibration",
    "with_vibration": "with vibration, as printed",
    "with_vibration_bounded": "with vibration, bounded",
}
"""Control -> what it is called."""

QUICK_LEVELS = (0.0, 0.025, 0.05, 0.075, 0.085, 0.1, 0.125, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9)
QUICK_SEEDS = 40
FULL_LEVELS = tuple(sorted({*QUICK_LEVELS, 0.175, 0.25, 0.6, 0.8, 0.95, 0.99}))
FULL_SEEDS = 10_000
CONFIDENCE = 0.95
"""Confidence of the upper bounds of probabilities."""

METRICS = ("iae_m_s", "peak_force_n", "largest_jump_m")
VAR = "disturbance.var"


@dataclass(frozen=True)
class DisturbanceRange:
    """IAE against the disturbance's half width var, over many runs each."""

    var: Values
    """Levels of var."""
    iae_m_s: Values
    """IAE of each run, levels x runs; NaN for a run that diverged."""
    peak_force_n: Values
    """Peak force of each run, levels x runs; NaN for a run that diverged."""
    largest_jump_m: Values
    """Largest jump of each run, levels x runs; NaN for a run that diverged."""
    outcomes: Mapping[str, Counts]
    """Number of runs that ended so, by outcome and level."""
    runs: int
    """Runs at each level."""

    @property
    def stable(self) -> Counts:
        """Number of runs that did not diverge, by level."""
        return self.runs - self.outcomes["diverged"]

    @property
    def released(self) -> Counts:
        """Number of runs that released the part, by level."""
        return self.outcomes["released"]

    @property
    def largest_stable_var(self) -> float | None:
        """The largest level up to which no run at any level diverged; None if one did at 0."""
        failing = np.flatnonzero(self.stable < self.runs)
        first = int(failing[0]) if failing.size else len(self.var)
        return float(self.var[first - 1]) if first else None

    def level(self, var: float) -> int:
        """Give the place of the level that is nearest to a value of var."""
        return int(np.argmin(np.abs(self.var - var)))

    def rows(self) -> list[dict[str, float | int | None]]:
        """Outcomes, upper bounds and IAE of each level.

        An upper bound is the one-sided one of Clopper and Pearson. There is none at var = 0, where
        nothing is drawn and all runs are the same one. IAE is that of the runs that did not
        diverge; None where all did.
        """
        return [self._row(i) for i in range(len(self.var))]

    def _row(self, i: int) -> dict[str, float | int | None]:
        counts = {name: int(values[i]) for name, values in self.outcomes.items()}
        kept = self.iae_m_s[i][np.isfinite(self.iae_m_s[i])]
        low, median, high = np.percentile(kept, [5, 50, 95]).tolist() if kept.size else [None] * 3
        drawn = self.var[i] > 0.0
        missed = self.runs - counts["released"]
        return {
            "var": float(self.var[i]),
            "runs": self.runs,
            **counts,
            "diverged_upper_bound": self._bound(counts["diverged"]) if drawn else None,
            "not_extracted_upper_bound": self._bound(missed) if drawn else None,
            "iae_5_percent_m_s": low,
            "iae_median_m_s": median,
            "iae_95_percent_m_s": high,
        }

    def _bound(self, events: int) -> float:
        return upper_bound(events, self.runs, CONFIDENCE)


def disturbance_range(
    scenario: Scenario, levels: Sequence[float] = QUICK_LEVELS, seeds: int = QUICK_SEEDS
) -> DisturbanceRange:
    """Simulate every level of var with run numbers 0 to ``seeds - 1``.

    Parameters
    ----------
    scenario : Scenario
        The extraction; its disturbance is uniform.
    levels : sequence of float, optional
        Levels of var, rising.
    seeds : int, optional
        Runs at each level.

    Examples
    --------
    >>> import breakaway as bk
    >>> survey = disturbance_range(bk.load_scenario("paper_as_computed"), [0.0, 0.5], 2)
    >>> survey.released.tolist(), survey.largest_stable_var
    ([2, 2], 0.5)

    """
    batches = [
        simulate_many(scenario.with_({VAR: var}), seeds, metrics=[*METRICS, "outcome"])
        for var in levels
    ]
    columns = {name: np.stack([batch[name] for batch in batches]) for name in METRICS}
    return _range(levels, columns, np.stack([batch["outcome"] for batch in batches]))


def _range(
    levels: Sequence[float], columns: Mapping[str, Values], outcomes: NDArray[Any]
) -> DisturbanceRange:
    """Count outcomes, and leave the metrics of diverged runs out. All are levels x runs."""
    usable = outcomes != "diverged"
    metrics = {name: np.where(usable, values, np.nan) for name, values in columns.items()}
    return DisturbanceRange(
        var=np.asarray(levels, dtype=np.float64),
        outcomes={name: np.count_nonzero(outcomes == name, axis=1) for name in OUTCOMES},
        runs=outcomes.shape[1],
        **metrics,
    )


@dataclass(frozen=True)
class FullSurvey:
    """Figure 10 in full: a study for each control, in folders that outlive an interruption.

    A finished level is on disk and is not computed again.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ranges = FullSurvey(levels=(0.05, 0.5), seeds=4).run(Path(folder) / "figure_10")
    >>> ranges["without_vibration"].released.tolist()
    [4, 4]

    """

    levels: Sequence[float] = FULL_LEVELS
    """Levels of var, rising."""
    seeds: int = FULL_SEEDS
    """Runs at each level, numbered from 0."""
    progress: Callable[[Progress], None] | None = field(default=None, compare=False)
    """Called about 20 times a second while runs are under way."""
    notice: Callable[[str], None] | None = field(default=None, compare=False)
    """Called with a sentence when a damaged file of a level is computed again."""

    def study(self, control: str) -> SweepStudy:
        """Give the study of a control.

        Parameters
        ----------
        control : str
            A key of `CONTROLS`.

        Examples
        --------
        >>> FullSurvey().study("without_vibration").runs
        10000

        """
        return SweepStudy(
            name=f"figure 10, {control.replace('_', ' ')}",
            scenario=load_scenario(CONTROLS[control]),
            runs=self.seeds,
            runs_per_piece=self.seeds,
            metrics=list(METRICS),
            sweep=SweepTable(grid={VAR: list(self.levels)}, confidence=CONFIDENCE),
        )

    def run(self, folder: Path) -> dict[str, DisturbanceRange]:
        """Simulate what the folder does not yet hold, and read the whole.

        Parameters
        ----------
        folder : Path
            Receives a folder for each control.

        Raises
        ------
        StudyError
            The folder holds figure 10 with other settings or of another version.
        OutputError
            The folder cannot be written; finished levels stay.
        KeyboardInterrupt
            Ctrl-C; finished levels stay.

        """
        total = _Total(len(CONTROLS) * len(self.levels) * self.seeds, self.progress)
        for control in CONTROLS:
            run_study(
                self.study(control),
                out=folder / control,
                resume=(folder / control / "manifest.json").exists(),
                progress=total.reporter(control.replace("_", " ")),
                notice=self.notice,
            )
        return read_survey(folder)


class _Total:
    """The progress of several studies, one after the other, as that of one."""

    def __init__(self, runs_max: int, report: Callable[[Progress], None] | None) -> None:
        self._runs_max, self._report = runs_max, report
        self._last = Progress(runs_done=0, runs_found=0, runs_max=runs_max, doing="")

    def reporter(self, doing: str) -> Callable[[Progress], None] | None:
        """Give what the next study reports to."""
        before, report = self._last, self._report
        if report is None:
            return None

        def told(at: Progress) -> None:
            self._last = Progress(
                runs_done=before.runs_done + at.runs_done,
                runs_found=before.runs_found + at.runs_found,
                runs_max=self._runs_max,
                doing=doing,
            )
            report(self._last)

        return told


def read_survey(folder: Path) -> dict[str, DisturbanceRange]:
    """Read a finished survey, by control.

    Parameters
    ----------
    folder : Path
        The folder that a `FullSurvey` was run into.

    Raises
    ------
    StudyError
        The folder holds none, or one that is not finished.

    Examples
    --------
    >>> read_survey(Path("nowhere"))
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: nowhere/without_vibration: holds no study ...

    """
    return {control: _read(open_study(folder / control)) for control in CONTROLS}


def _read(result: StudyResult) -> DisturbanceRange:
    if not result.finished:
        raise StudyError(f"{result.folder}: is not finished; go on with breakaway reproduce --full")
    table = result.scan([VAR, *METRICS, "outcome"])
    shape = (-1, int(result.manifest["asked"]["runs"]))
    levels = table[VAR].to_numpy().reshape(shape)[:, 0]
    columns = {name: table[name].to_numpy().reshape(shape) for name in METRICS}
    return _range(levels, columns, np.asarray(table["outcome"].to_pylist()).reshape(shape))
