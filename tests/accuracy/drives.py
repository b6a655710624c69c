"""What pushes in a case."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

from tests.accuracy.draws import Draws
from tests.accuracy.kinds import Kind
from tests.accuracy.part import Part


@dataclass(frozen=True)
class Drive:
    """What a controller has to know of the actuator."""

    stiffness_n_per_m: float = float("inf")
    """Of axis, stack and contact in series, in N/m."""
    gap_m: float = 0.0
    stack_force_n: float = 0.0


def actuator_table(
    kind: Kind, part: Part, duration_s: float, draws: Draws
) -> tuple[dict[str, Any], Drive]:
    """The actuator as a scenario has it."""
    if kind.feeds:
        return _feed_axis(kind, part, duration_s, draws)
    table: dict[str, Any] = {"kind": kind.actuator}
    if kind.actuator != "ideal":
        table["force_max_n"] = part.stiction_n * draws.log_uniform(1.2, 5.0)
    if kind.actuator == "force":
        table["bandwidth_hz"] = draws.log_uniform(max(50.0, 5.0 / duration_s), 5e3)
        rise_s = duration_s * draws.log_uniform(1e-3, 0.3)
        table["force_rate_max_n_per_s"] = part.stiction_n / rise_s
    return table, Drive()


def _feed_axis(
    kind: Kind, part: Part, duration_s: float, draws: Draws
) -> tuple[dict[str, Any], Drive]:
    tool_kg, axis = draws.log_uniform(0.1, 50.0), draws.log_uniform(1e5, 1e8)
    tip, tip_kg, stack_yield, stack_n = _tip(kind, draws)
    face_kg = tip_kg or tool_kg
    contact = _contact(part, face_kg, draws)
    together = 1.0 / (1.0 / axis + 1.0 / contact["stiffness_n_per_m"] + stack_yield)
    speed = _speed(part, together, duration_s)
    contact["gap_m"] = speed * duration_s * draws.log_uniform(1e-4, 1e-2)
    if kind.actuator == "feed_grip":
        contact["backlash_m"] = contact["gap_m"] * draws.uniform(1.0, 2.0)
    table = {
        "kind": "feed_axis",
        "speed_max_m_per_s": speed * draws.uniform(0.9, 3.0),
        "acceleration_max_m_per_s2": speed / duration_s / draws.log_uniform(0.003, 0.1),
        "stiffness_n_per_m": axis,
        "damping_n_s_per_m": 2 * draws.log_uniform(0.02, 0.7) * sqrt(axis * tool_kg),
        "tool_mass_kg": tool_kg,
        "tip": tip,
        "contact": contact,
    }
    return table, Drive(together, contact["gap_m"], stack_n)


def _speed(part: Part, stiffness_n_per_m: float, duration_s: float) -> float:
    """What winds the axis up to stiction in a third of the time, and goes on to the guide's end."""
    winding_m = part.stiction_n / stiffness_n_per_m + part.presliding_m
    return max(2.0 * part.guide_m, 3.0 * winding_m) / duration_s


def _tip(kind: Kind, draws: Draws) -> tuple[dict[str, Any], float, float, float]:
    """The tip, its mass, how it yields in m/N, and its largest force; zero without a stack."""
    if kind.actuator != "feed_piezo":
        return {"kind": "rigid"}, 0.0, 0.0, 0.0
    stiffness, stroke_m = draws.log_uniform(2e7, 3e8), draws.log_uniform(2e-5, 1.2e-4)
    mass_kg = draws.log_uniform(3e-3, 0.3)
    table = {
        "kind": "piezo",
        "stroke_m": stroke_m,
        "stiffness_n_per_m": stiffness,
        "tip_mass_kg": mass_kg,
        "damping_n_s_per_m": 2 * draws.log_uniform(0.01, 0.2) * sqrt(stiffness * mass_kg),
        "hysteresis_share": draws.one_of((0.0, 0.15, 0.377)),
        "preload_n": 0.3 * stiffness * stroke_m,
        "capacitance_f": draws.log_uniform(1e-6, 2e-5),
        "loss_tangent": 0.02,
        "voltage_max_v": 150.0,
        "current_max_a": draws.log_uniform(1.0, 10.0),
        "amplifier_bandwidth_hz": draws.log_uniform(1e3, 1e4),
    }
    return table, mass_kg, 1.0 / stiffness, stiffness * stroke_m


def _contact(part: Part, face_kg: float, draws: Draws) -> dict[str, Any]:
    """A fifth of the contacts have no damping."""
    stiffness = draws.log_uniform(1e6, 1e9)
    ratio = 0.0 if draws.chance(0.2) else draws.log_uniform(0.01, 0.5)
    lighter_kg = min(face_kg, part.mass_kg)
    return {
        "stiffness_n_per_m": stiffness,
        "damping_n_s_per_m": 2 * ratio * sqrt(stiffness * lighter_kg),
    }
