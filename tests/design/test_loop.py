"""Sampled loops against recursions, closed forms, and runs."""

import control
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.linalg import expm

import breakaway as bk
from breakaway.design import (
    PidGains,
    SampledPid,
    margins,
    open_loop,
    sampled_loops,
    sliding_plant,
    stribeck_slope,
    stuck_plant,
)
from breakaway.design.margins import closed_poles

JOINT = bk.Lugre(
    stiction_n=450.0,
    coulomb_n=360.0,
    stiffness_n_per_m=3.6e7,
    damping_n_s_per_m=9000.0,
    stribeck_velocity_m_per_s=0.09,
    engagement_length_m=0.1,
)
TABLE_II = PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)


@pytest.mark.parametrize("k", [0.05, 0.3, 0.9, 1.0, 1.5])
def test_margins_of_a_sampled_integrator_in_closed_form(k):
    """L = k / (z - 1): |L| = k / (2 sin(wT/2)), phase -90 deg - wT/2; 1 + L smallest at z = -1."""
    period_s = 0.02
    found = margins(control.tf([k], [1.0, -1.0], period_s))
    angle = 2.0 * np.arcsin(k / 2.0)
    phase = np.pi / 2.0 - angle / 2.0
    assert found.stable
    assert found.gain_margin == pytest.approx(2.0 / k, rel=1e-9)
    assert found.gain_reduction_margin == 0.0
    assert found.crossover_rad_per_s == pytest.approx(angle / period_s, rel=1e-9)
    assert found.phase_margin_deg == pytest.approx(np.degrees(phase), rel=1e-9)
    assert found.delay_margin_s == pytest.approx(phase / (angle / period_s), rel=1e-9)
    assert found.delay_margin_samples == pytest.approx(phase / angle, rel=1e-9)
    assert found.modulus_margin == pytest.approx(1.0 - k / 2.0, rel=1e-9)
    assert found.max_sensitivity == pytest.approx(1.0 / (1.0 - k / 2.0), rel=1e-9)
    assert found.poles == pytest.approx((1.0 - k,), abs=1e-12)


def test_an_unstable_loop_has_no_margins_but_ranges_of_gain():
    found = margins(control.tf([2.5], [1.0, -1.0], 0.02))
    assert not found.stable
    assert np.isnan(found.phase_margin_deg) and np.isnan(found.modulus_margin)
    [(low, high)] = found.stable_factors
    assert (low, high) == (0.0, pytest.approx(0.8))


def test_margins_agree_with_python_control():
    loop = open_loop(SampledPid(TABLE_II, 1e-5), sliding_plant(JOINT, 1.0))
    w = np.linspace(1700.0, 1900.0, 401)
    data = control.frd(loop(np.exp(1j * w * 1e-5)), w, dt=1e-5)
    _, phase_margin_deg, _, crossover = control.margin(data)
    found = margins(loop)
    assert found.phase_margin_deg == pytest.approx(phase_margin_deg, rel=1e-4)
    assert found.crossover_rad_per_s == pytest.approx(crossover, rel=1e-6)


def test_held_double_integrator_in_closed_form():
    """x[n+1] = x + T v + T^2/(2 m) F, v[n+1] = v + T/m F."""
    mass_kg, period_s = 2.5, 3e-4
    sampled = control.c2d(sliding_plant(JOINT, mass_kg), period_s, method="zoh")
    np.testing.assert_allclose(sampled.A, [[1.0, period_s], [0.0, 1.0]], rtol=1e-13)
    half = period_s**2 / (2.0 * mass_kg)
    np.testing.assert_allclose(sampled.B.ravel(), [half, period_s / mass_kg], rtol=1e-13)
    z = np.exp(0.3j)
    pid = SampledPid(PidGains(kp=7.0, ki=0.0, kd=0.0), period_s)
    expected = 7.0 * half * (z + 1.0) / (z - 1.0) ** 2
    assert complex(open_loop(pid, sliding_plant(JOINT, mass_kg))(z)) == pytest.approx(expected)


