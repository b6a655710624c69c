"""Comparison: controllers on the same parts with the same draws, run by run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.studies.base import percent
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.plan import (
    Plan,
    PointRuns,
    Row,
    Run,
    Summary,
    not_diverged,
    outcome_shares,
)
from breakaway.ask.studies.points import Point, parts_drawn
from breakaway.ask.studies.statistics import clopper_pearson, mcnemar, median_interval
from breakaway.ask.studies.study import CompareStudy, Study
from breakaway.model.scenario.scenario import Scenario

CONTROLLER = "controller"
"""Column that tells controllers apart."""


class ComparePlan(Plan):
    """Every controller a point, all with the same run numbers and the same parts."""

    def __init__(self, study: CompareStudy) -> None:
        self.study = study
        draw = parts_drawn(study)
        self.scenarios = {c.name: c.applied_to(study.base) for c in study.compare.controllers}
        self.points = [
            Point({CONTROLLER: name}, scenario, range(study.runs), draw)
            for name, scenario in self.scenarios.items()
        ]
        self.varied = list(study.vary)
        self.runs_max = len(self.points) * study.runs

    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:
        """Give the scenario with the controller of that name."""
        return self.scenarios[str(labels[CONTROLLER])]

    def conduct(self, run: Run) -> Summary:
        """Run all controllers, and compare the others with the first."""
        first, *others = run(self.points, "controllers")
        confidence = self.study.compare.confidence
        outcomes = [self._outcome_row(runs, first) for runs in (first, *others)]
        differences = [
            difference_row(first, other, name, confidence)
            for other in others
            for name in self.study.recorded
        ]
        return Summary(
            result=[_released(row, outcomes[0]) for row in outcomes[1:]],
            tables={"outcomes": outcomes, "differences": differences},
            notes=[
                "differences are the other controller's value less the first one's in the same "
                "run, over runs that diverged under neither and have the metric under both; their "
                f"medians have intervals by order statistics at {percent(confidence)}",
                "p: McNemar's exact test that both release equally often; not corrected for the "
                "number of controllers or metrics",
            ],
        )

    def _outcome_row(self, runs: PointRuns, first: PointRuns) -> Row:
        outcomes = runs.outcomes()
        here, there = (
            found == OUTCOMES.index("released") for found in (outcomes, first.outcomes())
        )
        row: Row = {CONTROLLER: runs.point.labels[CONTROLLER], "runs": len(outcomes)}
        row |= outcome_shares(outcomes, self.study.compare.confidence)
        if runs is first:
            return row | {"only_this_released": None, "only_first_released": None, "p": None}
        only_here, only_there = int((here & ~there).sum()), int((there & ~here).sum())
        return row | {
            "only_this_released": only_here,
            "only_first_released": only_there,
            "p": mcnemar(only_here, only_there),
        }

    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw outcomes and paired differences."""
        from breakaway.show.plots.study import plot_compare

        shown = [row for row in summary.tables["differences"] if row["metric"] in study.shown]
        return {"compare": plot_compare(study.name, summary.tables["outcomes"], shown)}


def difference_row(first: PointRuns, other: PointRuns, metric: str, confidence: float) -> Row:
    """Compare a metric of two controllers run by run."""
    usable = not_diverged(first.outcomes()) & not_diverged(other.outcomes())
    return {
        CONTROLLER: other.point.labels[CONTROLLER],
        "first": first.point.labels[CONTROLLER],
        "metric": metric,
        **paired(first.column(metric), other.column(metric), usable, confidence),
    }


def paired(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    usable: NDArray[np.bool_],
    confidence: float,
) -> Row:
    """Give what the pairs of two columns show of their difference.

    Examples
    --------
    >>> import numpy as np
    >>> before, usable = np.arange(10.0), np.ones(10, dtype=bool)
    >>> row = paired(before, before - 1.0, usable, 0.95)
    >>> row["pairs"], row["difference"], row["difference_low"], row["lower_share"]
    (10, -1.0, -1.0, 1.0)

    """
    both = usable & np.isfinite(before) & np.isfinite(after)
    difference = after[both] - before[both]
    names = ("difference", "difference_low", "difference_high", "difference_p05", "difference_p95")
    shares = ("lower_share", "lower_low", "lower_high")
    if not len(difference):
        return {"pairs": 0, "first_median": None, **dict.fromkeys((*names, *shares))}
    interval = median_interval(difference, confidence)
    p05, p95 = (float(q) for q in np.quantile(difference, [0.05, 0.95]))
    lower = int((difference < 0.0).sum())
    low, high = clopper_pearson(lower, len(difference), confidence)
    return {
        "pairs": len(difference),
        "first_median": float(np.median(before[both])),
        **dict(zip(names, (interval.median, interval.low, interval.high, p05, p95), strict=True)),
        **dict(zip(shares, (lower / len(difference), low, high), strict=True)),
    }


def _released(row: Row, first: Row) -> str:
    return (
        f"{row[CONTROLLER]} released {row['released']} of {row['runs']} parts, {first[CONTROLLER]} "
        f"{first['released']} of the same ones; only {row[CONTROLLER]}: "
        f"{row['only_this_released']}, only {first[CONTROLLER]}: {row['only_first_released']}; "
        f"p = {row['p']:.3g}"
    )
