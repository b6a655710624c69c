"""The numbers of a law, as the core answers them, against their closed forms."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.model.friction.curve import (
    breakaway_force,
    has_bristles,
    has_elements,
    steady_force,
    steady_friction,
    steepest_change_velocity,
    steepest_fall_velocity,
    stribeck_slope,
)

LEVELS = {"stiction_n": 450.0, "coulomb_n": 360.0}
GUIDE = {"engagement_length_m": 0.1, "residual_n": 9.81}
BRISTLE = {"stiffness_n_per_m": 3.6e7, "damping_n_s_per_m": 9000.0}
CURVE = {"stribeck_velocity_m_per_s": 0.09, "viscous_n_s_per_m": 60.0}
STRIBECK = {**LEVELS, **GUIDE, **BRISTLE, **CURVE, "damping_velocity_m_per_s": 0.3}
JOINTS = {
    "lugre": bk.Lugre(**STRIBECK),
    "elasto_plastic": bk.ElastoPlastic(**STRIBECK, elastic_share=0.7),
    "gms": bk.Gms(**STRIBECK, attraction_n_per_s=1e6, elements=5),
    "two_region": bk.TwoRegion(**LEVELS, **GUIDE, **BRISTLE),
    "coulomb_stiction": bk.CoulombStiction(**LEVELS, **GUIDE, **CURVE),
}
WITH_CURVE = [name for name in JOINTS if name != "two_region"]
X = np.array([0.0, 0.03, 0.1])[:, None]
V = np.array([-2.0, -0.09, -1e-3, 1e-6, 0.0636, 0.3, 5.0])


def by_hand(x, v):
    """g(v, x) of equations (3), (5) and (6)."""
    stiction, coulomb = (f + (9.81 - f) * x / 0.1 for f in (450.0, 360.0))
    return coulomb + (stiction - coulomb) * np.exp(-((v / 0.09) ** 2))


@pytest.mark.parametrize("law", WITH_CURVE)
def test_the_level_is_that_of_equation_3(law):
    found = steady_friction(JOINTS[law], V, position_m=X)
    np.testing.assert_allclose(found.level_n, by_hand(X, V), rtol=1e-13)
    assert np.all(found.viscous_n_s_per_m == 60.0)
    force = by_hand(X, V) * np.sign(V) + 60.0 * V
    np.testing.assert_allclose(steady_force(JOINTS[law], V, position_m=X), force, rtol=1e-13)


def test_two_regions_slide_at_the_coulomb_level():
    found = steady_friction(JOINTS["two_region"], V, position_m=X)
    coulomb = np.broadcast_to(360.0 + (9.81 - 360.0) * X / 0.1, (3, 7))
    np.testing.assert_allclose(found.level_n, coulomb, rtol=1e-13)
    assert np.all(found.viscous_n_s_per_m == 0.0) and np.all(found.rate_per_s == np.inf)


@pytest.mark.parametrize("law", WITH_CURVE)
def test_the_slope_is_the_derivative_of_equation_3(law):
    for x in (0.0, 0.03, 0.1):
        for v in V:
            bell = np.exp(-((v / 0.09) ** 2))
            expected = -2.0 * 90.0 * (1.0 - x / 0.1) * abs(v) / 0.09**2 * bell + 60.0
            slope = stribeck_slope(JOINTS[law], v, position_m=x)
            assert slope == pytest.approx(expected, rel=1e-12, abs=1e-11)


def test_backward_the_slope_is_that_of_the_weaker_friction():
    joint = JOINTS["lugre"].model_copy(update={"backward_ratio": 0.5, "viscous_n_s_per_m": 0.0})
    forward, backward = (stribeck_slope(joint, v) for v in (0.05, -0.05))
    assert backward == pytest.approx(0.5 * forward, rel=1e-13)
    force = steady_force(joint, [0.05, -0.05])
    assert force[1] == pytest.approx(-0.5 * force[0], rel=1e-13)


@pytest.mark.parametrize("law", WITH_CURVE)
@pytest.mark.parametrize("v_s", [1e-9, 3e-4, 0.09, 50.0])
def test_friction_changes_most_steeply_at_the_stribeck_velocity_over_root_two(law, v_s):
    joint = JOINTS[law].model_copy(
        update={"stribeck_velocity_m_per_s": v_s, "viscous_n_s_per_m": 0.0}
    )
    assert steepest_change_velocity(joint) == pytest.approx(v_s / np.sqrt(2.0), rel=1e-14)
    assert steepest_fall_velocity(joint) == steepest_change_velocity(joint)
    rising = joint.model_copy(update={"coulomb_n": 500.0})
    assert steepest_change_velocity(rising) == pytest.approx(v_s / np.sqrt(2.0), rel=1e-14)
    assert steepest_fall_velocity(rising) is None


@pytest.mark.parametrize("law", JOINTS)
def test_friction_that_does_not_fall_has_no_steepest_fall(law):
    flat = JOINTS[law].model_copy(update={"stiction_n": 360.0})
    assert steepest_change_velocity(flat) is None
    assert steepest_fall_velocity(flat) is None
    viscous = {"viscous_n_s_per_m": 1e6} if law != "two_region" else {}
    assert steepest_fall_velocity(JOINTS[law].model_copy(update=viscous)) is None


@pytest.mark.parametrize(
    ("law", "rate", "lead", "damping"),
    [
        ("lugre", 3.6e7, 9000.0, 9000.0),
        ("elasto_plastic", 3.6e7, 9000.0, 9000.0),
        ("gms", None, 0.0, 9000.0),
        ("coulomb_stiction", np.inf, None, 0.0),
    ],
)
def test_how_friction_follows_a_change_of_the_speed(law, rate, lead, damping):
    """Rate k_e v / g and lead c v / g of a bristle; C / g and none of elements."""
    v, fading = 0.06, np.exp(-((0.06 / 0.3) ** 2))
    found, g = steady_friction(JOINTS[law], v), by_hand(0.0, v)
    rate = 1e6 / g if rate is None else rate * v / g
    lead = 1.0 if lead is None else lead * fading * v / g
    assert found.rate_per_s == pytest.approx(rate, rel=1e-13)
    assert found.lead == pytest.approx(lead, rel=1e-13)
    assert found.damping_n_s_per_m == pytest.approx(damping * fading, rel=1e-13)


@pytest.mark.parametrize("law", JOINTS)
def test_the_breakaway_force_falls_along_the_guide(law):
    expected = 450.0 + (9.81 - 450.0) * X / 0.1
    found = breakaway_force(JOINTS[law], X)
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    assert breakaway_force(JOINTS[law], -0.01) == 450.0
    assert has_bristles(JOINTS[law]) == (law != "coulomb_stiction")
    assert has_elements(JOINTS[law]) == (law == "gms")


OPEN = JOINTS["gms"].model_copy(update={"residual_n": None})


def test_an_open_residual_force_matters_beyond_the_seat_alone():
    assert steady_friction(OPEN, 0.0).level_n == 450.0
    assert stribeck_slope(OPEN, 0.05, position_m=0.03) == pytest.approx(
        stribeck_slope(JOINTS["gms"], 0.05, position_m=0.03), rel=1e-13
    )


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda j: steady_friction(j, np.inf), r"^velocity_m_per_s: inf is not finite; give"),
        (lambda j: steady_force(j, [0.1, np.nan]), r"^velocity_m_per_s: nan is not finite; give"),
        (lambda j: steady_force(j, 0.1, position_m=0.2), r"^position_m: 0\.2 is not within"),
        (lambda j: stribeck_slope(j, 0.1, position_m=-1.0), r"^position_m: -1\.0 is not within"),
        (lambda _: steady_friction(OPEN, 0.1, position_m=0.01), r"^joint\.residual_n: is missing"),
        (lambda _: breakaway_force(OPEN, 0.0), r"^joint\.residual_n: is missing; give"),
    ],
)
def test_what_is_out_of_range_is_refused(call, said):
    with pytest.raises(bk.ScenarioError, match=said):
        call(JOINTS["gms"])


@pytest.mark.parametrize(
    "given", ["paper_as_computed", None, bk.load_scenario("paper_as_computed")]
)
def test_what_is_no_joint_is_refused(given):
    askers = (
        steepest_fall_velocity,
        steepest_change_velocity,
        has_bristles,
        has_elements,
        lambda given: stribeck_slope(given, 0.1),
        lambda given: steady_friction(given, 0.1),
        lambda given: steady_force(given, 0.1),
        lambda given: breakaway_force(given, 0.0),
        lambda given: bk.impose_motion(given, [0.1], period_s=1e-3),
    )
    for ask in askers:
        with pytest.raises(bk.ScenarioError, match=r"^joint: .* is not a joint; give") as refused:
            ask(given)
        assert "\n" not in str(refused.value)
