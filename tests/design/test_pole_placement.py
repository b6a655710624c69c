"""Gains by pole placement: the paper's Table II, and the poles that they were asked for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import breakaway as bk

PAPER = {
    "stiction_n": 450.0,
    "coulomb_n": 360.0,
    "stribeck_velocity_m_per_s": 0.09,
    "engagement_length_m": 0.1,
}
AS_COMPUTED = bk.Lugre(**PAPER, stiffness_n_per_m=3.6e7, damping_n_s_per_m=9000.0)
AS_PRINTED = bk.Lugre(**PAPER, stiffness_n_per_m=3.0e7, damping_n_s_per_m=1.6 * 3.0e7)

DESIGNS = {
    "without": {"settling_time_s": 5e-4, "damping_ratio": 1.0},
    "with": {"settling_time_s": 5.2e-4, "damping_ratio": 1.2},
}
# Printed, in thousands, as text: the last digit carries the tolerance.
TABLE_II = {
    ("without", "static"): {"kp": "31200", "kd": "7.2000", "ki": "12800000"},
    ("without", "dynamic"): {"kp": "19.2", "kd": "0.0046", "ki": "3655"},
    ("without", "total"): {"kp": "3137.3", "kd": "0.7242", "ki": "1283289"},
    ("with", "static"): {"kp": "8168.3", "kd": "6.5846", "ki": "8218277"},
    ("with", "dynamic"): {"kp": "12.6", "kd": "0.0044", "ki": "2347"},
    ("with", "total"): {"kp": "828.2", "kd": "0.6625", "ki": "823940"},
}
CASES = [
    (vibration, part, gain, printed)
    for (vibration, part), gains in TABLE_II.items()
    for gain, printed in gains.items()
]


def designed(vibration, joint=AS_COMPUTED, **changes):
    values = {"mass_kg": 1.0, "pole_per_s": 200.0, **DESIGNS[vibration], **changes}
    return bk.design.pole_placement(joint, **values)


def test_the_table_has_18_gains():
    assert len(CASES) == 18


@pytest.mark.parametrize(("vibration", "part", "gain", "printed"), CASES)
def test_table_ii(vibration, part, gain, printed):
    """Within one unit of the last printed digit: two of the 18 are cut off, not rounded."""
    digits = len(printed.partition(".")[2])
    ours = getattr(getattr(designed(vibration), part), gain) / 1000.0
    assert abs(ours - float(printed)) < 10.0**-digits


@pytest.mark.parametrize("vibration", DESIGNS)
def test_table_i_does_not_give_table_ii(vibration):
    """With c = 1.6 k_e the damping of the joint alone is far more than the target's."""
    static = designed(vibration, AS_PRINTED).static
    assert static.kd == pytest.approx(-4.8e7, rel=1e-3)
    printed = float(TABLE_II[vibration, "static"]["kp"]) * 1000.0
    assert static.kp - printed == pytest.approx(6e6, rel=1e-4)  # 3.6e7 - 3.0e7


def test_total_is_the_weighted_sum():
    for share in (0.0, 0.1, 0.7, 1.0):
        gains = designed("with", static_share=share)
        for name in ("kp", "ki", "kd"):
            static, dynamic = getattr(gains.static, name), getattr(gains.dynamic, name)
            expected = share * static + (1 - share) * dynamic
            assert getattr(gains.total, name) == pytest.approx(expected, rel=1e-14)


def test_a_given_residual_force_replaces_the_weight():
    given = AS_COMPUTED.model_copy(update={"residual_n": 9.81})
    assert designed("with", given) == designed("with")
    lighter = AS_COMPUTED.model_copy(update={"residual_n": 0.5})
    assert designed("with", lighter).dynamic.ki < designed("with").dynamic.ki


DESIGN_VALUES = {
    "mass_kg": st.floats(0.05, 50.0),
    "settling_time_s": st.floats(1e-4, 1e-1),
    "damping_ratio": st.floats(0.3, 3.0),
    "pole_per_s": st.floats(10.0, 5000.0),
}
JOINTS = st.builds(
    bk.Lugre,
    stiction_n=st.just(5000.0),
    coulomb_n=st.floats(1000.0, 5000.0),
    stiffness_n_per_m=st.floats(1e4, 1e8),
    damping_n_s_per_m=st.floats(0.0, 1e5),
    stribeck_velocity_m_per_s=st.just(0.1),
    engagement_length_m=st.floats(1e-3, 1.0),
)


