"""Hostile scenarios: parts, rigs and clocks far from any preset, made so that something happens."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

from tests.accuracy.controllers import controller_table
from tests.accuracy.draws import Draws
from tests.accuracy.drives import actuator_table
from tests.accuracy.kinds import Kind, kind_of
from tests.accuracy.part import Part, draw_part, joint_table

from breakaway.model.scenario.scenario import Scenario

SHORTEST_PERIODS = 30
"""Fewest control periods of a case."""
LONGEST_S = 2.0
"""Longest case, in s, but for parts that are slower."""
STEPS = 3e5
"""About as many steps as a case takes that resolves its fastest oscillation."""


@dataclass(frozen=True)
class Case:
    """A scenario with its place in the set."""

    seed: int
    number: int
    kind: Kind
    scenario: Scenario


def draw_case(seed: int, number: int) -> Case:
    """Give a case of the set, at the steps that it has by default."""
    kind, draws = kind_of(seed, number), Draws(seed, number)
    part = draw_part(kind, draws)
    period_s = draws.log_uniform(1e-5, 1e-3)
    duration_s = _duration_s(kind, part, period_s, draws)
    part = part.with_guide(duration_s, draws)
    actuator, drive = actuator_table(kind, part, duration_s, draws)
    delayed = draws.chance(0.4)
    controller, reference = controller_table(kind, part, drive, period_s, duration_s, draws)
    tables = {
        "name": f"case_{seed}_{number}",
        "seed": number,
        "joint": joint_table(kind, part, draws),
        "part": {"mass_kg": part.mass_kg},
        "reference": reference,
        "disturbance": _disturbance(part, period_s, draws),
        "actuator": actuator,
        "controller": controller,
        "timing": {
            "duration_s": duration_s,
            "control_period_s": period_s,
            "one_sample_delay": delayed,
        },
        "limits": _limits(part, duration_s),
        "trace": {"every_samples": 0},
    }
    return Case(seed, number, kind, Scenario.model_validate(tables))


def _duration_s(kind: Kind, part: Part, period_s: float, draws: Draws) -> float:
    periods = 2000 if "timed" in kind.controller else SHORTEST_PERIODS
    slow_s = 0.0 if part.rigid else 3 * pi * sqrt(part.mass_kg / part.stiffness_n_per_m)
    shortest_s = max(periods * period_s, slow_s)
    longest_s = min(LONGEST_S, STEPS * min(period_s, part.fastest_s))
    wanted_s = draws.log_uniform(shortest_s, longest_s)
    return max(periods, round(wanted_s / period_s)) * period_s


def _disturbance(part: Part, period_s: float, draws: Draws) -> dict[str, Any]:
    """A third of the parts have friction that varies, most of it along the way."""
    chosen = draws.uniform(0.0, 1.0)
    if chosen < 0.25:
        return {
            "kind": "field",
            "law": draws.one_of(("bounded", "log_normal")),
            "var": draws.uniform(0.02, 0.4),
            "correlation_length_m": max(1e-6, part.guide_m * draws.log_uniform(0.01, 0.3)),
        }
    if chosen < 0.35:
        return {
            "var": draws.uniform(0.02, 0.2),
            "hold_s": period_s * draws.log_uniform(1.0, 100.0),
            "acts_on": draws.one_of(("joint_force", "friction_level")),
        }
    return {"var": 0.0, "hold_s": period_s}


def _limits(part: Part, duration_s: float) -> dict[str, Any]:
    """Nothing ends a case but its release: what ends one of two runs says little of its steps."""
    return {
        "diverged_error_m": 1e3,
        "diverged_force_n": 1e12,
        "release_tolerance_m": min(1e-6, 1e-3 * part.guide_m),
        "after_release_s": 0.05 * duration_s,
    }
