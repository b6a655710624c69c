"""Friction levels are mu N: with every source of the normal force, and with a drift."""

from math import inf

import numpy as np
import pytest
from tests.known_answers.laws import LAWS
from vibrated_contact import DAMPED, ELASTIC, FRICTION_N, GUIDE_M, NORMAL_N, RIGID, STIFF

import breakaway as bk

AT_N_0 = {"nominal_n": NORMAL_N}
"""The levels hold at N_0 and not at the force of the start."""


def pushed(joint, force_n, duration_s=0.1, rate_n_per_s=1e5):
    """A part under a force that rises and then stays; damped, so that it does not swing."""
    if joint.law != "coulomb_stiction":
        joint = joint.model_copy(update={"damping_n_s_per_m": 9000.0})
    return bk.Scenario(
        joint=joint,
        part=bk.Part(mass_kg=1.0),
        reference=bk.StepReference(distance_m=GUIDE_M),
        actuator=bk.PushOnlyActuator(force_max_n=force_n),
        controller=bk.ForceRamp(rate_n_per_s=rate_n_per_s, travel_m=GUIDE_M),
        timing=bk.Timing(duration_s=duration_s, control_period_s=2e-5),
        limits=bk.Limits(
            diverged_error_m=1.0,
            diverged_force_n=1e6,
            breakaway_travel_m=1e-3,
        ),
        trace=bk.Trace(every_samples=0),
    )


def loose_s(scenario):
    """When the part broke loose, or infinity."""
    time_s = bk.simulate(scenario).metrics.time_to_breakaway_s
    return time_s if time_s == time_s else inf


def fed(joint):
    """A part in the grip of a stiff feed: position, time and friction of its way."""
    run = bk.simulate(
        bk.Scenario(
            joint=joint,
            part=bk.Part(mass_kg=1.0),
            reference=bk.StepReference(distance_m=GUIDE_M),
            actuator=bk.FeedAxis(
                **STIFF,
                speed_max_m_per_s=1.0,
                acceleration_max_m_per_s2=1e6,
                tool_mass_kg=1.0,
                contact=bk.Contact(**STIFF, backlash_m=0.0),
            ),
            controller=bk.SteadyFeed(speed_m_per_s=0.1, approach_m_per_s=0.1, approach_s=0.0),
            timing=bk.Timing(duration_s=1.0, control_period_s=2e-5),
            limits=bk.Limits(diverged_error_m=1.0, diverged_force_n=1e6),
            trace=bk.Trace(every_samples=50),
        )
    )
    later = run.trace["t_s"] > 0.05
    return tuple(run.trace[name][later] for name in ("t_s", "position_m", "joint_force_n"))


def with_force(joint, force):
    return joint.model_copy(update={"normal_force": force})


@pytest.mark.parametrize("joint", LAWS, ids=lambda joint: joint.law)
@pytest.mark.parametrize("times", [0.5, 1.0, 2.0])
def test_breakaway_goes_with_the_normal_force(joint, times):
    """Within 1e-3; LuGre slides below its level for long, before it holds."""
    pressed = with_force(joint, bk.ConstantNormalForce(force_n=times * NORMAL_N, **AT_N_0))
    level_n = times * FRICTION_N
    rate = {"rate_n_per_s": 10 * level_n, "duration_s": 0.3}
    holds = 0.99 if joint.law == "lugre" else 0.999
    assert loose_s(pushed(pressed, holds * level_n, **rate)) == inf
    assert loose_s(pushed(pressed, 1.001 * level_n, **rate)) < 0.3


def test_levels_that_hold_at_the_start_are_those_of_the_joint():
    """Old files keep their meaning: a constant force by itself changes nothing."""
    plain = bk.simulate(pushed(DAMPED, 1.05 * FRICTION_N))
    pressed = with_force(DAMPED, bk.ConstantNormalForce(force_n=NORMAL_N))
    assert bk.simulate(pushed(pressed, 1.05 * FRICTION_N)).metrics == plain.metrics


@pytest.mark.parametrize("joint", LAWS, ids=lambda joint: joint.law)
@pytest.mark.parametrize("source", ["course", "temperature", "drift"])
def test_a_force_that_falls_lets_a_part_go_that_rests_under_a_push(joint, source):
    """Where mu N has fallen to the push, at 70 % of N_0; the first mm then takes 26 ms.

    The force that accelerates it is F_s t / s, so x = F_s t^3 / (6 m s).
    """
    fall = {"time_s": [0.5, 1.0]}
    if source == "drift":
        falling = joint.model_copy(update={"drift": bk.DriftOverTime(**fall, factor=[1.0, 0.5])})
    elif source == "course":
        force = bk.NormalForceOverTime(**fall, force_n=[NORMAL_N, 0.5 * NORMAL_N])
        falling = with_force(joint, force)
    else:
        force = bk.TemperatureNormalForce(
            **fall, preload_n=NORMAL_N, expansion_n_per_k=-NORMAL_N / 120, change_k=[0.0, 60.0]
        )
        falling = with_force(joint, force)
    at_s = loose_s(pushed(falling, 0.7 * FRICTION_N, duration_s=1.2))
    first_mm_s = (6e-3 / FRICTION_N) ** (1 / 3)
    assert at_s == pytest.approx(0.8 + first_mm_s, abs=5e-4)


def course_over_travel():
    force = bk.NormalForceOverTravel(travel_m=[0.0, 0.05, 0.2], force_n=[2000.0, 3000.0, 600.0])
    return force, lambda _t, x: np.interp(x, [0.0, 0.05, 0.2], [1.0, 1.5, 0.3])


def course_over_time():
    force = bk.NormalForceOverTime(time_s=[0.0, 0.5, 0.8], force_n=[2000.0, 3000.0, 1000.0])
    return force, lambda t, _x: np.interp(t, [0.0, 0.5, 0.8], [1.0, 1.5, 0.5])


def springs():
    force = bk.SpringNormalForce(preload_n=2000.0, stiffness_n_per_m=1e6, slope=0.01)
    return force, lambda _t, x: 1.0 - 1e4 * x / 2000.0


def interference():
    force = bk.InterferenceNormalForce(pressure_pa=3e6, area_m2=1e-3, **AT_N_0)
    return force, lambda _t, x: np.full_like(x, 1.5)


def temperature():
    force = bk.TemperatureNormalForce(
        preload_n=2000.0, expansion_n_per_k=-12.5, time_s=[0.0, 1.0], change_k=[0.0, 80.0]
    )
    return force, lambda t, _x: 1.0 - 0.5 * t


SOURCES = [course_over_travel, course_over_time, springs, interference, temperature]


@pytest.mark.parametrize("joint", [RIGID, ELASTIC], ids=lambda joint: joint.law)
@pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.__name__)
def test_sliding_friction_follows_the_normal_force(joint, source):
    force, share = source()
    t_s, position_m, friction_n = fed(with_force(joint, force))
    assert friction_n == pytest.approx(FRICTION_N * share(t_s, position_m), rel=1e-3)


def test_sliding_friction_drifts():
    drift = bk.DriftOverTravel(travel_m=[0.0, 0.1], factor=[1.0, 0.4])
    _, position_m, friction_n = fed(RIGID.model_copy(update={"drift": drift}))
    assert friction_n == pytest.approx(FRICTION_N * (1.0 - 6.0 * position_m), rel=1e-3)
