"""Single samples of a channel that stand alone, as a disturbed transmission leaves them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from breakaway.measure.identification.stretches import noise
from breakaway.measure.logs.log import Array

STANDS_OUT = 10.0
"""A spike stands out from both neighbors by more than this many standard deviations of noise."""

STEEPER = 3.0
"""It does so by more than this many times the largest of the steps around it."""

AROUND = 3
"""Steps on either side that count as around it."""

NEIGHBORS = 0.5
"""Its neighbors differ from each other by less than this share of its height."""


@dataclass(frozen=True)
class Spike:
    """A single sample that stands alone."""

    time_s: float
    force_n: float


def spike_places(values: Array) -> npt.NDArray[np.intp]:
    """Return the places of single samples that stand alone.

    Such a sample leaves both neighbors to the same side, by more than ten standard deviations of
    the channel's noise and three times the largest of the three steps before and after it, and its
    neighbors are close to each other. A peak that a load rises to, or falls from, over several
    samples is none.

    Examples
    --------
    >>> load = np.concatenate([np.arange(50.0), np.full(50, 20.0)])  # a peak of 49, then sliding
    >>> load[30] = 9999.0
    >>> spike_places(load).tolist()
    [30]

    """
    step = np.diff(values)
    up, down = step[:-1], -step[1:]
    height = np.where(up * down > 0.0, np.minimum(np.abs(up), np.abs(down)), 0.0)
    apart = np.abs(up - down)
    places = np.flatnonzero((height > STANDS_OUT * noise(values)) & (apart < NEIGHBORS * height))
    steep = [_steepest(step, int(place)) for place in places]
    return places[height[places] > STEEPER * np.array(steep)] + 1


def _steepest(step: Array, place: int) -> float:
    """Return the largest of the steps around the two that lead to a sample and away."""
    around = np.abs([*step[max(place - AROUND, 0) : place], *step[place + 2 : place + 2 + AROUND]])
    return float(around.max()) if around.size else np.inf


def without_spikes(values: Array, places: npt.NDArray[np.intp]) -> Array:
    """Return values in which each spike has the value before it."""
    out = values.copy()
    out[places] = values[places - 1]
    return out
