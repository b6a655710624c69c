"""Vibration across the motion."""

import pytest
from vibrated_contact import (
    DAMPED,
    across,
    creep,
    mean_friction,
    pushed,
    shaken_across,
    static_friction,
)

import known_answers as known


@pytest.mark.parametrize("speed", [0.3, 0.7, 1.5])
def test_mean_friction_of_a_contact_that_is_rigid_enough(speed):
    """Found: within 1.5e-4, most of it what is left of its springs."""
    assert mean_friction(across(speed, 0.005)) == pytest.approx(known.transverse(speed), rel=5e-4)


@pytest.mark.parametrize(
    ("speed", "softness"), [(0.3, 0.05), (0.3, 0.4), (0.5, 2.0), (0.1, 1.5), (0.9, 0.3)]
)
def test_mean_friction_of_an_elastic_contact(speed, softness):
    """Found: within 5.2e-4; the last 0.02 % of the level are not quite plastic."""
    formula = known.transverse_elastic(speed, softness)
    assert mean_friction(across(speed, softness)) == pytest.approx(formula, rel=1e-3)


@pytest.mark.parametrize(("push", "amplitude"), [(0.6, 1.0), (0.6, 3.0), (0.3, 2.0), (0.8, 1.5)])
def test_a_push_below_the_friction_creeps(push, amplitude):
    """In every cycle, without any drift of the law. Found: within 2e-4."""
    found = creep(pushed(shaken_across(DAMPED, amplitude), push))
    assert found == pytest.approx(known.creep_per_cycle(push, amplitude), rel=1e-3)


@pytest.mark.parametrize("push", [0.3, 0.6, 0.9])
def test_below_the_shakedown_amplitude_it_comes_to_rest(push):
    limit = known.shakedown_amplitude(push)
    assert abs(creep(pushed(shaken_across(DAMPED, 0.995 * limit), push))) < 3e-5
    assert creep(pushed(shaken_across(DAMPED, 1.005 * limit), push)) > 1e-3


@pytest.mark.slow
def test_static_friction_that_is_searched_for():
    for softness in (1.2, 2.0, 4.0):
        found = static_friction(shaken_across(DAMPED, 1 / softness))
        assert found == pytest.approx(known.transverse_static(softness), rel=1e-3)
