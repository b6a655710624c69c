"""Faults of a log: named, and parameters stay right or are taken back; sound logs have none."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from breakaway.measure.identification import Cascade, Identification, identify
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.logs import Log

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/05_own_rig_log"))

from families import log_of

AT_PART = RigFile(position_sensor="part")


def kinds(found: Identification) -> set[str]:
    return {one.kind for one in found.faults}


def late(log: Log, rows: int) -> Log:
    return Log(t_s=log.t_s[rows:], position_m=log.position_m[:-rows], force_n=log.force_n[rows:])


def told_within(found: Identification, name: str, truth: float) -> bool:
    """Whether a parameter's interval holds the truth, or the log is said not to tell it."""
    one = found[name]
    return not one.identifiable or one.low <= truth <= one.high


@pytest.fixture(scope="module")
def heavy(rig: Any, lugre: dict[str, float]) -> Log:
    """Give a log of a part whose inertia shows, and whose bristle is hardly damped."""
    truth = lugre | {"mass_kg": 20.0, "damping_n_s_per_m": 1.0, "stiffness_n_per_m": 2e5}
    log: Log = rig(**truth).moved(3000, 1000.0, force_noise_n=0.1)
    return log


def test_a_sound_log_has_no_fault(rich_fit: Identification, heavy: Log) -> None:
    assert not rich_fit.faults
    assert not identify(heavy, starts=2).faults


def test_a_position_that_is_5_ms_late_is_modeled(heavy: Log) -> None:
    """Without the delay the stiffness came out 57 % too high, viscous friction 46 % too low."""
    found = identify(late(heavy, 5), starts=2, rig=AT_PART)
    assert "delay" in kinds(found)
    assert any("delay: the position is late by about" in note for note in found.notes)
    assert found["delay_s"].value == pytest.approx(5e-3, abs=3e-4)
    assert found["viscous_n_s_per_m"].value == pytest.approx(60.0, rel=0.1)
    assert told_within(found, "stiffness_n_per_m", 2e5)
    assert found["mass_kg"].value == pytest.approx(20.0, rel=0.05)


def test_a_delay_that_looks_like_damping_takes_the_damping_back(rich: Log) -> None:
    found = identify(rich, starts=2)
    damping = found["damping_n_s_per_m"]
    assert not found.faults and not damping.identifiable
    assert damping.low == 0.0 and damping.high > 150.0
    assert "looks the same; hold delay_s at 0 where one clock stamps" in damping.remark
    assert identify(rich, starts=2, fixed={"delay_s": 0.0})["damping_n_s_per_m"].identifiable


def test_a_drift_of_the_force_is_modeled(rich: Log) -> None:
    drift_n_per_s = 6.0 / rich.t_s[-1]
    found = identify(replace(rich, force_n=rich.force_n + drift_n_per_s * rich.t_s), starts=2)
    assert kinds(found) == {"drift"}
    assert found["drift_n_per_s"].value == pytest.approx(drift_n_per_s, rel=0.1)
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.03)
    assert found["offset_n"].value == pytest.approx(1.5, abs=0.2)


@pytest.mark.parametrize("case", [1, 2])
def test_friction_that_warms_is_modeled(case: int) -> None:
    truth, log = log_of("warming", "lugre", case)
    found = identify(log, starts=2, rig=AT_PART)
    assert "warming" in kinds(found)
    assert told_within(found, "coulomb_n", truth.coulomb_n)
    assert found["warming_per_s"].value == pytest.approx(truth.warming_per_s, rel=0.2)


@pytest.mark.parametrize("case", [1, 2])
def test_backlash_does_not_soften_the_bristle(case: int) -> None:
    """Without it the stiffness came out at 0.15 to 0.4 of the truth, and was told."""
    truth, log = log_of("backlash", "lugre", case)
    found = identify(log, starts=2, rig=AT_PART)
    assert "backlash" in kinds(found)
    assert found["backlash_m"].value == pytest.approx(20e-6, rel=0.2)
    assert told_within(found, "stiffness_n_per_m", truth.stiffness_n_per_m)


def test_single_samples_that_stand_out_are_left_out_and_named(rich: Log) -> None:
    force = rich.force_n.copy()
    force[[300, 900]] = 9999.0
    found = identify(replace(rich, force_n=force), starts=2)
    assert kinds(found) == {"spikes"}
    assert any("force_n: 2 single-sample spikes, at 0.3, 0.9 s" in note for note in found.notes)
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.03)
    assert found.rms_error < 0.3


def test_a_position_in_millimeters_that_is_called_meters_is_named(rich: Log) -> None:
    found = identify(replace(rich, position_m=1e3 * rich.position_m), law="lugre", starts=2)
    assert kinds(found) == {"units"}
    assert any("is the position in mm" in str(one) for one in found.faults)


def test_a_plausibility_line_stands_beside_every_fit(rich_fit: Identification) -> None:
    line = rich_fit.notes[-1]
    assert "friction level 20" in line or "friction level 19" in line
    assert "stiffness" in line and "deflection before sliding" in line


def test_a_known_outside_force_belongs_to_the_drive(
    rig: Any, drives: Any, lugre: dict[str, float]
) -> None:
    """Pulses beside the drive, as EMPS has them in its second record."""
    truth = lugre | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    pulses = np.where(np.arange(1200) % 300 < 100, 15.0, 0.0)
    alone = drives["cascade"](1000.0)
    log = rig(**truth).driven(
        1200, 1000.0, lambda row, x: alone(row, x) + float(pulses[row]), force_noise_n=0.05
    )
    measured = Log(
        position_m=log.position_m,
        force_n=log.force_n - pulses,
        reference_m=log.reference_m,
        channels={"outside_force_n": pulses},
        t_s=log.t_s,
    )
    cascade = Cascade(position_gain_per_s=60.0, velocity_gain_n_s_per_m=400.0, force_limit_n=100.0)
    asked = {"motion": "closed_loop", "controller": cascade, "steps_per_row": 2, "starts": 2}
    found = identify(measured, **asked)
    blind = identify(replace(measured, channels=without(measured, "outside_force_n")), **asked)
    assert found.relative_error_percent < 2.0 < blind.relative_error_percent
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.02)
    assert found["mass_kg"].value == pytest.approx(3.0, rel=0.02)


def without(log: Log, name: str) -> dict[str, Any]:
    return {key: one for key, one in log.channels.items() if key != name}
