"""What a model says of a record whose position was recorded late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from breakaway.measure.logs.log import Array

NODES = 4
"""Rows about a time that a value between them is interpolated from, by a cubic."""

NEAR = 0.05
"""Rows ahead and behind over which a slope in time is taken."""


@dataclass(frozen=True, eq=False)
class Lag:
    """Rows whose prediction is shifted in time, segment by segment.

    A position that is late by τ at a row was true τ before. What is predicted from it, the force,
    belongs τ later: the value for a row at t is the prediction at t + τ. A position that is
    predicted is compared τ before: ``sign`` is then -1. Beyond the ends of a segment its end is
    taken.
    """

    t_s: Array
    segments: tuple[tuple[int, int], ...]
    sign: int

    @classmethod
    def of(cls, t_s: Array, segments: Sequence[tuple[int, int]], *, position: bool) -> Lag:
        """Lay out segments, first and end row of each, one behind the other."""
        lengths = np.cumsum([0, *(end - first for first, end in segments)]).tolist()
        places = np.concatenate([np.arange(first, end) for first, end in segments])
        joined = tuple(pairwise(lengths))
        return cls(t_s[places], joined, -1 if position else 1)

    def shifted(self, values: Array, delay_s: float) -> Array:
        """Return values (n,) or columns (n, k) as they are where the position is late."""
        if delay_s == 0.0:
            return values
        parts = [self._within(values[a:b], self.t_s[a:b], delay_s) for a, b in self.segments]
        return np.concatenate(parts)

    def slope(self, values: Array, delay_s: float) -> Array:
        """Return the derivative of `shifted` with respect to the delay, per s."""
        near = NEAR * float(np.median(np.diff(self.t_s)))
        after, before = (self.shifted(values, delay_s + side) for side in (near, -near))
        return (after - before) / (2.0 * near)

    def _within(self, values: Array, t_s: Array, delay_s: float) -> Array:
        at = np.clip(t_s + self.sign * delay_s, t_s[0], t_s[-1])
        first = np.clip(np.searchsorted(t_s, at) - NODES // 2, 0, len(t_s) - NODES)
        nodes = first[:, None] + np.arange(NODES)
        weights = _lagrange(t_s[nodes], at)
        shifted: Array = np.einsum("nk,nk...->n...", weights, values[nodes])
        return shifted


def _lagrange(nodes: Array, at: Array) -> Array:
    """Return the weights (n, k) of values at nodes (n, k) for the polynomial through them."""
    weights = np.ones_like(nodes)
    for i in range(nodes.shape[1]):
        for j in range(nodes.shape[1]):
            if i != j:
                weights[:, i] *= (at - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    return weights
