"""What decides in a case, and where its part should be."""

from __future__ import annotations

from math import sqrt
from typing import Any

from tests.accuracy.draws import Draws
from tests.accuracy.drives import Drive
from tests.accuracy.kinds import Kind
from tests.accuracy.part import Part

from breakaway.model.scenario.controller import TimedImpacts

IMPACTS_S, IMPACTS_M = 5.0, 0.06
"""Time and travel that the usual numbers of timed impacts are made for."""


def controller_table(
    kind: Kind, part: Part, drive: Drive, period_s: float, duration_s: float, draws: Draws
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Controller and reference as a scenario has them."""
    reference = _reference(part, duration_s, draws)
    if kind.feeds:
        return _feed(kind, part, drive, period_s, duration_s, draws), reference
    makers = {
        "pid": lambda: _pid(kind, part, period_s, duration_s, draws),
        "fm_vibration": lambda: _fm(kind, part, period_s, duration_s, draws),
        "force_ramp": lambda: _ramp(part, duration_s, draws),
        "timed_impacts": lambda: _impacts(part, period_s, duration_s),
    }
    if kind.controller != "two_step":
        return makers[kind.controller](), reference
    table = {
        "kind": "two_step",
        "breakaway": makers[draws.one_of(("pid", "force_ramp"))](),
        "vibration": makers[draws.one_of(("fm_vibration", "timed_impacts"))](),
        "breakaway_travel_m": max(1.5 * part.presliding_m, 1e-3 * part.guide_m),
    }
    return table, reference


def _reference(part: Part, duration_s: float, draws: Draws) -> dict[str, Any]:
    distance_m = part.guide_m * draws.uniform(1.0, 1.3)
    kind = draws.one_of(("step", "ramp", "minimum_jerk", "trapezoidal_velocity"))
    table: dict[str, Any] = {"kind": kind, "distance_m": distance_m}
    moving_s = duration_s * draws.uniform(0.4, 0.9)
    if kind in ("ramp", "minimum_jerk"):
        table["duration_s"] = moving_s
    if kind == "trapezoidal_velocity":
        speed = 1.4 * distance_m / moving_s
        table["velocity_m_per_s"] = speed
        table["acceleration_m_per_s2"] = speed * speed / distance_m * draws.uniform(1.5, 4.0)
    return table


def _ramp(part: Part, duration_s: float, draws: Draws) -> dict[str, Any]:
    rate = part.stiction_n / (duration_s * draws.uniform(0.2, 0.6))
    return {"kind": "force_ramp", "rate_n_per_s": rate, "travel_m": part.guide_m}


def _pid(
    kind: Kind, part: Part, period_s: float, duration_s: float, draws: Draws
) -> dict[str, Any]:
    """Gains that a free mass is stable with, and that reach stiction before the guide's end."""
    fastest = 0.15 / period_s
    if not part.rigid:
        own = sqrt(part.stiffness_n_per_m / part.mass_kg)
        fastest = min(fastest, max(part.damping_ratio * own, 20.0 / duration_s))
    needed = sqrt(3.0 * part.stiction_n / (part.mass_kg * part.guide_m))
    omega = max(draws.log_uniform(20.0 / duration_s, fastest), min(needed, fastest))
    kp, m = part.mass_kg * omega * omega, part.mass_kg
    ki = max(kp * omega * draws.uniform(0.05, 0.3), 4 * part.stiction_n / part.guide_m / duration_s)
    table: dict[str, Any] = {
        "kind": "pid",
        "gains": {
            "kind": "given",
            "kp_n_per_m": kp,
            "ki_n_per_m_s": ki,
            "kd_n_s_per_m": 2.0 * draws.uniform(0.7, 1.5) * m * omega,
        },
        "derivative_of": draws.one_of(("error", "measurement")),
        "velocity_from": draws.one_of(("sensor", "position_difference")),
    }
    if draws.chance(0.5):
        table["derivative_filter_s"] = draws.uniform(0.1, 0.4) / omega
    if kind.actuator != "ideal":
        table["anti_windup"] = draws.one_of(("off", "conditional", "back_calculation"))
        table["tracking_time_s"] = 10 * period_s
    return table


def _fm(kind: Kind, part: Part, period_s: float, duration_s: float, draws: Draws) -> dict[str, Any]:
    pid = _pid(kind, part, period_s, duration_s, draws)
    del pid["kind"]
    highest_hz = draws.log_uniform(min(5.0 / duration_s, 0.1 / period_s), 0.1 / period_s)
    highest_hz = min(highest_hz, 40.0 / duration_s)
    return {
        "kind": "fm_vibration",
        "pid": pid,
        "vibration": {
            "frequency_min_hz": highest_hz * draws.uniform(0.4, 1.0),
            "frequency_max_hz": highest_hz,
            "error_full_scale_m": part.guide_m * draws.log_uniform(0.01, 1.0),
            "pulse_width_s": draws.uniform(0.25, 0.95) / highest_hz,
            "base_fraction": draws.uniform(0.0, 0.8),
            "shape": draws.one_of(("rectangular", "half_sine", "raised_cosine")),
        },
    }


def _impacts(part: Part, period_s: float, duration_s: float) -> dict[str, Any]:
    """The usual numbers, scaled to the case's time and travel."""
    slower, longer = duration_s / IMPACTS_S, part.guide_m / IMPACTS_M
    table: dict[str, Any] = {"kind": "timed_impacts", "travel_m": part.guide_m}
    table["target_s"] = 0.9 * duration_s
    table["force_start_n"] = 0.4 * part.stiction_n
    for name, field in TimedImpacts.model_fields.items():
        if name in table or field.is_required():
            continue
        if name.endswith("_m_per_s"):
            table[name] = field.default * longer / slower
        elif name.endswith("_per_s"):
            table[name] = field.default / slower
        elif name.endswith("_s"):
            table[name] = max(field.default * slower, period_s)
        elif name.endswith("_m"):
            table[name] = field.default * longer
    return table


def _feed(
    kind: Kind, part: Part, drive: Drive, period_s: float, duration_s: float, draws: Draws
) -> dict[str, Any]:
    """Through the gap in a tenth of the time, up to stiction in a third of it, then on."""
    winding_m = part.stiction_n / drive.stiffness_n_per_m + part.presliding_m
    speed = max(2.0 * part.guide_m, 3.0 * winding_m) / duration_s
    approach_s = duration_s * draws.uniform(0.02, 0.2)
    feed = {
        "speed_m_per_s": speed,
        "approach_m_per_s": max(1.2 * drive.gap_m / approach_s, speed * draws.uniform(0.05, 0.5)),
        "approach_s": approach_s,
    }
    if kind.controller == "steady_feed":
        return {"kind": "steady_feed", **feed}
    lowest_hz = min(5.0 / duration_s, 0.1 / period_s)
    frequency_hz = draws.log_uniform(lowest_hz, min(0.1 / period_s, 40.0 / duration_s))
    pulses = {
        "frequency_hz": frequency_hz,
        "pulse_width_s": draws.uniform(0.25, 1.0) / frequency_hz,
        "amplitude_ratio": draws.uniform(0.1, 0.8),
        "stack_force_n": drive.stack_force_n,
        "force_filter_s": max(period_s, 0.02 * duration_s),
    }
    return {"kind": "vibrated_feed", "feed": feed, "pulses": pulses}
