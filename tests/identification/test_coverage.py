"""The study of coverage: what it simulates is friction, and what it prints adds up."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

STUDY = Path(__file__).parents[2] / "examples/05_own_rig_log"
sys.path.insert(0, str(STUDY))

from families import FAMILIES, log_of  # noqa: E402

from friction import LAWS, Levels  # noqa: E402

JOINT = Levels(
    coulomb_n=10.0,
    viscous_n_s_per_m=0.0,
    stiction_ratio=1.5,
    stribeck_velocity_m_per_s=0.01,
    stiffness_n_per_m=1e6,
    damping_n_s_per_m=0.0,
)


@pytest.mark.parametrize("law", list(LAWS))
def test_a_law_is_a_spring_first_and_slides_at_its_level(law: str) -> None:
    joint = LAWS[law](JOINT)
    assert joint.move(1e-9, 1e-4) == pytest.approx(1e-3, rel=0.01)
    for _ in range(1000):
        force = joint.move(1e-5, 1e-4)  # 0.1 m/s, ten times v_s
    assert force == pytest.approx(10.0, rel=1e-3)


@pytest.mark.parametrize("family", list(FAMILIES))
def test_a_family_gives_a_log(family: str) -> None:
    truth, log = log_of(family, "two_regions", 1)
    assert log.rows >= 1000 and np.isfinite(log.force_n).all()
    assert np.ptp(log.position_m) > 50.0 * truth.position_quantum_m or "presliding" in family


@pytest.mark.slow
def test_the_study_prints_each_family_that_it_was_asked() -> None:
    asked = ["--cases", "1", "--family", "one-way", "--family", "presliding only"]
    command = [sys.executable, str(STUDY / "coverage.py"), *asked]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    one_way, presliding = shown.split("presliding only: 4 logs")
    assert "one-way: 4 logs" in one_way and "coulomb_plus_offset_n" in one_way
    assert "stiffness_n_per_m" in presliding and "coulomb_n " in presliding
