"""Sensitivity: which of the numbers that differ from part to part matter, by Sobol indices."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.studies.base import percent
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.plan import Plan, Row, Run, Summary, not_diverged
from breakaway.ask.studies.points import Columns, Draw, Point
from breakaway.ask.studies.study import SensitivityStudy, Study
from breakaway.errors import StudyError
from breakaway.model.scenario.scenario import Scenario

Array = NDArray[np.float64]

BLOCK = "block"
"""Column that tells the blocks of samples apart: ``A``, ``B``, and ``A`` with one input of B."""
DRAWS = "disturbance draws"
"""The input that the draws of the disturbance are."""
RESAMPLED = 2**23
"""Values that are resampled at a time for an interval, which bounds its memory."""


class SensitivityPlan(Plan):
    """Saltelli's design, each of its blocks a point.

    Runs of block A, and of A with one input of B, have the same numbers 0 to N - 1 and so the
    same draws of the disturbance; those of B have N to 2 N - 1. The draws are thereby an input
    like any other, with a block of their own where there is a disturbance: A with B's run
    numbers.
    """

    def __init__(self, study: SensitivityStudy) -> None:
        self.study = study
        self.sobol = _salib("analyze.sobol")
        self.varied = list(study.vary)
        disturbed = study.base.disturbance.var > 0.0 or "disturbance.var" in study.vary
        self.inputs = [*study.vary, *([DRAWS] if disturbed else [])]
        first, second = _base_samples(study)
        near, far = range(study.runs), range(study.runs, 2 * study.runs)
        self.points = [self._point("A", first, near), self._point("B", second, far)]
        for place, name in enumerate(self.inputs):
            if name == DRAWS:
                self.points.append(self._point(DRAWS, first, far))
            else:
                mixed = first.copy()
                mixed[:, place] = second[:, place]
                self.points.append(self._point(name, mixed, near))
        self.runs_max = len(self.points) * study.runs

    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:  # noqa: ARG002
        """Give the study's scenario: the blocks differ in what varies only."""
        return self.study.base

    def _point(self, block: str, fractions: Array, runs: range) -> Point:
        return Point({BLOCK: block}, self.study.base, runs, self._drawn(fractions, runs.start))

    def _drawn(self, fractions: Array, first_run: int) -> Draw:
        def drawn(runs: range) -> Columns:
            rows = slice(runs.start - first_run, runs.stop - first_run)
            return {
                path: law.quantile(fractions[rows, place])
                for place, (path, law) in enumerate(self.study.vary.items())
            }

        return drawn

    def conduct(self, run: Run) -> Summary:
        """Run all blocks, and give the indices of every metric that has them."""
        blocks = run(self.points, "blocks")
        rows: list[Row] = []
        without: dict[str, str] = {}
        diverged = sum(int((~not_diverged(block.outcomes())).sum()) for block in blocks)
        for name in self.study.recorded:
            columns = [block.column(name) for block in blocks]
            reason = _unusable(columns, diverged)
            if reason:
                without[name] = reason
            else:
                rows += self._indices(name, columns)
        return Summary(
            result=[_strongest(rows, name) for name in self.study.shown if name not in without],
            tables={"indices": rows},
            notes=self._notes(without),
            facts={"without_indices": without},
        )

    def _indices(self, metric: str, columns: list[Array]) -> list[Row]:
        """Estimate first and total order of all inputs."""
        first, second, *mixed = columns
        outputs = np.column_stack([first, *mixed, second]).ravel()  # the order that SALib expects
        confidence = self.study.sensitivity.confidence
        found = self.sobol.analyze(
            {"num_vars": len(self.inputs), "names": self.inputs, "bounds": [[0, 1]] * len(mixed)},
            outputs,
            calc_second_order=False,
            num_resamples=int(np.clip(RESAMPLED // self.study.runs, 100, 1000)),
            conf_level=confidence,
            seed=1 + self.study.base.seed,  # for which 0 would mean none
        )
        return [
            {
                "metric": metric,
                "input": name,
                "first_order": float(found["S1"][k]),
                "first_order_error": float(found["S1_conf"][k]),
                "total_order": float(found["ST"][k]),
                "total_order_error": float(found["ST_conf"][k]),
            }
            for k, name in enumerate(self.inputs)
        ]

    def _notes(self, without: Mapping[str, str]) -> list[str]:
        notes = [
            "first order: the share of a metric's variance that an input explains by itself; total "
            "order: including all interactions with others; errors are half widths of bootstrap "
            f"intervals at {percent(self.study.sensitivity.confidence)}"
        ]
        reasons: dict[str, list[str]] = {}
        for name, reason in without.items():
            if self.study.metrics is not None or name in self.study.shown:
                reasons.setdefault(reason, []).append(name)
        notes += [f"no indices of {', '.join(names)}: {why}" for why, names in reasons.items()]
        return notes

    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw the indices of the shown metrics that have them."""
        from breakaway.show.plots.study import plot_sensitivity

        rows = [row for row in summary.tables["indices"] if row["metric"] in study.shown]
        return {"sensitivity": plot_sensitivity(study.name, rows)} if rows else {}


def _base_samples(study: SensitivityStudy) -> tuple[Array, Array]:
    """Give two samples of the unit cube, by SALib from a scrambled Sobol sequence."""
    count = len(study.vary)
    problem = {"num_vars": count, "names": list(study.vary), "bounds": [[0.0, 1.0]] * count}
    with np.errstate(all="ignore"):
        table = _salib("sample.sobol").sample(
            problem, study.runs, calc_second_order=False, seed=study.base.seed
        )
    inside = np.clip(table, 2.0**-53, 1.0 - 2.0**-53)  # where quantiles are finite
    return inside[:: count + 2], inside[count + 1 :: count + 2]


def _salib(module: str) -> Any:  # noqa: ANN401 - has no type stubs
    try:
        return import_module(f"SALib.{module}")
    except ImportError:
        raise StudyError(
            "SALib is not installed, and sensitivity studies need it; install it with: pip install "
            "'breakaway[sensitivity]'"
        ) from None


def _unusable(columns: list[Array], diverged: int) -> str | None:
    """Say why a metric has no indices, None where it has."""
    total = sum(len(column) for column in columns)
    if diverged:
        return (
            f"{diverged} of {total} runs diverged, and their metrics end there; give narrower "
            "distributions"
        )
    missing = sum(int((~np.isfinite(column)).sum()) for column in columns)
    if missing:
        return f"missing in {missing} of {total} runs"
    # Rounding alone is no variance to be shared out.
    spread = max(float(np.ptp(column)) for column in columns)
    if spread <= 1e-12 * max(float(np.abs(column).max()) for column in columns):
        return "the same in all runs"
    return None


def _strongest(rows: list[Row], metric: str) -> str:
    indices = [row for row in rows if row["metric"] == metric]
    top = max(indices, key=lambda row: float(row["total_order"]))
    return (
        f"{metric}: {top['input']} has the largest index, total order {top['total_order']:.2f} "
        f"± {top['total_order_error']:.2f}, first order {top['first_order']:.2f} "
        f"± {top['first_order_error']:.2f}"
    )
