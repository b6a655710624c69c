"""Describing functions in closed form; predicted limit cycles against runs."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.design import (
    PidGains,
    SampledPid,
    compare_limit_cycle,
    describing_function,
    limit_cycles,
    measured_cycles,
)
from breakaway.design.describing_function import harmonic, midpoints
from breakaway.model.friction.periodic import friction_over_period

BASE = bk.load_scenario("paper_as_computed")
JOINT = BASE.joint
TABLE_II = PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)


def given(gains):
    return {
        "kind": "pid",
        "gains": {
            "kind": "given",
            "kp_n_per_m": gains.kp,
            "ki_n_per_m_s": gains.ki,
            "kd_n_s_per_m": gains.kd,
        },
    }


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 30.0])
def test_describing_functions_in_closed_form(amplitude):
    a = amplitude
    mean, relay = describing_function(np.sign, a)
    assert relay.real == pytest.approx(4.0 / (np.pi * a), rel=1e-5)
    assert abs(relay.imag) < 1e-9 and abs(mean) < 1e-9
    mean, cubic = describing_function(lambda u: u**3, a, bias=0.7)
    assert cubic == pytest.approx(0.75 * a**2 + 3.0 * 0.7**2, rel=1e-12)
    assert mean == pytest.approx(0.7**3 + 1.5 * 0.7 * a**2, rel=1e-12)
    bias = 0.6 * a  # a biased relay: 4/(pi A) sqrt(1 - (b/A)^2), mean 2/pi asin(b/A)
    mean, biased = describing_function(np.sign, a, bias=bias)
    assert biased.real == pytest.approx(4.0 / (np.pi * a) * 0.8, rel=2e-3)
    assert mean == pytest.approx(2.0 / np.pi * np.arcsin(0.6), rel=2e-3)


def test_a_stiff_bristle_is_the_friction_curve():
    """As k_e grows, equation (2) leaves R = g(v) sgn v, reversal included."""
    stiff = JOINT.model_copy(update={"stiffness_n_per_m": 1e13, "damping_n_s_per_m": 0.0})
    v = 0.05 + 0.08 * np.cos(midpoints(1024))
    w, x = np.array(1800.0), np.array(0.0)
    force = friction_over_period(stiff, v, w, position_m=x)
    curve = (360.0 + 90.0 * np.exp(-((v / 0.09) ** 2))) * np.sign(v)
    assert abs(harmonic(force, 1) - harmonic(curve, 1)) < 0.01 * abs(harmonic(curve, 1))


def test_friction_over_a_period_is_what_the_core_computes():
    """The joint under an imposed oscillation that reverses, from the core itself."""
    w, n = 2.0 * np.pi * 280.0, 400
    period_s = 2.0 * np.pi / w / n
    t = np.arange(6 * n) * period_s
    velocity = 0.06 + 0.065 * np.cos(w * (t + period_s / 2.0))
    long = JOINT.model_copy(update={"engagement_length_m": 1e3, "residual_n": 1.0})
    imposed = bk.impose_motion(long, velocity_m_per_s=velocity, period_s=period_s, start_m=0.0)
    theirs = imposed.joint_force_n[-n:]
    ours = friction_over_period(long, velocity[-n:], np.array(w), position_m=np.array(0.0))
    assert np.max(np.abs(theirs - ours)) < 0.02 * np.max(np.abs(ours))
    assert abs(harmonic(theirs, 1) - harmonic(ours, 1)) < 0.01 * abs(harmonic(ours, 1))


@pytest.mark.parametrize(("speed", "one_hz"), [(0.06, 4.0), (0.09, 1.6), (0.12, 0.5)])
def test_a_steady_limit_cycle_is_the_simulated_one(speed, one_hz):
    """One harmonic within some percent of a run at constant speed; seven within 0.2 and 1 %."""
    scenario = BASE.with_(
        {
            "trace.every_samples": 4,
            "joint.engagement_length_m": 1e3,
            "joint.residual_n": 1.0,
            "timing.duration_s": 0.5,
        },
        reference={"kind": "ramp", "distance_m": speed, "duration_s": 1.0},
        controller=given(TABLE_II),
    )
    trace = bk.simulate(scenario).trace
    late = trace["t_s"] > 0.35
    velocity = trace["velocity_m_per_s"][late]
    cycles = measured_cycles(trace["t_s"][late], velocity, np.full(velocity.shape, speed))
    hz, amplitude = np.mean(cycles.frequency_hz), np.mean(cycles.amplitude_m_per_s)
    pid = SampledPid(TABLE_II, 1e-5)
    [one] = limit_cycles(pid, scenario.joint, 1.0, speed)
    [seven] = limit_cycles(pid, scenario.joint, 1.0, speed, harmonics=7)
    assert one.stable and one.frequency_hz == pytest.approx(hz, rel=0.01 * one_hz)
    assert one.amplitude_m_per_s == pytest.approx(amplitude, rel=0.03)
    assert seven.frequency_hz == pytest.approx(hz, rel=2e-3)
    assert seven.amplitude_m_per_s == pytest.approx(amplitude, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kd", "verdict"),
    [
        (724.2, "agree: oscillation"),
        (900.0, "agree: oscillation"),
        (1300.0, "agree: none"),
        (2500.0, "agree: none"),
    ],
)
def test_prediction_along_the_paper_s_motion_agrees_with_a_run(kd, verdict):
    gains = PidGains(TABLE_II.kp, TABLE_II.ki, kd)
    run = bk.simulate(BASE.with_({"trace.every_samples": 4}, controller=given(gains)))
    found = compare_limit_cycle(
        SampledPid(gains, 1e-5),
        JOINT,
        1.0,
        t_s=run.trace["t_s"],
        reference_m=run.trace["reference_m"],
        velocity_m_per_s=run.trace["velocity_m_per_s"],
    )
    assert found.verdict == verdict
    if verdict == "agree: none":
        assert np.isnan(found.predicted_hz) and np.isnan(found.simulated_hz)
        return
    assert abs(found.frequency_error_percent) < 2.0
    assert abs(found.amplitude_error_percent) < 6.0
    if kd == 724.2:
        assert found.simulated_hz == pytest.approx(282.4, abs=0.5)
        assert found.simulated_window_s == pytest.approx((0.0225, 0.1225), abs=2e-3)
        assert found.predicted_window_s == pytest.approx((0.027, 0.119), abs=4e-3)


def test_no_limit_cycle_where_damping_suffices():
    for speed in (0.01, 0.0636, 0.2):
        gains = PidGains(TABLE_II.kp, TABLE_II.ki, 2500.0)
        assert limit_cycles(SampledPid(gains, 1e-5), JOINT, 1.0, speed) == ()


def test_a_law_without_stribeck_curve_has_none():
    values = JOINT.model_dump(exclude={"law", "stribeck_velocity_m_per_s", "viscous_n_s_per_m"})
    flat = bk.TwoRegion(**{k: v for k, v in values.items() if k in bk.TwoRegion.model_fields})
    assert limit_cycles(SampledPid(TABLE_II, 1e-5), flat, 1.0, 0.06) == ()


def test_beyond_the_falling_friction_an_unstable_cycle_bounds_a_stable_one():
    """At 0.14 m/s sliding is stable, and yet a large oscillation keeps itself up."""
    inner, outer = limit_cycles(SampledPid(TABLE_II, 1e-5), JOINT, 1.0, 0.14)
    assert not inner.stable and outer.stable
    assert inner.amplitude_m_per_s < outer.amplitude_m_per_s


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda p: limit_cycles(p, JOINT, 1.0, 0.0), r"^speed_m_per_s: 0\.0 is not > 0"),
        (lambda p: limit_cycles(p, JOINT, 1.0, 0.1, harmonics=0), r"^harmonics: 0 is not"),
        (lambda p: limit_cycles(p, JOINT, 1.0, 0.1, position_m=1.0), r"^position_m: 1\.0 is"),
        (lambda p: limit_cycles(p, JOINT, 0.0, 0.1), r"^mass_kg: 0\.0 is not > 0"),
        (lambda _: describing_function(np.sign, 0.0), r"^amplitude: 0\.0 is not > 0"),
        (lambda _: describing_function(np.sign, 1.0, points=4), r"^points: 4 is not >= 8"),
        (
            lambda p: compare_limit_cycle(
                p, JOINT, 1.0, t_s=[0.0], reference_m=[0.0], velocity_m_per_s=[0.0]
            ),
            r"^t_s, reference_m, velocity_m_per_s: shapes",
        ),
    ],
)
def test_values_out_of_range_are_refused(call, said):
    with pytest.raises(bk.ScenarioError, match=said):
        call(SampledPid(TABLE_II, 1e-5))
