"""Inertia and friction: published figures, known answers, honest errors, refusals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import sawtooth

from breakaway.errors import LogError
from breakaway.measure.identification import InertiaFrictionFit, identify_inertia_friction
from breakaway.measure.logs import Log, read_log

EMPS = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"

TRUTH = {"mass_kg": 5.0, "viscous_n_s_per_m": 20.0, "coulomb_n": 4.0, "offset_n": 1.0}
T_S = np.arange(4000) / 1000.0

Array = npt.NDArray[np.float64]


def synthetic(
    *, seed: int = 0, force_noise_n: float = 0.5, position_noise_m: float = 0.0, peak_n: float = 0.0
) -> Log:
    """Return 4 s of a part with `TRUTH`'s parameters, driven by a sum of two sines."""
    rng = np.random.default_rng(seed)
    x = 0.1 * np.sin(3 * T_S) + 0.05 * np.sin(7 * T_S + 1)
    v = 0.3 * np.cos(3 * T_S) + 0.35 * np.cos(7 * T_S + 1)
    a = -0.9 * np.sin(3 * T_S) - 2.45 * np.sin(7 * T_S + 1)
    friction = 4.0 + peak_n * np.exp(-((v / 0.03) ** 2))
    force = 5.0 * a + 20.0 * v + friction * np.sign(v) + 1.0
    return Log(
        t_s=T_S,
        position_m=x + position_noise_m * rng.standard_normal(len(T_S)),
        force_n=force + force_noise_n * rng.standard_normal(len(T_S)),
    )


def moved(position_m: Array, force_n: Array | float = 1.0) -> Log:
    return Log(t_s=T_S, position_m=position_m, force_n=force_n * np.ones_like(T_S))


@pytest.fixture(scope="module")
def emps() -> InertiaFrictionFit:
    if not EMPS.is_file():
        pytest.skip("the measured logs (../shared/data) are absent")
    return identify_inertia_friction(read_log(EMPS, format="emps"))


def test_emps_symmetric_as_published(emps: InertiaFrictionFit) -> None:
    fit = emps.symmetric
    assert fit.mass_kg == pytest.approx(95.1089, abs=0.1085)
    assert fit.viscous_n_s_per_m == pytest.approx(203.5034, abs=1.146)
    assert fit.coulomb_n == pytest.approx(20.3935, abs=0.101)
    assert fit.offset_n == pytest.approx(-3.1648, abs=0.044)
    assert fit.relative_force_error_percent == pytest.approx(4.08, abs=0.1)
    published = [0.1085, 1.146, 0.101, 0.044]
    np.testing.assert_allclose(list(fit.standard_error.values()), published, rtol=0.02)


def test_emps_asymmetric_as_published(emps: InertiaFrictionFit) -> None:
    fit = emps.asymmetric
    assert fit.mass_kg == pytest.approx(95.154, abs=0.1)
    assert fit.viscous_positive_n_s_per_m == pytest.approx(166.71, abs=1.2)
    assert fit.viscous_negative_n_s_per_m == pytest.approx(240.42, abs=1.2)
    assert fit.coulomb_positive_n == pytest.approx(20.144, abs=0.1)
    assert fit.coulomb_negative_n == pytest.approx(20.628, abs=0.1)
    assert fit.relative_force_error_percent == pytest.approx(3.11, abs=0.1)


def test_emps_says_what_it_can_not_tell(emps: InertiaFrictionFit) -> None:
    notes = "\n".join(emps.notes)
    for field in ("stiction_n", "stiffness_n_per_m", "damping_n_s_per_m", "engagement_length_m"):
        assert f"joint.{field}" in notes
        assert f"joint.{field}" in emps.not_identified
    assert "joint.stribeck_velocity_m_per_s" in notes
    assert "stiction peak: none" in notes
    assert "successive residuals correlate (0.68)" in notes
    assert "columns not used: kp, kv" in notes
    assert (emps.trimmed_samples, emps.symmetric.samples) == (200, 2465)


