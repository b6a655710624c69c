"""Robustness: the largest level of a number, or of the parts' spread, that is survived."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.studies.base import percent
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.plan import Plan, Row, Run, Summary, outcome_counts
from breakaway.ask.studies.points import Columns, Draw, Point, parts_drawn
from breakaway.ask.studies.statistics import upper_bound
from breakaway.ask.studies.study import (
    PART_SCALE,
    RobustnessStudy,
    RobustnessTable,
    Study,
)
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch.columns import with_nominal_controller
from breakaway.run.warnings import REDRAWN_IN_TIME

Mask = NDArray[np.bool_]


class RobustnessPlan(Plan):
    """Bisection between the lowest and the highest level, every level with the same draws.

    A run that fails at one level and at every higher one makes the answer as sure as a single
    level: with the same draws, a level above the true limit can only be survived where the limit
    itself is, which has a chance of 1 - confidence at most. Runs that do otherwise are counted.
    """

    def __init__(self, study: RobustnessStudy) -> None:
        self.study = study
        self.asked = study.robustness
        self.levels = self.asked.levels
        self.points = [self._point(level) for level in (self.levels[0], self.levels[-1])]
        self.varied = list(study.vary)
        most = 2 + ceil(log2(max(2, len(self.levels) - 1)))
        self.runs_max = min(most, len(self.levels)) * study.runs

    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:
        """Give the scenario at a level, which the controller was not designed for."""
        nominal, over = with_nominal_controller(self.study.base), self.asked.over
        return nominal if over == PART_SCALE else nominal.with_({over: labels[over]})

    def _point(self, level: float) -> Point:
        study, over = self.study, self.asked.over
        if over == PART_SCALE:
            scaled = {path: law.scaled(level) for path, law in study.vary.items()}
            draw = parts_drawn(study, scaled)
        else:
            draw = _with_constant(parts_drawn(study), over, level)
        return Point({over: level}, study.base, range(study.runs), draw)

    def conduct(self, run: Run) -> Summary:
        """Try the lowest and the highest level, then always the middle of what is left."""
        rows: dict[int, Row] = {}
        failed: dict[int, Mask] = {}

        def survives(place: int) -> bool:
            level = self.levels[place]
            finished = run([self._point(level)], f"{self.asked.over} = {level:g}")[0]
            outcomes = finished.outcomes()
            failed[place] = np.isin(outcomes, [OUTCOMES.index(name) for name in self.asked.failure])
            rows[place] = _trail_row(self.asked, level, failed[place], outcomes)
            return bool(rows[place]["survived"])

        best = largest_true(len(self.levels), survives)
        trail = [row | {"step": step} for step, row in enumerate(rows.values(), 1)]
        against = _contradictions(failed)
        survived = None if best is None else rows[best]
        shown = rows[0] if survived is None else survived
        return Summary(
            result=[self._sentence(shown, at_least=best == len(self.levels) - 1)],
            tables={"trail": trail},
            notes=self._notes(against),
            facts=self._facts(survived, at_least=best == len(self.levels) - 1)
            | {"runs_against_the_presumption": against},
        )

    def _facts(self, survived: Row | None, *, at_least: bool) -> Row:
        asked = self.asked
        return {
            "over": asked.over,
            "survived": None if survived is None else survived[asked.over],
            "at_least": at_least,
            "failure": list(asked.failure),
            "failure_probability_max": asked.failure_probability_max,
            "confidence": asked.confidence,
            "disturbance": disturbance_in_words(self.study.base, asked.over),
            "levels": [self.levels[0], self.levels[-1], asked.resolution],
        }

    def _sentence(self, row: Row, *, at_least: bool) -> str:
        asked = self.asked
        level = f"{asked.over} = {row[asked.over]:g}"
        bound, failures = asked.failure_probability_max, row["failures"]
        evidence = (
            f"at {percent(asked.confidence)} confidence ({failures} "
            f"failure{'' if failures == 1 else 's'} in {row['runs']} runs; failure: "
            f"{', '.join(asked.failure)}; {disturbance_in_words(self.study.base, asked.over)})"
        )
        if not row["survived"]:
            return (
                f"{level}, the lowest level, was not shown to be survived: failure probability <= "
                f"{row['upper_bound']:.3g}, not <= {bound:g}, {evidence}"
            )
        highest = " at least, the highest level tried," if at_least else ""
        return f"{level}{highest} survived with failure probability <= {bound:g} {evidence}"

    def _notes(self, against: int) -> list[str]:
        notes = [
            "bisection assumes that failures grow with the level; of "
            f"{self.study.runs} runs, {against} failed at a level and survived a higher one"
        ]
        if against:
            notes.append(
                "so the confidence holds for each level by itself, and not for the choice among "
                "them"
            )
        redrawn = self.study.base.disturbance.kind == "paper_random_factor"
        if redrawn and self.asked.over == "disturbance.var":
            notes.append(REDRAWN_IN_TIME)
        if self.study.design != "random":
            notes.append(
                f"the parts are a {self.study.design} design, not independent draws, which the "
                "interval assumes; it is then only a guide"
            )
        return notes

    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw the failure probability of every level that was tried."""
        from breakaway.show.plots.study import plot_robustness

        return {
            "robustness": plot_robustness(
                study.name,
                summary.tables["trail"],
                self.asked.over,
                summary.result[0],
                self.asked.failure_probability_max,
                (self.levels[0], self.levels[-1]),
            )
        }


