"""Vibration normal to the joint."""

import pytest
from tests.known_answers.laws import GMS, TWO_REGION
from vibrated_contact import (
    DAMPED,
    RIGID,
    creep,
    mean_friction,
    pressed,
    pushed,
    shaken_normal,
    sprung,
    static_friction,
)

import known_answers as known


@pytest.mark.parametrize("amplitude", [0.2, 0.6, 0.9])
@pytest.mark.parametrize("joint", [RIGID, DAMPED, GMS, TWO_REGION], ids=lambda joint: joint.law)
def test_static_friction_is_what_the_lowest_normal_force_holds(joint, amplitude):
    """A push just below holds, one just above does not: within 1e-3 of mu N_0."""
    static, shaken = known.normal_static(amplitude), shaken_normal(joint, amplitude)
    assert abs(creep(pushed(shaken, static - 1e-3))) < 1e-4
    assert creep(pushed(shaken, static + 1e-3)) > 1e-4


def test_bodies_that_part_have_no_static_friction():
    assert creep(pushed(shaken_normal(RIGID, 1.1), 1e-3)) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("joint", [RIGID, DAMPED], ids=lambda joint: joint.law)
def test_static_friction_that_is_searched_for(joint):
    for amplitude in (0.2, 0.6, 0.9):
        found = static_friction(shaken_normal(joint, amplitude))
        assert found == pytest.approx(known.normal_static(amplitude), rel=1e-3)


@pytest.mark.parametrize(
    ("amplitude", "speed"),
    [(0.6, 0.3), (0.5, 0.1), (0.9, 0.8), (0.6, 1.3), (1.5, 0.3), (1.5, 0.9)],
)
def test_mean_friction_of_an_elastic_contact(amplitude, speed):
    """Its bristle lets go as its level falls. Found: within 1.5e-4."""
    found = mean_friction(pressed(amplitude, speed))
    assert found == pytest.approx(known.normal(amplitude, speed), rel=5e-4)


@pytest.mark.parametrize(("amplitude", "speed"), [(0.6, 0.3), (0.5, 0.1), (0.9, 0.8)])
def test_mean_friction_of_a_rigid_contact_behind_a_spring(amplitude, speed):
    """A light part behind a soft axis is that contact, the better the lighter: 4e-5 at 10 g."""
    formula = known.normal(amplitude, speed)
    heavy, light = (
        abs(mean_friction(sprung(amplitude, speed, mass_kg=mass_kg)) / formula - 1)
        for mass_kg in (0.16, 0.01)
    )
    assert light < 1e-4
    assert light < 0.3 * heavy
