"""Logs that tell little: one way, stick-slip, below breakaway; what each may say, and no more."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from breakaway.errors import LogError
from breakaway.measure.identification import Identification, JointFile, identify
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.logs import Log

Array = npt.NDArray[np.float64]
T_S = np.arange(4000) / 1000.0
AT_PART = RigFile(position_sensor="part")


def because(found: Identification) -> dict[str, str]:
    return {one.parameter: one.because for one in found.verdicts}


def noisy(x: Array, force: Array, noise_n: float, quantum_m: float) -> Log:
    rng = np.random.default_rng(7)
    return Log(
        t_s=np.arange(len(x)) / 1000.0,
        position_m=np.round(x / quantum_m) * quantum_m,
        force_n=force + noise_n * rng.standard_normal(len(x)),
    )


def extraction(direction: float = 1.0, offset_n: float = -25.0) -> Log:
    """Give a pull of 24.7 kg against 145 N that never comes back, most of its force inertia."""
    v = 0.1 + 0.095 * np.sin(30.0 * T_S - 1.5)
    a = 2.85 * np.cos(30.0 * T_S - 1.5)
    force = 145.0 + 120.0 * v + 24.7 * a
    x = 0.1 * T_S - 0.095 / 30.0 * np.cos(30.0 * T_S - 1.5)
    return noisy(direction * x, direction * force + offset_n, 1.0, 1e-7)


@pytest.fixture(scope="module")
def one_way() -> Identification:
    return identify(extraction(), law="stribeck", starts=2, rig=AT_PART)


def test_the_mass_of_an_extraction_is_found(one_way: Identification) -> None:
    mass = one_way["mass_kg"]
    assert mass.identifiable
    assert mass.low <= 24.7 <= mass.high
    assert mass.value == pytest.approx(24.7, rel=0.03)


def test_one_way_tells_the_sum_of_coulomb_and_offset_and_neither(one_way: Identification) -> None:
    assert not one_way["coulomb_n"].identifiable
    assert "only coulomb plus offset is told" in because(one_way)["coulomb_n"]
    assert one_way["coulomb_n"].low <= 145.0 <= one_way["coulomb_n"].high
    assert "offset_n" not in one_way.values and "held at 0" in because(one_way)["offset_n"]
    told = one_way.combined[0]
    assert (told.name, told.identifiable) == ("coulomb_plus_offset_n", True)
    assert told.low <= 120.0 <= told.high
    assert told.value == pytest.approx(120.0, rel=0.03)


def test_one_way_does_not_tell_the_peak_over_coulomb(one_way: Identification) -> None:
    assert not one_way["stiction_ratio"].identifiable
    with pytest.raises(LogError, match="coulomb_n is not identifiable"):
        JointFile.from_identification(one_way)


def test_a_pull_backward_tells_the_difference() -> None:
    found = identify(extraction(-1.0), law="coulomb", starts=1, rig=AT_PART)
    told = found.combined[0]
    assert told.name == "coulomb_minus_offset_n"
    assert told.value == pytest.approx(170.0, rel=0.03)


def test_a_known_offset_tells_the_level() -> None:
    fixed = {"offset_n": -25.0}
    found = identify(extraction(), law="coulomb", starts=1, fixed=fixed, rig=AT_PART)
    assert found["coulomb_n"].identifiable and not found.combined
    assert found["coulomb_n"].value == pytest.approx(145.0, rel=0.02)


def stick_slip() -> Log:
    """Give a part of 2 kg that sticks and slips behind a spring of 2e5 N/m, exactly LuGre."""
    mass, spring, drive, stiffness, damping = 2.0, 2e5, 0.02, 2e7, 4e3
    steps, x, v, z = 40, 0.0, 0.0, 0.0
    h, path, forces = 1e-3 / 40, [], []
    for row in range(3500):
        path.append(x)
        forces.append(spring * (drive * row * 1e-3 - x))
        for step in range(steps):
            pull = spring * (drive * (row * 1e-3 + step * h) - x)
            level = 1800.0 + 1000.0 * math.exp(-((v / 0.004) ** 2))
            slope = v - stiffness * abs(v) / level * z
            v += h * (pull - stiffness * z - damping * slope) / mass
            z += h * (v - stiffness * abs(v) / level * z)
            x += h * v
    return noisy(np.array(path), np.array(forces), 2.0, 1e-7)


def test_stick_slip_is_refused_with_a_reason() -> None:
    found = identify(stick_slip(), law="lugre", starts=2, rig=AT_PART)
    assert found.excitation.slips >= 3
    assert not any(one.identifiable for one in (*found.estimates, *found.combined))
    told = {one.parameter: one for one in found.verdicts}["coulomb_n"]
    assert "stick-slip: " in told.because and "look alike" in told.because
    assert "`breakaway events` tells the force" in told.remedy


def lugre(z: float, dx: float) -> tuple[float, float]:
    """Return deflection and force of a LuGre joint of 11 N and 1e6 N/m, once moved."""
    z += dx - 1e6 * abs(dx) / 11.0 * z
    return z, 1e6 * z


def maxwell(parts: Array, dx: float) -> tuple[Array, float]:
    """Return the forces of eight springs that each slip, and their sum."""
    limits = 11.0 * np.linspace(0.3, 1.7, 8) / 8.0
    parts = np.clip(parts + 1e6 / 8.0 * dx, -limits, limits)
    return parts, float(parts.sum())


def loaded(law: Callable[[Any, float], tuple[Any, float]], state: Any) -> Log:
    """Give a log of a joint of 11 N that is loaded with about 6 N, and never slides."""
    t_s = np.arange(32000) / 8000.0
    x = 7e-6 * np.sin(2.0 * np.pi * 0.8 * t_s)
    force = np.zeros_like(x)
    for step, dx in enumerate(np.diff(x), start=1):
        state, force[step] = law(state, float(dx))
    slow = 500.0 * np.gradient(x, t_s)
    return noisy(x[::8], (force + slow)[::8], 0.02, 1e-9)


@pytest.mark.parametrize("law", ["lugre", "maxwell"])
def test_below_breakaway_no_level_is_told(law: str) -> None:
    log = loaded(lugre, 0.0) if law == "lugre" else loaded(maxwell, np.zeros(8))
    found = identify(log, law="lugre", starts=2, rig=AT_PART)
    assert not found.excitation.broke_away
    assert not found["coulomb_n"].identifiable
    assert "never broke away; it held at least" in because(found)["coulomb_n"]
    assert 4.0 < found.excitation.held_n < 11.0
    assert "stiction_ratio" not in found.values
    assert found["stiffness_n_per_m"].value == pytest.approx(1e6, rel=0.2)


def test_slip_in_part_is_no_damping() -> None:
    found = identify(loaded(maxwell, np.zeros(8)), law="lugre", starts=2, rig=AT_PART)
    damping = [one for one in found.estimates if one.name == "damping_n_s_per_m"]
    assert not any(one.identifiable for one in damping)


def test_a_law_that_errs_at_turns_does_not_tell_its_bristle(rig: Any, lugre: Any) -> None:
    log = rig(**lugre | {"elastic_share": 0.8}).moved(1500, 1000.0, force_noise_n=0.1)
    found = identify(log, law="lugre", starts=2, rig=AT_PART)
    assert not found["stiffness_n_per_m"].identifiable
    assert "law 'elasto_plastic' explains the log better" in because(found)["stiffness_n_per_m"]
    assert found["coulomb_n"].low <= 20.0 <= found["coulomb_n"].high
    right = identify(log, law="elasto_plastic", starts=2, rig=AT_PART)
    assert right["stiffness_n_per_m"].identifiable
