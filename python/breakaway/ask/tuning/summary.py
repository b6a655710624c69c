"""What a tuning found: tables, and sentences that say what they mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from breakaway._core import __version__
from breakaway.ask.tuning.evaluation import Evaluation, Laws, is_feasible, violations_of
from breakaway.ask.tuning.problem import Tuning
from breakaway.ask.tuning.scores import Score, ScoreKind, score_kind, worst_of
from breakaway.model.scenario.variation import VARIATION_WORDS

Row = dict[str, Any]
WORST = "worst"
"""What stands for the law where a score is worst."""
RULE = (
    "the recommendation is made on the training parts: of the points of the front whose first "
    "objective is within the interval of the best one, it is the closest to the best of the other "
    "objectives"
)


@dataclass(frozen=True)
class Found:
    """All that a tuning computed."""

    tuning: Tuning
    """What was asked."""
    evaluations: Sequence[Evaluation]
    """All evaluations."""
    front: Sequence[Evaluation]
    """Evaluations that no other beats, best in the first objective first."""
    best: Evaluation | None
    """The recommended one; None where no evaluation met the constraints."""
    start_training: Laws
    """The method as it was, on the training parts."""
    start_unseen: Laws
    """The method as it was, on unseen parts."""
    unseen: Mapping[int, Laws]
    """The front on unseen parts, by number of the evaluation."""

    def file(self, evaluation: Evaluation) -> str:
        """Give the name of the file of a point of the front."""
        if len(self.front) == 1:
            return "best.toml"
        return f"pareto_{self.front.index(evaluation) + 1:02d}.toml"

    def worst(self, laws: Laws) -> dict[str, Score]:
        """Give every score under the law where it is worst."""
        return worst_of(self.tuning.kinds, laws)


def evaluation_rows(found: Found) -> list[Row]:
    """Give a row for each evaluation: its numbers, its scores, and what became of it."""
    rows = []
    for evaluation in found.evaluations:
        row: Row = {"evaluation": evaluation.number, "state": _state(found.tuning, evaluation)}
        row |= {
            "front": evaluation in found.front,
            "recommended": evaluation is found.best,
            **evaluation.numbers,
        }
        for kind in found.tuning.kinds:
            row[kind.name] = _finite(evaluation.worst[kind.name].value) if evaluation.laws else None
            for law in found.tuning.laws if len(found.tuning.laws) > 1 else ():
                laws = evaluation.laws
                row[f"{kind.name}[{law}]"] = _finite(laws[law][kind.name].value) if laws else None
        violation = (
            sum(violations_of(found.tuning, evaluation).values()) if evaluation.laws else None
        )
        rows.append(row | {"violation": violation, "refused": evaluation.refused})
    return rows


def _state(tuning: Tuning, evaluation: Evaluation) -> str:
    if evaluation.laws is None:
        return "refused"
    return "feasible" if is_feasible(tuning, evaluation) else "infeasible"


def pareto_rows(found: Found) -> list[Row]:
    """Give a row for each point of the front: training and unseen scores side by side."""
    rows = []
    for point, evaluation in enumerate(found.front, 1):
        row: Row = {
            "point": point,
            "evaluation": evaluation.number,
            "recommended": evaluation is found.best,
            "file": found.file(evaluation),
            **evaluation.numbers,
        }
        unseen = found.worst(found.unseen[evaluation.number])
        for kind in found.tuning.kinds:
            row |= _interval(f"{kind.name}_training", evaluation.worst[kind.name])
            row |= _interval(f"{kind.name}_unseen", unseen[kind.name])
        rows.append(row)
    return rows


def _interval(name: str, score: Score) -> Row:
    value, low, high = score.as_json()
    return {name: value, f"{name}_low": low, f"{name}_high": high}


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def score_rows(found: Found) -> list[Row]:
    """Give every score of the start and of the front, on both sets of parts, under every law."""
    sets = [("start", "training", found.start_training), ("start", "unseen", found.start_unseen)]
    for evaluation in found.front:
        name = f"evaluation {evaluation.number}"
        sets += [
            (name, "training", evaluation.laws or {}),
            (name, "unseen", found.unseen[evaluation.number]),
        ]
    return [
        {"of": of, "on": on, "law": law, "score": kind.name}
        | dict(zip(("value", "low", "high"), score.as_json(), strict=True))
        for of, on, laws in sets
        for kind in found.tuning.kinds
        for law, score in _laws_and_worst(kind, laws)
    ]


def _laws_and_worst(kind: ScoreKind, laws: Laws) -> list[tuple[str, Score]]:
    rows = [(law, scores[kind.name]) for law, scores in laws.items()]
    if len(rows) > 1:
        rows.append((WORST, kind.worst(score for _, score in rows)))
    return rows


def overfitting_rows(found: Found) -> list[Row]:
    """Compare training and unseen scores of the recommended method, objective by objective."""
    if found.best is None:
        return []
    unseen = found.worst(found.unseen[found.best.number])
    before, before_unseen = found.worst(found.start_training), found.worst(found.start_unseen)
    rows = []
    for kind in found.tuning.objective_kinds:
        trained, tested = found.best.worst[kind.name], unseen[kind.name]
        rows.append(
            {
                "score": kind.name,
                "verdict": verdict(kind, trained, tested),
                **_interval("training", trained),
                **_interval("unseen", tested),
                "lost": _lost(kind, trained, tested),
                "start_training": _finite(before[kind.name].value),
                "start_unseen": _finite(before_unseen[kind.name].value),
                "start_lost": _lost(kind, before[kind.name], before_unseen[kind.name]),
            }
        )
    return rows


def _lost(kind: ScoreKind, training: Score, unseen: Score) -> float | None:
    """Give by how much unseen parts are worse; negative where they are better."""
    if not (isfinite(training.value) and isfinite(unseen.value)):
        return None
    return kind.sign * (unseen.value - training.value)


def verdict(kind: ScoreKind, training: Score, unseen: Score) -> str:
    """Tell whether a score is better on training parts than it is in truth.

    Perhaps it is where each of the two lies outside the other's interval, and surely where the
    intervals do not overlap.

    Examples
    --------
    >>> share = score_kind("strict_share")
    >>> verdict(share, Score(0.95, 0.92, 0.97), Score(0.8, 0.77, 0.83))
    'overfitted'
    >>> verdict(share, Score(0.95, 0.92, 0.97), Score(0.91, 0.89, 0.93))
    'perhaps overfitted'
    >>> verdict(share, Score(0.95, 0.92, 0.97), Score(0.94, 0.92, 0.955))
    'not shown'

    """
    if kind.more_is_better:
        apart = unseen.high < training.low
        outside = unseen.high < training.value and unseen.value < training.low
    else:
        apart = unseen.low > training.high
        outside = unseen.low > training.value and unseen.value > training.high
    return "overfitted" if apart else "perhaps overfitted" if outside else "not shown"


VERDICTS = {
    "overfitted": "overfitted: the intervals do not overlap; trust only the unseen score",
    "perhaps overfitted": "perhaps overfitted: each is outside the interval of the other",
    "not shown": "no overfitting is shown",
}


def sentences(found: Found) -> list[str]:
    """Say what was found."""
    tuning, best = found.tuning, found.best
    if best is None:
        return [_nothing(found)]
    count = f"{len(found.evaluations)} evaluations"
    said = [
        f"evaluation {best.number} of {count} is recommended"
        + (f", one of {len(found.front)} that no other beats" if len(found.front) > 1 else "")
        + ("; it is the method as it was before tuning" if best.numbers == tuning.start else "")
    ]
    for row in overfitting_rows(found):
        low, high = _short(row["unseen_low"]), _short(row["unseen_high"])
        said.append(
            f"{row['score']}: {_short(row['training'])} on {tuning.training_runs} training parts, "
            f"{_short(row['unseen'])} ({_percent(tuning.confidence)}: {low} to {high}) on "
            f"{tuning.test_runs.runs} unseen ones; {VERDICTS[row['verdict']]}; before tuning "
            f"{_short(row['start_training'])} and {_short(row['start_unseen'])}"
        )
    return said + _constraint_sentences(found, best)


def _constraint_sentences(found: Found, best: Evaluation) -> list[str]:
    unseen = found.worst(found.unseen[best.number])
    said = []
    for name, bound in found.tuning.constraints.items():
        kind, score = score_kind(name), unseen[name]
        limit = bound.at_least if kind.more_is_better else bound.at_most
        assert limit is not None  # checked when the tuning was made
        met = kind.sign * (score.value - limit) <= 0.0
        words = f"{'>=' if kind.more_is_better else '<='} {limit:g}"
        said.append(
            f"{name} {words}: {'met' if met else 'NOT met'} on unseen parts, "
            f"{_short(_finite(score.value))} ({_short(_finite(score.low))} to "
            f"{_short(_finite(score.high))})"
        )
    return said


def _nothing(found: Found) -> str:
    tried = [e for e in found.evaluations if e.laws is not None]
    if not tried:
        last = found.evaluations[-1].refused
        return f"all {len(found.evaluations)} evaluations were refused, the last one with: {last}"

    def far(evaluation: Evaluation) -> float:
        return sum(violations_of(found.tuning, evaluation).values())

    nearest = min(tried, key=far)
    missed = [name for name, v in violations_of(found.tuning, nearest).items() if v]
    return (
        f"none of {len(found.evaluations)} evaluations met all constraints, so none is "
        f"recommended; the closest is evaluation {nearest.number}, which misses "
        f"{', '.join(missed)}: loosen it, or try more"
    )


def notes(found: Found) -> list[str]:
    """Say what has to be known before the scores are believed."""
    tuning = found.tuning
    said = [
        "intervals are exact for parts drawn from the population; that of a training score is too "
        "optimistic, because the method was chosen by it",
        "a part that was not freed is infinitely bad in every quantile",
    ]
    said.append(f"friction {VARIATION_WORDS[tuning.variation]} ({tuning.variation})")
    if len(tuning.laws) > 1:
        said.append(f"every score is that of the worst of {len(tuning.laws)} friction laws")
    if len(found.front) > 1:
        said.append(RULE)
    if tuning.start is None:
        said.append("the method before tuning is outside the ranges and was not evaluated")
    refused = sum(evaluation.laws is None for evaluation in found.evaluations)
    if refused:
        said.append(f"{refused} evaluations were refused by a scenario; evaluations.csv says why")
    return said


def content_of(found: Found) -> Row:
    """Give the summary as it is written."""
    tuning, best = found.tuning, found.best
    states = [_state(tuning, evaluation) for evaluation in found.evaluations]
    return {
        "kind": tuning.kind,
        "name": tuning.name,
        "population": tuning.population.name,
        "method": tuning.method.name,
        "laws": list(tuning.laws),
        "variation": tuning.variation,
        "seed": tuning.seed,
        "sampler_seed": tuning.sampler_seed,
        "training_parts": [0, tuning.training_runs],
        "unseen_parts": [tuning.test_runs.numbers.start, tuning.test_runs.numbers.stop],
        "evaluations": len(found.evaluations),
        **{state: states.count(state) for state in ("feasible", "infeasible", "refused")},
        "breakaway_version": __version__,
        "confidence": tuning.confidence,
        "result": sentences(found),
        "notes": notes(found),
        "recommended": best
        and {"evaluation": best.number, "file": "best.toml", "numbers": dict(best.numbers)},
        "overfitting": overfitting_rows(found),
        "front": pareto_rows(found),
        "scores": score_rows(found),
    }


def _percent(confidence: float) -> str:
    return f"{100.0 * confidence:g} %"


def _short(value: float | None) -> str:
    return "infinite" if value is None else f"{value:.4g}"