def test_recovers_known_parameters() -> None:
    fit = identify_inertia_friction(synthetic())
    for name, value in TRUTH.items():
        error = fit.symmetric.standard_error[name]
        assert abs(getattr(fit.symmetric, name) - value) < 3.5 * error
        assert 0.0 < error < 0.05 * value
    assert fit.asymmetric.coulomb_positive_n == pytest.approx(5.0, abs=0.2)
    assert fit.asymmetric.coulomb_negative_n == pytest.approx(3.0, abs=0.2)


def test_recovers_exactly_without_noise() -> None:
    fit = identify_inertia_friction(synthetic(force_noise_n=0.0)).symmetric
    for name, value in TRUTH.items():
        assert getattr(fit, name) == pytest.approx(value, rel=5e-3)
    assert fit.relative_force_error_percent < 0.5


@pytest.mark.slow
def test_standard_errors_cover_the_truth() -> None:
    fits = [identify_inertia_friction(synthetic(seed=seed)).symmetric for seed in range(150)]
    for name, value in TRUTH.items():
        score = [(getattr(fit, name) - value) / fit.standard_error[name] for fit in fits]
        assert 0.85 < np.std(score) < 1.35  # 1.12 is due: white noise fills 0.8 of the band
        assert 0.85 < np.mean(np.abs(score) < 2.0) < 0.99
        assert abs(np.mean(score)) < 0.5


def test_does_not_see_where_time_starts() -> None:
    log = synthetic()
    here = identify_inertia_friction(log).symmetric
    later = identify_inertia_friction(replace(log, t_s=log.t_s + 1000.0)).symmetric
    for name in TRUTH:
        assert getattr(later, name) == pytest.approx(getattr(here, name), rel=1e-6)


def test_does_not_see_where_position_starts() -> None:
    log = synthetic()
    here = identify_inertia_friction(log).symmetric
    there = identify_inertia_friction(replace(log, position_m=log.position_m + 3.0)).symmetric
    for name in TRUTH:
        assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-6)


def test_direction_flips_offset_and_swaps_sides() -> None:
    log = synthetic()
    one = identify_inertia_friction(log)
    other = identify_inertia_friction(
        replace(log, position_m=-log.position_m, force_n=-log.force_n)
    )
    for name in ("mass_kg", "viscous_n_s_per_m", "coulomb_n"):
        assert getattr(other.symmetric, name) == pytest.approx(getattr(one.symmetric, name))
    assert other.symmetric.offset_n == pytest.approx(-one.symmetric.offset_n)
    assert other.asymmetric.coulomb_positive_n == pytest.approx(one.asymmetric.coulomb_negative_n)
    assert other.asymmetric.viscous_negative_n_s_per_m == pytest.approx(
        one.asymmetric.viscous_positive_n_s_per_m
    )


def test_force_scales_every_parameter() -> None:
    log = synthetic()
    one = identify_inertia_friction(log).symmetric
    ten = identify_inertia_friction(replace(log, force_n=10.0 * log.force_n)).symmetric
    for name in TRUTH:
        assert getattr(ten, name) == pytest.approx(10.0 * getattr(one, name))
        assert ten.standard_error[name] == pytest.approx(10.0 * one.standard_error[name])
    assert ten.relative_force_error_percent == pytest.approx(one.relative_force_error_percent)


@pytest.mark.parametrize(
    ("log", "note"),
    [
        (synthetic(peak_n=2.0), "stiction peak: seen, but not identified"),
        (synthetic(force_noise_n=0.1), "stiction peak: none"),
        (synthetic(force_noise_n=20.0), "stiction peak: this log cannot tell"),
        (synthetic(position_noise_m=1e-5, force_noise_n=0.1), "biases the mass toward 0"),
    ],
)
def test_notes_follow_the_log(log: Log, note: str) -> None:
    assert note in "\n".join(identify_inertia_friction(log).notes)


