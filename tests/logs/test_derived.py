"""Derived motion is that of known signals; the noise floor is the noise that was added."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from breakaway.errors import LogError
from breakaway.measure.logs import Log, derive_motion, noise_floor, read_log
from breakaway.measure.logs.derived import default_lowpass_hz

EMPS = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"
T_S = np.arange(20000) / 1000.0
NOISE = np.random.default_rng(2).standard_normal(20000)


def log_of(position_m: np.ndarray) -> Log:
    return Log(t_s=T_S, position_m=position_m)


@given(st.floats(1e-9, 1e3), st.floats(0.1, 100.0), st.floats(0.0, 50.0))
def test_noise_floor_beneath_smooth_motion(sd: float, omega: float, size: float) -> None:
    log = log_of(size * sd * np.sin(omega * T_S) + sd * NOISE)
    assert noise_floor(log, "position_m").white == pytest.approx(sd, rel=0.05)


def test_noise_floor_ignores_impacts_and_steps() -> None:
    values = 0.01 * NOISE + (T_S > 3.0)
    values[::500] += 5.0
    assert noise_floor(log_of(values), "position_m").white == pytest.approx(0.01, rel=0.05)


def test_noise_floor_reports_the_rounding() -> None:
    noise = noise_floor(log_of(np.round(np.sin(T_S), 3)), "position_m")
    assert noise.quantum == pytest.approx(1e-3)
    assert noise.quantization == pytest.approx(1e-3 / np.sqrt(12.0))
    coarse = noise_floor(log_of(np.round(np.sin(T_S) + 0.002 * NOISE, 3)), "position_m")
    assert coarse.white == pytest.approx(np.hypot(0.002, 1e-3 / np.sqrt(12.0)), rel=0.05)


def test_motion_of_a_sine() -> None:
    motion = derive_motion(log_of(0.1 * np.sin(20 * T_S)), lowpass_hz=100.0)
    inner = slice(200, -200)
    np.testing.assert_allclose(motion.position_m[inner], 0.1 * np.sin(20 * T_S)[inner], atol=1e-7)
    velocity, acceleration = 2.0 * np.cos(20 * T_S), -40.0 * np.sin(20 * T_S)
    np.testing.assert_allclose(motion.velocity_m_per_s[inner], velocity[inner], atol=2e-4)
    np.testing.assert_allclose(motion.acceleration_m_per_s2[inner], acceleration[inner], atol=6e-3)
    assert motion.lowpass_hz == 100.0


def test_motion_is_filter_and_central_differences() -> None:
    log = log_of(np.sin(T_S) + 0.001 * NOISE)
    motion = derive_motion(log, lowpass_hz=60.0)
    rate = log.sample_rate_hz
    smooth = signal.sosfiltfilt(signal.butter(4, 60.0, fs=rate, output="sos"), log.position_m)
    np.testing.assert_array_equal(motion.position_m, smooth)
    np.testing.assert_array_equal(motion.velocity_m_per_s, np.gradient(smooth, 1 / rate))
    twice = np.gradient(np.gradient(smooth, 1 / rate), 1 / rate)
    np.testing.assert_array_equal(motion.acceleration_m_per_s2, twice)
    assert motion.noise_m == np.std(log.position_m - smooth)


@pytest.mark.parametrize("sd", [1e-5, 1e-4, 1e-3])
def test_the_default_lowpass_is_near_the_best(sd: float) -> None:
    """Try many cutoffs against the true acceleration; the default is hardly worse than the best."""
    clean = sum(0.1 / k**3 * np.sin(2 * np.pi * 1.7 * k * T_S + k * k) for k in range(1, 40))
    log = log_of(clean + sd * NOISE)
    truth = derive_motion(log_of(clean), lowpass_hz=400.0).acceleration_m_per_s2

    def error(cutoff: float) -> float:
        found = derive_motion(log, cutoff).acceleration_m_per_s2
        return float(np.std((found - truth)[500:-500]))

    best = min(error(cutoff) for cutoff in np.geomspace(5.0, 300.0, 30))
    assert error(default_lowpass_hz(log)) < 1.5 * best


def test_the_default_lowpass_stays_within_its_bounds() -> None:
    assert default_lowpass_hz(log_of(NOISE)) == pytest.approx(10.0)
    assert derive_motion(log_of(np.zeros(20000))).lowpass_hz == pytest.approx(10.0)


def test_refuses() -> None:
    uneven = T_S.copy()
    uneven[5000:] += 0.3
    words = r"row 5001: the step of 0.301 s deviates .*log.between.*log.resampled"
    with pytest.raises(LogError, match=words):
        derive_motion(Log(t_s=uneven, position_m=NOISE))
    with pytest.raises(LogError, match="repeats"):
        derive_motion(Log(t_s=np.zeros(20000), position_m=NOISE))
    with pytest.raises(LogError, match="there is no channel 'position_m'"):
        derive_motion(Log(t_s=T_S, force_n=NOISE))
    for cutoff in (0.0, 501.0, np.nan, -1.0):
        with pytest.raises(LogError, match=r"lowpass_hz is .* it must be > 0 and < 500 Hz"):
            derive_motion(log_of(NOISE), cutoff)
    with pytest.raises(LogError, match="10 rows are too few"):
        derive_motion(Log(t_s=T_S[:10], position_m=NOISE[:10]), 100.0)


@pytest.mark.skipif(not EMPS.is_file(), reason="the measured logs (../shared/data) are absent")
def test_the_default_lowpass_of_a_measured_log() -> None:
    log = read_log(EMPS)
    assert 80.0 < default_lowpass_hz(log) < 160.0
    assert noise_floor(log, "position_m").quantization == pytest.approx(5e-8 / np.sqrt(12.0))
