"""Make every number of a scenario explicit, and hand it to the core."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.design.pole_placement import pole_placement, with_residual
from breakaway.errors import ScenarioError
from breakaway.model.scenario.actuator import ForceActuator
from breakaway.model.scenario.controller import (
    AnyController,
    FmVibration,
    Gains,
    PidSettings,
    PolePlacement,
    TwoStep,
)
from breakaway.model.scenario.core_joint import leave_out_zero, nested_joint
from breakaway.model.scenario.joint import AnyJoint
from breakaway.model.scenario.model import Model
from breakaway.model.scenario.scenario import Scenario

AnyPart = TypeVar("AnyPart", bound=Model)


def resolve(scenario: Scenario) -> Scenario:
    """Replace what a scenario leaves open with numbers: gains, residual force, limits, steps.

    The result runs bit-identically to the scenario and depends on nothing else. Designed gains stay
    as they are when its joint is changed: the controller does not know its part.

    Parameters
    ----------
    scenario : Scenario
        What is resolved; it does not change.

    Raises
    ------
    ScenarioError
        It is not a scenario, or the controller cannot be designed for this joint.

    Examples
    --------
    >>> import breakaway as bk
    >>> bk.resolve(bk.load_scenario("paper_as_computed")).controller.gains.kind
    'given'

    """
    check_arguments(resolve, locals(), ScenarioError)
    joint, limits = scenario.joint, scenario.limits
    explicit_limits = limits.model_copy(
        update={
            "diverged_error_m": joint.engagement_length_m / 2
            if limits.diverged_error_m is None
            else limits.diverged_error_m,
            "diverged_force_n": 20 * joint.stiction_n
            if limits.diverged_force_n is None
            else limits.diverged_force_n,
            "breakaway_travel_m": _breakaway_travel_m(joint)
            if limits.breakaway_travel_m is None
            else limits.breakaway_travel_m,
            "contact_force_n": _contact_force_n(scenario)
            if limits.contact_force_n is None
            else limits.contact_force_n,
        }
    )
    return at_steps(scenario, scenario.steps_per_period).model_copy(
        update={
            "joint": _with_nominal(with_residual(joint, scenario.part.mass_kg)),
            "limits": explicit_limits,
            "controller": with_gains(scenario),
        }
    )


def at_steps(scenario: Scenario, steps: int) -> Scenario:
    """Give the scenario with so many integration steps in a control period, unchecked."""
    timing = scenario.timing.model_copy(update={"steps_per_period": steps})
    return scenario.model_copy(update={"timing": timing})


def _contact_force_n(scenario: Scenario) -> float:
    """What is behind a lag fades, and is never quite zero."""
    actuator = scenario.actuator
    return 1e-3 * actuator.force_max_n if isinstance(actuator, ForceActuator) else 0.0


def _breakaway_travel_m(joint: AnyJoint) -> float:
    """Twice what bristles can stretch; a rigid joint is loose once it has moved at all."""
    stretch_m = 2 * joint.stiction_n / joint.stiffness_n_per_m
    return stretch_m if np.any(stretch_m) else 1e-6 * joint.engagement_length_m


def with_gains(scenario: Scenario) -> AnyController:
    """Give the controller with its gains as numbers, if it has any."""
    return _with_gains(scenario.controller, scenario)


def _with_gains(part: AnyPart, scenario: Scenario) -> AnyPart:
    """Give a controller, or a part of one, with its gains as numbers."""
    update: dict[str, object] = {}
    if isinstance(part, PidSettings):
        update["gains"] = given_gains(part.gains, scenario)
    elif isinstance(part, FmVibration):
        update["pid"] = _with_gains(part.pid, scenario)
    elif isinstance(part, TwoStep):
        update["breakaway"] = _with_gains(part.breakaway, scenario)
        update["vibration"] = _with_gains(part.vibration, scenario)
    return part.model_copy(update=update) if update else part


def given_gains(gains: Gains | PolePlacement, scenario: Scenario) -> Gains:
    """Give the gains as numbers, designed for the scenario's own joint where they are designed."""
    if isinstance(gains, Gains):
        return gains
    total = pole_placement(
        scenario.joint,
        mass_kg=scenario.part.mass_kg,
        settling_time_s=gains.settling_time_s,
        damping_ratio=gains.damping_ratio,
        pole_per_s=gains.pole_per_s,
        static_share=gains.static_share,
    ).total
    return Gains(kp_n_per_m=total.kp, ki_n_per_m_s=total.ki, kd_n_s_per_m=total.kd)