def test_notes_friction_that_falls_with_speed() -> None:
    log = synthetic()
    v = np.gradient(log.position_m, log.t_s)
    notes = identify_inertia_friction(replace(log, force_n=log.force_n - 30.0 * v)).notes
    assert any(note.startswith("viscous_n_s_per_m is negative (-") for note in notes)


NOISE = np.random.default_rng(1).standard_normal(len(T_S))


@pytest.mark.parametrize(
    ("log", "words"),
    [
        (moved(np.full_like(T_S, 0.3)), "the part never moves .*: record a log in which it moves"),
        (moved(1e-6 * NOISE, NOISE), "the part never moves"),
        (moved(0.1 * T_S + 1e-6 * NOISE), "goes down in 0 % of the rows.*record both directions"),
        (moved(-0.1 * T_S**2), "goes up in 0 % of the rows"),
        (
            moved(0.1 * sawtooth(6.0 * T_S, 0.5), NOISE),
            "viscous_n_s_per_m and coulomb_n cannot be told apart.*sum of sines",
        ),
        (moved(synthetic().position_m, 0.0), "column 'force_n' is 0 in every row"),
        (moved(synthetic().position_m, NOISE), "the mass cannot be determined"),
        (moved(synthetic().position_m, -synthetic().force_n), "flip the sign of one"),
    ],
    ids=["rest", "noise", "up", "down", "triangle", "no force", "noise force", "flipped"],
)
def test_refuses_a_log_that_can_not_tell(log: Log, words: str) -> None:
    with pytest.raises(LogError, match=words):
        identify_inertia_friction(log)


def test_refuses_uneven_sampling() -> None:
    t_s = T_S.copy()
    t_s[2000:] += 0.27
    words = r"column 't_s', row 2001: the step of 0.271 s deviates .* nothing is resampled"
    with pytest.raises(LogError, match=words):
        identify_inertia_friction(replace(synthetic(), t_s=t_s))


def test_accepts_the_jitter_that_it_states() -> None:
    jitter = 4e-6 * np.sin(np.arange(len(T_S)) ** 2)
    fit = identify_inertia_friction(replace(synthetic(), t_s=T_S + jitter)).symmetric
    assert fit.mass_kg == pytest.approx(5.0, rel=0.02)


def test_counts_the_rows_that_it_needs() -> None:
    log = synthetic()

    def first(rows: int) -> Log:
        return Log(t_s=T_S[:rows], position_m=log.position_m[:rows], force_n=log.force_n[:rows])

    with pytest.raises(LogError, match="699 rows; with decimation 10 at least 700 are needed"):
        identify_inertia_friction(first(699))
    with pytest.raises(LogError, match=r"139 rows; .* at least 140 are needed"):
        identify_inertia_friction(first(139), decimation=2, lowpass_hz=300.0)
    assert identify_inertia_friction(first(2200)).symmetric.samples == 200


@pytest.mark.parametrize("lowpass_hz", [0.0, -1.0, 39.9, 500.0, np.nan, np.inf])
def test_refuses_a_lowpass_out_of_range(lowpass_hz: float) -> None:
    with pytest.raises(LogError, match=r"lowpass_hz is .* at least 40 Hz .* below 500 Hz"):
        identify_inertia_friction(synthetic(), lowpass_hz=lowpass_hz)


@pytest.mark.parametrize("decimation", [0, -1, True, 2.5])
def test_refuses_a_decimation_out_of_range(decimation: int) -> None:
    with pytest.raises(LogError, match=r"decimation:? .* whole number"):
        identify_inertia_friction(synthetic(), decimation=decimation)


@pytest.mark.parametrize(("lowpass_hz", "decimation"), [(60.0, 10), (200.0, 5), (450.0, 1)])
def test_other_settings_agree(lowpass_hz: float, decimation: int) -> None:
    fit = identify_inertia_friction(
        synthetic(force_noise_n=0.05), lowpass_hz=lowpass_hz, decimation=decimation
    ).symmetric
    assert fit.mass_kg == pytest.approx(5.0, rel=0.01)
    assert fit.coulomb_n == pytest.approx(4.0, rel=0.01)
