"""What one more measurement would buy: expected value of perfect information, quantity by quantity.

With U the number of parts unharmed, of a part with the quantity q and a way w ::

    worth(q) = E_q[max_w E[U | w, q]] - max_w E[U | w]

Source: Raiffa and Schlaifer, Applied Statistical Decision Theory, 1961; the inner means are over
parts whose q is alike, as Strong and Oakley, Medical Decision Making 33 (2013), do by regression.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.advice.trying import Tried

Array = NDArray[np.float64]

BINS = 5
"""Groups of parts that are alike in a quantity."""
SHUFFLES = 50
"""Orders of the parts, in which a quantity tells nothing: what they gain is subtracted."""
SHOWN = {
    "stiction_n": "the force that breaks it loose",
    "stiction_ratio": "stiction over sliding friction",
    "presliding_m": "how far it yields before it slips",
    "bristle_damping_ratio": "damping before it slips",
    "stribeck_velocity_m_per_s": "the speed over which friction falls",
    "mass_kg": "its mass",
    "engagement_length_m": "the length of the guide",
    "var": "how much friction varies",
    "correlation_length_m": "over which length it varies",
}
"""Quantity of a part -> what it is, in words."""


@dataclass(frozen=True)
class Worth:
    """What it would buy to know something."""

    quantity: str
    """A quantity of the part, or ``law``."""
    words: str
    """What it is."""
    gain: float
    """Share of parts that are spared more, if it is known before one decides; 0 to 1."""
    noise: float
    """Standard deviation of that gain where the quantity tells nothing."""

    @property
    def is_clear(self) -> bool:
        """Whether the gain is beyond what chance gives."""
        return self.gain > 2.0 * self.noise and self.gain > 0.0


def worths(tried: Tried) -> list[Worth]:
    """Give what knowing each quantity, or the law, would buy, the most first."""
    names = list(tried.chosen)
    by_law = np.array(
        [[found[n].unharmed.astype(float) for n in names] for found in tried.outcomes.values()]
    )  # law, way, part
    over_laws = by_law.mean(axis=0)
    found = [
        _worth(name, words, tried.quantities[name], over_laws)
        for name, words in SHOWN.items()
        if np.ptp(tried.quantities[name]) > 0.0
    ]
    found.append(_worth_of_law(by_law))
    return sorted(found, key=lambda one: -one.gain)


def _worth_of_law(by_law: Array) -> Worth:
    """Subtract what chance alone gains: laws that are dealt anew to each part tell nothing."""

    def gain(spared: Array) -> float:
        shares = spared.mean(axis=2)
        return float(shares.max(axis=1).mean() - shares.mean(axis=0).max())

    rng = np.random.default_rng(0)
    laws, ways, parts = by_law.shape
    by_chance = []
    for _ in range(SHUFFLES):
        order = rng.permuted(np.tile(np.arange(laws), (parts, 1)), axis=1)  # part, law
        dealt = by_law[order.T[:, None, :], np.arange(ways)[None, :, None], np.arange(parts)]
        by_chance.append(gain(dealt))
    left = max(gain(by_law) - float(np.mean(by_chance)), 0.0)
    return Worth("law", "the friction law", left, float(np.std(by_chance)))


def _worth(name: str, words: str, values: Array, unharmed: Array) -> Worth:
    """Subtract what chance alone gains: bins of any parts have means of their own."""
    groups = np.array_split(np.argsort(values, kind="stable"), BINS)
    rng = np.random.default_rng(0)
    by_chance = [
        _gain(np.array_split(rng.permutation(len(values)), BINS), unharmed) for _ in range(SHUFFLES)
    ]
    gain = _gain(groups, unharmed) - float(np.mean(by_chance))
    return Worth(name, words, max(gain, 0.0), float(np.std(by_chance)))


def _gain(groups: list[NDArray[np.intp]], unharmed: Array) -> float:
    best = sum(len(one) * unharmed[:, one].mean(axis=1).max() for one in groups if len(one))
    return float(best / unharmed.shape[1] - unharmed.mean(axis=1).max())
