"""An independent solver for the kinds of cases that it knows, in C."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

from tests.accuracy.figures import Figures

import breakaway as bk

SOURCE = Path(__file__).with_name("solver.c")
LAWS = ("lugre", "elasto_plastic", "gms", "two_region", "coulomb_stiction")
DRIVES = ("ideal", "push_only", "force", "feed_axis")
CONTROLLERS = ("force_ramp", "pid", "steady_feed")
REFERENCES = ("step", "ramp", "minimum_jerk", "trapezoidal_velocity")
LONGEST_S = 60.0
"""What a solution may take, in s."""


def build(folder: Path) -> Path | None:
    """Compile the solver; none without a compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    program = folder / "solver"
    options = ("-O2", "-std=gnu11", "-Wall", "-Wextra", "-Werror")
    subprocess.run([compiler, *options, "-o", str(program), str(SOURCE), "-lm"], check=True)
    return program


def is_known(scenario: bk.Scenario) -> bool:
    """Whether the solver has the equations of a scenario."""
    actuator, controller = scenario.actuator, scenario.controller
    rigid = actuator.kind != "feed_axis" or actuator.tip.kind == "rigid"
    wound = controller.kind != "pid" or controller.anti_windup == "off"
    return (
        scenario.joint.law in LAWS
        and actuator.kind in DRIVES
        and controller.kind in CONTROLLERS
        and rigid
        and wound
        and scenario.disturbance.var == 0.0
    )


def solve(program: Path, scenario: bk.Scenario) -> Figures | None:
    """Figures of the solution, as far as the solver knows them; none if it takes too long."""
    numbers = _numbers(bk.resolve(scenario))
    text = "".join(f"{name} {float(value)!r}\n" for name, value in numbers.items())
    try:
        done = subprocess.run(
            [str(program)], input=text, capture_output=True, text=True, timeout=LONGEST_S
        )
    except subprocess.TimeoutExpired:
        return None
    if done.returncode:
        return None
    pairs = (line.split() for line in done.stdout.splitlines())
    return {name: float(value) for name, value in pairs}


def _numbers(scenario: bk.Scenario) -> dict[str, Any]:
    """Numbers of a resolved scenario under the solver's names."""
    timing, limits, joint = scenario.timing, scenario.limits, scenario.joint
    return {
        "law": LAWS.index(joint.law),
        "stiction": joint.stiction_n,
        "coulomb": joint.coulomb_n,
        "residual": joint.residual_n,
        "guide": joint.engagement_length_m,
        "backward": joint.backward_ratio or 1.0,
        "stiffness": joint.stiffness_n_per_m if joint.law != "coulomb_stiction" else 0.0,
        "damping": joint.damping_n_s_per_m,
        "viscous": getattr(joint, "viscous_n_s_per_m", 0.0),
        "stribeck": getattr(joint, "stribeck_velocity_m_per_s", 1.0),
        "damping_velocity": getattr(joint, "damping_velocity_m_per_s", None) or 0.0,
        "elastic_share": getattr(joint, "elastic_share", 0.0),
        "elements": getattr(joint, "elements", 1),
        "attraction": getattr(joint, "attraction_n_per_s", 0.0),
        "mass": scenario.part.mass_kg,
        "duration": scenario.samples * timing.control_period_s,
        "period": timing.control_period_s,
        "delayed": timing.one_sample_delay,
        "release": joint.engagement_length_m - limits.release_tolerance_m,
        "after_release": limits.after_release_s or 1e300,
        "loose": limits.breakaway_travel_m,
        "contact_force": limits.contact_force_n,
        **_drive(scenario.actuator),
        **_controller(scenario.controller),
        **_reference(scenario.reference),
    }


def _drive(actuator: Any) -> dict[str, Any]:
    numbers = {"drive": DRIVES.index(actuator.kind)}
    if actuator.kind in ("push_only", "force"):
        numbers["force_max"] = actuator.force_max_n
    if actuator.kind == "force":
        numbers["bandwidth"] = actuator.bandwidth_hz
        numbers["force_rate"] = actuator.force_rate_max_n_per_s
    if actuator.kind == "feed_axis":
        contact = actuator.contact
        numbers |= {
            "axis_stiffness": actuator.stiffness_n_per_m,
            "axis_damping": actuator.damping_n_s_per_m,
            "tool_mass": actuator.tool_mass_kg,
            "speed_max": actuator.speed_max_m_per_s,
            "acceleration": actuator.acceleration_max_m_per_s2,
            "contact_stiffness": contact.stiffness_n_per_m,
            "contact_damping": contact.damping_n_s_per_m,
            "gap": contact.gap_m,
            "backlash": contact.backlash_m or 0.0,
            "grips": contact.backlash_m is not None,
        }
    return numbers


def _controller(controller: Any) -> dict[str, Any]:
    numbers = {"controller": CONTROLLERS.index(controller.kind)}
    if controller.kind == "force_ramp":
        return numbers | {"ramp_rate": controller.rate_n_per_s, "ramp_travel": controller.travel_m}
    if controller.kind == "steady_feed":
        return numbers | {
            "feed_speed": controller.speed_m_per_s,
            "approach_speed": controller.approach_m_per_s,
            "approach_time": controller.approach_s,
        }
    gains = controller.gains
    return numbers | {
        "kp": gains.kp_n_per_m,
        "ki": gains.ki_n_per_m_s,
        "kd": gains.kd_n_s_per_m,
        "of_error": controller.derivative_of == "error",
        "from_sensor": controller.velocity_from == "sensor",
        "filter": controller.derivative_filter_s,
    }


def _reference(reference: Any) -> dict[str, Any]:
    return {
        "reference": REFERENCES.index(reference.kind),
        "distance": reference.distance_m,
        "start": reference.start_s,
        "motion": getattr(reference, "duration_s", 1.0),
        "cruise": getattr(reference, "velocity_m_per_s", 1.0),
        "reference_acceleration": getattr(reference, "acceleration_m_per_s2", 1.0),
    }
