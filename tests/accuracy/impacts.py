"""Peaks of impacts on a part that does not move, against their closed form ``w sqrt(k m)``.

A tool on an axis so soft that it flies freely: the drive moves at half of w, so the tool swings to
w and is there, without any force of the axis on it, when it touches.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import ceil, pi, sqrt

from tests.accuracy.steps import at_steps, steps_of

import breakaway as bk

TOOLS_KG = (0.1, 0.5, 5.0, 50.0)
CONTACTS_N_PER_M = (1e7, 1e8, 2e8, 1e9)
PERIODS_S = (1e-5, 5e-5, 2e-4, 1e-3)
SPEED_M_PER_S = 0.1
"""w, the speed at which the tool strikes."""
SOFTNESS = 1e-6
"""Stiffness of the axis over that of the contact."""
CLOSE = 1e-2
"""Error that a peak may have."""


@dataclass(frozen=True)
class Impact:
    """A tool, a contact and a clock, with the peak's relative error at so many steps."""

    tool_kg: float
    contact_n_per_m: float
    period_s: float
    steps: int
    error: float


def impact_scenario(tool_kg: float, contact_n_per_m: float, period_s: float) -> bk.Scenario:
    """A tool that strikes a part which nothing can free, at its default steps."""
    axis = SOFTNESS * contact_n_per_m
    swing_s = pi * sqrt(tool_kg / axis)
    duration_s = swing_s + 4 * pi * sqrt(tool_kg / contact_n_per_m)
    joint = bk.CoulombStiction(
        stiction_n=1e9,
        coulomb_n=1e9,
        stribeck_velocity_m_per_s=0.1,
        engagement_length_m=1.0,
        residual_n=1e9,
    )
    return bk.Scenario(
        joint=joint,
        part=bk.Part(mass_kg=1.0),
        reference=bk.StepReference(distance_m=0.1),
        actuator=bk.FeedAxis(
            speed_max_m_per_s=1.0,
            acceleration_max_m_per_s2=1e7,
            stiffness_n_per_m=axis,
            damping_n_s_per_m=0.0,
            tool_mass_kg=tool_kg,
            contact=bk.Contact(
                stiffness_n_per_m=contact_n_per_m,
                damping_n_s_per_m=0.0,
                gap_m=0.5 * SPEED_M_PER_S * swing_s,
            ),
        ),
        controller=bk.SteadyFeed(
            speed_m_per_s=0.5 * SPEED_M_PER_S, approach_m_per_s=1.0, approach_s=0.0
        ),
        timing=bk.Timing(
            duration_s=ceil(duration_s / period_s) * period_s,
            control_period_s=period_s,
        ),
        trace=bk.Trace(every_samples=0),
    )


def strike(scenario: bk.Scenario, steps: int) -> Impact:
    """Strike once; give the peak's error."""
    actuator = scenario.actuator
    contact = actuator.contact.stiffness_n_per_m
    exact_n = SPEED_M_PER_S * sqrt(contact * actuator.tool_mass_kg)
    peak_n = bk.simulate(at_steps(scenario, steps)).metrics.peak_force_n
    period_s, error = scenario.timing.control_period_s, abs(peak_n / exact_n - 1.0)
    return Impact(actuator.tool_mass_kg, contact, period_s, steps, error)


def strike_all() -> Iterator[Impact]:
    """Every tool on every contact by every clock, at the default steps."""
    for numbers in product(TOOLS_KG, CONTACTS_N_PER_M, PERIODS_S):
        scenario = impact_scenario(*numbers)
        yield strike(scenario, steps_of(scenario))
