"""The metrics of a run as figures that are compared, and what is too small to tell apart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from math import inf, isfinite, pi

import breakaway as bk

COUNTS = ("impacts",)
"""Metrics that are whole numbers: they are compared by their difference."""
LEAST_LENGTH_M = 1e-5
"""Length below which an error is one of this length, in m; a thousandth of a short guide."""
LEAST_VELOCITY_M_PER_S = 1e-3
"""Velocity below which an error is one of this velocity, in m/s."""
LEAST_SHARE = 0.01
"""Share of the duration, and a tenth of it of the stiction, that stand for the least of others."""

Figures = Mapping[str, float]


def figures_of(run: bk.Run) -> Figures:
    """Every metric, and the outcome as a number."""
    outcomes = list(type(run.outcome))
    return {**asdict(run.metrics), "outcome": float(outcomes.index(run.outcome))}


def floors_of(scenario: bk.Scenario) -> Figures:
    """What stands in for a reference that is smaller, metric by metric; zero where nothing does."""
    force, time_s = 0.1 * scenario.joint.stiction_n, scenario.timing.duration_s
    length = min(LEAST_LENGTH_M, 1e-3 * scenario.joint.engagement_length_m)
    soon_s = LEAST_SHARE * time_s
    work = force * max(length, scenario.joint.stiction_n / scenario.joint.stiffness_n_per_m)
    return {
        "simulated_s": soon_s,
        "iae_m_s": length * time_s,
        "ise_m2_s": length * length * time_s,
        "itae_m_s2": length * time_s * time_s,
        "largest_error_m": length,
        "peak_force_n": force,
        "peak_over_breakaway": 0.1,
        "mean_force_n": force,
        "rms_force_n": force,
        "impulse_n_s": force * time_s,
        "work_j": work,
        "friction_loss_j": work,
        "contact_time_s": soon_s,
        "mean_impact_s": soon_s,
        "largest_step_m": length,
        "largest_impact_work_j": work,
        "largest_jump_m": length,
        "time_to_breakaway_s": soon_s,
        "time_to_release_s": soon_s,
        "release_velocity_m_per_s": LEAST_VELOCITY_M_PER_S,
        "saturation_time_s": soon_s,
        "supplied_work_j": work,
        "actuator_loss_j": work,
        "stack_tension_n": force,
        "final_position_m": length,
        "stack_cycles": 0.1,
        **_floors_of_stack(scenario),
    }


def _floors_of_stack(scenario: bk.Scenario) -> Figures:
    """A hundredth of the largest current, and the heat of it."""
    tip = getattr(scenario.actuator, "tip", None)
    if tip is None or tip.kind != "piezo":
        return {}
    current = 0.01 * tip.current_max_a
    heat = tip.loss_tangent / (2 * pi * 1e3 * tip.capacitance_f) * current * current
    return {"rms_current_a": current, "stack_loss_w": heat}


def errors_of(figures: Figures, reference: Figures, floors: Figures) -> dict[str, float]:
    """Error of every metric, relative to its reference; of a count, by how much it differs.

    The mean of impacts is over as many impacts as the reference has: their number is compared by
    itself.
    """
    errors = {}
    for name, exact in reference.items():
        value = figures[name]
        if name == "mean_impact_s" and reference["impacts"] > 0:
            value *= figures["impacts"] / reference["impacts"]
        if name in COUNTS:
            errors[name] = abs(value - exact)
        else:
            errors[name] = _relative(value, exact, floors.get(name, 0.0))
    return errors


def _relative(value: float, exact: float, floor: float) -> float:
    """Zero for the same, also where neither is a number; infinite where one of them is not."""
    if value == exact or (not isfinite(value) and not isfinite(exact)):
        return 0.0
    scale = max(abs(exact), floor)
    return abs(value - exact) / scale if isfinite(value - exact) and scale > 0 else inf


def worst_of(errors: Mapping[str, float]) -> float:
    """The largest error, a count that is off by one being none."""
    return max(max(0.0, e - 1.0) if name in COUNTS else e for name, e in errors.items())