def target(damping_ratio, settling_time_s, pole_per_s):
    """(s + a)(s**2 + 2 eps w s + w**2) with the 2 % settling time t_s = 4 / (eps w)."""
    w = 4.0 / (damping_ratio * settling_time_s)
    return np.polymul([1.0, pole_per_s], [1.0, 2.0 * damping_ratio * w, w * w])


def same_polynomial(ours, expected):
    """Coefficients of like size on a time scale of their own, where poles are of order one."""
    scale = np.max(np.abs(expected) ** (1.0 / np.maximum(np.arange(4), 1)))
    powers = scale ** np.arange(4)
    return np.allclose(ours / powers, expected / powers, rtol=0, atol=1e-9)


@given(joint=JOINTS, **DESIGN_VALUES)
def test_static_gains_place_the_poles_of_the_stuck_loop(joint, mass_kg, **values):
    """Loop of PID (kd s^2 + kp s + ki)/s and the plant 1/(m s^2 + c s + k_e), by hand."""
    gains = bk.design.pole_placement(joint, mass_kg=mass_kg, **values).static
    plant = [mass_kg, joint.damping_n_s_per_m, joint.stiffness_n_per_m]
    loop = np.polyadd(np.polymul([1.0, 0.0], plant), [gains.kd, gains.kp, gains.ki])
    assert same_polynomial(loop / loop[0], target(**values))


@given(joint=JOINTS, **DESIGN_VALUES)
def test_dynamic_gains_place_the_poles_of_the_sliding_loop(joint, mass_kg, **values):
    """The paper's T_d, equation (13): friction falls by m2 per meter, and m2 scales the loop.

    m s^3 + m2 kd s^2 + m2 (kp + 1) s + m2 ki.
    """
    gains = bk.design.pole_placement(joint, mass_kg=mass_kg, **values).dynamic
    m2 = (joint.coulomb_n - mass_kg * 9.81) / joint.engagement_length_m
    loop = np.array([mass_kg, m2 * gains.kd, m2 * (gains.kp + 1.0), m2 * gains.ki])
    assert same_polynomial(loop / mass_kg, target(**values))


def test_poles_of_the_paper_by_their_roots():
    for vibration, design in DESIGNS.items():
        gains = designed(vibration).static
        poles = np.sort_complex(np.roots([1.0, 9000.0 + gains.kd, 3.6e7 + gains.kp, gains.ki]))
        expected = np.sort_complex(np.roots(target(**design, pole_per_s=200.0)))
        np.testing.assert_allclose(poles, expected, rtol=1e-6)
        assert np.min(np.abs(poles + 200.0)) < 1e-6


@pytest.mark.parametrize("name", ["mass_kg", "settling_time_s", "damping_ratio", "pole_per_s"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), -float("inf")])
def test_design_values_out_of_range_are_refused(name, value):
    with pytest.raises(bk.ScenarioError, match=rf"^{name}: {value!r} is not > 0 and finite; give"):
        designed("with", **{name: value})


@pytest.mark.parametrize("share", [-0.1, 1.1, float("nan"), float("inf")])
def test_a_share_out_of_range_is_refused(share):
    with pytest.raises(bk.ScenarioError, match=r"^static_share: .* is not within 0 to 1"):
        designed("with", static_share=share)


def test_a_joint_whose_friction_does_not_fall_has_no_dynamic_gains():
    heavy = {"mass_kg": 360.0 / 9.81 + 1.0}
    with pytest.raises(bk.ScenarioError, match=r"^joint.coulomb_n: 360.0 is not > .*369\.81 N"):
        designed("with", **heavy)
    same = AS_COMPUTED.model_copy(update={"residual_n": 360.0})
    with pytest.raises(bk.ScenarioError, match=r"^joint.coulomb_n: 360.0 is not > .*360 N"):
        designed("with", same)


@pytest.mark.parametrize(
    "extreme",
    [
        {"settling_time_s": 5e-324},  # gains without bound
        {"settling_time_s": 1e-200, "damping_ratio": 1e-200},  # their product is zero
        {"pole_per_s": 1.7e308},
    ],
)
def test_gains_that_are_no_numbers_are_refused(extreme):
    with pytest.raises(bk.ScenarioError):
        designed("with", **extreme)


def test_misspelled_design_values_are_refused():
    with pytest.raises(TypeError, match="dampin_ratio"):
        designed("with", dampin_ratio=1.0)
