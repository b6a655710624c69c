"""A log is told what it cannot tell, and which experiment would."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from breakaway.errors import LogError
from breakaway.measure.identification import Identification, Verdict, identifiability, identify
from breakaway.measure.identification.curve import curve_misfit, peak_in_words
from breakaway.measure.identification.verdicts import stiction_peak
from breakaway.measure.logs import Log

Array = npt.NDArray[np.float64]
T_S = np.arange(2000) / 500.0


def of(found: Identification) -> dict[str, Verdict]:
    return {one.parameter: one for one in found.verdicts}


def peak(found: Identification) -> str:
    return stiction_peak({one.name: one for one in found.estimates}, found.verdicts)


def log_of(velocity: Array, friction: Callable[[Array], Array], noise_m: float = 0.0) -> Log:
    """Return a log of this velocity with this friction, of 0.05 N noise."""
    rng = np.random.default_rng(0)
    x = np.cumsum(velocity) / 500.0 + noise_m * rng.standard_normal(len(T_S))
    force = friction(velocity) + 0.05 * rng.standard_normal(len(T_S))
    return Log(t_s=T_S, position_m=x, force_n=force)


@pytest.fixture(scope="module")
def one_speed() -> Log:
    """Give a log that goes to and fro at 20 mm/s, and reverses smoothly within 20 ms."""
    velocity = 0.02 * np.tanh(np.sin(2 * np.pi * T_S) / 0.06)
    return log_of(velocity, lambda v: 5.0 * np.tanh(v / 0.001))


def test_one_speed_tells_neither_peak_nor_viscous_friction(one_speed: Log) -> None:
    found = identify(one_speed, law="stribeck", starts=2)
    told = of(found)
    for name in ("stiction_ratio", "stribeck_velocity_m_per_s", "viscous_n_s_per_m"):
        assert name not in found.values
        assert not told[name].identifiable
        assert "nearly one speed, 90 % of the sliding rows lie between" in told[name].because
        assert told[name].remedy
    assert "held at 1" in told["stiction_ratio"].because
    assert "held at 0" in told["viscous_n_s_per_m"].because
    assert "creeping to fast" in told["viscous_n_s_per_m"].remedy
    assert "start from rest many times" in told["stiction_ratio"].remedy
    assert told["coulomb_n"].identifiable
    assert found["coulomb_n"].value == pytest.approx(5.0, rel=0.05)
    assert peak(found).startswith("stiction peak: not identified (held at 1: nearly one speed")


def test_free_fits_all_the_same(one_speed: Log) -> None:
    found = identify(one_speed, law="coulomb", free=["viscous_n_s_per_m"], starts=1)
    assert "viscous_n_s_per_m" in found.values
    assert set(found.values) == {"coulomb_n", "viscous_n_s_per_m", "offset_n"}


def test_fixed_needs_no_verdict_of_excitation(one_speed: Log) -> None:
    found = identify(one_speed, law="coulomb", fixed={"viscous_n_s_per_m": 3.0}, starts=1)
    assert found.fixed["viscous_n_s_per_m"] == 3.0
    told = of(found)
    assert "viscous_n_s_per_m" not in told or "held at 0" not in told["viscous_n_s_per_m"].because


def test_one_direction_does_not_tell_an_offset() -> None:
    velocity = 0.05 + 0.045 * np.sin(3 * T_S)
    found = identify(log_of(velocity, lambda v: 5.0 + 40.0 * v), law="coulomb", starts=1)
    told = of(found)["offset_n"]
    assert not told.identifiable and "offset_n" not in found.values
    assert "slides only one way, so an offset looks like friction" in told.because
    assert told.remedy.startswith("let the part slide both ways, or fix the offset")
    assert found["viscous_n_s_per_m"].value == pytest.approx(40.0, rel=0.05)


def test_presliding_below_the_noise_holds_the_damper(rig: Any, lugre: dict[str, float]) -> None:
    log = rig(**lugre).moved(1500, 1000.0, force_noise_n=0.1, position_noise_m=1e-3)
    found = identify(log, law="elasto_plastic", lowpass_hz=20.0, starts=1)
    told = of(found)
    for name in ("damping_n_s_per_m", "elastic_share"):
        assert not told[name].identifiable and name not in found.values
        assert "presliding is" in told[name].because and "noise" in told[name].because
    assert "ten times its resonance" in told["damping_n_s_per_m"].remedy
    assert "up to breakaway" in told["elastic_share"].remedy


def test_a_rich_log_tells_all(rich_fit: Identification) -> None:
    assert {one.parameter for one in rich_fit.verdicts if one.identifiable} == set(rich_fit.values)
    held = [one for one in rich_fit.verdicts if not one.identifiable]
    assert [one.parameter for one in held] == ["mass_kg"]
    assert "inertia is too small against friction to show" in held[0].because
    assert peak(rich_fit).startswith("stiction peak: seen; F_s / F_c = 1.")


def test_the_curve_of_a_law_that_holds_runs_through_the_dots(rich_fit: Identification) -> None:
    misfit = curve_misfit(rich_fit)
    assert misfit is not None and misfit.share < 0.1
    assert peak_in_words(rich_fit) == peak(rich_fit)


def test_a_curve_that_leaves_the_dots_makes_a_peak_doubtful(
    rig: Any, lugre: dict[str, float], rich_fit: Identification
) -> None:
    truth = {**lugre, "coulomb_n": 14.0}
    other = rig(**truth).moved(1500, 1000.0, force_noise_n=0.1)
    shown = replace(rich_fit, log=other)
    misfit = curve_misfit(shown)
    assert misfit is not None and misfit.share == pytest.approx(20.0 / 14.0 - 1.0, abs=0.1)
    assert "peak: doubtful; F_s / F_c = 1." in peak_in_words(shown)
    assert f"by {100 * misfit.share:.0f} % at" in peak_in_words(shown)


def test_no_peak_is_said_where_there_is_none(rig: Any, lugre: dict[str, float]) -> None:
    truth = {**lugre, "stiction_ratio": 0.7}
    found = identify(rig(**truth).moved(1500, 1000.0, force_noise_n=0.1), starts=2)
    assert peak(found).startswith("stiction peak: none; F_s / F_c = 0.")


def test_what_a_law_leaves_out_is_said(rich: Log) -> None:
    told = of(identify(rich, law="coulomb", starts=1))
    for name in ("stiction_ratio", "stiffness_n_per_m", "damping_n_s_per_m"):
        assert told[name].because == "law 'coulomb' does not have it"
        assert told[name].remedy.startswith("fit law")


def test_an_estimate_that_is_not_told_says_so() -> None:
    velocity = 0.05 * np.sin(3 * T_S) + 0.04 * np.sin(8 * T_S)
    found = identify(log_of(velocity, lambda v: 5.0 * np.sign(v) + 20.0 * v), law="lugre", starts=2)
    for one in found.estimates:
        verdict = of(found)[one.name]
        assert verdict.identifiable == one.identifiable
        assert one.identifiable or (one.remark and verdict.remedy)
    assert not found["stribeck_velocity_m_per_s"].identifiable


def test_the_mass_is_fitted_where_the_log_shows_it(rig: Any, lugre: dict[str, float]) -> None:
    log = rig(**lugre).moved(1500, 1000.0, force_noise_n=0.1)
    v = np.gradient(log.position_m, log.t_s)
    heavy = Log(
        t_s=log.t_s,
        position_m=log.position_m,
        force_n=log.force_n + 30.0 * np.gradient(v, log.t_s),
    )
    found = identify(heavy, law="lugre", starts=2)
    assert found.values["mass_kg"] == pytest.approx(30.0, rel=0.05)


def test_a_force_that_drives_by_friction_is_refused(rich: Log) -> None:
    backward = Log(t_s=rich.t_s, position_m=rich.position_m, force_n=-rich.force_n)
    with pytest.raises(LogError, match="force and velocity oppose each other"):
        identify(backward, law="coulomb", starts=1)


def test_a_law_that_explains_little_is_said_to(rich: Log) -> None:
    rng = np.random.default_rng(3)
    noisy = rich.force_n + 5.0 * float(np.std(rich.force_n)) * rng.standard_normal(rich.rows)
    log = Log(t_s=rich.t_s, position_m=rich.position_m, force_n=noisy)
    assert "explains the log poorly" in identify(log, law="coulomb", starts=1).notes[0]


def test_noise_of_the_position_is_said_to_bias_the_stribeck_term(
    rig: Any, lugre: dict[str, float]
) -> None:
    log = rig(**lugre).moved(1500, 1000.0, force_noise_n=0.1, position_noise_m=2e-5)
    notes = identify(log, law="stribeck", lowpass_hz=200.0, starts=1).notes
    assert any("biases F_s / F_c and v_s beyond their intervals" in note for note in notes)


def test_identifiability_is_told_without_a_fit(rich: Log, rich_fit: Identification) -> None:
    found = rich_fit
    report = identifiability(rich, law="lugre", guesses=found.values)
    assert report.excitation == found.excitation
    assert set(report.expected_error) == set(found.values)
    assert [one.parameter for one in report.held] == ["mass_kg"]
    for name in ("coulomb_n", "stiffness_n_per_m"):  # no fit does better than the noise allows
        assert 0.0 < report.expected_error[name] < found[name].standard_error / found[name].value


def test_the_expected_error_of_an_offset_is_that_of_a_mean() -> None:
    noise = 0.1 * np.random.default_rng(4).standard_normal(len(T_S))
    log = log_of(0.05 * np.sin(7 * T_S), lambda v: 5.0 * np.sign(v) + noise)
    expected = identifiability(log, law="coulomb").expected_error["offset_n"]
    assert expected == pytest.approx(0.1 / np.sqrt(len(T_S)), rel=0.2)


def test_what_a_log_can_not_tell_has_an_infinite_expected_error() -> None:
    log = log_of(0.05 + 0.045 * np.sin(3 * T_S), lambda v: 5.0 + 40.0 * v)
    expected = identifiability(log, law="coulomb", asymmetric=True).expected_error
    assert np.isinf(expected["coulomb_negative_n"]) and expected["coulomb_positive_n"] < 0.1
