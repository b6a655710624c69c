"""The simulations behind the reproduction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.resolution import resolve
from breakaway.run import Outcome, Run
from breakaway.scenario.controller import Gains, Pid, PolePlacement
from breakaway.scenario.files import load_scenario
from breakaway.scenario.reference import StepReference
from breakaway.scenario.scenario import Scenario
from breakaway.simulation import simulate

Progress = Callable[[str], None]

CONTROLS = {
    "without_vibration": "paper_as_computed",
    "with_vibration": "paper_as_computed_vibration",
    "with_vibration_bounded": "paper_as_computed_vibration_bounded",
}
"""The two controllers of the paper, and the reading of the second that stays bounded."""

VAR_LEVELS = (0.0, 0.025, 0.05, 0.075, 0.085, 0.1, 0.125, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9)
SEEDS = 40


@dataclass(frozen=True)
class DisturbanceRange:
    """IAE against the disturbance's half width var, over many runs each."""

    var: NDArray[np.float64]
    """Levels of var."""
    iae_m_s: NDArray[np.float64]
    """IAE of each run, levels x runs; NaN for a run that diverged."""
    peak_force_n: NDArray[np.float64]
    """Peak force of each run, levels x runs."""
    largest_jump_m: NDArray[np.float64]
    """Largest jump of each run, levels x runs."""
    stable: NDArray[np.int64]
    """Number of runs that did not diverge, by level."""
    released: NDArray[np.int64]
    """Number of runs that released the part, by level."""
    runs: int
    """Runs at each level."""

    @property
    def largest_stable_var(self) -> float | None:
        """The largest level up to which no run at any level diverged; None if one did at 0."""
        failing = np.flatnonzero(self.stable < self.runs)
        first = int(failing[0]) if failing.size else len(self.var)
        return float(self.var[first - 1]) if first else None


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
    half_push: Mapping[str, Run]
    """A constant push of half of F_s0 at var = 30 %, by what the disturbance acts on."""
    ranges: Mapping[str, DisturbanceRange]
    """IAE against var, by control."""


def simulate_all(progress: Progress) -> Runs:
    """Run every simulation that the reproduction needs, telling what is under way."""
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
    ranges = {}
    for control in scenarios:
        progress(f"IAE against var, {control.replace('_', ' ')}: {SEEDS} runs at each level")
        ranges[control] = disturbance_range(scenarios[control])
    return Runs(
        undisturbed=undisturbed,
        disturbed=disturbed,
        oracle=oracle,
        damped=simulate(with_derivative_gain(base, 2500.0)),
        as_printed=simulate(load_scenario("paper_as_printed")),
        plain_vibration_gains=simulate(base.with_(controller=Pid(gains=vibration_gains))),
        half_push=constant_push(base),
        ranges=ranges,
    )


def disturbance_range(scenario: Scenario) -> DisturbanceRange:
    """Simulate every level of var with run numbers 0 to `SEEDS` - 1."""
    iae = np.full((len(VAR_LEVELS), SEEDS), np.nan)
    peak, jump = np.full_like(iae, np.nan), np.full_like(iae, np.nan)
    released = np.zeros(len(VAR_LEVELS), dtype=np.int64)
    for i, var in enumerate(VAR_LEVELS):
        level = scenario.with_({"disturbance.var": var, "trace.every_samples": 0})
        for k in range(SEEDS):
            run = simulate(level, run_index=k)
            released[i] += run.outcome is Outcome.RELEASED
            if run.outcome is not Outcome.DIVERGED:
                iae[i, k] = run.metrics.iae_m_s
                peak[i, k] = run.metrics.peak_force_n
                jump[i, k] = run.metrics.largest_jump_m
    stable = np.count_nonzero(np.isfinite(iae), axis=1)
    return DisturbanceRange(np.array(VAR_LEVELS), iae, peak, jump, stable, released, SEEDS)


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
