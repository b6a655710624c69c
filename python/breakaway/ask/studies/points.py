"""The points of a study: a scenario, what differs between its runs, and how many there are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.studies.base import StudyBase
from breakaway.ask.studies.levels import Level
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.distribution import Distribution
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch import Batch, draw_columns, simulate_many
from breakaway.run.batch.columns import check_values, with_nominal_controller

Columns = dict[str, NDArray[np.float64]]
Draw = Callable[[range], Columns]
"""Run numbers -> the values of what differs between them."""

CHECKED_TOGETHER = 100_000
"""Runs whose values are drawn and checked at a time."""


def no_columns(_: range) -> Columns:
    """Give no columns: the runs differ in the draws of the disturbance only."""
    return {}


@dataclass(frozen=True)
class Point:
    """Runs that belong together: of one point of a grid, one level, one controller."""

    labels: Mapping[str, Level]
    """What tells it from the other points, by name of a column."""
    scenario: Scenario
    """What its runs have in common."""
    runs: range
    """The numbers of its runs."""
    draw: Draw = field(default=no_columns)
    """What differs between its runs."""

    def simulate(
        self,
        rows: range,
        *,
        metrics: tuple[str, ...],
        threads: int | None,
        progress: Callable[[int, int], None],
    ) -> Batch:
        """Simulate some of its runs, counted from its first."""
        numbers = self.runs[rows.start : rows.stop]
        return simulate_many(
            self.scenario,
            numbers,
            vary=self.draw(numbers),
            metrics=[*metrics, "outcome"],
            threads=threads,
            progress=progress,
        )

    def check(self) -> None:
        """Raise unless every one of its runs is a valid scenario.

        Raises
        ------
        StudyError
            A run is not valid; the message names the point, the run, the field and the value.

        """
        try:
            nominal = with_nominal_controller(self.scenario)
            for numbers in _slices(self.runs, CHECKED_TOGETHER):
                check_values(nominal, self.draw(numbers), numbers.start)
        except (StudyError, ScenarioError) as error:
            where = ", ".join(f"{name} = {value}" for name, value in self.labels.items())
            raise StudyError(f"{where}: {error}" if where else str(error)) from None


def parts_drawn(study: StudyBase, vary: Mapping[str, Distribution] | None = None) -> Draw:
    """Give the draw of a study's parts, or of other distributions by the same seed and design.

    A design that is no sequence of independent draws is computed once, whole.
    """
    distributions = study.vary if vary is None else vary
    seed = study.base.seed
    if not distributions:
        return no_columns
    if study.design == "random":
        return lambda runs: draw_columns(distributions, runs, seed=seed)
    whole = draw_columns(distributions, range(study.runs), seed=seed, design=study.design)
    return lambda runs: {path: values[runs.start : runs.stop] for path, values in whole.items()}


def _slices(runs: range, length: int) -> Iterator[range]:
    for start in range(0, len(runs), length):
        yield runs[start : start + length]
