"""The formulas against a contact that is stepped by return mapping, and against their limits."""

from math import pi, sin, sqrt

import numpy as np
import pytest
from scipy.special import ellipk

import known_answers as known

STEPS = 20_000


def stepped(moves, levels, cycles, start=0.0):
    """Mean over the last of some cycles of a spring that follows moves, up to a level."""
    z, total = start, 0.0
    for n in range(cycles * STEPS):
        z = min(levels[n % STEPS], max(-levels[n % STEPS], z + moves[n % STEPS]))
        total += z if n >= (cycles - 1) * STEPS else 0.0
    return total / STEPS


@pytest.mark.parametrize(
    ("speed", "softness"),
    [(0.3, 0.05), (0.7, 0.02), (0.5, 2.0), (0.05, 1.5), (0.9, 0.3), (1.2, 1.0)],
)
def test_elastic_contact_along_the_motion(speed, softness):
    p = np.linspace(0.0, 2 * pi, STEPS + 1)
    moves = np.diff(speed * p + np.sin(p)).tolist()
    found = stepped(moves, [softness] * STEPS, 8) / softness
    assert known.tangential_elastic(speed, softness) == pytest.approx(found, abs=2e-6)


@pytest.mark.parametrize(
    ("amplitude", "speed"), [(0.6, 0.3), (0.9, 0.8), (0.6, 1.3), (1.5, 0.2), (1.5, 0.9), (3.0, 0.7)]
)
def test_elastic_contact_under_normal_vibration(amplitude, speed):
    p = np.linspace(0.0, 2 * pi, STEPS + 1)[1:]
    levels = np.maximum(0.0, 1 - amplitude * np.cos(p)).tolist()
    moves = [amplitude * speed * 2 * pi / STEPS] * STEPS
    found = stepped(moves, levels, 4, start=levels[-1])
    assert known.normal(amplitude, speed) == pytest.approx(found, abs=2e-4)


def test_slow_limits_are_the_static_ones():
    assert known.tangential_elastic(1e-6, 2.0) == pytest.approx(1 - 1 / 2.0, abs=1e-3)
    assert known.tangential_elastic(1e-6, 0.9) == pytest.approx(0.0, abs=1e-3)
    assert known.normal(0.6, 1e-6) == pytest.approx(known.normal_static(0.6), abs=1e-3)


def test_stiff_limits_are_the_rigid_ones():
    for speed in (0.2, 0.5, 0.9):
        rigid = known.tangential(speed)
        assert known.tangential_elastic(speed, 1e-5) == pytest.approx(rigid, rel=1e-3)
        assert known.transverse_elastic(speed, 1e-3) == pytest.approx(
            known.transverse(speed), rel=1e-3
        )


def test_transverse_is_the_mean_that_it_says():
    p = (np.arange(4096) + 0.5) / 4096 * 2 * pi
    for speed in (0.3, 1.0, 3.0):
        mean = np.mean(speed / np.hypot(speed, np.cos(p)))
        assert known.transverse(speed) == pytest.approx(mean, rel=1e-9)
    assert known.transverse(1.0) == pytest.approx(2 / pi / sqrt(2) * ellipk(0.5))


@pytest.mark.parametrize(("push", "amplitude"), [(0.6, 0.79), (0.6, 0.85), (0.3, 2.0), (0.9, 1.5)])
def test_creep_is_that_of_an_element_in_the_plane(push, amplitude):
    """Stepped: the part goes as far as keeps z_x at the push."""
    y, gone, before = 0.0, 0.0, amplitude
    for n in range(1, 4 * STEPS + 1):
        if n == 3 * STEPS + 1:
            gone = 0.0
        across = amplitude * sin(2 * pi * n / STEPS + pi / 2)
        y, before = y + across - before, across
        limit = sqrt(1 - push**2)
        if abs(y) > limit:
            gone += (abs(y) - limit) * push / limit
            y = limit if y > 0 else -limit
    assert known.creep_per_cycle(push, amplitude) == pytest.approx(gone, abs=1e-9)
