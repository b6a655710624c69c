"""Short guides, so that parts are out within a second; an advice about them."""

from __future__ import annotations

import numpy as np
import pytest

import breakaway as bk


@pytest.fixture(scope="session")
def population() -> bk.PartPopulation:
    seized = bk.load_population("seized_parts")
    guides = {"engagement_length_m": bk.Uniform(low=0.002, high=0.004)}
    return seized.model_copy(
        update={"duration_s": 0.8, "parts": seized.parts.model_copy(update=guides)}
    )


@pytest.fixture(scope="session")
def limits() -> bk.HarmLimits:
    neck = bk.StressLimit(place="neck", section_m2=1e-5, allowed_pa=2e8)
    slot = bk.StressLimit(place="slot", of="host", bearing_area_m2=4e-5, allowed_pa=1e8)
    return bk.HarmLimits(stresses=[neck, slot], jump_max_m=2.5e-4, release_velocity_max_m_per_s=0.2)


@pytest.fixture(scope="session")
def advice(population: bk.PartPopulation, limits: bk.HarmLimits) -> bk.Advice:
    return bk.advise(population, "fast_force", limits, budget_s=1e6, parts_max=48, seed=1)


@pytest.fixture(scope="session")
def joint_file() -> bk.JointFile:
    """Give the joint of a log with Coulomb and viscous friction, which shows no peak."""
    t_s = np.arange(5000) / 1000.0
    v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    a = -1.5 * np.sin(5 * t_s) - 0.4 * np.sin(2 * t_s)
    log = bk.Log(
        t_s=t_s,
        position_m=0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s),
        force_n=3.0 * a + 25.0 * v + 300.0 * np.sign(v) + 2.0,
    )
    return bk.JointFile.from_fit(bk.identify_inertia_friction(log), log)
