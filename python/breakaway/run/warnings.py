"""What has to be known of a run before its figures are trusted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from breakaway.model.friction.passivity import passive_attraction_n_per_s, passive_speed
from breakaway.model.scenario.controller import Gains, ReferenceController, gain_sets
from breakaway.model.scenario.joint import AnyJoint, Gms
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.scenario.steps import steps_per_period

if TYPE_CHECKING:
    from breakaway.run.finished import Outcome, RunMetrics

Trace = Mapping[str, NDArray[np.float64]]

STICTION_RATIO_MAX = 10.0
"""Largest ratio of stiction to Coulomb friction that is not doubted."""

REDRAWN_IN_TIME = (
    "disturbance: a factor that is redrawn by the clock breaks up what counts as one jump (one "
    "part, var 0.3, every 1 ms: 0.667 mm became 0.068 mm) and lets waiting find the lowest of many "
    "draws (friction of 450 N let go at 315.3 N within 4 s); friction varies along the way: "
    "disturbance.kind = 'field'"
)
"""What to know of the paper's random factor; examples/11_redrawn_in_time prints its figures."""


def warnings_of(
    scenario: Scenario, outcome: Outcome, metrics: RunMetrics, trace: Trace
) -> Iterator[str]:
    """Say what is doubtful about a run of a resolved scenario, one sentence each."""
    if outcome == "diverged":
        yield from _diverged(scenario, metrics)
    yield from _steps_are_coarse(scenario)
    yield from _lost_of_the_log(scenario)
    yield from _levels_do_not_fit(scenario.joint)
    yield from _friction_rises(scenario.joint)
    yield from _reference_does_not_fit(scenario)
    yield from _stuck_but_loose(scenario)
    yield from _negative_gains(scenario)
    yield from _bristles_push(scenario, trace)
    yield from _redrawn_in_time(scenario)
    let_go_early = metrics.time_to_breakaway_s > 0 and metrics.peak_over_breakaway < 1
    if scenario.joint.law == "lugre" and let_go_early:
        yield (
            f"the joint let go at {metrics.peak_over_breakaway:.2f} of stiction_n: LuGre friction "
            "creeps under a rising force; compare with law = 'two_region' before sizing an actuator"
        )


def _diverged(scenario: Scenario, metrics: RunMetrics) -> Iterator[str]:
    at = f"diverged at {metrics.simulated_s:.5g} s"
    error_mm, force_n = 1e3 * metrics.largest_error_m, metrics.peak_force_n
    bounds = scenario.limits
    most_mm, most_n = 1e3 * (bounds.diverged_error_m or 0.0), bounds.diverged_force_n or 0.0
    if not error_mm <= most_mm:
        bound = f"limits.diverged_error_m = {most_mm:.5g} mm"
        yield f"{at}: largest error {error_mm:.5g} mm is above {bound}"
    if not force_n <= most_n:
        bound = f"limits.diverged_force_n = {most_n:.5g} N"
        yield f"{at}: peak force {force_n:.5g} N is above {bound}"


def _lost_of_the_log(scenario: Scenario) -> Iterator[str]:
    source = scenario.joint_source
    if source is not None and source.dropped:
        yield f"joint_source: of the joint of {source.log} the run leaves out {source.dropped}"
    if source is not None and source.at_least:
        yield f"joint_source: {source.log} bounds from below, and the run takes: {source.at_least}"


def _levels_do_not_fit(joint: AnyJoint) -> Iterator[str]:
    hold_n, slide_n = joint.stiction_n, joint.coulomb_n
    levels = f"joint.stiction_n = {hold_n:.5g} N is {{}} joint.coulomb_n = {slide_n:.5g} N"
    if hold_n < slide_n:
        yield f"{levels.format('below')}: the joint slides at more than breaks it loose; give more"
    elif hold_n > STICTION_RATIO_MAX * slide_n:
        yield (
            f"{levels.format('more than ten times')}: joints have 1 to 4 times; give both of the "
            "same joint"
        )


def _friction_rises(joint: AnyJoint) -> Iterator[str]:
    left_n = joint.residual_n
    if left_n is not None and left_n > joint.coulomb_n:
        yield (
            f"joint.residual_n = {left_n:.5g} N is above joint.coulomb_n = {joint.coulomb_n:.5g} "
            "N: friction rises along the guide; left out it is the weight, give at most coulomb_n"
        )


