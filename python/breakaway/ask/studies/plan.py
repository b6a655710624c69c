"""How a study goes: its points, what becomes of them, and what they show in the end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.points import Point
from breakaway.ask.studies.run_pieces import RunPieces, Stretch
from breakaway.ask.studies.statistics import clopper_pearson
from breakaway.ask.studies.study import Study
from breakaway.model.scenario.scenario import Scenario

Row = dict[str, Any]
"""One row of a table: texts, numbers, true or false; None for what is not there."""


@dataclass(frozen=True)
class PointRuns:
    """The finished runs of a point, in the pieces that hold them."""

    point: Point
    """The point."""
    stretches: Sequence[tuple[str, Stretch]]
    """Name of a piece, and where in it they are."""
    pieces: RunPieces
    """What reads pieces."""

    def column(self, name: str) -> NDArray[Any]:
        """Read a column of all its runs, in their order."""
        return np.concatenate(
            [self.pieces.column(name, piece, stretch) for piece, stretch in self.stretches]
        )

    def outcomes(self) -> NDArray[np.int8]:
        """Read how its runs ended, as places among the outcomes."""
        return self.column("outcome")


Run = Callable[[Sequence[Point], str], list[PointRuns]]
"""Points, and what is done with them in words -> their finished runs."""


@dataclass
class Summary:
    """What a study shows."""

    result: list[str]
    """The answer, in sentences that say what they mean."""
    tables: dict[str, list[Row]]
    """Tables by name."""
    notes: list[str] = field(default_factory=list)
    """What to know before trusting the answer."""
    facts: Row = field(default_factory=dict)
    """Single numbers of the answer."""


class Plan(ABC):
    """A study that can be run: each kind has its own."""

    runs_max: int
    """The most runs that it may take."""
    points: list[Point]
    """Points that are known before anything runs, or that bound the others; all are checked."""
    varied: list[str]
    """What differs between the runs of a point, by path, without what tells points apart."""

    @abstractmethod
    def conduct(self, run: Run) -> Summary:
        """Run the points, and say what they show."""

    @abstractmethod
    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:
        """Give the scenario of the point with these labels; what varies is not in it."""

    @abstractmethod
    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw the figures, by name."""


def outcome_counts(outcomes: NDArray[np.int8]) -> dict[str, int]:
    """Count how runs ended."""
    counts = np.bincount(outcomes, minlength=len(OUTCOMES))
    return {name: int(counts[place]) for place, name in enumerate(OUTCOMES)}


def outcome_shares(outcomes: NDArray[np.int8], confidence: float) -> Row:
    """Give the share of each outcome, and the interval of its probability."""
    row: Row = {}
    for name, count in outcome_counts(outcomes).items():
        low, high = clopper_pearson(count, len(outcomes), confidence)
        row |= {
            name: count,
            f"{name}_share": count / len(outcomes),
            f"{name}_low": low,
            f"{name}_high": high,
        }
    return row


def metric_spread(values: NDArray[np.float64], usable: NDArray[np.bool_], name: str) -> Row:
    """Give median and 5 to 95 % range of a metric, among the usable runs where it is a number."""
    kept = values[usable & np.isfinite(values)]
    if not len(kept):
        return {f"{name}_runs": 0, **{f"{name}_{q}": None for q in ("p05", "median", "p95")}}
    p05, median, p95 = (float(q) for q in np.quantile(kept, [0.05, 0.5, 0.95]))
    return {
        f"{name}_runs": len(kept),
        f"{name}_p05": p05,
        f"{name}_median": median,
        f"{name}_p95": p95,
    }


def not_diverged(outcomes: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Tell which runs did not diverge: metrics of the others are those until they did."""
    usable: NDArray[np.bool_] = outcomes != OUTCOMES.index("diverged")
    return usable
