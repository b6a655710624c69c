"""A force that drifts, and friction that changes while it is measured."""

from __future__ import annotations

import numpy as np

from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.hysteresis import reference, thinned
from breakaway.measure.identification.record import Rows
from breakaway.measure.identification.turns import to_and_fro
from breakaway.measure.identification.uncertainty import covariance
from breakaway.measure.logs.log import Array

SIGNIFICANT = 4.0
"""Standard errors from 0, which a sound log exceeds in 1 of 16,000."""

FEWEST_TURNS = 6
"""Turns without which a change with time can be one with position or speed."""

MATERIAL = 0.05
"""Least change over the record, as a share of the friction, that is named."""


def find_drift(rows: Rows) -> tuple[Fault, ...]:
    """Regress the force on time, and on time times friction, beside any friction at all.

    ::

        F = reference + d t + w t R

    with the standard errors of correlated residuals. A drift moves both directions alike; friction
    that warms or runs in moves them together.
    """
    if to_and_fro(*rows.columns[:2]) < FEWEST_TURNS:
        return ()
    rows = thinned(rows)
    base = reference(rows)
    force, time = rows.driving_force_n, rows.columns[10]
    duration = float(np.ptp(time))
    time = time - 0.5 * duration
    friction = base.friction(force)
    level = float(np.median(np.abs(friction)))
    if level == 0.0:
        return ()
    tested = np.column_stack([base.columns, time / duration, time / duration * friction])
    changes, errors = _last_two(tested, force)
    out = []
    if _counts(changes[0] / level, errors[0] / level):
        out.append(_drifts(changes[0], level, duration))
    if _counts(changes[1], errors[1]):
        out.append(_warms(changes[1], duration))
    return tuple(out)


def _counts(change: float, error: float) -> bool:
    return abs(change) > max(SIGNIFICANT * error, MATERIAL)


def _last_two(columns: Array, force: Array) -> tuple[Array, Array]:
    """Return the coefficients of the last two columns and their standard errors."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / size
    others, last = scaled[:, :-2], scaled[:, -2:]
    left, singular, _ = np.linalg.svd(others, full_matrices=False)
    basis = left[:, singular > 1e-8 * singular[0]]
    free = last - basis @ (basis.T @ last)
    rest = force - basis @ (basis.T @ force)
    found = np.linalg.lstsq(free, rest, rcond=None)[0]
    known = covariance(rest - free @ found, free)
    return found / size[-2:], np.sqrt(np.diag(known.matrix)) / size[-2:]


def _drifts(change_n: float, level_n: float, duration_s: float) -> Fault:
    return Fault(
        "drift",
        "drift_n_per_s",
        change_n / duration_s,
        f"force drift: {change_n:+.3g} N over the record, {100 * abs(change_n) / level_n:.0f} % of "
        "the friction; warm up the load cell, or zero it before each run",
    )


def _warms(change: float, duration_s: float) -> Fault:
    change = float(np.clip(change, -1.5, 1.5))
    end = 100 * (1 + 0.5 * change) / (1 - 0.5 * change)
    return Fault(
        "warming",
        "warming_per_s",
        change / (1.0 - 0.5 * change) / duration_s,
        f"warming: friction ends at {end:.0f} % of what it began with, as joints do that warm up "
        "or run in; the levels are those of its start",
    )
