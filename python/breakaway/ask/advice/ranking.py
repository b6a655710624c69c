"""Which way is best, which is second, and how surely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from breakaway.ask.advice.outcome import Outcome
from breakaway.ask.advice.trying import Tried
from breakaway.ask.studies.statistics import clopper_pearson, mcnemar
from breakaway.model.scenario.laws import Law

CONFIDENCE = 0.95
CLEAR = 0.05
"""Chance of calling a difference clear where there is none."""
HIGH = 0.95
"""Quantile that stands for the bad cases."""


@dataclass(frozen=True)
class Ranked:
    """What a way does under the law where it does worst; of all laws where nothing is said."""

    way: str
    """Name of the way."""
    words: str
    """What is done."""
    setting: str
    """Name of its setting."""
    law: Law
    """The law where it does worst."""
    parts: int
    """How many parts it was judged on."""
    unharmed: float
    """Share of parts that come out within all limits, under that law."""
    low: float
    """Lower end of its interval."""
    high: float
    """Upper end of its interval."""
    by_law: dict[Law, float]
    """The same share under each law."""
    freed: float
    """Share that comes out at all."""
    failing: dict[str, float]
    """Limit -> share of parts that it fails, of those tried under that law."""
    load_median: float
    """Peak force over the one allowed, at the median."""
    load_high: float
    """The same, for one part in twenty exceeded."""
    peak_high_n: float
    """Peak force, for one part in twenty exceeded."""
    jump_high_m: float
    """Largest jump, for one part in twenty exceeded."""
    velocity_high_m_per_s: float | None
    """Velocity at release, for one part in twenty exceeded."""
    time_median_s: float | None
    """Time to release, at the median."""
    impulse_median_n_s: float
    """Impulse of the force, at the median."""

    @property
    def order(self) -> tuple[float, float, float, float]:
        """The larger, the better: unharmed, freed, low load, little time."""
        slow = np.inf if self.time_median_s is None else self.time_median_s
        return self.unharmed, self.freed, -round(self.load_high, 2), -slow


@dataclass(frozen=True)
class Difference:
    """How the best way and the second differ, part by part, under the law that is worst for it."""

    only_best: int
    """Parts that the best way alone frees unharmed."""
    only_second: int
    """Parts that the second alone frees unharmed."""
    p: float
    """McNemar's exact p value."""

    @property
    def is_clear(self) -> bool:
        """Whether parts tell the two apart."""
        return self.p < CLEAR


def ranked(tried: Tried) -> list[Ranked]:
    """Give all ways, the best first."""
    rows = [_row(tried, way.name, way.words) for way in tried.ways]
    return sorted(rows, key=lambda row: row.order, reverse=True)


def difference(tried: Tried, best: Ranked, second: Ranked) -> Difference:
    """Compare two ways on the same parts, under the law that is worst for the best of them."""
    one = tried.outcomes[best.law][best.way].unharmed
    other = tried.outcomes[best.law][second.way].unharmed
    counts = int((one & ~other).sum()), int((other & ~one).sum())
    return Difference(*counts, mcnemar(*counts))


def _row(tried: Tried, name: str, words: str) -> Ranked:
    by_law = {law: float(found[name].unharmed.mean()) for law, found in tried.outcomes.items()}
    law = min(by_law, key=lambda one: by_law[one])
    outcome = tried.outcomes[law][name]
    count = int(outcome.unharmed.sum())
    low, high = clopper_pearson(count, tried.parts, CONFIDENCE)
    return Ranked(
        way=name,
        words=words,
        setting=tried.chosen[name].name,
        law=law,
        parts=tried.parts,
        unharmed=count / tried.parts,
        low=low,
        high=high,
        by_law=by_law,
        freed=float(outcome.freed.mean()),
        failing=_failing(outcome),
        load_median=float(np.median(outcome.load)),
        load_high=float(np.quantile(outcome.load, HIGH)),
        peak_high_n=float(np.quantile(outcome.peak_n, HIGH)),
        jump_high_m=float(np.quantile(outcome.jump_m, HIGH)),
        velocity_high_m_per_s=_finite_quantile(outcome.velocity_m_per_s, HIGH),
        time_median_s=_finite_quantile(outcome.time_s, 0.5),
        impulse_median_n_s=float(np.median(outcome.impulse_n_s)),
    )


def _failing(outcome: Outcome) -> dict[str, float]:
    """Give the share of parts that each limit fails, the largest first; limits that fail none."""
    shares = {
        "stays in place": float((~outcome.freed).mean()),
        "force": float((~outcome.within_force).mean()),
        "jump": float((~outcome.within_jump).mean()),
        "velocity": float((~outcome.within_velocity).mean()),
    }
    return {k: v for k, v in sorted(shares.items(), key=lambda one: -one[1]) if v > 0.0}


def _finite_quantile(values: np.ndarray, share: float) -> float | None:
    kept = values[np.isfinite(values)]
    return float(np.quantile(kept, share)) if kept.size else None
