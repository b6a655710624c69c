"""Whether the steady curve of an identified law runs through what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from breakaway.measure.identification.friction import (
    FrictionPath,
    measured_friction,
    steady_friction,
)
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.verdicts import stiction_peak
from breakaway.measure.logs.log import Array

BINS = 12
"""Bands of speed in which measured friction and curve are compared, each direction apart."""

FEWEST_ROWS = 20
"""Fewest rows of a band that count."""

SETTLED = 3.0
"""Sliding is steady after this many deflections of the joint since the last turn."""

LEAVES = 0.2
"""Share of the measured friction from which a curve leaves it."""


@dataclass(frozen=True)
class CurveMisfit:
    """Where a steady curve is farthest from the measured friction, as a share of the latter."""

    speed_m_per_s: float
    share: float


def curve_misfit(found: Identification) -> CurveMisfit | None:
    """Return where the steady curve leaves the measured friction most; None without steady sliding.

    ::

        share = |median (R_measured - R_curve)| / |median R_measured|

    over the rows of a band of speed, in either direction, that slide steadily.

    Parameters
    ----------
    found : Identification
        A finished fit.

    """
    path = measured_friction(found)
    rows = np.flatnonzero(_steady(found, path))
    if rows.size < FEWEST_ROWS:
        return None
    speed, friction = path.velocity_m_per_s[rows], path.friction_n[rows]
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    curve = steady_friction(found, speed, numbers)
    bands = [_misfit(speed[own], friction[own], curve[own]) for own in _bands(speed)]
    return max(bands, key=lambda band: band.share, default=None)


def _steady(found: Identification, path: FrictionPath) -> NDArray[np.bool_]:
    """Tell which rows slide, and have done so for long enough."""
    speed = path.velocity_m_per_s
    turned = np.concatenate([[True], (speed[1:] * speed[:-1] <= 0.0)])
    turned |= np.concatenate([[True], np.diff(path.segment) != 0])
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.position_m)))])
    last = np.maximum.accumulate(np.where(turned, np.arange(len(way)), 0))
    values = found.values
    deflection = 0.0
    if "stiffness_n_per_m" in values:
        deflection = float(np.quantile(np.abs(path.friction_n), 0.95)) / values["stiffness_n_per_m"]
    noise = found.excitation.noise_m
    return np.asarray((way - way[last] > SETTLED * max(deflection, noise)) & (speed != 0.0))


def _bands(speed: Array) -> list[NDArray[np.bool_]]:
    """Return the bands of speed that hold enough rows."""
    size = np.abs(speed)
    edges = np.geomspace(float(np.quantile(size, 0.01)), float(size.max()), BINS + 1)
    bands = [
        (np.sign(speed) == side) & (size >= low) & (size <= high)
        for side in (-1.0, 1.0)
        for low, high in pairwise(edges)
    ]
    return [band for band in bands if np.count_nonzero(band) >= FEWEST_ROWS]


def _misfit(speed: Array, friction: Array, curve: Array) -> CurveMisfit:
    level = max(abs(float(np.median(friction))), 1e-300)
    off = abs(float(np.median(friction - curve)))
    return CurveMisfit(float(np.median(np.abs(speed))), off / level)


def peak_in_words(found: Identification) -> str:
    """Say in one sentence whether friction peaks before sliding, and whether the curve shows it."""
    said = stiction_peak({one.name: one for one in found.estimates}, found.verdicts)
    if "peak: seen" not in said:
        return said
    misfit = curve_misfit(found)
    if misfit is None or misfit.share < LEAVES:
        return said
    return (
        f"{said.replace('peak: seen', 'peak: doubtful')}, but the steady curve leaves the measured "
        f"friction by {100 * misfit.share:.0f} % at {1e3 * misfit.speed_m_per_s:.3g} mm/s"
    )
