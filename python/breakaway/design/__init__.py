"""Controller design: gains by pole placement, and what becomes of the closed loop.

In come joints, gains and timing; out go gains, margins, poles and limit cycles. No runs, no files.
"""

from __future__ import annotations

from breakaway.design.describing_function import describing_function
from breakaway.design.limit_cycle import LimitCycle, limit_cycles
from breakaway.design.limit_cycle_course import (
    Cycles,
    LimitCycleComparison,
    compare_limit_cycle,
    measured_cycles,
)
from breakaway.design.loop import SampledPid, open_loop, sliding_plant, stuck_plant
from breakaway.design.margins import Margins, margins
from breakaway.design.pole_placement import GainSet, PidGains, pole_placement
from breakaway.design.regimes import SampledLoop, sampled_loops, sampled_pid
from breakaway.design.stability import LoopStability, Stability, stability
from breakaway.model.friction.curve import steepest_fall_velocity, stribeck_slope

__all__ = [
    "Cycles",
    "GainSet",
    "LimitCycle",
    "LimitCycleComparison",
    "LoopStability",
    "Margins",
    "PidGains",
    "SampledLoop",
    "SampledPid",
    "Stability",
    "compare_limit_cycle",
    "describing_function",
    "limit_cycles",
    "margins",
    "measured_cycles",
    "open_loop",
    "pole_placement",
    "sampled_loops",
    "sampled_pid",
    "sliding_plant",
    "stability",
    "steepest_fall_velocity",
    "stribeck_slope",
    "stuck_plant",
]
