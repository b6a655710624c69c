"""What a rig may do to a log besides moving the part: 0 unless a log shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from breakaway.measure.identification.laws import Parameter
from breakaway.measure.identification.record import MotionKind

LONGEST_DELAY_S = 0.05

RIG_PARAMETERS = (
    Parameter("delay_s", (), False, -LONGEST_DELAY_S, LONGEST_DELAY_S),
    Parameter("drift_n_per_s", ("drift_n_per_s",), False, -1e9, 1e9),
    Parameter("warming_per_s", ("warming_per_s",), False, -10.0, 10.0),
    Parameter("backlash_m", ("backlash_m",), False, 0.0, 1.0),
)
"""Delay of the position, drift of the force, change of the levels, free travel at a turn."""


def rig_parameters(motion: MotionKind) -> tuple[Parameter, ...]:
    """Return what a rig can be given; in a closed loop a late position would change the motion."""
    late = motion == "closed_loop"
    return tuple(one for one in RIG_PARAMETERS if not (late and one.name == "delay_s"))


def idle(names: Sequence[str], asked: Sequence[str]) -> Mapping[str, float]:
    """Return 0 for each parameter of a rig among the names that nobody asked for."""
    known = {one.name for one in RIG_PARAMETERS}
    return {name: 0.0 for name in names if name in known and name not in asked}
