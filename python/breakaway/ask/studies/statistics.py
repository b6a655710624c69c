"""What a number of runs shows, and how surely: exact intervals, none of them asymptotic."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, log, log1p, log2

import numpy as np
from numpy.typing import NDArray


def clopper_pearson(events: int, runs: int, confidence: float) -> tuple[float, float]:
    """Give the two-sided interval of a probability that was seen ``events`` times in ``runs``.

    Clopper and Pearson, Biometrika 26 (1934): the probabilities under which neither as few nor as
    many events are less likely than ``(1 - confidence) / 2``. Its coverage is at least
    ``confidence`` for every probability.

    Parameters
    ----------
    events : int
        How often it happened, 0 to ``runs``.
    runs : int
        How often it could have happened, at least 1; independent of each other.
    confidence : float
        Between 0 and 1.

    Examples
    --------
    >>> [round(bound, 4) for bound in clopper_pearson(0, 100, 0.95)]
    [0.0, 0.0362]

    """
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - confidence)
    low = float(betaincinv(events, runs - events + 1, tail)) if events else 0.0
    high = float(betaincinv(events + 1, runs - events, 1.0 - tail)) if events < runs else 1.0
    return low, high


def upper_bound(events: int, runs: int, confidence: float) -> float:
    """Give the one-sided upper bound of a probability, of Clopper and Pearson.

    Examples
    --------
    >>> round(upper_bound(0, 2995, 0.95), 6), upper_bound(5, 5, 0.95)
    (0.001, 1.0)

    """
    from scipy.special import betaincinv

    return float(betaincinv(events + 1, runs - events, confidence)) if events < runs else 1.0


def runs_needed(probability: float, confidence: float) -> int:
    """Give the fewest runs that can show a failure probability: that many without any failure.

    ``(1 - probability)**runs <= 1 - confidence``.

    Examples
    --------
    >>> runs_needed(0.001, 0.95)
    2995

    """
    return max(1, ceil(log(1.0 - confidence) / log1p(-probability)))


@dataclass(frozen=True)
class MedianInterval:
    """A median, and an interval that holds the true one with at least the confidence asked for."""

    median: float
    """Median of the values."""
    low: float | None
    """Lower end; None where there are too few values for the confidence."""
    high: float | None
    """Upper end; None where there are too few values for the confidence."""


def median_interval(values: NDArray[np.float64], confidence: float) -> MedianInterval:
    """Give the median of some values with its interval by order statistics.

    Each value is below the true median with probability 1/2, so how many are is binomial,
    whatever the values' distribution. Exact and without resampling, it needs no seed and takes
    a sort of the values; the bootstrap of a median is neither.

    Parameters
    ----------
    values : numpy.ndarray
        At least one, all finite, independent of each other.
    confidence : float
        Between 0 and 1.

    Examples
    --------
    >>> import numpy as np
    >>> median_interval(np.arange(1.0, 12.0), 0.95)
    MedianInterval(median=6.0, low=2.0, high=10.0)
    >>> median_interval(np.arange(3.0), 0.95).low is None
    True

    """
    ordered = np.sort(values)
    outside = _values_outside(len(ordered), 0.5 * (1.0 - confidence))
    median = float(np.median(ordered))
    if outside == 0:
        return MedianInterval(median, None, None)
    return MedianInterval(median, float(ordered[outside - 1]), float(ordered[-outside]))


def _values_outside(count: int, tail: float) -> int:
    """Give the largest r for which fewer than r of the values are below with chance <= tail."""
    from scipy.special import bdtr

    few, many = 0, (count + 1) // 2
    while few < many:
        middle = (few + many + 1) // 2
        if bdtr(middle - 1, count, 0.5) <= tail:
            few = middle
        else:
            many = middle - 1
    return few


def fewest_pairs(p_max: float) -> int:
    """Give the fewest cases on which two ways can differ with a p value below a limit.

    ::

        p = 2 / 2^n       where all n cases are survived by the same way alone

    is the smallest p value that `mcnemar` gives for n cases.

    Parameters
    ----------
    p_max : float
        Above 0 and at most 1.

    Examples
    --------
    >>> fewest_pairs(0.05), fewest_pairs(0.00025)
    (6, 13)

    """
    return floor(2.0 - log2(p_max))


def mcnemar(only_first: int, only_second: int) -> float:
    """Give the exact two-sided p value that two ways fail equally often on the same cases.

    McNemar, Psychometrika 12 (1947), exact: of the cases that only one way survives, either way
    is as likely.

    Parameters
    ----------
    only_first, only_second : int
        Cases that only the first, and only the second way survives.

    Examples
    --------
    >>> mcnemar(0, 5), mcnemar(3, 3)
    (0.0625, 1.0)

    """
    from scipy.special import bdtr

    discordant = only_first + only_second
    if discordant == 0:
        return 1.0
    return min(1.0, 2.0 * float(bdtr(min(only_first, only_second), discordant, 0.5)))