def core_job(resolved: Scenario, run: int) -> dict[str, Any]:
    """Values of a resolved scenario under the names of the core."""
    values = resolved.model_dump(warnings=False)  # a batch puts columns where numbers are
    timing, limits = values["timing"], values["limits"]
    joint = nested_joint(resolved.joint, values["joint"])
    infinite = float("inf")
    controller = values["controller"]
    _name_as_the_core(values)
    for pid in _pid_tables(controller):
        del pid["gains"]["kind"]
        leave_out_zero(pid, "derivative_filter_s")
    field, random_factor = _field_and_random_factor(values["disturbance"], timing)
    del timing["duration_s"]
    release_position_m = resolved.joint.engagement_length_m - limits.pop("release_tolerance_m")
    return {
        "extraction": {
            "joint": joint,
            "part": values["part"],
            "reference": values["reference"],
            "variation": {
                "field": field,
                "drift": resolved.joint.drift and resolved.joint.drift.core(),
                "normal_force": _core_normal_force(resolved.joint),
            },
            "disturbance": random_factor,
            "actuator": values["actuator"],
            "sensors": values["sensors"],
            "watch": values["watch"],
            "controller": controller,
            "timing": timing,
        },
        "limits": {name: infinite if v is None else v for name, v in limits.items()}
        | {"release_position_m": release_position_m},
        "samples": resolved.samples,
        "seed": resolved.seed,
        "run": run,
        "trace_every": resolved.trace.every_samples,
    }


def _field_and_random_factor(
    disturbance: dict[str, Any], timing: dict[str, Any]
) -> tuple[dict[str, Any] | None, dict[str, Any]]:
    """Give both kinds of disturbance under the names of the core; a scenario has one of them.

    The core draws the keys of a field.
    """
    if disturbance.pop("kind") == "field":
        keys = {"first": 0.0, "second": 0.0, "offset": 0.0}
        still = {"law": {"kind": "uniform"}, "var": 0.0, "acts_on": "friction_level"}
        return disturbance | {"keys": keys}, still | {"hold_s": timing["control_period_s"]}
    law = {"kind": disturbance.pop("law")}
    if "bandwidth_hz" in disturbance:
        law["bandwidth_hz"] = disturbance.pop("bandwidth_hz")
    return None, {"law": law, **disturbance}


def _core_normal_force(joint: AnyJoint) -> dict[str, Any] | None:
    """Give the normal force of a resolved joint under the names of the core."""
    normal = joint.normal_force
    if normal is None:
        return None
    vibrations = {name: getattr(normal, name) for name in ("vibration", "transverse")}
    dumped = {name: v and v.model_dump(warnings=False) for name, v in vibrations.items()}
    return {"nominal_n": normal.nominal_n, **normal.core_source(), **dumped}


def _with_nominal(joint: AnyJoint) -> AnyJoint:
    """Say at which normal force the joint's levels hold: where it is not said, at the first."""
    normal = joint.normal_force
    if normal is None or normal.nominal_n is not None:
        return joint
    nominal_n = normal.start_n()
    if not np.all(nominal_n > 0.0):
        raise ScenarioError(
            "joint.normal_force.nominal_n: is left out, and the force at the start is "
            f"{nominal_n!r} N, at which no friction levels can hold; give the force "
            "at which they hold, in N"
        )
    stated = normal.model_copy(update={"nominal_n": nominal_n})
    return joint.model_copy(update={"normal_force": stated})


def _name_as_the_core(values: dict[str, Any]) -> None:
    """Sensors of the core have no units of their own; what is left out of a watch is infinite."""
    for sensor in (values["sensors"] or {}).values():
        for name in ("noise_rms", "quantum"):
            unit = next(suffix for suffix in ("_m", "_n") if f"{name}{suffix}" in sensor)
            sensor[name] = sensor.pop(f"{name}{unit}")
    watch = values["watch"]
    if watch and watch["frozen_max_s"] is None:
        watch["frozen_max_s"] = float("inf")


def _pid_tables(controller: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Every table of a controller that is a PID, however deep."""
    if "gains" in controller:
        yield controller
    for value in controller.values():
        if isinstance(value, dict):
            yield from _pid_tables(value)
