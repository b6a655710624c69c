"""Steady sliding and turns of a part, and the offset of the force that sliding both ways shows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from breakaway.measure.identification.stretches import Stretches
from breakaway.measure.logs.log import Array

FAST = 0.5
"""A part slides from this share of the median speed of its motion."""

FEWEST_SAMPLES = 5
"""Fewest samples of steady sliding that give a sliding level."""


@dataclass(frozen=True)
class Reversal:
    """A change of direction without a rest: where, into which direction, how long it stood."""

    time_s: float
    direction: int
    standstill_s: float


@dataclass(frozen=True)
class SlidingLevel:
    """Steady sliding between two turns or rests; the force is signed and as measured."""

    direction: int
    start_s: float
    end_s: float
    speed_m_per_s: float
    force_n: float
    spread_n: float


def sliding_levels(cut: Stretches, force: Array) -> tuple[SlidingLevel, ...]:
    """Return the steady part of every motion that has one."""
    levels = []
    for stretch in cut.stretches:
        if stretch.direction == 0:
            continue
        places = np.arange(stretch.first, stretch.last + 1)
        speed = stretch.direction * cut.speed_m_per_s[places]
        moving = speed[speed > cut.rest_speed_m_per_s]
        if moving.size < FEWEST_SAMPLES:
            continue
        typical = float(np.median(moving))
        steady = places[np.abs(speed - typical) <= FAST * typical]
        if steady.size < FEWEST_SAMPLES:
            continue
        level = float(np.median(force[steady]))
        levels.append(
            SlidingLevel(
                direction=stretch.direction,
                start_s=float(cut.t_s[steady[0]]),
                end_s=float(cut.t_s[steady[-1]]),
                speed_m_per_s=typical,
                force_n=level,
                spread_n=1.4826 * float(np.median(np.abs(force[steady] - level))),
            )
        )
    return tuple(levels)


def estimate_offset(sliding: tuple[SlidingLevel, ...]) -> tuple[float | None, float | None, str]:
    """Return (F_up + F_down) / 2 with its standard error, or why there is none."""
    sides = [[level for level in sliding if level.direction == d] for d in (1, -1)]
    if not sliding:
        return None, None, "the part does not slide steadily; give offset_n"
    if not all(sides):
        return None, None, "the part slides only one way; give offset_n"
    means = [float(np.median([level.force_n for level in side])) for side in sides]
    variance = sum(_level_error(side) ** 2 for side in sides)
    return 0.5 * sum(means), 0.5 * math.sqrt(variance), "estimated from sliding in both directions"


def _level_error(side: list[SlidingLevel]) -> float:
    """Return the error of a median level: between motions, or within the only one."""
    if len(side) == 1:
        return side[0].spread_n
    between = float(np.std([level.force_n for level in side], ddof=1))
    return between / math.sqrt(len(side))


def friction(sliding: tuple[SlidingLevel, ...], offset_n: float | None) -> float:
    """Return the magnitude of sliding friction, 0 where none is seen."""
    levels = [level.direction * (level.force_n - (offset_n or 0.0)) for level in sliding]
    return abs(float(np.median(levels))) if levels else 0.0


def reversals(cut: Stretches) -> tuple[Reversal, ...]:
    """Return the turns between motions without a rest."""
    found = []
    for before, after in pairwise(cut.stretches):
        if before.direction * after.direction != -1:
            continue
        inside = cut.position_m[before.first : after.last + 1] * before.direction
        turn = before.first + int(np.argmax(inside))
        slow = ~(np.abs(cut.speed_m_per_s) > cut.rest_speed_m_per_s)
        low = high = turn
        while low > before.first and slow[low - 1]:
            low -= 1
        while high < after.last and slow[high + 1]:
            high += 1
        stood = float(cut.t_s[high] - cut.t_s[low])
        found.append(Reversal(float(cut.t_s[turn]), after.direction, stood))
    return tuple(found)
