"""The sweep: what becomes of the extraction over a grid of values, or over many parts."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from math import prod
from typing import Any

from breakaway.ask.studies.base import changed, percent
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.plan import (
    Plan,
    PointRuns,
    Row,
    Run,
    Summary,
    metric_spread,
    not_diverged,
    outcome_shares,
)
from breakaway.ask.studies.points import Point, parts_drawn
from breakaway.ask.studies.study import Study, SweepStudy
from breakaway.errors import StudyError
from breakaway.model.scenario.scenario import Scenario

POINTS_MAX = 100_000
"""Most points of a grid."""


class SweepPlan(Plan):
    """Every combination of the grid's values, each with the same run numbers."""

    def __init__(self, study: SweepStudy) -> None:
        self.study = study
        grid = study.sweep.grid
        count = prod(len(levels) for levels in grid.values())
        if count > POINTS_MAX:
            raise StudyError(f"sweep.grid: has {count} points, not <= {POINTS_MAX}; give fewer")
        draw = parts_drawn(study)
        combinations = (dict(zip(grid, levels, strict=True)) for levels in product(*grid.values()))
        self.points = [
            Point(labels, self.scenario_at(labels), range(study.runs), draw)
            for labels in combinations
        ]
        self.varied = list(study.vary)
        self.runs_max = count * study.runs

    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:
        """Give the scenario of a point of the grid."""
        return changed(self.study.base, labels, "sweep.grid") if labels else self.study.base

    def conduct(self, run: Run) -> Summary:
        """Run all points, and give the outcomes and metrics of each."""
        finished = run(self.points, "grid" if self.study.sweep.grid else "runs")
        rows = [self._row(runs) for runs in finished]
        runs = sum(row["runs"] for row in rows)
        released = sum(row["released"] for row in rows)
        points = f"{len(rows)} point" + ("s" if len(rows) > 1 else "")
        return Summary(
            result=[f"{released} of {runs} runs released, at {points} of {self.study.runs} each"],
            tables={"points": rows},
            notes=[
                "metrics are medians and 5 to 95 % ranges of the runs that did not diverge and in "
                "which they are numbers",
                f"shares of outcomes have intervals of Clopper and Pearson at "
                f"{percent(self.study.sweep.confidence)}, each by itself",
            ],
        )

    def _row(self, runs: PointRuns) -> Row:
        outcomes = runs.outcomes()
        row: Row = {**runs.point.labels, "runs": len(outcomes)}
        row |= outcome_shares(outcomes, self.study.sweep.confidence)
        usable = not_diverged(outcomes)
        for name in self.study.recorded:
            row |= metric_spread(runs.column(name), usable, name)
        return row

    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw outcomes and metrics over what is swept; of a single point, nothing is swept."""
        from breakaway.show.plots.study import plot_sweep

        paths = list(self.study.sweep.grid)
        if not paths:
            return {}
        return {"sweep": plot_sweep(study.name, summary.tables["points"], paths, list(study.shown))}
