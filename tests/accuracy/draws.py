"""Random numbers of a case: a function of its seed and number."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, log
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")


class Draws:
    """Draws for one case."""

    def __init__(self, seed: int, number: int) -> None:
        self._draws = np.random.default_rng([seed, number])

    def uniform(self, low: float, high: float) -> float:
        return float(self._draws.uniform(low, high))

    def log_uniform(self, low: float, high: float) -> float:
        """Low, where the range is empty."""
        return exp(self.uniform(log(low), log(high))) if low < high else low

    def chance(self, share: float) -> bool:
        return bool(self._draws.random() < share)

    def one_of(self, items: Sequence[Item]) -> Item:
        return items[int(self._draws.integers(len(items)))]
