"""What a log that goes one way tells of friction and offset: their sum, and neither alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from breakaway.measure.identification.laws import Layout
from breakaway.measure.identification.uncertainty import HALF_WIDTH
from breakaway.measure.identification.verdicts import Estimate, Excitation
from breakaway.measure.logs.log import Array


def sums(
    layout: Layout, best: Array, matrix: Array, shown: Excitation, estimates: Sequence[Estimate]
) -> tuple[Estimate, ...]:
    """Return Coulomb and stiction force with the offset in the direction of motion.

    A fit whose offset is held at 0 finds these sums instead of the levels.
    """
    names = [one.name for one in layout.free]
    if "coulomb_n" not in names:
        return ()
    word = "plus" if shown.direction > 0 else "minus"
    coulomb = [names.index("coulomb_n")]
    out = [_product(f"coulomb_{word}_offset_n", coulomb, best, matrix)]
    ratio = next((one for one in estimates if one.name == "stiction_ratio"), None)
    if ratio is not None and ratio.identifiable:
        both = [*coulomb, names.index("stiction_ratio")]
        out.append(_product(f"stiction_{word}_offset_n", both, best, matrix))
    return tuple(out)


def _product(name: str, places: Sequence[int], best: Array, matrix: Array) -> Estimate:
    """Return the product of positive parameters, which are fitted as logarithms."""
    log = float(np.sum(best[list(places)]))
    error = math.sqrt(float(np.sum(matrix[np.ix_(places, places)])))
    value, half = math.exp(log), min(HALF_WIDTH * error, 700.0)
    ends = value * math.exp(-half), value * math.exp(half)
    return Estimate(name, value, value * error, *ends, error < 0.5)


def without_offset(one: Estimate, shown: Excitation, stiction_n: float) -> Estimate:
    """Return an estimate of a level that allows for any offset that the rests of a log allow.

    The offset is taken to be no larger than the sum. A joint at rest holds at most its stiction
    force, so F_0 ≤ (F_rest + F_s + F_0) / 2, along the motion.
    """
    largest = min(one.value, 0.5 * (max(shown.resting_n, -stiction_n) + stiction_n))
    ends = max(one.low - largest, 0.0), 2.0 * one.high
    return replace(one, low=ends[0], high=ends[1])
