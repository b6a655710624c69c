"""Vibration along the motion. For a rigid contact: tests/physics/test_vibrated_sliding.py."""

import pytest
from vibrated_contact import ELASTIC, along, mean_friction

import known_answers as known


@pytest.mark.parametrize(
    ("speed", "softness"), [(0.3, 0.05), (0.3, 0.4), (0.5, 2.0), (0.1, 1.5), (0.9, 0.3)]
)
def test_mean_friction_of_an_elastic_contact(speed, softness):
    """Found: within 1.3e-4."""
    found = mean_friction(along(ELASTIC, speed, softness))
    assert found == pytest.approx(known.tangential_elastic(speed, softness), rel=5e-4)
    assert abs(found / known.tangential(speed) - 1) > 5e-3  # stiffness makes a difference
