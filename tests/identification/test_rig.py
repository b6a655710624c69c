"""A rig in the log: its compliance, mass, filter and load cell, taken off or told as uncertain."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from breakaway.errors import LogError, ScenarioError
from breakaway.measure.identification import (
    Identification,
    JointFile,
    RigFile,
    find_breakaway_events,
    fit_population,
    identify,
)
from breakaway.measure.logs import Log

Array = npt.NDArray[np.float64]

AXIS_N_PER_M = 3e6
JOINT_N_PER_M = 3.6e7
TRUTH = {
    "coulomb_n": 360.0,
    "viscous_n_s_per_m": 2000.0,
    "stiction_ratio": 1.25,
    "stribeck_velocity_m_per_s": 1e-3,
    "stiffness_n_per_m": JOINT_N_PER_M,
    "damping_n_s_per_m": 9000.0,
}
AXIS = RigFile(stiffness_n_per_m=AXIS_N_PER_M, stiffness_error_n_per_m=3e3)


def behind_an_axis(rig: Any) -> Log:
    """A part that is moved to and fro within 2 mm; its position is measured at the drive."""
    rate, rows, substeps = 1000.0, 4000, 8
    joint, h, z = rig(**TRUTH), 1.0 / rate / substeps, 0.0
    fast, slow = 2 * np.pi * 1.7, 2 * np.pi * 0.5

    def moved(t: float) -> tuple[float, float]:
        x = 1.5e-3 * np.sin(slow * t) + 0.6e-3 * np.sin(fast * t + 1.0)
        return x, 1.5e-3 * slow * np.cos(slow * t) + 0.6e-3 * fast * np.cos(fast * t + 1.0)

    def slope(t: float, z: float) -> float:
        return float(joint.friction(*moved(t), z)[1])

    rows_x, rows_f = [], []
    for row in range(rows):
        x, v = moved(row / rate)
        rows_x.append(x)
        rows_f.append(joint.friction(x, v, z)[0])
        for step in range(substeps):
            t = row / rate + step * h
            k1 = slope(t, z)
            k2 = slope(t + h / 2, z + h / 2 * k1)
            k3 = slope(t + h / 2, z + h / 2 * k2)
            z += h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(t + h, z + h * k3))
    rng = np.random.default_rng(0)
    force = np.array(rows_f)
    position = np.array(rows_x) + force / AXIS_N_PER_M
    return Log(
        t_s=np.arange(rows) / rate,
        position_m=position + 1e-7 * rng.standard_normal(rows),
        force_n=force + 3.0 * rng.standard_normal(rows),
    )


@pytest.fixture(scope="module")
def axis_log(rig: Any) -> Log:
    return behind_an_axis(rig)


@pytest.fixture(scope="module")
def with_axis(axis_log: Log) -> Identification:
    return identify(axis_log, rig=AXIS, starts=2)


def test_a_joint_behind_an_axis_is_a_bound_from_below(axis_log: Log) -> None:
    found = identify(axis_log, starts=2)
    in_series = 1.0 / (1.0 / JOINT_N_PER_M + 1.0 / AXIS_N_PER_M)
    stiffness = found["stiffness_n_per_m"]
    assert stiffness.value == pytest.approx(in_series, rel=0.1)
    assert not (stiffness.identifiable and np.isfinite(stiffness.high))
    assert any("is a bound from below: the stiffness of joint and rig" in n for n in found.notes)


def test_the_stiffness_of_the_joint_is_told_with_the_rigs(with_axis: Identification) -> None:
    stiffness = with_axis["stiffness_n_per_m"]
    assert stiffness.identifiable and stiffness.remark == ""
    assert stiffness.value == pytest.approx(JOINT_N_PER_M, rel=0.05)
    assert stiffness.low < JOINT_N_PER_M < stiffness.high < 1.1 * JOINT_N_PER_M
    ratio = with_axis["stiction_ratio"]
    assert ratio.identifiable and ratio.low < 1.25 < ratio.high
    assert not any("bound from below" in note for note in with_axis.notes)


def test_without_a_rig_file_a_stiffness_has_no_upper_end(rich_fit: Identification) -> None:
    stiffness = rich_fit["stiffness_n_per_m"]
    assert stiffness.identifiable and stiffness.high == np.inf
    assert stiffness.low < 5e4
    verdict = next(one for one in rich_fit.verdicts if one.parameter == "stiffness_n_per_m")
    assert verdict.because.startswith(f"at least {stiffness.low:.4g}: a bound from below")
    kept = JointFile.from_identification(rich_fit)
    assert kept.interval["stiffness_n_per_m"] == [stiffness.low, np.inf]


def test_a_joint_file_keeps_the_rig(with_axis: Identification, tmp_path: Path) -> None:
    JointFile.from_identification(with_axis).save(tmp_path / "joint.toml")
    kept = JointFile.load(tmp_path / "joint.toml")
    assert kept.provenance.fit is not None and kept.provenance.fit.rig == AXIS


def test_a_rig_that_is_hardly_known_leaves_the_stiffness_open(axis_log: Log) -> None:
    vague = RigFile(stiffness_n_per_m=AXIS_N_PER_M, stiffness_error_n_per_m=3e5)
    stiffness = identify(axis_log, rig=vague, starts=2)["stiffness_n_per_m"]
    assert stiffness.high == np.inf and stiffness.low < JOINT_N_PER_M
    assert "leaves the joint's open" in stiffness.remark


def test_a_position_at_the_part_needs_no_stiffness(rich: Log) -> None:
    found = identify(rich, rig=RigFile(position_sensor="part"), starts=4)
    stiffness = found["stiffness_n_per_m"]
    assert stiffness.low < 5e4 < stiffness.high < 1e5


def test_the_gain_of_the_load_cell_is_in_every_force(rich: Log) -> None:
    sure = identify(rich, rig=RigFile(position_sensor="part"), starts=4)
    gain = RigFile(position_sensor="part", force_calibration_percent=2.0)
    unsure = identify(rich, rig=gain, starts=4)
    for one in unsure.estimates:
        exact = sure[one.name]
        assert one.value == exact.value
        if one.name in ("stiction_ratio", "stribeck_velocity_m_per_s"):
            assert (one.low, one.high) == (exact.low, exact.high)
            continue
        expected = np.hypot(exact.standard_error, 0.02 * abs(one.value))
        assert one.standard_error == pytest.approx(expected, rel=1e-6)
        half = 0.5 * (one.high - one.low)
        assert half >= 0.99 * 1.96 * 0.02 * abs(one.value)
    drawn = unsure.draws(4000)
    assert np.std(drawn["coulomb_n"]) == pytest.approx(unsure["coulomb_n"].standard_error, rel=0.1)


def test_mass_behind_the_load_cell_is_taken_off(rig: Any, lugre: dict[str, float]) -> None:
    log = rig(**{**lugre, "mass_kg": 8.0}).moved(1500, 1000.0, force_noise_n=0.1)
    clamp = RigFile(position_sensor="part", mass_kg=5.0, mass_error_kg=0.3)
    found = (identify(log, rig=one, free=["mass_kg"], starts=4) for one in (None, clamp))
    whole, part = (one["mass_kg"] for one in found)
    assert whole.value == pytest.approx(8.0, rel=0.01)
    assert part.value == pytest.approx(whole.value - 5.0, abs=1e-3)
    assert part.standard_error == pytest.approx(np.hypot(whole.standard_error, 0.3), rel=0.01)
    assert part.low < 3.0 < part.high


@pytest.mark.parametrize(
    ("motion", "rig_file", "words"),
    [
        ("closed_loop", AXIS, "stiffness_n_per_m cannot be taken off motion 'closed_loop'"),
        ("free", RigFile(mass_kg=1.0), "mass_kg is part of the mass that motion 'free' finds"),
    ],
)
def test_what_cannot_be_taken_off_is_refused(
    looped: Log, motion: Any, rig_file: RigFile, words: str
) -> None:
    with pytest.raises(LogError, match=words):
        identify(looped, motion=motion, rig=rig_file)


# Events


def pull(
    breakaway_n: float = 90.0, rate_hz: float = 1000.0, lowpass: Callable[[Array], Array] = np.copy
) -> Log:
    """A pull at 100 N/s that breaks loose within 1 ms, sampled at a rate after a filter."""
    t = np.arange(0.0, 4.0, 1e-4)
    slip = 0.5 + breakaway_n / 100.0
    force = np.where(t < slip, np.clip(100.0 * (t - 0.5), 0.0, None), 40.0)
    x = 0.01 * np.maximum(t - slip, 0.0)
    every = round(1e4 / rate_hz)
    return Log(t_s=t[::every], position_m=x[::every], force_n=lowpass(force)[::every])


def first_order(cutoff_hz: float) -> Callable[[Array], Array]:
    share = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * 1e-4)

    def through(force: Array) -> Array:
        out, state = np.empty_like(force), 0.0
        for k, value in enumerate(force):
            state += share * (value - state)
            out[k] = state
        return out

    return through


def test_a_filter_holds_back_as_much_as_is_said() -> None:
    log = pull(lowpass=first_order(5.0))
    event = find_breakaway_events(log, rig=RigFile(filter_hz=5.0)).events[0]
    assert not event.is_lower_bound
    missing = 90.0 - event.breakaway_force_n
    assert missing == pytest.approx(100.0 / (2.0 * np.pi * 5.0), rel=0.05)
    assert event.unseen_gain_n == pytest.approx(missing + 0.1, rel=0.05)


def test_a_rise_that_the_filter_does_not_follow_is_a_lower_bound() -> None:
    log = pull(lowpass=first_order(0.4))
    event = find_breakaway_events(log, rig=RigFile(filter_hz=0.4)).events[0]
    assert event.is_lower_bound
    assert "which the rig's filter of 0.4 Hz does not follow; the peak was higher" in event.reason


def test_the_gain_of_the_load_cell_is_in_the_error_of_a_breakaway() -> None:
    gain = RigFile(force_calibration_percent=1.0)
    event = find_breakaway_events(pull(), rig=gain, offset_n=0.0).events[0]
    noise = event.force_noise_n
    assert event.breakaway_error_n == pytest.approx(np.hypot(noise, 0.01 * event.breakaway_force_n))
    assert event.sliding_error_n == pytest.approx(0.4)


def test_presliding_is_that_of_the_part() -> None:
    log = pull()
    soft = Log(t_s=log.t_s, position_m=log.position_m + log.force_n / 1e6, force_n=log.force_n)
    event = find_breakaway_events(soft).events[0]
    assert event.presliding_displacement_m == pytest.approx(90e-6, rel=0.1)
    event = find_breakaway_events(soft, rig=RigFile(stiffness_n_per_m=1e6)).events[0]
    assert event.presliding_displacement_m == pytest.approx(0.0, abs=1e-6)


def test_a_population_allows_for_one_gain_of_all_parts() -> None:
    rig_file = RigFile(force_calibration_percent=3.0)
    forces = (80.0, 100.0, 130.0)
    sure = fit_population([find_breakaway_events(pull(f)) for f in forces])
    unsure = fit_population([find_breakaway_events(pull(f), rig=rig_file) for f in forces])
    one, other = (p.fits["breakaway_force_n"] for p in (sure, unsure))
    assert other.parameters == one.parameters
    assert other.interval["sigma"] == one.interval["sigma"]
    median = one.parameters["median"]
    widened = np.hypot(one.interval["median"][1] - median, 1.96 * 0.03 * median)
    assert other.interval["median"][1] == pytest.approx(median + widened, rel=1e-4)


# The file


def test_a_rig_file_is_kept(tmp_path: Path) -> None:
    rig_file = RigFile(
        stiffness_n_per_m=3e6, mass_kg=2.0, filter_hz=100.0, force_calibration_percent=0.5,
        notes=["weighed"],
    )  # fmt: skip
    rig_file.save(tmp_path / "rig.toml")
    assert RigFile.load(tmp_path / "rig.toml") == rig_file


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("stiffness_n_per_m = 0.0", r"stiffness_n_per_m: .*0"),
        ("mass_kg = -1.0", r"mass_kg: .*-1"),
        ("force_calibration_percent = 50.0", r"force_calibration_percent: .*50"),
        ('position_sensor = "table"', r"position_sensor: .*'drive'.*'part'"),
        ("stiffness = 1.0", r"stiffness: is not a known key"),
        (
            'position_sensor = "part"\nstiffness_n_per_m = 1e6',
            "stiffness_n_per_m: has no effect with position_sensor = 'part'; leave one out",
        ),
    ],
)
def test_a_wrong_rig_file_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(text)
    with pytest.raises(ScenarioError, match=words):
        RigFile.load(path)
