"""Errors are as large as they are said to be, where noise is white and where it is not."""

import sys
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from breakaway.errors import LogError
from breakaway.measure.identification import Identification, identify
from breakaway.measure.identification.uncertainty import correlation_window, covariance
from breakaway.measure.logs import Log

T_S = np.arange(300) / 150.0
X = 0.02 * np.sin(5 * T_S) + 0.01 * np.sin(13 * T_S + 1)
V = 0.1 * np.cos(5 * T_S) + 0.13 * np.cos(13 * T_S + 1)
ROUGH = Log(t_s=T_S, position_m=X, force_n=5.0 * np.sign(V) + 40.0 * V + 1.0)


def noise(seed: int, rho: float) -> npt.NDArray[np.float64]:
    """Return noise of variance 1, whose next value is rho times this one, and new noise."""
    drawn = np.random.default_rng(seed).standard_normal(len(T_S))
    for row in range(1, len(drawn)):
        drawn[row] = rho * drawn[row - 1] + np.sqrt(1.0 - rho**2) * drawn[row]
    return drawn


@pytest.fixture(scope="module")
def clean() -> Log:
    """Give a log that the law fits but for what is added: its own simulation."""
    return replace(
        ROUGH, force_n=identify(ROUGH, law="coulomb", steps_per_row=1, starts=1).fit.force_n
    )


def fit(clean: Log, seed: int, rho: float, size_n: float = 0.3) -> Identification:
    force = clean.force_n + size_n * noise(seed, rho)
    return identify(replace(clean, force_n=force), law="coulomb", steps_per_row=1, starts=1)


@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_standard_errors_are_the_spread_over_many_logs(clean: Log, rho: float) -> None:
    fits = [fit(clean, seed, rho) for seed in range(60)]
    for name in fits[0].values:
        spread = np.std([one[name].value for one in fits], ddof=1)
        told = np.sqrt(np.mean([one[name].standard_error ** 2 for one in fits]))
        assert 0.7 < told / spread < 1.4, name


def test_correlated_noise_widens_the_errors(clean: Log) -> None:
    white, correlated = fit(clean, 0, 0.0), fit(clean, 0, 0.9)
    for name in white.values:
        assert correlated[name].standard_error > 1.5 * white[name].standard_error
    assert correlated.effective_rows < 0.4 * white.effective_rows
    assert any("residuals correlate over about" in note for note in correlated.notes)


def test_covariance_of_white_residuals_is_that_of_least_squares() -> None:
    rng = np.random.default_rng(4)
    slopes = rng.standard_normal((20_000, 3)) @ np.diag([1.0, 10.0, 1e4])
    residual = 0.5 * rng.standard_normal(20_000)
    found = covariance(residual, slopes)
    classic = 0.25 * np.linalg.inv(slopes.T @ slopes)
    ratio = np.sqrt(np.diag(found.matrix) / np.diag(classic))
    np.testing.assert_allclose(ratio, 1.0, atol=0.1)
    assert found.weight > 0.9


def test_covariance_is_the_sum_that_it_says() -> None:
    rng = np.random.default_rng(5)
    slopes = rng.standard_normal((300, 2))
    residual = np.convolve(rng.standard_normal(309), np.ones(10), "valid")
    window = correlation_window(residual)
    score = slopes * residual[:, None]
    meat = score.T @ score
    for lag in range(1, window + 1):
        part = score[lag:].T @ score[:-lag]
        meat += (1.0 - lag / (window + 1)) * (part + part.T)
    bread = np.linalg.inv(slopes.T @ slopes)
    expected = 300 / 298 * bread @ meat @ bread
    np.testing.assert_allclose(covariance(residual, slopes).matrix, expected, rtol=1e-9)


def test_what_has_no_slope_has_no_known_error() -> None:
    slopes = np.column_stack([np.ones(50), np.zeros(50)])
    found = covariance(np.random.default_rng(0).standard_normal(50), slopes)
    assert np.isfinite(found.matrix[0, 0])
    assert found.matrix[1, 1] == np.inf
    assert covariance(np.ones(50), np.zeros((50, 1))).matrix[0, 0] == np.inf


def test_the_window_follows_the_correlation() -> None:
    windows = [correlation_window(noise(1, rho)) for rho in (0.0, 0.5, 0.9)]
    assert windows[0] < windows[1] < windows[2] <= 30
    assert correlation_window(np.zeros(50)) == 0


def test_errors_do_not_change_with_the_unit_of_the_residual() -> None:
    rng = np.random.default_rng(6)
    slopes, residual = rng.standard_normal((500, 3)), rng.standard_normal(500)
    one, other = covariance(residual, slopes), covariance(1e3 * residual, 1e3 * slopes)
    np.testing.assert_allclose(one.matrix, other.matrix, rtol=1e-9)


@pytest.fixture(scope="module")
def linear(clean: Log) -> Identification:
    """Give a fit that is nearly linear in its parameters."""
    return fit(clean, 3, 0.0)


@pytest.mark.parametrize("name", ["coulomb_n", "viscous_n_s_per_m"])
def test_a_profile_agrees_with_the_normal_interval(linear: Identification, name: str) -> None:
    profile, one = linear.profile(name), linear[name]
    half = 0.5 * (one.high - one.low)
    assert profile.low == pytest.approx(one.low, abs=0.25 * half)
    assert profile.high == pytest.approx(one.high, abs=0.25 * half)
    assert profile.deviance.min() == 0.0
    assert np.all(np.diff(profile.values) > 0.0)


def test_a_profile_is_open_where_the_log_tells_nothing(clean: Log) -> None:
    found = identify(clean, law="stribeck", fixed={"stiction_ratio": 1.0}, starts=1)
    profile = found.profile("stribeck_velocity_m_per_s")
    assert (profile.low, profile.high) == (0.0, np.inf)
    assert profile.deviance.max() < 1e-6
    assert not found["stribeck_velocity_m_per_s"].identifiable


@pytest.mark.slow
def test_the_posterior_agrees_with_the_linear_errors(linear: Identification) -> None:
    pytest.importorskip("emcee")
    seen: list[tuple[int, int]] = []
    drawn = linear.posterior(1500, seed=1, progress=lambda *at: seen.append(at))
    for one in linear.estimates:
        column = drawn.samples[one.name]
        assert len(column) == 1500
        assert abs(column.mean() - one.value) < 0.2 * one.standard_error
        assert column.std() == pytest.approx(one.standard_error, rel=0.2)
    assert 0.2 < drawn.acceptance < 0.9
    assert seen[-1][0] == seen[-1][1]
    again = linear.posterior(64, seed=1)  # the first of the same draws
    for name, column in again.samples.items():
        np.testing.assert_array_equal(column, drawn.samples[name][:64])


def test_draws_have_the_errors_and_the_correlation(linear: Identification) -> None:
    drawn = linear.draws(20_000, seed=2)
    for one in linear.estimates:
        assert drawn[one.name].std() == pytest.approx(one.standard_error, rel=0.03)
    slope = np.corrcoef(drawn["coulomb_n"], drawn["viscous_n_s_per_m"])[0, 1]
    assert slope < -0.3
    np.testing.assert_array_equal(drawn["offset_n"], linear.draws(20_000, seed=2)["offset_n"])


def test_a_posterior_without_emcee_names_the_extra(
    linear: Identification, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(LogError, match=r"needs emcee; install it with.*breakaway\[posterior\]"):
        linear.posterior(100)
