"""Signals derived from a log: motion behind a low-pass, and the noise of a channel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal

from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.findings import quantum
from breakaway.measure.logs.log import Log

LOWPASS_ORDER = 4
"""Order of the Butterworth low-pass on position; run both ways it counts twice."""

DIFFERENCE_ORDER = 5
"""Order of the difference that removes the motion from a channel and leaves its noise."""

SPACING_TOLERANCE = 0.01
"""Largest deviation of a time step from the median step, relative to it."""

HIGHEST_LOWPASS = 0.4
LOWEST_LOWPASS = 0.01
"""Bounds of the default low-pass, as shares of the sample rate."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Filtered motion at the log's own rate, with its noise.

    ``noise_m`` is the standard deviation of what the low-pass took out of the position.
    """

    position_m: Array
    velocity_m_per_s: Array
    acceleration_m_per_s2: Array
    noise_m: float
    lowpass_hz: float


@dataclass(frozen=True)
class NoiseFloor:
    """Noise of a channel, in the unit of the channel.

    Parameters
    ----------
    white : float
        Standard deviation of the white noise, which includes that of the quantization.
    quantum : float
        Step of the quantization, 0 where none is resolved.
    quantization : float
        ``quantum / √12``, the standard deviation of rounding.

    """

    white: float
    quantum: float
    quantization: float


def noise_floor(log: Log, channel: str) -> NoiseFloor:
    """Estimate the white noise of a channel beneath its smooth motion.

    ::

        white = 1.4826 median|d - median(d)| / √C(2p, p),    p = 5

    with d the p-th difference of the values: it cancels what changes slowly (at a twentieth of
    the sample rate 0.3 % of the amplitude is left), and turns white noise of variance s² into
    noise of variance C(2p, p) s². The median ignores steps and impacts.

    Parameters
    ----------
    log : Log
        The log.
    channel : str
        Name of a channel.

    Returns
    -------
    NoiseFloor

    Raises
    ------
    LogError
        There is no such channel.

    Notes
    -----
    Not checked: that the noise is white (filtered noise comes out too small), and that the
    stamps are even. Where noise is much smaller than the quantum, ``white`` is 0 or coarse:
    ``quantization`` is the better figure then.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> t_s = np.arange(20000) / 1000.0
    >>> log = Log(t_s=t_s, force_n=np.sin(t_s) + 0.01 * rng.standard_normal(20000))
    >>> round(noise_floor(log, "force_n").white, 3)
    0.01

    """
    check_arguments(noise_floor, locals(), LogError)
    values = log[channel]
    d = np.diff(values, n=DIFFERENCE_ORDER)
    spread = 1.4826 * float(np.median(np.abs(d - np.median(d))))
    white = spread / math.sqrt(math.comb(2 * DIFFERENCE_ORDER, DIFFERENCE_ORDER))
    step = quantum(values) or 0.0
    return NoiseFloor(white=white, quantum=step, quantization=step / math.sqrt(12.0))


def derive_motion(log: Log, lowpass_hz: float | None = None) -> Motion:
    """Return position, velocity and acceleration behind a low-pass without phase.

    A Butterworth filter of order 4 runs forward and backward over the position; velocity and
    acceleration are central differences, v_k = (x_{k+1} - x_{k-1}) / (2 h), and so again.

    Parameters
    ----------
    log : Log
        A log with evenly spaced stamps.
    lowpass_hz : float, optional
        Cutoff in Hz, below half of the sample rate; by default as `default_lowpass_hz` says.

    Returns
    -------
    Motion

    Raises
    ------
    LogError
        The log has no position, a time step deviates by more than 1 % from the median, the
        cutoff is out of range, or there are too few samples to filter.

    Notes
    -----
    At both ends, over about one period of the cutoff, the filter rings; nothing is trimmed.

    Examples
    --------
    >>> t_s = np.arange(2000) / 1000.0
    >>> motion = derive_motion(Log(t_s=t_s, position_m=np.sin(t_s)), lowpass_hz=50.0)
    >>> bool(abs(motion.velocity_m_per_s[1000] - np.cos(1.0)) < 1e-5)
    True

    """
    check_arguments(derive_motion, locals(), LogError)
    position = log.position_m
    check_even(log)
    rate = log.sample_rate_hz
    cutoff = default_lowpass_hz(log) if lowpass_hz is None else lowpass_hz
    if not 0.0 < cutoff < 0.5 * rate:
        raise LogError(
            f"lowpass_hz is {cutoff:g}; for {log.name} it must be > 0 and < {0.5 * rate:.6g} Hz "
            "(half of the sample rate)"
        )
    low = signal.butter(LOWPASS_ORDER, cutoff, fs=rate, output="sos")
    try:
        smooth = np.asarray(signal.sosfiltfilt(low, position), dtype=np.float64)
    except ValueError:
        raise LogError(
            f"{log.name}: {log.rows} rows are too few for the low-pass; record for longer"
        ) from None
    velocity = np.gradient(smooth, 1.0 / rate)
    acceleration = np.gradient(velocity, 1.0 / rate)
    noise = float(np.std(position - smooth))
    return Motion(smooth, velocity, acceleration, noise, float(cutoff))


def default_lowpass_hz(log: Log) -> float:
    """Return the cutoff that `derive_motion` takes by default.

    It makes the expected squared error of the acceleration smallest: the motion that is lost
    above it, plus the noise that passes below it,

    ::

        E(f_c) = Σ_{f > f_c} max(S - N, 0) ω⁴ + Σ_{f ≤ f_c} N ω⁴

    with S the power spectral density of the position (Welch) and N that of white noise, of the
    larger figure of `noise_floor`. It stays within 0.01 to 0.4 of the sample rate.

    Parameters
    ----------
    log : Log
        A log with evenly spaced stamps.

    Returns
    -------
    float

    """
    rate, noise = log.sample_rate_hz, noise_floor(log, "position_m")
    floor = 2.0 * max(noise.white, noise.quantization) ** 2 / rate
    # The difference keeps slow motion from leaking into all frequencies. Its squared gain
    # is (ω h)², so (S - N) ω⁴ is its power above the noise's times this gain.
    frequencies, power = signal.welch(
        np.diff(log.position_m), fs=rate, nperseg=min(1024, log.rows - 1), detrend="constant"
    )
    gain = 4.0 * np.sin(np.pi * frequencies / rate) ** 2
    lost = np.maximum(power - floor * gain, 0.0) * gain
    passed = floor * gain**2
    error = np.sum(lost) - np.cumsum(lost) + np.cumsum(passed)
    best = float(frequencies[int(np.argmin(error))])
    return min(max(best, LOWEST_LOWPASS * rate), HIGHEST_LOWPASS * rate)


def check_even(log: Log) -> None:
    """Raise `LogError` where a time step deviates by more than 1 % from the median step."""
    log.check_increasing()
    steps = np.diff(log.t_s)
    median = float(np.median(steps))
    deviation = np.abs(steps / median - 1.0)
    worst = int(np.argmax(deviation))
    if deviation[worst] > SPACING_TOLERANCE:
        raise LogError(
            f"{log.name}: column 't_s', row {worst + 2}: the step of {steps[worst]:.6g} s deviates "
            f"by {100 * deviation[worst]:.3g} % from the median step of {median:.6g} s; at most "
            f"{100 * SPACING_TOLERANCE:g} % is allowed, and nothing is resampled silently: cut "
            "the log at its gaps with --between (log.between), or use --resample-hz (log.resampled)"
        )