def test_sliding_and_stuck_plants_are_the_linearized_law():
    """Against the numerical response of equations (1) to (3) to a small change of speed."""
    v0, k_e, c = 0.06, 3.6e7, 9000.0
    g = 360.0 + 90.0 * np.exp(-((v0 / 0.09) ** 2))
    slope = stribeck_slope(JOINT, v0)
    for w in (1e2, 1.8e3, 2e4):
        s = 1j * w
        friction = slope * (1.0 + s * c / k_e) / (1.0 + s * g / (k_e * v0))
        plant = sliding_plant(JOINT, 1.3, v0)(s)
        assert complex(plant[1, 0]) == pytest.approx(1.0 / (1.3 * s + friction), rel=1e-9)
        stuck = stuck_plant(JOINT, 1.3)(s)
        assert complex(stuck[0, 0]) == pytest.approx(1.0 / (1.3 * s * s + c * s + k_e), rel=1e-9)


def test_slope_is_that_of_the_curve_along_the_guide():
    for x in (0.0, 0.03, 0.1):
        for v in (0.0, 0.02, 0.0636, -0.0636, 0.3, 5.0):
            share, h = 1.0 - x / 0.1, 1e-7
            level = [90.0 * share * np.exp(-(((abs(v) + d) / 0.09) ** 2)) for d in (-h, h)]
            expected = (level[1] - level[0]) / (2.0 * h)
            assert stribeck_slope(JOINT, v, position_m=x) == pytest.approx(expected, abs=1e-3)


def by_hand(pid, k, c, slope, mass_kg, steps):
    """The loop as `pid.rs` runs it, around the exactly held plant; gives |x| over time."""
    a = np.array([[0.0, 1.0], [-k / mass_kg, -(c + slope) / mass_kg]])
    whole = np.zeros((3, 3))
    whole[:2, :2], whole[1, 2] = a, 1.0 / mass_kg
    held = expm(whole * pid.period_s)
    state = np.array([1.0, 0.0])
    integral, derivative, previous = 0.0, 0.0, 1.0
    waiting = [0.0] * pid.delay_samples
    share = pid.period_s / (pid.derivative_filter_s + pid.period_s)
    sizes = []
    for _ in range(steps):
        x, v = state
        if pid.velocity_from == "position_difference":
            v = (x - previous) / pid.period_s
        previous = x
        derivative = (1.0 - share) * derivative - share * v
        integral += pid.gains.ki * -x * pid.period_s
        waiting.append(pid.gains.kp * -x + integral + pid.gains.kd * derivative)
        state = held[:2, :2] @ state + held[:2, 2] * waiting.pop(0)
        sizes.append(float(np.hypot(state[0], state[1] * pid.period_s)))
        if not sizes[-1] < 1e60:
            break
    return np.array(sizes)


@pytest.mark.slow
@given(
    kp=st.floats(1e4, 2e6),
    ki=st.floats(0.0, 5e8),
    kd=st.floats(0.0, 4e3),
    delay=st.integers(0, 3),
    difference=st.booleans(),
    filter_s=st.sampled_from([0.0, 3e-4]),
    stuck=st.booleans(),
)
def test_verdict_is_what_the_recursion_does(kp, ki, kd, delay, difference, filter_s, stuck):
    joint = JOINT.model_copy(update={"stiffness_n_per_m": 1e6, "damping_n_s_per_m": 200.0})
    source = "position_difference" if difference else "sensor"
    pid = SampledPid(PidGains(kp, ki, kd), 5e-4, delay, source, filter_s)
    plant = stuck_plant(joint, 1.0) if stuck else sliding_plant(joint, 1.0)
    [poles] = closed_poles(open_loop(pid, plant), [1.0])
    radius = np.max(np.abs(poles))
    assume(abs(radius - 1.0) > 1e-2)
    k, c = (1e6, 200.0) if stuck else (0.0, 0.0)
    sizes = by_hand(pid, k, c, 0.0, 1.0, 2000)
    assert (radius < 1.0) == bool(sizes[-1] < 1e-3 * sizes.max())


