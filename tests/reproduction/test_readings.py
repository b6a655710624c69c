"""Equation (13) and what m2 multiplies, by arithmetic of their own."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.reproduction.findings import misprints
from breakaway.ask.reproduction.readings import (
    READINGS,
    equation_13,
    velocity_gain,
    with_m2,
)
from breakaway.ask.reproduction.tables import TABLE_2

M2 = (360.0 - 9.81) / 0.1  # equation (12), m = 1 kg
TUNED = {"without_vibration": (5e-4, 1.0), "with_vibration": (5.2e-4, 1.2)}
K_E, C = 3.6e7, 9000.0


def wanted(control):
    """Coefficients of s**2, s and 1 in (s + 200)(s**2 + 2 eps w s + w**2)."""
    settling_s, eps = TUNED[control]
    w = 4.0 / (eps * settling_s)
    return np.polymul([1.0, 200.0], [1.0, 2.0 * eps * w, w * w])[1:]


def totals(control, on_static=1.0, on_dynamic=1.0, sign=-1.0):
    """kd, kp and ki, with m2 on neither part, one or both; the sign is that of kp_d's 1."""
    static = wanted(control) - [C, K_E, 0.0]
    dynamic = wanted(control) / M2 + [0.0, sign, 0.0]
    return 0.1 * on_static * static + 0.9 * on_dynamic * dynamic


@pytest.mark.parametrize(
    ("control", "newton", "printed"),
    [("without_vibration", -148.93, -457.31), ("with_vibration", 89.584, -625.14)],
)
def test_the_largest_real_part_depends_on_the_plant(control, newton, printed):
    kd, kp, ki = totals(control)
    assert max(np.roots([1.0, kd, kp, ki]).real) == pytest.approx(newton, rel=1e-4)
    joint = bk.load_scenario("paper_as_computed").joint
    gains = bk.design.PidGains(kp=kp, ki=ki, kd=kd)
    ours = bk.design.stability(gains, joint, mass_kg=1.0).sliding
    assert max(p.real for p in ours.poles_per_s) == pytest.approx(newton, rel=1e-4)

    poles = np.roots([1.0, M2 * kd, M2 * (1.0 + kp), M2 * ki])
    assert max(poles.real) == pytest.approx(printed, rel=1e-4)
    found = equation_13(control)
    assert found.stable
    np.testing.assert_allclose(np.sort_complex(found.poles_per_s), np.sort_complex(poles), 1e-6)


@pytest.mark.parametrize("control", TUNED)
def test_the_sign_of_13_is_not_to_be_told_from_table_ii(control):
    """m x'' = m2 u - F_c0 + m2 x: only kp_d with + 1 places the poles, but both round alike."""
    target = np.concatenate([[1.0], wanted(control)])

    def loop(sign):
        kd, kp, ki = wanted(control) / M2 + [0.0, sign, 0.0]
        return np.array([1.0, M2 * kd, M2 * (kp - 1.0), M2 * ki])

    np.testing.assert_allclose(loop(1.0), target, rtol=1e-12)
    assert loop(-1.0)[2] == pytest.approx(target[2] - 2.0 * M2, rel=1e-12)
    printed = TABLE_2[control]
    for sign in (-1.0, 1.0):
        kp_d = (wanted(control) / M2)[1] + sign
        kp = totals(control, sign=sign)[1]
        assert abs(kp_d / 1000.0 - float(printed["dynamic"]["kp"])) < 0.1
        assert abs(kp / 1000.0 - float(printed["total"]["kp"])) < 0.1
        (erratum,) = (found for found in misprints() if found.key == "misprint_equation_13")
        assert f"{kp_d:.1f}" in erratum.explanation


@pytest.mark.parametrize(("key", "on_static"), [("m2_whole_loop", M2), ("m2_dynamic_gains", 1.0)])
def test_a_reading_multiplies_what_it_says(key, on_static):
    pulsed = with_m2(bk.load_scenario("paper_as_computed_vibration"), READINGS[key]).controller
    for gains, control in (
        (pulsed.breakaway.gains, "without_vibration"),
        (pulsed.vibration.pid.gains, "with_vibration"),
    ):
        found = [gains.kd_n_s_per_m, gains.kp_n_per_m, gains.ki_n_per_m_s]
        np.testing.assert_allclose(found, totals(control, on_static, M2), rtol=1e-12)


def test_a_sampled_loop_needs_kd_below_two_periods():
    reading = READINGS["m2_whole_loop"]
    assert velocity_gain(reading, 1e-5) == pytest.approx(M2 * totals("without_vibration")[0] * 1e-5)
    scenario = with_m2(bk.load_scenario("paper_as_computed"), reading)
    short = scenario.with_({"timing.duration_s": 1e-3, "trace.every_samples": 0})
    for period_s, outcome in ((1e-5, "diverged"), (1e-6, "diverged"), (5e-7, "not_released")):
        assert (velocity_gain(reading, period_s) > 2.0) == (outcome == "diverged")
        assert bk.simulate(short.with_({"timing.control_period_s": period_s})).outcome == outcome
