"""Verdicts on the closed loop, against its poles."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import breakaway as bk

JOINT = bk.Lugre(
    stiction_n=450.0,
    coulomb_n=360.0,
    stiffness_n_per_m=3.6e7,
    damping_n_s_per_m=9000.0,
    stribeck_velocity_m_per_s=0.09,
    engagement_length_m=0.1,
)
WITHOUT = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)  # Table II, totals
WITH = bk.design.PidGains(kp=828.2e3, ki=823940e3, kd=662.5)


def test_table_ii_without_vibration_is_stable():
    verdict = bk.design.stability(WITHOUT, JOINT, mass_kg=1.0)
    assert verdict.stuck.stable
    assert verdict.sliding.stable
    assert verdict.sliding.reason == "damping x stiffness / m = 2.272e+09 > ki = 1.283e+09"


def test_table_ii_with_vibration_is_unstable_while_sliding():
    verdict = bk.design.stability(WITH, JOINT, mass_kg=1.0)
    assert verdict.stuck.stable
    assert not verdict.sliding.stable
    assert verdict.sliding.reason == "damping x stiffness / m = 5.487e+08 <= ki = 8.239e+08"
    growing = [pole for pole in verdict.sliding.poles_per_s if pole.real > 0]
    assert len(growing) == 2  # an oscillation that grows
    assert growing[0] == growing[1].conjugate()


def log_uniform(low, high):
    return st.floats(np.log10(low), np.log10(high)).map(lambda exponent: 10.0**exponent)


def signed(low, high):
    """Mostly positive, since a negative coefficient decides by itself."""
    return st.tuples(log_uniform(low, high), st.sampled_from([1.0, 1.0, 1.0, -1.0])).map(np.prod)


@given(
    kp=signed(1e2, 1e8),
    ki=signed(1e2, 1e12),
    kd=signed(1.0, 1e5),
    k_e=log_uniform(1e3, 1e8),
    c=log_uniform(1.0, 1e5),
    mass_kg=log_uniform(0.01, 100.0),
)
def test_routh_and_hurwitz_agree_with_the_poles(kp, ki, kd, k_e, c, mass_kg):
    joint = JOINT.model_copy(update={"stiffness_n_per_m": k_e, "damping_n_s_per_m": c})
    gains = bk.design.PidGains(kp=float(kp), ki=float(ki), kd=float(kd))
    verdict = bk.design.stability(gains, joint, mass_kg=mass_kg)
    loops = (
        (verdict.stuck, [mass_kg, c + kd, k_e + kp, ki]),
        (verdict.sliding, [mass_kg, kd, kp, ki]),
    )
    for loop, polynomial in loops:
        # Time in units in which the coefficients, and so the poles, are of order one.
        monic = np.array(polynomial) / mass_kg
        scale = np.max(np.abs(monic[1:]) ** (1.0 / np.arange(1, 4)))
        poles = np.roots(monic / scale ** np.arange(4))
        assume(np.min(np.abs(poles.real)) > 1e-7)  # too near the axis for numbers to tell
        assert loop.stable == (poles.real.max() < 0.0)
        ours = np.array(loop.poles_per_s) / scale
        assert len(ours) == 3
        for pole in poles:
            assert np.min(np.abs(ours - pole)) < 1e-6
        if not loop.stable and min(polynomial) <= 0.0:
            assert loop.reason.startswith("not all coefficients are positive")


@pytest.mark.parametrize(("kp", "ki", "kd"), [(1.0, 1.0, 1.0), (2.0, 2.0, 1.0), (0.5, 2.0, 4.0)])
def test_on_the_edge_counts_as_unstable(kp, ki, kd):
    """kd kp / m = ki: two poles on the imaginary axis."""
    verdict = bk.design.stability(bk.design.PidGains(kp=kp, ki=ki, kd=kd), JOINT, mass_kg=1.0)
    assert not verdict.sliding.stable


@pytest.mark.parametrize("gains", [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)])
def test_a_missing_term_is_named(gains):
    kp, ki, kd = gains
    verdict = bk.design.stability(bk.design.PidGains(kp=kp, ki=ki, kd=kd), JOINT, mass_kg=1.0)
    missing = ("stiffness", "ki", "damping")[gains.index(0.0)]
    assert not verdict.sliding.stable
    assert verdict.sliding.reason == f"not all coefficients are positive: {missing} = 0"


def test_stribeck_slope_is_the_steepest_of_the_curve():
    """Against a numerical derivative of g(v) + sigma_2 v."""
    for viscous in (0.0, 300.0):
        joint = JOINT.model_copy(update={"viscous_n_s_per_m": viscous})
        v = np.linspace(0.0, 0.5, 200_001)
        slope = np.gradient(360.0 + 90.0 * np.exp(-((v / 0.09) ** 2)) + viscous * v, v)
        steepest, at = -slope.min(), v[slope.argmin()]
        for kd, expected in ((steepest * 1.01, "damps it"), (steepest * 0.99, "self-excited")):
            gains = bk.design.PidGains(kp=1.0, ki=1.0, kd=kd)
            said = bk.design.stability(gains, joint, mass_kg=1.0).stribeck
            assert expected in said
            assert f"steepest fall {steepest:.3g}"[:-1] in said
            assert f"at {at:.3g} m/s" in said


def test_the_paper_oscillates_at_low_speed():
    assert "self-excited" in bk.design.stability(WITHOUT, JOINT, mass_kg=1.0).stribeck


def test_a_law_without_stribeck_curve_says_so():
    joint = bk.TwoRegion(
        stiction_n=450.0,
        coulomb_n=360.0,
        stiffness_n_per_m=3.6e7,
        damping_n_s_per_m=9000.0,
        engagement_length_m=0.1,
    )
    verdict = bk.design.stability(WITHOUT, joint, mass_kg=1.0)
    assert verdict.stribeck == "this law has no falling friction curve"
    assert verdict.stuck == bk.design.stability(WITHOUT, JOINT, mass_kg=1.0).stuck


@pytest.mark.parametrize("mass_kg", [0.0, -1.0, float("nan"), float("inf")])
def test_a_mass_out_of_range_is_refused(mass_kg):
    with pytest.raises(bk.ScenarioError, match=rf"^mass_kg: {mass_kg!r} is not > 0"):
        bk.design.stability(WITHOUT, JOINT, mass_kg=mass_kg)


@pytest.mark.parametrize("growth", ["unstable", "stable"])
def test_verdict_while_sliding_is_what_a_run_does(growth):
    """With no friction to speak of, a run follows the poles: the unstable loop diverges."""
    gains = {"unstable": WITH, "stable": WITHOUT}[growth]
    run = bk.simulate(
        bk.load_scenario("paper_as_computed").with_(
            {
                "joint.stiction_n": 1e-3,
                "joint.coulomb_n": 1e-3,
                "joint.residual_n": 1e-3,
                "joint.stiffness_n_per_m": 1e3,
                "joint.damping_n_s_per_m": 0.0,
                "limits.diverged_force_n": 1e6,
                "timing.control_period_s": 1e-6,
                "trace.every_samples": 0,
            },
            controller={
                "kind": "pid",
                "gains": {
                    "kind": "given",
                    "kp_n_per_m": gains.kp,
                    "ki_n_per_m_s": gains.ki,
                    "kd_n_s_per_m": gains.kd,
                },
            },
        )
    )
    assert run.outcome == {"unstable": "diverged", "stable": "released"}[growth]