def largest_true(count: int, test: Any) -> int | None:  # noqa: ANN401 - a predicate
    """Give the largest place below ``count`` that passes, if places pass up to some and no more.

    The first place is tried, then the last, then always the middle.

    Examples
    --------
    >>> largest_true(100, lambda place: place <= 37), largest_true(5, lambda place: False)
    (37, None)

    """
    if not test(0):
        return None
    if test(count - 1):
        return count - 1
    passed, not_passed = 0, count - 1
    while not_passed - passed > 1:
        middle = (passed + not_passed) // 2
        if test(middle):
            passed = middle
        else:
            not_passed = middle
    return passed


def disturbance_in_words(scenario: Scenario, over: str) -> str:
    """Say which disturbance a result is for.

    Examples
    --------
    >>> import breakaway as bk
    >>> disturbance_in_words(bk.load_scenario("paper_as_computed"), "disturbance.var")
    'uniform disturbance of the joint force, held 0.1 ms'
    >>> disturbance_in_words(bk.load_scenario("paper_as_computed"), "part_scale")
    'no disturbance'

    """
    disturbance = scenario.disturbance
    if over != "disturbance.var" and disturbance.var == 0.0:
        return "no disturbance"
    law = disturbance.law.replace("_", "-")
    size = "" if over == "disturbance.var" else f" of var = {disturbance.var:g}"
    if disturbance.kind == "field":
        length_mm = 1e3 * disturbance.correlation_length_m
        return f"{law} field{size} along the way, correlation length {length_mm:g} mm"
    more = {
        name: value
        for name, value in disturbance.model_dump().items()
        if name not in ("kind", "law", "var", "hold_s", "acts_on")
    }
    rest = "".join(f", {name} = {value:g}" for name, value in more.items())
    return (
        f"{law} disturbance{size} of the {disturbance.acts_on.replace('_', ' ')}, held "
        f"{1e3 * disturbance.hold_s:g} ms{rest}"
    )


def _with_constant(draw: Draw, path: str, level: float) -> Draw:
    def drawn(runs: range) -> Columns:
        return {path: np.full(len(runs), level), **draw(runs)}

    return drawn


def _trail_row(
    asked: RobustnessTable, level: float, failed: Mask, outcomes: NDArray[np.int8]
) -> Row:
    runs, failures = len(failed), int(failed.sum())
    bound = upper_bound(failures, runs, asked.confidence)
    return {
        asked.over: level,
        "runs": runs,
        "failures": failures,
        "failure_probability": failures / runs,
        "upper_bound": bound,
        "survived": bound <= asked.failure_probability_max,
        **outcome_counts(outcomes),
    }


def _contradictions(failed: Mapping[int, Mask]) -> int:
    """Count the runs that failed at a level and survived a higher one."""
    against = np.zeros(len(next(iter(failed.values()))), dtype=bool)
    so_far = against.copy()
    for place in sorted(failed):
        against |= so_far & ~failed[place]
        so_far |= failed[place]
    return int(against.sum())
