"""Agreement: the same question under every friction law, and what only one of them says."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations
from math import ceil, log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.studies.agreement_study import (
    RELEASED,
    SMALLEST,
    AgreementStudy,
    certain_under,
    varied_under,
)
from breakaway.ask.studies.base import percent
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
from breakaway.ask.studies.points import Columns, Draw, Point, parts_drawn
from breakaway.ask.studies.study import Study
from breakaway.ask.studies.verdicts import compared, compared_shares, conclusion_of, in_words
from breakaway.model.scenario.scenario import Scenario

LAW, DISTURBANCE, VARIANT, STEP = "law", "disturbance", "variant", "step"
"""Columns that tell points apart; step 0 is the scenario as it stands, later ones are those of the
search for the smallest sufficient level."""
SIDE_BY_SIDE = 32
"""Levels that are tried at once where nothing is drawn: as many as there are lanes."""

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Places = NDArray[np.int64]
Case = tuple[str, str, str]
"""Law, disturbance, name of a variant."""
Passes = Callable[[int, Places], Mask]
"""Number of a step, places of levels by case and run -> which of them suffice."""


@dataclass(frozen=True)
class Question:
    """One thing that is compared."""

    name: str
    """A metric, how many are released, or the smallest sufficient level."""
    values: Mapping[Case, Array]
    """Its value in each run of each case."""
    relevant: float
    """Difference up to which values are the same."""


class AgreementPlan(Plan):
    """Every variant under every law, all with the same run numbers and the same parts."""

    def __init__(self, study: AgreementStudy) -> None:
        self.study = study
        self.asked = study.agreement
        self.sought = study.agreement.smallest
        self.scenarios = study.scenarios
        asked_first: list[str] = [*self.asked.laws, *study.disturbances]
        order = {name: place for place, name in enumerate(asked_first)}
        self.cases = sorted(self.scenarios, key=lambda case: (order[case[0]], order[case[1]]))
        self._draw = parts_drawn(study)
        everyone = range(study.runs)
        plain = self.cases if study.compares_metrics else []
        self.plain = [self._point(case, 0, everyone) for case in plain]
        self.points = list(self.plain)
        self.varied = list(study.vary)
        self.runs_max = len(self.plain) * study.runs
        if self.sought is not None:
            self.levels = np.array(self.sought.levels)
            ends = (self.levels[:1], self.levels[-1:])
            self.points += [
                self._point(case, 1, everyone, np.repeat(level, study.runs))
                for case in self.cases
                for level in ends
            ]
            self.varied.append(self.sought.over)
            self.runs_max += len(self.cases) * self._runs_of_search()

    def _runs_of_search(self) -> int:
        answers = len(self.levels) + 1
        if not self.study.certain:
            return self.study.runs * ceil(log2(answers))
        side, steps = min(SIDE_BY_SIDE, len(self.levels)), 0
        while answers > 1:
            answers, steps = ceil(answers / (side + 1)), steps + 1
        return side * steps

    def scenario_at(self, labels: Mapping[str, Level]) -> Scenario:
        """Give the scenario of a variant under a law."""
        law, disturbance, variant = (str(labels[name]) for name in (LAW, DISTURBANCE, VARIANT))
        return self.scenarios[law, disturbance, variant]

    def _point(self, case: Case, step: int, runs: range, levels: Array | None = None) -> Point:
        labels: dict[str, Level] = dict(zip((LAW, DISTURBANCE, VARIANT), case, strict=True)) | {
            STEP: step
        }
        return Point(labels, self.scenarios[case], runs, self._drawn(case, levels))

    def _drawn(self, case: Case, levels: Array | None) -> Draw:
        """Draw the parts, without what the case has no place for, and with the levels to try."""
        known = varied_under(self.study, *case)
        over = None if self.sought is None else self.sought.over

        def drawn(runs: range) -> Columns:
            columns = self._draw(runs)
            kept = {path: columns[path] for path in known}
            if over is not None and levels is not None:
                kept[over] = levels[runs.start : runs.stop]
            return kept

        return drawn

    def conduct(self, run: Run) -> Summary:
        """Run all variants under all laws, and say on what the laws agree."""
        finished = run(self.plain, "laws") if self.plain else []
        plain = dict(zip(self.cases, finished, strict=True)) if finished else {}
        smallest = {} if self.sought is None else self._smallest(run)
        groups = [
            self._asked_everywhere(question, first, other)
            for first, other in combinations([v.name for v in self.asked.variants], 2)
            for question in self._questions(plain, smallest)
        ]
        conclusions = [conclusion_of(group) for group in groups]
        tables = {"conclusions": conclusions, "laws": [row for group in groups for row in group]}
        if plain:
            tables["variants"] = [self._variant_row(case, found) for case, found in plain.items()]
        if smallest:
            tables["smallest"] = [self._level_row(case, found) for case, found in smallest.items()]
        return Summary(
            result=[in_words(c, group) for c, group in zip(conclusions, groups, strict=True)],
            tables=tables,
            notes=self._notes(smallest),
            facts={"certain": self.study.certain},
        )

    def _questions(
        self, plain: Mapping[Case, PointRuns], smallest: Mapping[Case, Array]
    ) -> list[Question]:
        """Give what is compared."""
        relevant = self.asked.relevant
        questions: list[Question] = []
        if plain:
            names = [RELEASED, *self.study.shown]
            for name in names:
                values = {case: _compared_column(found, name) for case, found in plain.items()}
                questions.append(Question(name, values, relevant.get(name, 0.0)))
        if self.sought is not None:
            # A level is known to one step, and so is a difference of two.
            least = max(relevant.get(SMALLEST, 0.0), self.sought.resolution * (1.0 + 1e-9))
            questions.append(Question(f"{SMALLEST} {self.sought.over}", smallest, least))
        return questions

    def _asked_everywhere(self, question: Question, first: str, other: str) -> list[Row]:
        """Compare two variants under every law."""
        compare = compared_shares if question.name == RELEASED else compared
        names = {"other": other, "first": first, "quantity": question.name}
        return [
            {**names, LAW: law, DISTURBANCE: disturbance}
            | compare(
                question.values[law, disturbance, first],
                question.values[law, disturbance, other],
                self.asked.confidence,
                question.relevant,
                certain=certain_under(self.study, law, disturbance),
            )
            for law, disturbance in dict.fromkeys(case[:2] for case in self.cases)
        ]

    def _smallest(self, run: Run) -> dict[Case, Array]:
        """Give the smallest sufficient level of each run; one step above the highest for none."""
        assert self.sought is not None
        until, resolution = self.sought.until, self.sought.resolution

        def passes(step: int, places: Places) -> Mask:
            runs = range(places.shape[1])
            points = [
                self._point(case, step, runs, self.levels[row])
                for case, row in zip(self.cases, places, strict=True)
            ]
            test = _released if until == "released" else _loose
            return np.array([test(found) for found in run(points, f"levels, step {step}")])

        if self.study.certain:
            found = narrowed(len(self.levels), len(self.cases), passes)
        else:
            found = bisected(len(self.levels), (len(self.cases), self.study.runs), passes)
        reachable = np.append(self.levels, self.levels[-1] + resolution)
        return dict(zip(self.cases, reachable[found], strict=True))

    def _variant_row(self, case: Case, found: PointRuns) -> Row:
        outcomes = found.outcomes()
        row: Row = dict(zip((LAW, DISTURBANCE, VARIANT), case, strict=True))
        row |= {"runs": len(outcomes)} | outcome_shares(outcomes, self.asked.confidence)
        for name in self.study.recorded:
            row |= metric_spread(found.column(name), not_diverged(outcomes), name)
        return row

    def _level_row(self, case: Case, found: Array) -> Row:
        row: Row = dict(zip((LAW, DISTURBANCE, VARIANT), case, strict=True))
        p05, median, p95 = (float(q) for q in np.quantile(found, [0.05, 0.5, 0.95]))
        return row | {
            "runs": len(found),
            "p05": p05,
            "median": median,
            "p95": p95,
            "at_lowest": int((found <= self.levels[0]).sum()),
            "above_highest": int((found > self.levels[-1]).sum()),
        }

    def _notes(self, smallest: Mapping[Case, Array]) -> list[str]:
        notes = [
            "agreed: every law says the same; contradicted: laws say different things; only ...: "
            "nothing else shows it; undecided: some laws do not show it"
        ]
        if len(self.study.disturbances) > 1:
            notes.append(
                "a conclusion turns on how friction varies where one law shows different things "
                "with two disturbances"
            )
        if self.study.certain:
            notes.append(
                "nothing is drawn: differences are exact, for this one part and under these laws"
            )
        else:
            notes.append(
                "differences are the other variant's value less the first one's in the same run; "
                f"intervals at {percent(self.asked.confidence)} are of the median, by order "
                "statistics, and of shares, exact; each by itself, not corrected for their number"
            )
        notes += self._notes_of_levels(smallest)
        if self.study.jolted:
            notes.append(
                "a disturbance of the joint force multiplies what holds a stuck joint and jolts it "
                "at every redraw, which counts as help under some laws; disturbances = "
                '["joint_force", "friction_level"] shows how much depends on that'
            )
        return notes

    def _notes_of_levels(self, smallest: Mapping[Case, Array]) -> list[str]:
        if self.sought is None:
            return []
        over, low, high = self.sought.over, self.levels[0], self.levels[-1]
        notes = [
            f"{over} is known to within {self.sought.resolution:g}; smaller differences count as "
            "none"
        ]
        below = sum(int((found <= low).sum()) for found in smallest.values())
        above = sum(int((found > high).sum()) for found in smallest.values())
        if below:
            notes.append(
                f"{below} runs need no more than the lowest level, {low:g}, and are counted at it"
            )
        if above:
            notes.append(
                f"{above} runs need more than the highest level {high:g}, and are counted as one "
                "step above it: their true differences are larger than stated"
            )
        return notes

    def draw_figures(self, study: Study, summary: Summary) -> dict[str, Any]:
        """Draw what each law says of each conclusion."""
        from breakaway.show.plots.study import plot_agreement

        tables = summary.tables
        return {"agreement": plot_agreement(study.name, tables["conclusions"], tables["laws"])}


def bisected(count: int, shape: tuple[int, int], passes: Passes) -> Places:
    """Give the smallest sufficient place of each run of each case, by bisection of each by itself.

    Parameters
    ----------
    count : int
        How many places there are; ``count`` stands for none of them.
    shape : tuple of int
        Cases, and runs of each.
    passes : callable
        Number of a step and a place for each run -> which suffice.

    Examples
    --------
    >>> import numpy as np
    >>> need = np.array([[0, 3, 7, 9]])
    >>> bisected(9, (1, 4), lambda step, places: places >= need).tolist()
    [[0, 3, 7, 9]]

    """
    low, high = np.full(shape, -1), np.full(shape, count)
    for step in range(1, ceil(log2(count + 1)) + 1):
        open_ = high - low > 1
        middle = np.clip((low + high) // 2, 0, count - 1)
        passed = passes(step, middle)
        high = np.where(open_ & passed, middle, high)
        low = np.where(open_ & ~passed, middle, low)
    return high


def narrowed(count: int, cases: int, passes: Passes) -> Places:
    """Give the smallest sufficient place of each case, trying many places side by side.

    Parameters
    ----------
    count : int
        How many places there are; ``count`` stands for none of them.
    cases : int
        How many cases.
    passes : callable
        Number of a step and some places for each case -> which suffice.

    Examples
    --------
    >>> import numpy as np
    >>> need = np.array([[0], [300], [999], [1000]])
    >>> narrowed(1000, 4, lambda step, places: places >= need).ravel().tolist()
    [0, 300, 999, 1000]

    """
    low, high = np.full((cases, 1), -1), np.full((cases, 1), count)
    share = np.arange(1, min(SIDE_BY_SIDE, count) + 1) / (min(SIDE_BY_SIDE, count) + 1)
    step = 0
    while (high - low > 1).any():
        step += 1
        inner = np.floor(low + share * (high - low)).astype(np.int64)
        tried = np.clip(np.clip(inner, low + 1, np.maximum(high - 1, low + 1)), 0, count - 1)
        passed = passes(step, tried)
        inside = (tried > low) & (tried < high)
        high = np.where(passed & inside, tried, high).min(axis=1, keepdims=True)
        low = np.where(inside & (tried < high), tried, low).max(axis=1, keepdims=True)
    return high


def _released(found: PointRuns) -> Mask:
    released: Mask = found.outcomes() == OUTCOMES.index("released")
    return released


def _loose(found: PointRuns) -> Mask:
    loose: Mask = np.isfinite(found.column("time_to_breakaway_s"))
    return loose


def _compared_column(found: PointRuns, name: str) -> Array:
    """Give 1 for runs that were released, or a metric, not a number where the run diverged."""
    if name == RELEASED:
        return _released(found).astype(np.float64)
    return np.where(not_diverged(found.outcomes()), found.column(name), np.nan)