@pytest.mark.parametrize("delay", [0, 1, 4])
def test_delay_margin_is_what_whole_samples_show(delay):
    plant = sliding_plant(JOINT, 1.0)
    found = margins(open_loop(SampledPid(TABLE_II, 1e-5, delay), plant))
    more = int(found.delay_margin_samples)
    assert margins(open_loop(SampledPid(TABLE_II, 1e-5, delay + more), plant)).stable
    assert not margins(open_loop(SampledPid(TABLE_II, 1e-5, delay + more + 1), plant)).stable


def test_gain_margins_are_where_the_verdict_changes():
    for loop in sampled_loops(SampledPid(TABLE_II, 1e-5, 1), JOINT, 1.0):
        for low, high in loop.margins.stable_factors:
            for edge, inside in ((low, 1.001), (high, 0.999)):
                if 0.0 < edge < np.inf:
                    assert margins(edge * inside * loop.open_loop).stable
                    assert not margins(edge / inside * loop.open_loop).stable


def test_the_paper_without_vibration_as_it_runs():
    stuck, sliding, falling = sampled_loops(SampledPid(TABLE_II, 1e-5), JOINT, 1.0)
    assert stuck.margins.stable and sliding.margins.stable and not falling.margins.stable
    assert sliding.margins.phase_margin_deg == pytest.approx(9.89, abs=0.01)
    assert sliding.margins.delay_margin_samples == pytest.approx(9.65, abs=0.01)
    assert (stuck.counts, sliding.counts, falling.counts) == (True, True, False)


def test_sampling_can_undo_a_stable_loop():
    """kd T / m > 2: the velocity loop alone turns over at every sample."""
    gains = PidGains(kp=1e5, ki=1e6, kd=2500.0)
    assert bk.design.stability(gains, JOINT, 1.0).sliding.stable
    assert not sampled_loops(SampledPid(gains, 1e-3), JOINT, 1.0)[1].margins.stable


def test_the_integral_counts_in_the_stribeck_verdict():
    """Here kd = 900 exceeds the slope of 858, but ki m / kp = 409 takes its part; a run agrees."""
    gains = PidGains(kp=3137.3e3, ki=1283289e3, kd=900.0)
    assert "self-excited" in bk.design.stability(gains, JOINT, 1.0).stribeck
    assert (
        "damps it"
        in bk.design.stability(PidGains(3137.3e3, 1283289e3, 1300.0), JOINT, 1.0).stribeck
    )


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: SampledPid(TABLE_II, 0.0), r"^period_s: 0\.0 is not > 0"),
        (lambda: SampledPid(PidGains(np.nan, 0.0, 0.0), 1e-5), r"^gains\.kp: nan is not finite"),
        (lambda: SampledPid(TABLE_II, 1e-5, -1), r"^delay_samples: -1 is not a whole number"),
        (lambda: SampledPid(TABLE_II, 1e-5, 0, "guess"), r"^velocity_from: 'guess' is not one of"),
        (lambda: SampledPid(TABLE_II, 1e-5, 0, "sensor", -1.0), r"^derivative_filter_s: -1\.0 is"),
        (lambda: stuck_plant(JOINT, -1.0), r"^mass_kg: -1\.0 is not > 0"),
        (lambda: sliding_plant(JOINT, 1.0, 0.0), r"^velocity_m_per_s: 0\.0 is not > 0"),
        (lambda: stribeck_slope(JOINT, np.inf), r"^velocity_m_per_s: inf is not finite"),
        (lambda: stribeck_slope(JOINT, 0.1, position_m=0.2), r"^position_m: 0\.2 is not within"),
        (lambda: margins(control.tf([1.0], [1.0, 1.0])), r"^loop: has 1 inputs.*dt = 0"),
    ],
)
def test_values_out_of_range_are_refused(call, said):
    with pytest.raises(bk.ScenarioError, match=said):
        call()
