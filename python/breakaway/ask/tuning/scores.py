"""What a method is judged by: shares of parts, and quantiles over parts, with their intervals."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import ceil, inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.studies.statistics import clopper_pearson
from breakaway.base.text import shown
from breakaway.errors import StudyError
from breakaway.run.trials import TRIAL_METRICS, Trial

SHARES = ("released_share", "gentle_share", "strict_share")
"""Shares of the parts: free, free and gentle, free and strictly gentle. More is better."""
PIEZO_METRICS = ("rms_current_a", "stack_cycles", "stack_loss_w", "stack_tension_n")
"""Metrics that only a piezo has."""
METRICS = tuple(name for name in TRIAL_METRICS if name not in ("stop_reason", "final_position_m"))
"""Metrics whose quantiles can be scores. Less is better."""

_QUANTILE = re.compile(r"(median|p(\d+(?:\.\d+)?))_(\w+)")


@dataclass(frozen=True)
class ScoreKind:
    """What a score is of."""

    name: str
    """Such as ``strict_share``, ``median_time_to_release_s`` or ``p99_largest_jump_m``."""
    metric: str | None = None
    """The metric, for quantiles."""
    quantile: float = 0.5
    """The quantile, above 0 and at most 1."""

    @property
    def more_is_better(self) -> bool:
        """Whether it is a share."""
        return self.metric is None

    @property
    def sign(self) -> float:
        """What makes less better: 1, or -1 for shares."""
        return -1.0 if self.more_is_better else 1.0

    def worst(self, scores: Iterable[Score]) -> Score:
        """Give the worst of some scores of this kind."""
        return max(scores, key=lambda score: self.sign * score.value)


@dataclass(frozen=True)
class Score:
    """A score, and the interval that holds the true one; infinite where parts were not freed."""

    value: float
    """Of the parts that were tried."""
    low: float
    """Lower end of the interval for all parts of the population."""
    high: float
    """Upper end; infinite where there are too few parts to tell."""

    def as_json(self) -> list[float | None]:
        """Give value and ends, None where they are infinite."""
        return [
            number if isfinite(number) else None for number in (self.value, self.low, self.high)
        ]

    @classmethod
    def of_json(cls, numbers: Iterable[float | None]) -> Score:
        """Read what `as_json` gave."""
        return cls(*(inf if number is None else float(number) for number in numbers))


def score_kind(name: str) -> ScoreKind:
    """Read the name of a score.

    Raises
    ------
    StudyError
        It is no score.

    Examples
    --------
    >>> score_kind("p99_largest_jump_m")
    ScoreKind(name='p99_largest_jump_m', metric='largest_jump_m', quantile=0.99)
    >>> score_kind("strict_shares")
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: 'strict_shares' is not a score; did you mean strict_share?

    """
    if name in SHARES:
        return ScoreKind(name)
    found = _QUANTILE.fullmatch(name)
    if found is None or found[3] not in METRICS:
        near = difflib.get_close_matches(name, _examples(found), n=1, cutoff=0.5)
        hint = f"did you mean {near[0]}?" if near else f"give one of {_known()}"
        raise StudyError(f"{shown(name)} is not a score; {hint}")
    percent = 50.0 if found[2] is None else float(found[2])
    if not 0.0 < percent <= 100.0:
        raise StudyError(
            f"{shown(name)} is not a score: its percentile is not within 0 and 100; give p1 to p100"
        )
    return ScoreKind(name, found[3], round(percent / 100.0, 12))


def _examples(found: re.Match[str] | None) -> list[str]:
    """Give names that someone may have meant."""
    prefix = found[1] if found else "median"
    return [*SHARES, *(f"{prefix}_{metric}" for metric in METRICS)]


def _known() -> str:
    return (
        f"{', '.join(SHARES)}, or a quantile such as median_time_to_release_s or p99_... of "
        f"{', '.join(METRICS)}"
    )


def scores_of(trial: Trial, kinds: Iterable[ScoreKind], confidence: float) -> dict[str, Score]:
    """Score a trial.

    A part that was not freed is infinitely bad in every metric: a method that does nothing is
    not gentle.
    """
    return {kind.name: _score(trial, kind, confidence) for kind in kinds}


def _score(trial: Trial, kind: ScoreKind, confidence: float) -> Score:
    if kind.metric is not None:
        values = np.where(trial.released, trial.metrics[kind.metric], np.inf)
        return quantile_score(values, kind.quantile, confidence)
    limits = {
        "gentle_share": trial.population.gentle,
        "strict_share": trial.population.strict,
    }.get(kind.name)
    passed = trial.released if limits is None else trial.within(limits)
    events, parts = int(passed.sum()), len(passed)
    return Score(events / parts, *clopper_pearson(events, parts, confidence))


def quantile_score(values: NDArray[np.float64], quantile: float, confidence: float) -> Score:
    """Give a quantile with its interval by order statistics.

    How many values are at most the true quantile is binomial, whatever their distribution, so
    that the interval is exact. What is not a number counts as infinite.

    Examples
    --------
    >>> import numpy as np
    >>> quantile_score(np.arange(1.0, 12.0), 0.5, 0.95)
    Score(value=6.0, low=2.0, high=10.0)
    >>> quantile_score(np.array([1.0, 2.0, np.nan]), 0.99, 0.95)
    Score(value=inf, low=2.0, high=inf)

    """
    from scipy.special import bdtr

    ordered = np.sort(np.where(np.isnan(values), np.inf, values))
    count, tail = len(ordered), 0.5 * (1.0 - confidence)
    below = bdtr(np.arange(count + 1), count, quantile)
    first = int(np.argmax(below >= tail))  # P(fewer values than that are below) < tail
    last = int(np.argmax(below >= 1.0 - tail)) + 1  # P(as many values are below) <= tail
    place = max(1, ceil(quantile * count * (1.0 - 1e-12)))
    return Score(
        value=float(ordered[place - 1]),
        low=float(ordered[first - 1]) if first >= 1 else 0.0,
        high=float(ordered[last - 1]) if last <= count else inf,
    )


def worst_of(
    kinds: Iterable[ScoreKind], laws: Mapping[str, Mapping[str, Score]]
) -> dict[str, Score]:
    """Give every score under the law where it is worst."""
    return {kind.name: kind.worst(scores[kind.name] for scores in laws.values()) for kind in kinds}


def laws_as_json(laws: Mapping[str, Mapping[str, Score]]) -> dict[str, Any]:
    """Give the scores under every law as JSON."""
    return {
        law: {n: score.as_json() for n, score in scores.items()} for law, scores in laws.items()
    }


def laws_of_json(laws: Mapping[str, Any]) -> dict[str, dict[str, Score]]:
    """Read what `laws_as_json` gave."""
    return {law: {n: Score.of_json(s) for n, s in scores.items()} for law, scores in laws.items()}
