"""What is known, and what is not, of the rig in the intervals of what a log tells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from scipy.special import ndtri

from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.uncertainty import LEVEL, Profile
from breakaway.measure.identification.verdicts import Estimate

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
    low, high = known.widened(one.name, one.value, one.low, one.high, QUANTILE)
    error = known.error(one.name, one.value, one.standard_error)
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
    low, high = rig.widened(found.name, value, found.low, found.high, QUANTILE)
    return replace(found, low=low, high=high)
