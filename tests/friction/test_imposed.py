"""Motion imposed on a joint of every law."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import breakaway as bk
from breakaway.model.friction.curve import steady_force

GUIDE = {"engagement_length_m": 1e3, "residual_n": 100.0}
LEVELS = {"stiction_n": 450.0, "coulomb_n": 360.0, "backward_ratio": 0.7}
BRISTLE = {"stiffness_n_per_m": 3.6e7, "damping_n_s_per_m": 9000.0}
CURVE = {"stribeck_velocity_m_per_s": 0.09, "viscous_n_s_per_m": 60.0}
JOINTS = {
    "lugre": bk.Lugre(**LEVELS, **GUIDE, **BRISTLE, **CURVE),
    "elasto_plastic": bk.ElastoPlastic(**LEVELS, **GUIDE, **BRISTLE, **CURVE, elastic_share=0.7),
    "gms": bk.Gms(**LEVELS, **GUIDE, **BRISTLE, **CURVE, attraction_n_per_s=1e6),
    "two_region": bk.TwoRegion(**LEVELS, **GUIDE, **BRISTLE),
    "coulomb_stiction": bk.CoulombStiction(**LEVELS, **GUIDE, **CURVE),
}


@pytest.mark.parametrize("law", JOINTS)
@pytest.mark.parametrize("speed", [1e-3, 0.0636, 0.4])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_a_steady_speed_it_ends_at_the_curve(law, speed, sign):
    time_s = max(20.0 * 450.0 / 3.6e7 / speed, 20.0 * 450.0 / 1e6)
    velocity = np.full(20_000, sign * speed)
    moved = bk.impose_motion(JOINTS[law], velocity, period_s=time_s / velocity.size)
    expected = steady_force(
        JOINTS[law], sign * speed, position_m=max(0.0, float(moved.position_m[-1]))
    )
    assert moved.joint_force_n[-1] == pytest.approx(float(expected), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("law", JOINTS)
@settings(max_examples=40, deadline=None)
@given(speeds=st.lists(st.floats(-0.05, 0.05), min_size=1, max_size=8), to_and_fro=st.booleans())
def test_a_closed_loop_takes_work(law, speeds, to_and_fro):
    """From rest and back to the same place, a joint takes energy and never gives any.

    At these speeds c |v| is below 4 g, so that a bristle cannot push the part.
    """
    path = [*speeds, *(-v for v in (reversed(speeds) if to_and_fro else speeds))]
    velocity = np.repeat(path, 200)
    period_s = 2e-6
    moved = bk.impose_motion(JOINTS[law], velocity, period_s=period_s)
    work_j = float(np.sum(moved.joint_force_n * velocity) * period_s)
    assert work_j >= -1e-12
    if max(map(abs, speeds)) * 200 * period_s > 1e-5 and law == "coulomb_stiction":
        assert work_j > 0.0


def test_a_rigid_joint_that_stands_holds_what_it_held():
    joint = JOINTS["coulomb_stiction"]
    velocity = np.array([0.0, 0.0, 0.02, 0.02, 0.0, 0.0, -0.02, 0.0])
    force = bk.impose_motion(joint, velocity, period_s=1e-4).joint_force_n
    assert list(force[:2]) == [0.0, 0.0]
    sliding = force[3]
    assert sliding > 360.0
    # Viscous friction included, it is below stiction forward, and beyond it backward.
    assert force[4] == force[5] == sliding
    assert force[6] == pytest.approx(-0.7 * 450.0 - 60.0 * 0.02, rel=0.05)
    assert force[7] == pytest.approx(-0.7 * 450.0, rel=1e-6) and force[7] > force[6]


def test_elements_report_their_mean_deflection():
    """All stuck, they stretch as far as the part has moved; a rigid joint never stretches."""
    velocity, period_s = np.full(100, 1e-5), 1e-4
    moved = bk.impose_motion(JOINTS["gms"], velocity, period_s=period_s)
    np.testing.assert_allclose(moved.bristle_m, np.cumsum(velocity * period_s), rtol=1e-12)
    elastic = 3.6e7 * (moved.position_m) + (9000.0 + 60.0) * velocity
    np.testing.assert_allclose(moved.joint_force_n, elastic, rtol=1e-12)
    assert not bk.impose_motion(JOINTS["coulomb_stiction"], velocity, period_s=1e-4).bristle_m.any()


@pytest.mark.parametrize("law", JOINTS)
def test_beyond_the_guide_there_is_no_friction(law):
    short = JOINTS[law].model_copy(update={"engagement_length_m": 1e-3})
    moved = bk.impose_motion(short, np.full(300, 0.1), period_s=1e-4)
    free = moved.position_m > 1e-3
    assert np.all(moved.joint_force_n[free] == 0.0) and np.all(moved.bristle_m[free] == 0.0)
    assert np.all(moved.joint_force_n[~free] > 0.0)
