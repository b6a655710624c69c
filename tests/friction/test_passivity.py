"""Bounds within which friction never pushes a part."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.model.friction.passivity import passive_attraction_n_per_s, passive_speed

PAPER = {
    "stiction_n": 450.0,
    "coulomb_n": 360.0,
    "stiffness_n_per_m": 3.6e7,
    "damping_n_s_per_m": 9000.0,
    "engagement_length_m": 0.1,
}
STRIBECK = {**PAPER, "stribeck_velocity_m_per_s": 0.09}
LUGRE = bk.Lugre(**STRIBECK)
ELASTO_PLASTIC = bk.ElastoPlastic(**STRIBECK, elastic_share=0.7)
GMS = bk.Gms(**STRIBECK, attraction_n_per_s=4.5e5)


@pytest.mark.parametrize("joint", [LUGRE, ELASTO_PLASTIC], ids=lambda joint: joint.law)
@pytest.mark.parametrize(
    ("changes", "speed"),
    [
        ({}, 0.16),  # 4 * 360 / 9000
        ({"residual_n": 9.81}, 0.16),
        ({"coulomb_n": 450.0, "stiction_n": 90.0}, 0.04),
        ({"backward_ratio": 0.5}, 0.08),
        ({"backward_ratio": 2.0}, 0.16),
        ({"viscous_n_s_per_m": 1000.0}, 4 * 360 * 1e4 / 9000**2),
        ({"damping_velocity_m_per_s": 0.3}, None),
        ({"damping_n_s_per_m": 0.0}, None),
    ],
)
def test_a_bristle_cannot_push_up_to_4_g_over_c(joint, changes, speed):
    found = passive_speed(joint.model_copy(update=changes))
    assert found == (None if speed is None else pytest.approx(speed, rel=1e-14))
    assert passive_attraction_n_per_s(joint) is None


def test_the_quadratic_of_the_power_touches_zero_there():
    """k_e z (v - z') + c z' v = |v| g (s**2 + (c/g) (1 - s) |v|): no real zero s up to 4 g / c."""
    g, c, v = 360.0, 9000.0, passive_speed(LUGRE)
    for factor, pushes in ((0.999, False), (1.001, True)):
        zeros = np.roots([g, -c * factor * v, c * factor * v])
        assert bool(np.all(np.isreal(zeros))) == pushes


@pytest.mark.parametrize(
    ("changes", "attraction"),
    [
        ({}, 3.6e7 * 360.0 / 9000.0),
        ({"backward_ratio": 0.5}, 3.6e7 * 180.0 / 9000.0),
        ({"damping_velocity_m_per_s": 0.3}, None),
        ({"damping_n_s_per_m": 0.0}, None),
    ],
)
def test_elements_cannot_push_up_to_an_attraction(changes, attraction):
    found = passive_attraction_n_per_s(GMS.model_copy(update=changes))
    assert found == (None if attraction is None else pytest.approx(attraction, rel=1e-14))
    assert passive_speed(GMS) is None


def test_other_laws_have_no_sliding_bristles():
    rigid = bk.CoulombStiction(
        **{name: STRIBECK[name] for name in STRIBECK if "ff" not in name and "damp" not in name}
    )
    for joint in (bk.TwoRegion(**PAPER), rigid):
        assert passive_speed(joint) is None and passive_attraction_n_per_s(joint) is None


def test_what_is_no_joint_is_refused():
    for function in (passive_speed, passive_attraction_n_per_s):
        with pytest.raises(bk.ScenarioError, match="joint"):
            function("paper_as_computed")
