"""Friction force along the path of an identified log, and of steady sliding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.measure.identification.laws import SHARED
from breakaway.measure.identification.record import Rows, RunSettings, core_record, measured_rows
from breakaway.measure.identification.result import Identification
from breakaway.measure.logs.log import Array, Log

Places = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class FrictionPath:
    """Friction force along a path: what is left of the force without inertia and rig.

    ::

        R = F + F_out - m a - F_0 - d t - k_r (x - x_0)
    """

    position_m: Array
    velocity_m_per_s: Array
    friction_n: Array
    segment: NDArray[np.int64]


def measured_friction(found: Identification) -> FrictionPath:
    """Return the friction force along the measured path of the rows that were fitted.

    Parameters
    ----------
    found : Identification
        A finished fit, whose mass, offsets and spring are taken off.

    """
    rows, places = fitted_rows(found)
    x, v, a, force = rows.columns[:4, places]
    return _path(found, rows.columns[9:11, places], x, v, a, force)


def simulated_friction(found: Identification) -> FrictionPath:
    """Return the friction force along the simulated path.

    Where the motion is simulated, its velocity and acceleration are derived as the measured ones
    are, by the same low-pass.

    Parameters
    ----------
    found : Identification
        A finished fit.

    """
    rows, places = fitted_rows(found)
    fit = found.fit
    if found.settings.motion == "imposed":
        x, v, a = rows.columns[:3, places]
        return _path(found, rows.columns[9:11, places], x, v, a, fit.force_n)
    settings = RunSettings("imposed", lowpass_hz=rows.lowpass_hz, origin_m=found.settings.origin_m)
    parts = []
    for segment in range(int(fit.segment[-1]) + 1):
        own = fit.segment == segment
        log = Log(t_s=fit.t_s[own], position_m=fit.position_m[own], force_n=fit.force_n[own])
        parts.append(measured_rows(log, settings).columns[:4])
    x, v, a, force = np.concatenate(parts, axis=1)
    return _path(found, rows.columns[9:11, places], x, v, a, force)


def _path(
    found: Identification, beside: Array, x: Array, v: Array, a: Array, force: Array
) -> FrictionPath:
    """Take off inertia and rig; ``beside`` are the outside force and the time from the start."""
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    named = ("mass_kg", "spring_n_per_m", "drift_n_per_s")
    mass, spring, drift = (numbers[SHARED.index(name)] for name in named)
    offset = numbers[len(SHARED) + found.fit.segment]
    friction = force + beside[0] - mass * a - offset - drift * beside[1] - spring * x
    return FrictionPath(x + found.settings.origin_m, v, friction, found.fit.segment)


def fitted_rows(found: Identification) -> tuple[Rows, Places]:
    """Return the rows of the log, and which of them were fitted."""
    rows = measured_rows(found.log, found.settings)
    return rows, np.searchsorted(rows.log.t_s, found.fit.t_s)


def steady_friction(found: Identification, speeds: Array, numbers: Array) -> Array:
    """Return the friction force of steady sliding, as the core has it.

    A row at rest in its acceleration whose force is huge starts with its bristle at its level: what
    the core says of it is steady sliding.

    Parameters
    ----------
    found : Identification
        The fit, for its law.
    speeds : array of shape (k,)
        Velocities in m/s, none 0.
    numbers : array of shape (n,)
        Numbers of the core, as ``found.internals.problem.layout.numbers`` gives them.

    """
    still, huge = np.zeros_like(speeds), 1e12 * np.sign(speeds)
    period = np.ones_like(speeds)
    columns = [still, speeds, still, huge, still, still, period, speeds, huge, still, still]
    rows = Rows(found.log, np.array(columns), even=True, lowpass_hz=None)
    segments = [(row, row + 1) for row in range(len(speeds))]
    record = core_record(rows, segments, found.law, RunSettings("imposed"))
    shared = numbers[: len(SHARED)]
    return np.frombuffer(record.simulate([*shared.tolist(), *still.tolist()])[1])
