"""Sliding friction under vibration along the motion, from a scenario: a feed that grips its part.

Coulomb friction F_c of a part that is moved at v + v_a cos(w t) points to and fro. Its mean over a
period is F_c (2 / pi) asin(v / v_a) for v < v_a, and F_c beyond.
"""

from math import acos, asin, pi, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

import breakaway as bk

FRICTION_N = 360.0
STROKE_M = 4e-5
FREQUENCY_HZ = 100.0
AMPLITUDE_M_PER_S = pi * FREQUENCY_HZ * STROKE_M
"""v_a of a stroke d (1 - cos(w t)) / 2."""
PERIODS = 20
STIFF = {"stiffness_n_per_m": 1e12, "damping_n_s_per_m": 3e6}
STACK = bk.Piezo(
    **STIFF,
    stroke_m=STROKE_M,
    tip_mass_kg=0.1,
    preload_n=800.0,
    capacitance_f=1e-6,
    voltage_max_v=120.0,
    current_max_a=10.0,
    amplifier_bandwidth_hz=2e4,
)
"""The amplifier is slow beside a control period, so the tip does not follow the stairs of commands
that are held for one: the closed forms know a sine only."""


def sliding(share, backlash_m=0.0):
    """A part that is fed at a share of v_a while the stack goes through its whole stroke as a sine.

    Pulses as long as their period are one; the ratio is so large that all of them are full.
    """
    feed_m_per_s = share * AMPLITUDE_M_PER_S
    return bk.load_scenario("paper_as_computed").with_(
        {
            "timing.control_period_s": 2e-6,
            "timing.duration_s": (2 + PERIODS) / FREQUENCY_HZ,
            "disturbance.var": 0.0,
            "trace.every_samples": 1,
        },
        joint=bk.CoulombStiction(
            stiction_n=FRICTION_N,
            coulomb_n=FRICTION_N,
            residual_n=FRICTION_N,
            stribeck_velocity_m_per_s=0.09,
            engagement_length_m=0.1,
        ),
        actuator=bk.FeedAxis(
            **STIFF,
            speed_max_m_per_s=1.0,
            acceleration_max_m_per_s2=1e6,
            tool_mass_kg=10.0,
            tip=STACK,
            contact=bk.Contact(**STIFF, backlash_m=backlash_m),
        ),
        controller=bk.VibratedFeed(
            feed=bk.FeedSettings(
                speed_m_per_s=feed_m_per_s, approach_m_per_s=feed_m_per_s, approach_s=0.0
            ),
            pulses=bk.StackPulses(
                frequency_hz=FREQUENCY_HZ,
                pulse_width_s=1.0 / FREQUENCY_HZ,
                amplitude_ratio=1e4,
                stack_force_n=1000.0,
                force_filter_s=1.0,
            ),
        ),
    )


def mean_friction_n(scenario):
    """The mean of the last whole periods."""
    trace = bk.simulate(scenario).trace
    samples = round(PERIODS / FREQUENCY_HZ / scenario.timing.control_period_s)
    return np.mean(trace["joint_force_n"][-1 - samples : -1])


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9, 1.2])
def test_mean_friction_of_a_gripped_part_is_that_of_the_arcsine(share):
    """Found: within 7.1e-5."""
    expected = FRICTION_N * (2 / pi) * asin(min(share, 1.0))
    assert mean_friction_n(sliding(share)) == pytest.approx(expected, rel=2e-4)


def test_a_tip_that_only_pushes_leaves_its_part_behind():
    """It stops where cos p = -s and waits until the tip is back; friction acts while it moves.

    Then it falls with the force of axis, stack and contact, as the tip draws back: by a t^2 / 2
    through 3 / k. Found: within 1.0e-4.
    """
    share, omega = 0.5, 2 * pi * FREQUENCY_HZ
    stops = pi - acos(share)
    back = brentq(lambda p: share * (p - stops) + sin(p) - sin(stops), 1.5 * pi, 2 * pi)
    moving = 1.0 - (back - stops) / (2 * pi)
    drawn_back_m = FRICTION_N * 3 / STIFF["stiffness_n_per_m"]
    relaxing_s = sqrt(2 * drawn_back_m / (AMPLITUDE_M_PER_S * omega * sin(stops)))
    expected = FRICTION_N * (moving + 2 / 3 * relaxing_s * FREQUENCY_HZ)
    assert mean_friction_n(sliding(share, backlash_m=None)) == pytest.approx(expected, rel=5e-4)
