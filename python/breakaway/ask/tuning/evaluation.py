"""A method that was tried, its scores, and how far it is from what is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

from breakaway.ask.tuning.problem import Tuning
from breakaway.ask.tuning.scores import (
    Score,
    ScoreKind,
    laws_as_json,
    laws_of_json,
    score_kind,
    scores_of,
    worst_of,
)
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.method import Method
from breakaway.run.trials import run_trial

Laws = Mapping[str, Mapping[str, Score]]
"""Scores by law and name."""


@dataclass(frozen=True)
class Evaluation:
    """A method that was tried on the training parts."""

    number: int
    """Its place among the evaluations."""
    numbers: Mapping[str, float]
    """The tuned numbers, by dotted path."""
    laws: Laws | None = None
    """Scores by law and name; None where a scenario refused the numbers."""
    refused: str = ""
    """Why a scenario refused the numbers."""

    @cached_property
    def worst(self) -> dict[str, Score]:
        """Every score under the law where it is worst."""
        laws = self.laws or {}
        names = next(iter(laws.values()), {})
        return worst_of([score_kind(name) for name in names], laws)

    def as_json(self) -> dict[str, Any]:
        """Give what is written to disk."""
        outcome: dict[str, Any] = (
            {"refused": self.refused} if self.laws is None else {"laws": laws_as_json(self.laws)}
        )
        return {"number": self.number, "numbers": dict(self.numbers), **outcome}

    @classmethod
    def of_json(cls, record: Mapping[str, Any]) -> Evaluation:
        """Read what `as_json` gave."""
        laws = laws_of_json(record["laws"]) if "laws" in record else None
        return cls(record["number"], record["numbers"], laws, record.get("refused", ""))


def run_laws(
    tuning: Tuning,
    method: Method,
    parts: range,
    threads: int | None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, dict[str, Score]]:
    """Try a method on parts under every law, and score it.

    Raises
    ------
    ScenarioError
        The method is not valid for a part.

    """
    scores: dict[str, dict[str, Score]] = {}
    for i, law in enumerate(tuning.laws):
        trial = run_trial(
            tuning.population,
            method,
            law=law,
            variation=tuning.variation,
            runs=parts,
            seed=tuning.seed,
            threads=threads,
            progress=_counting(progress, i * len(parts)),
        )
        scores[law] = scores_of(trial, tuning.kinds, tuning.confidence)
    return scores


def _counting(
    progress: Callable[[int], None] | None, before: int
) -> Callable[[int, int], None] | None:
    return None if progress is None else lambda done, _total: progress(before + done)


def evaluate(
    tuning: Tuning,
    number: int,
    numbers: Mapping[str, float],
    threads: int | None,
    progress: Callable[[int], None] | None = None,
) -> Evaluation:
    """Try numbers on the training parts. What a scenario refuses is no error, but a finding."""
    try:
        laws = run_laws(tuning, tuning.tuned(numbers), tuning.training, threads, progress)
    except (ScenarioError, StudyError) as error:
        return Evaluation(number, numbers, refused=" ".join(str(error).split()))
    return Evaluation(number, numbers, laws)


def values_of(tuning: Tuning, evaluation: Evaluation) -> list[float]:
    """Give the objectives of an evaluation."""
    return [evaluation.worst[name].value for name in tuning.objectives]


def violations_of(tuning: Tuning, evaluation: Evaluation) -> dict[str, float]:
    """Tell how far an evaluation is from each constraint: 0 where it is met, else above 0.

    A quantile asks for more than its bound: were fewer parts freed than the quantile is, it is
    infinite, and how many are missing shows which way is better.
    """
    found: dict[str, float] = {}
    for name, bound in tuning.constraints.items():
        kind, value = score_kind(name), evaluation.worst[name].value
        limit = bound.at_least if kind.more_is_better else bound.at_most
        assert limit is not None  # checked when the tuning was made
        excess = max(0.0, kind.sign * (value - limit) / abs(limit)) if isfinite(value) else 0.0
        found[name] = excess / (1.0 + excess)
    freed = evaluation.worst["released_share"].value
    for kind in tuning.kinds:
        if kind.metric is not None and not isfinite(evaluation.worst[kind.name].value):
            found[f"{kind.name} is finite"] = 1.0 + max(0.0, kind.quantile - freed)
    return found


def is_feasible(tuning: Tuning, evaluation: Evaluation) -> bool:
    """Tell whether a scenario takes the numbers, and all constraints are met."""
    return evaluation.laws is not None and not any(violations_of(tuning, evaluation).values())


def pareto_front(tuning: Tuning, evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Give the evaluations that none is better than, best in the first objective first.

    Of several with the same values the first counts, and none that violates a constraint.
    """
    chosen: list[Evaluation] = []
    ranked = sorted(
        (e for e in evaluations if is_feasible(tuning, e)),
        key=lambda e: (losses(tuning.objective_kinds, values_of(tuning, e)), e.number),
    )
    for evaluation in ranked:
        here = losses(tuning.objective_kinds, values_of(tuning, evaluation))
        if not any(
            all(a <= b for a, b in zip(_losses_of(tuning, other), here, strict=True))
            for other in chosen
        ):
            chosen.append(evaluation)
    return chosen


def recommended(tuning: Tuning, front: Sequence[Evaluation]) -> Evaluation:
    """Give the point of a front that its first objective speaks for, then the others.

    The points whose first objective lies within the interval of the best one cannot be told apart
    from it with so few parts. Among these counts who is nearest to the best of every other
    objective, each scaled to their range.
    """
    kind = tuning.objective_kinds[0]
    best = front[0].worst[kind.name]
    worst_alike = kind.sign * (best.low if kind.more_is_better else best.high)
    alike = [e for e in front if _losses_of(tuning, e)[0] <= worst_alike]
    columns = list(zip(*(_losses_of(tuning, e)[1:] for e in alike), strict=True))

    def distance(place: int) -> float:
        shares = ((c[place] - min(c)) / ((max(c) - min(c)) or 1.0) for c in columns)
        return float(sum(share * share for share in shares))

    return alike[min(range(len(alike)), key=lambda place: (distance(place), place))]


def losses(kinds: Sequence[ScoreKind], values: Sequence[float]) -> tuple[float, ...]:
    """Give objectives so that less is better."""
    return tuple(kind.sign * value for kind, value in zip(kinds, values, strict=True))


def _losses_of(tuning: Tuning, evaluation: Evaluation) -> tuple[float, ...]:
    return losses(tuning.objective_kinds, values_of(tuning, evaluation))