def _reference_does_not_fit(scenario: Scenario) -> Iterator[str]:
    reference, length_m = scenario.reference, scenario.joint.engagement_length_m
    if not isinstance(scenario.controller, ReferenceController):
        return
    if reference.distance_m > 2 * length_m:
        yield (
            f"reference.distance_m = {reference.distance_m:.5g} m is more than twice "
            f"joint.engagement_length_m = {length_m:.5g} m, where the part is free, so it is "
            f"pulled faster than over its guide alone; give about {length_m:.5g}"
        )
    if reference.start_s >= scenario.timing.duration_s:
        yield (
            f"reference.start_s = {reference.start_s:.5g} s is not before the end of the run at "
            f"timing.duration_s = {scenario.timing.duration_s:.5g} s: nothing is pulled"
        )


def _steps_are_coarse(scenario: Scenario) -> Iterator[str]:
    """Compare with what "auto" would take."""
    steps, wanted = scenario.steps_per_period, int(steps_per_period(scenario))
    if steps < wanted:
        yield (
            f"timing.steps_per_period = {steps} is coarse: part and rig ask for {wanted}, and with "
            "fewer metrics may be more than 1 % off; give 'auto', or see `breakaway run "
            "--check-accuracy`"
        )


def _stuck_but_loose(scenario: Scenario) -> Iterator[str]:
    presliding_m = scenario.joint.stiction_n / scenario.joint.stiffness_n_per_m
    travel_m = scenario.limits.breakaway_travel_m
    if travel_m is not None and travel_m <= presliding_m:
        yield (
            f"limits.breakaway_travel_m = {1e6 * travel_m:.5g} µm is within the presliding travel "
            f"{1e6 * presliding_m:.5g} µm: a stuck joint counts as loose"
        )


def _negative_gains(scenario: Scenario) -> Iterator[str]:
    for which, gains in gain_sets(scenario.controller).items():
        if isinstance(gains, Gains) and min(gains.kp_n_per_m, gains.kd_n_s_per_m) < 0.0:
            yield (
                f"controller.{which}: a gain is negative: kp = {gains.kp_n_per_m:.4g} N/m, kd = "
                f"{gains.kd_n_s_per_m:.4g} N s/m; see `breakaway design`"
            )


def _bristles_push(scenario: Scenario, trace: Trace) -> Iterator[str]:
    """Say where constant damping lets friction give back more than it takes.

    The speed is the part's own, which the trace has and no metric; that of a reference says little
    of a part that jumps. A run without a trace is not judged by it.
    """
    joint = scenario.joint
    safe = passive_speed(joint)
    if safe is not None and trace and (speed := _fastest_within(scenario, trace)) > safe:
        yield (
            f"the part moved at {speed:.3g} m/s, above 4 g / c = {safe:.3g} m/s at the seat: there "
            "bristles of constant damping may push it; give joint.damping_velocity_m_per_s"
        )
    slow = passive_attraction_n_per_s(joint)
    if isinstance(joint, Gms) and slow is not None and joint.attraction_n_per_s > slow:
        yield (
            f"joint.attraction_n_per_s = {joint.attraction_n_per_s:.4g} is above k_e g / c = "
            f"{slow:.4g} N/s at the seat: slipping elements may push the part; give at most that"
        )


def _fastest_within(scenario: Scenario, trace: Trace) -> float:
    """Give the largest speed of the part while the joint holds it, in m/s."""
    held = trace["position_m"] < scenario.joint.engagement_length_m
    speed = np.abs(trace["velocity_m_per_s"])
    return float(np.max(speed, initial=0.0, where=held & np.isfinite(speed)))


def _redrawn_in_time(scenario: Scenario) -> Iterator[str]:
    """Warn of the paper's random factor, but for the paper's own scenarios, which are named for it.

    A factor that is held for the whole run is one of the part.
    """
    disturbance = scenario.disturbance
    if disturbance.kind == "field" or scenario.name.startswith("paper_"):
        return
    if disturbance.var > 0.0 and disturbance.hold_s < scenario.timing.duration_s:
        yield REDRAWN_IN_TIME
