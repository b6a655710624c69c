"""Free travel of a joint or its drive: a stretch of the reversal over which nothing resists."""

from __future__ import annotations

import numpy as np
from scipy.stats import t as student

from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.hysteresis import reference, thinned
from breakaway.measure.identification.record import Rows
from breakaway.measure.identification.turns import to_and_fro
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array

FALSE_ALARMS = 1e-3
"""Chance that a sound log's reversals look like free travel, over all levels that are tried."""

SPAN = 0.2
STEP = 0.1
LEVELS = np.arange(0.5, -0.11, -STEP)
"""Span of force, and where spans begin, as shares of the level before the turn."""

FEWEST_TURNS = 5

RESOLVED = 4.0
"""Least free travel, over the noise of the position."""

MATERIAL = 0.2
"""Least free travel, over the travel of the next span of force."""

SLOW = 0.02
"""A row moves if its speed exceeds this share of the largest speed."""


def find_backlash(rows: Rows) -> tuple[Fault, ...]:
    """Look for a span of force that takes more travel than the next one.

    From a turn on, friction gives way ever more easily: in every law the travel for a span of force
    grows from the turn until the part slides. With free travel b the force lets go, stays about 0
    over b, and only then rises on the other side: the span about 0 takes b more than the next. Over
    the turns the excess is tested against 0 by its spread (Student's t).
    """
    if to_and_fro(*rows.columns[:2]) < FEWEST_TURNS:
        return ()
    rows = thinned(rows)
    base = reference(rows)
    noise = noise_floor(rows.log, "position_m")
    friction = base.resisting(rows.driving_force_n)
    travels = _travels(rows.columns[0], rows.columns[1], friction)
    if len(travels) < FEWEST_TURNS:
        return ()
    excess, following = travels[:, 0] - travels[:, 1], travels[:, 1].mean(axis=0)
    mean = excess.mean(axis=0)
    error = excess.std(axis=0, ddof=1) / np.sqrt(len(excess))
    limit = float(student.ppf(1.0 - FALSE_ALARMS / len(LEVELS), len(excess) - 1))
    least = np.maximum(RESOLVED * max(noise.white, noise.quantization), MATERIAL * following)
    counts = (mean > limit * error) & (mean > least)
    if not counts.any():
        return ()
    free_m = float(mean[counts].max())
    return (
        Fault(
            "backlash",
            "backlash_m",
            free_m,
            f"backlash: at {len(excess)} turns about {free_m:.2g} m of travel meet no resistance, "
            "between the sensor of the position and the joint; take up the play, or measure the "
            "position at the part",
        ),
    )


def _travels(x: Array, v: Array, friction: Array) -> Array:
    """Return (turns, 2, levels): the travel of each span of force, and that of the next span."""
    moving = np.flatnonzero(np.abs(v) > SLOW * float(np.quantile(np.abs(v), 0.99)))
    turns = np.flatnonzero(np.diff(np.sign(v[moving])))
    if turns.size == 0:
        return np.array([])
    ends = [*moving[turns[1:]], len(x) - 1]
    found = []
    for before, after, end in zip(moving[turns], moving[turns + 1], ends, strict=True):
        side = float(np.sign(v[before]))
        turn = before + int(np.argmax(side * x[before : after + 1]))
        level = side * float(friction[turn])
        travel = side * (x[turn] - x[turn : end + 1])
        force = side * friction[turn : end + 1]
        if level > 0.0 and force.min() < -0.6 * level:
            found.append(_spans(travel, force / level))
    return np.array(found)


def _spans(travel: Array, share: Array) -> Array:
    """Return the travel in which the force falls through each span, and through the next one."""
    shares = np.arange(LEVELS[0], LEVELS[-1] - 2.5 * SPAN, -STEP)
    lowest = np.minimum.accumulate(share)
    at = np.interp(-shares, -lowest, travel)
    step = round(SPAN / STEP)
    spans = at[step:] - at[:-step]
    return np.array([spans[:-step], spans[step:]])
