"""What is known, and what is not, of the rig in the intervals of what a log tells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.uncertainty import LEVEL, Profile
from breakaway.measure.identification.verdicts import Estimate
from breakaway.measure.logs.log import Array
from breakaway.model.units import unit_of

QUANTILE = float(ndtri(0.5 + 0.5 * LEVEL))
"""Half width of an interval, in standard errors."""

IN_SERIES = (
    "a bound from below: the stiffness of joint and rig in series; a rig file (`rig`, --rig) tells "
    "the joint's"
)
TOO_UNCERTAIN = (
    "a bound from below: what the rig file says of the rig's stiffness leaves the joint's open"
)


def stiffness_is_told(rig: RigFile | None) -> bool:
    """Whether a fit tells the stiffness of the joint alone."""
    return rig is not None and rig.stiffness_is_told


def with_rig(estimates: Sequence[Estimate], rig: RigFile | None) -> list[Estimate]:
    """Return estimates whose errors and intervals allow for the rig.

    The stiffness of the joint is a bound from below where nothing is known of the rig's.
    """
    return [_with_rig(one, rig) for one in estimates]


def _with_rig(one: Estimate, rig: RigFile | None) -> Estimate:
    known = RigFile() if rig is None else rig
    low, high = _widened(known, one.name, one.value, (one.low, one.high))
    error = _with_own(known, one.name, one.value, one.standard_error)
    remark = one.remark
    if one.name == "stiffness_n_per_m" and one.identifiable:
        if not stiffness_is_told(rig):
            high, remark = math.inf, IN_SERIES
        elif math.isinf(high):
            remark = TOO_UNCERTAIN
    return replace(one, standard_error=error, low=low, high=high, remark=remark)


def profile_with_rig(found: Profile, value: float, rig: RigFile | None) -> Profile:
    """Return a profile whose interval allows for the rig."""
    if rig is None:
        return found
    low, high = _widened(rig, found.name, value, (found.low, found.high))
    return replace(found, low=low, high=high)


def spread_by_rig(drawn: dict[str, Array], rig: RigFile | None, seed: int) -> dict[str, Array]:
    """Return draws of parameters that are also spread by what is uncertain of the rig.

    One load cell measured all of a draw, so its forces share a gain.
    """
    if rig is None:
        return drawn
    rng = np.random.default_rng((seed, 1))
    count = len(next(iter(drawn.values())))
    gain = np.exp(0.01 * rig.force_calibration_percent * rng.standard_normal(count))
    softer = _rig_compliance_error(rig) * rng.standard_normal(count)
    heavier = rig.mass_error_kg * rng.standard_normal(count)
    out = {name: one * gain if scales_with_force(name) else one for name, one in drawn.items()}
    if "stiffness_n_per_m" in out:
        out["stiffness_n_per_m"] = 1.0 / np.abs(1.0 / out["stiffness_n_per_m"] - softer)
    if "mass_kg" in out:
        out["mass_kg"] = np.abs(out["mass_kg"] - heavier)
    return out


def _widened(
    rig: RigFile, name: str, value: float, ends: tuple[float, float]
) -> tuple[float, float]:
    """Return an interval that allows for the rig; that of a stiffness is of its compliance."""
    low, high = ends
    if name == "stiffness_n_per_m" and low > 0.0:
        error = QUANTILE * _compliance_error(rig, value)
        most = 1.0 / value + math.hypot(1.0 / low - 1.0 / value, error)
        least = 1.0 / value - math.hypot(1.0 / value - 1.0 / high, error)
        return 1.0 / most, 1.0 / least if least > 0.0 else math.inf
    error = QUANTILE * _own_error(rig, name, value)
    wide = value - math.hypot(value - low, error), value + math.hypot(high - value, error)
    return (max(wide[0], 0.0) if low >= 0.0 else wide[0]), wide[1]


def _with_own(rig: RigFile, name: str, value: float, error: float) -> float:
    """Return a standard error that allows for the rig."""
    own = _own_error(rig, name, value)
    if name == "stiffness_n_per_m":
        own = value**2 * _compliance_error(rig, value)
    return math.hypot(error, own)


def _own_error(rig: RigFile, name: str, value: float) -> float:
    gain = 0.01 * rig.force_calibration_percent * abs(value)
    if not scales_with_force(name):
        return 0.0
    return math.hypot(gain, rig.mass_error_kg) if name == "mass_kg" else gain


def _compliance_error(rig: RigFile, stiffness_n_per_m: float) -> float:
    """Return what the rig adds to the uncertainty of 1 / k_e, in m/N."""
    gain = 0.01 * rig.force_calibration_percent / stiffness_n_per_m
    return math.hypot(gain, _rig_compliance_error(rig))


def _rig_compliance_error(rig: RigFile) -> float:
    """Return the standard uncertainty of 1 / k_rig, in m/N."""
    stiffness = rig.stiffness_n_per_m
    return 0.0 if stiffness is None else rig.stiffness_error_n_per_m / stiffness**2


def scales_with_force(name: str) -> bool:
    """Whether a parameter is as wrong as the gain of the load cell.

    Examples
    --------
    >>> [scales_with_force(name) for name in ("damping_n_s_per_m", "mass_kg", "stiction_ratio")]
    [True, True, False]

    """
    return unit_of(name).symbol.startswith(("N", "kg"))
