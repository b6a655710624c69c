"""Where a fit starts and how far it may go, from a regression of force on motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from breakaway.errors import LogError
from breakaway.measure.identification.hysteresis import reference, thinned
from breakaway.measure.identification.laws import Law, Layout, Parameter
from breakaway.measure.identification.record import STEP_LIMIT, Rows, RunSettings
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array, Log

MOVING = 0.05
"""A row moves if its speed exceeds this share of the largest speed."""

INERTIA_ERRORS = 5.0
INERTIA_SHARE = 0.05
"""Inertia shows if the regression's mass exceeds so many standard errors, and its force this
share of the whole."""

BRAKING = 0.5
"""Share of the power that may brake, net."""

REACH = 1e4
"""A positive parameter stays within its first guess times or divided by this."""


@dataclass(frozen=True)
class Scales:
    """Rough size of everything in a log, which guesses and bounds come from.

    ``hidden_mass_kg`` is how large a mass may be that does not show, at 95 %; 0 where one does or
    is given.
    """

    mass_kg: float
    mass_shows: bool
    hidden_mass_kg: float
    coulomb_n: float
    viscous_n_s_per_m: float
    offset_n: float
    force_n: float
    speed_m_per_s: float
    travel_m: float
    noise_m: float
    velocity_noise_m_per_s: float
    period_s: float
    duration_s: float

    def stiffest(self, settings: RunSettings) -> float:
        """Return the largest stiffness in N/m that can be told, or simulated."""
        if settings.motion == "imposed":
            return self.coulomb_n / max(2.0 * self.noise_m, 1e-8 * self.travel_m)
        step = self.period_s / settings.steps
        return STEP_LIMIT**2 * self.mass_kg / step**2


def scales(rows: Rows, chosen: Array, mass_kg: float | None) -> Scales:
    """Regress force on speed and direction where the part moves, without its inertia.

    Raises
    ------
    LogError
        The part never moves, or the force is 0 throughout.

    """
    x, v, a = rows.columns[:3, chosen]
    force = rows.driving_force_n[chosen]
    log, noise = rows.log, noise_floor(rows.log, "position_m")
    noise_m = max(noise.white, noise.quantization)
    travel, speed = float(np.ptp(x)), float(np.quantile(np.abs(v), 0.99))
    if not travel > 5.0 * noise_m or speed == 0.0:
        raise LogError(
            f"{log.name}: the part never moves (travel {travel:.3g} m, noise {noise_m:.3g} m); "
            "friction shows in motion only: record a log in which it slides"
        )
    if not np.any(force):
        raise LogError(f"{log.name}: the force is 0 in every row; record the force on the part")
    moving = np.abs(v) > MOVING * speed
    _check_dissipation(log, force, v)
    columns = np.column_stack([v, np.sign(v), np.ones_like(v)])[moving]
    if np.all(columns[:, 1] == columns[0, 1]):
        columns = columns[:, :2]
    size = float(np.sqrt(np.mean(force**2)))
    inertia, hidden = (mass_kg, 0.0) if mass_kg is not None else _inertia(rows, chosen)
    found = np.linalg.lstsq(columns, (force - inertia * a)[moving], rcond=None)[0]
    found = np.append(found, 0.0)[:3]
    coulomb = max(float(found[1]), 0.05 * size)
    fallback = 0.01 * size / max(float(np.std(a)), 1e-300)
    return Scales(
        mass_kg=inertia if inertia > 0.0 else fallback,
        mass_shows=inertia > 0.0,
        hidden_mass_kg=hidden,
        coulomb_n=coulomb,
        viscous_n_s_per_m=max(float(found[0]), 0.02 * coulomb / speed),
        offset_n=float(found[2]),
        force_n=size,
        speed_m_per_s=speed,
        travel_m=travel,
        noise_m=noise_m,
        velocity_noise_m_per_s=_velocity_noise(rows, noise_m),
        period_s=float(np.median(np.diff(log.t_s))),
        duration_s=float(log.t_s[-1] - log.t_s[0]),
    )


def _inertia(rows: Rows, chosen: Array) -> tuple[float, float]:
    """Return the mass in kg that shows under any hysteresis, and how large a hidden one may be."""
    some = thinned(replace(rows, columns=rows.columns[:, chosen]))
    force, a = some.driving_force_n, some.columns[2]
    size, acceleration = (max(float(np.sqrt(np.mean(one**2))), 1e-300) for one in (force, a))
    least = INERTIA_SHARE * size / acceleration
    mass, error = reference(some).mass_kg(force)
    if mass > max(INERTIA_ERRORS * error, least):
        return mass, 0.0
    return 0.0, min(max(mass, 0.0) + 2.0 * error, least)


def _velocity_noise(rows: Rows, noise_m: float) -> float:
    """Return the noise of the velocity in m/s: that of the position within the low-pass, as rate.

    ::

        s_v² = s_x² (2 / f_s) ∫ (2 π f)² df from 0 to the cutoff
    """
    rate = rows.log.sample_rate_hz
    cutoff = rows.lowpass_hz or 0.5 * rate
    return noise_m * float(np.sqrt(8.0 * np.pi**2 * cutoff**3 / (3.0 * rate)))


def _check_dissipation(log: Log, force: Array, v: Array) -> None:
    """Raise `LogError` where the force brakes on the whole: friction cannot drive."""
    power = force * v
    if float(np.sum(power)) < -BRAKING * float(np.sum(np.abs(power))):
        raise LogError(
            f"{log.name}: force and velocity oppose each other on balance, as if friction drove "
            "the part; flip the sign of one: 'sign = -1' in the mapping, or the channel's own"
        )


def stand_in(law: Law, settings: RunSettings, sizes: Scales) -> dict[str, float]:
    """Return numbers of the core that a law without a bristle needs so that it can rest."""
    if law.has_bristle:
        return {}
    stiffness = sizes.stiffest(settings)
    damping = 0.0 if settings.motion == "imposed" else float(np.sqrt(stiffness * sizes.mass_kg))
    return {"stiffness_n_per_m": stiffness, "damping_n_s_per_m": damping}


def first_guess(parameter: Parameter, sizes: Scales, settings: RunSettings) -> tuple[float, float]:
    """Return a value, and the half width of the draws around it in the internal parameter."""
    stiffness = 0.2 * sizes.stiffest(settings)
    damping = 0.3 * float(np.sqrt(stiffness * sizes.mass_kg))
    if settings.motion == "imposed":
        stiffness = sizes.coulomb_n / (0.02 * sizes.travel_m)
        damping = 0.05 * sizes.coulomb_n / sizes.speed_m_per_s
    slope = sizes.coulomb_n / sizes.travel_m
    known = {
        "mass_kg": (sizes.mass_kg, 0.3),
        "stiction_ratio": (1.0, 0.5),
        "stribeck_velocity_m_per_s": (0.1 * sizes.speed_m_per_s, 2.0),
        "stiffness_n_per_m": (stiffness, 3.0),
        "damping_n_s_per_m": (damping, damping),
        "elastic_share": (0.5, 0.7),
        "coulomb_slope_n_per_m": (0.0, 0.3 * slope),
        "spring_n_per_m": (0.0, 0.3 * slope),
        "delay_s": (0.0, 0.0),
        "drift_n_per_s": (0.0, 0.1 * sizes.force_n / sizes.duration_s),
        "warming_per_s": (0.0, 0.1 / sizes.duration_s),
        "backlash_m": (10.0 * sizes.noise_m, 5.0 * sizes.noise_m),
    }
    if parameter.name in known:
        return known[parameter.name]
    if parameter.name.startswith("coulomb"):
        return sizes.coulomb_n, 0.5
    if parameter.name.startswith("viscous"):
        return sizes.viscous_n_s_per_m, 0.5 * sizes.viscous_n_s_per_m
    return sizes.offset_n, 0.1 * sizes.force_n


def bounds_of(
    parameter: Parameter, guess: float, sizes: Scales, settings: RunSettings
) -> tuple[float, float]:
    """Return the values that a parameter may take."""
    low, high = parameter.low, parameter.high
    if parameter.positive and high > 1e8:
        low, high = guess / REACH, guess * REACH
    if parameter.may_vanish:
        high = guess * REACH
    if parameter.name == "warming_per_s":
        low, high = -0.95 / sizes.duration_s, 19.0 / sizes.duration_s
    if parameter.name == "stiffness_n_per_m" and settings.motion != "imposed":
        high = sizes.stiffest(settings)
    return low, high


def internal_guess(
    layout: Layout, sizes: Scales, settings: RunSettings, known: Mapping[str, float]
) -> tuple[Array, Array, tuple[Array, Array]]:
    """Return first guess, half width of the draws and bounds of the internal parameters.

    ``known`` are guesses by name, which go before those from the log.
    """
    guess, spread, low, high = [], [], [], []
    for parameter in layout.free:
        value, width = first_guess(parameter, sizes, settings)
        ends = bounds_of(parameter, value, sizes, settings)
        value = known.get(parameter.name, value)
        guess.append(parameter.internal(min(max(value, ends[0]), ends[1])))
        spread.append(width)
        low.append(parameter.internal(ends[0]))
        high.append(parameter.internal(ends[1]))
    return np.array(guess), np.array(spread), (np.array(low), np.array(high))
