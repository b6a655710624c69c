"""The simulations behind the reproduction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from breakaway.ask.reproduction.readings import READINGS, try_readings, with_m2
from breakaway.ask.reproduction.survey import (
    CONTROLS,
    QUICK_SEEDS,
    DisturbanceRange,
    disturbance_range,
)
from breakaway.model.scenario.controller import Gains, Pid, PolePlacement
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.reference import StepReference
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.finished import Run
from breakaway.run.resolution import resolve
from breakaway.run.simulation import simulate

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Runs:
    """Everything that was simulated."""

    undisturbed: Mapping[str, Run]
    """var = 0, by control."""
    disturbed: Mapping[str, Run]
    """var = 5 %, as in figures 7 to 9, by control."""
    oracle: Run
    """Without vibration, by Runge-Kutta at 0.1 us."""
    damped: Run
    """Without vibration, with kd = 2500 N s/m."""
    as_printed: Run
    """Tables I and II as printed, without vibration."""
    plain_vibration_gains: Run
    """Table II's gains with vibration as a plain PID on an ideal actuator."""
    plain_vibration_gains_times_m2: Run
    """The same gains multiplied by m2, as in equation (13)."""
    half_push: Mapping[str, Run]
    """A constant push of half of F_s0 at var = 30 %, by what the disturbance acts on."""
    ranges: Mapping[str, DisturbanceRange]
    """IAE against var, by control."""
    readings: Mapping[str, Mapping[str, DisturbanceRange]]
    """The same at a few levels, by reading of what m2 multiplies and control."""


def simulate_all(progress: Progress, ranges: Mapping[str, DisturbanceRange] | None = None) -> Runs:
    """Run every simulation that the reproduction needs, telling what is under way.

    IAE against var may be given, from a survey of many runs; left out, it is that of few.
    """
    scenarios = {control: load_scenario(preset) for control, preset in CONTROLS.items()}
    base = scenarios["without_vibration"]
    progress("one run of each controller, undisturbed and at var = 5 %")
    undisturbed = {control: simulate(s) for control, s in scenarios.items()}
    disturbed = {
        control: simulate(s.with_({"disturbance.var": 0.05})) for control, s in scenarios.items()
    }
    progress("the oracle: Runge-Kutta at 0.1 us")
    oracle = simulate(base.with_({"timing.integrator": "rk4", "timing.steps_per_period": 100}))
    progress("variations")
    vibration_gains = PolePlacement(settling_time_s=5.2e-4, damping_ratio=1.2, pole_per_s=200.0)
    plain = base.with_(controller=Pid(gains=vibration_gains))
    progress("readings of what m₂ multiplies")
    readings = try_readings()
    if ranges is None:
        progress(f"IAE against var: {QUICK_SEEDS} runs at each level")
        ranges = {control: disturbance_range(s) for control, s in scenarios.items()}
    return Runs(
        undisturbed=undisturbed,
        disturbed=disturbed,
        oracle=oracle,
        damped=simulate(with_derivative_gain(base, 2500.0)),
        as_printed=simulate(load_scenario("paper_as_printed")),
        plain_vibration_gains=simulate(plain),
        plain_vibration_gains_times_m2=simulate(with_m2(plain, READINGS["m2_whole_loop"])),
        half_push=constant_push(base),
        ranges=ranges,
        readings=readings,
    )


def with_derivative_gain(scenario: Scenario, kd_n_s_per_m: float) -> Scenario:
    """Give the scenario with the kd of its designed gains replaced."""
    return resolve(scenario).with_({"controller.gains.kd_n_s_per_m": kd_n_s_per_m})


def constant_push(scenario: Scenario) -> dict[str, Run]:
    """Push with half of F_s0 for 4 s at var = 30 %, with the disturbance on R and on g.

    A proportional gain on a reference far away makes the force constant to 0.01 %.
    """
    far_m = 1000.0
    push_n = 0.5 * scenario.joint.stiction_n
    gains = Gains(kp_n_per_m=push_n / far_m, ki_n_per_m_s=0.0, kd_n_s_per_m=0.0)
    pushed = scenario.with_(
        {"timing.duration_s": 4.0, "disturbance.var": 0.3, "trace.every_samples": 100},
        reference=StepReference(distance_m=far_m),
        controller=Pid(gains=gains),
        limits={"diverged_error_m": 2 * far_m},
    )
    return {
        target: simulate(pushed.with_({"disturbance.acts_on": target}))
        for target in ("joint_force", "friction_level")
    }
