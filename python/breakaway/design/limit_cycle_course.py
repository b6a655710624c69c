"""A predicted limit cycle along a motion, against the oscillation that a run shows."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import nan, pi, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway.base.arguments import check_arguments, column_of
from breakaway.base.equality import ByValue
from breakaway.design.limit_cycle import Oscillator, oscillator_of
from breakaway.design.loop import SampledPid
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import steepest_change_velocity
from breakaway.model.scenario.joint import AnyJoint

Array = NDArray[np.float64]
Stations = tuple[Array, Array, Array]

SLOWEST = 0.01
"""Share of the largest speed below which a reference counts as standing still."""
SEEN = 0.1
"""An oscillation counts as seen while its amplitude is above this share of the mean speed."""
CYCLES_MIN = 5
"""Fewest cycles in a row that count as an oscillation and not as the jolt of breaking loose."""
STATIONS = 120
"""Moments of a motion at which growth is computed; between them it is interpolated."""
GRID = np.concatenate(
    [
        [1e-4, 1e-2],
        np.geomspace(0.05, 0.7, 12),
        np.linspace(0.75, 1.3, 23),
        np.geomspace(1.4, 10, 12),
    ]
)
"""Amplitudes over mean speed at which growth is computed: close where the speed turns back."""
FLAT = 2.5
"""Speed over v_s above which friction no longer changes with speed, exp(-6) or so; v_s is sqrt(2)
times the speed of the steepest change."""

Verdict = Literal["agree: oscillation", "agree: none", "only predicted", "only simulated"]


@dataclass(frozen=True, eq=False)
class Cycles(ByValue):
    """Cycles of an oscillation of the speed about a mean that moves, one row each."""

    t_s: Array
    """Their middles, in s."""
    frequency_hz: Array
    """One over their durations, in Hz."""
    amplitude_m_per_s: Array
    """Amplitudes of their first harmonic, in m/s."""
    speed_m_per_s: Array
    """Mean speed of the reference during them, in m/s."""


@dataclass(frozen=True, eq=False)
class LimitCycleComparison(ByValue):
    """A predicted limit cycle against the oscillation of a run."""

    verdict: Verdict
    """Whether both see an oscillation in the stretch of time that is compared."""
    cycles: Cycles
    """What the run shows while it slides."""
    predicted_t_s: Array
    """Times of the prediction, in s."""
    speed_m_per_s: Array
    """Mean speed at these times, in m/s."""
    steady_amplitude_m_per_s: Array
    """Amplitude of the limit cycle if speed and place stood still, in m/s; NaN where there is
    none."""
    steady_frequency_hz: Array
    """Its frequency, in Hz."""
    growth_per_s: Array
    """Growth rate of a very small oscillation, in 1/s: above 0 where sliding is unstable."""
    course_amplitude_m_per_s: Array
    """Amplitude while speed and place change: ``dA/dt = sigma(A, t) A`` from the first cycle."""
    course_frequency_hz: Array
    """Frequency of that oscillation, in Hz."""
    predicted_window_s: tuple[float, float]
    """First and last moment at which the predicted oscillation is seen, in s; NaN where never."""
    simulated_window_s: tuple[float, float]
    """The same of the run."""
    predicted_hz: float
    """Mean predicted frequency over the cycles seen in both, in Hz."""
    simulated_hz: float
    """Mean frequency of these cycles, in Hz."""
    predicted_amplitude_m_per_s: float
    """Root mean square over these cycles of the predicted amplitude, in m/s."""
    simulated_amplitude_m_per_s: float
    """The same of the run, in m/s."""

    @property
    def frequency_error_percent(self) -> float:
        """Predicted over simulated frequency, less one, in %."""
        return 100.0 * (self.predicted_hz / self.simulated_hz - 1.0)

    @property
    def amplitude_error_percent(self) -> float:
        """Predicted over simulated amplitude, less one, in %."""
        return 100.0 * (self.predicted_amplitude_m_per_s / self.simulated_amplitude_m_per_s - 1.0)


def compare_limit_cycle(
    pid: SampledPid,
    joint: AnyJoint,
    mass_kg: float,
    *,
    t_s: ArrayLike,
    reference_m: ArrayLike,
    velocity_m_per_s: ArrayLike,
) -> LimitCycleComparison:
    """Predict the limit cycle along a motion, and compare it with the speed that a run shows.

    Only two things of the run enter the prediction: its reference and, where the oscillation
    begins, the amplitude of its first cycle, because the describing function does not say what
    breaking loose leaves behind. The amplitude then follows ``dA/dt = sigma(A, v0(t), x(t)) A``.

    Parameters
    ----------
    pid : SampledPid
        The controller.
    joint : AnyJoint
        The joint.
    mass_kg : float
        m, above 0.
    t_s : array_like
        Times of the rows of the run's trace, in s, evenly spaced.
    reference_m : array_like
        Its reference, in m.
    velocity_m_per_s : array_like
        Its velocity, in m/s.

    Returns
    -------
    LimitCycleComparison
        Amplitudes and frequencies are NaN where there is no oscillation to compare.

    Raises
    ------
    ScenarioError
        The columns differ in length or have fewer than 16 rows, or a parameter is out of range.

    Notes
    -----
    Not checked: that the run had no disturbance, and that its actuator met no limit; both are
    absent from the prediction.

    Examples
    --------
    >>> import breakaway as bk
    >>> run = bk.simulate(bk.load_scenario("paper_as_computed"))
    >>> gains = run.scenario.controller.gains
    >>> pid = SampledPid(
    ...     bk.design.PidGains(gains.kp_n_per_m, gains.ki_n_per_m_s, gains.kd_n_s_per_m), 1e-5)
    >>> columns = {key: run.trace[key] for key in ("t_s", "reference_m", "velocity_m_per_s")}
    >>> found = compare_limit_cycle(pid, run.scenario.joint, 1.0, **columns)
    >>> found.verdict, abs(found.frequency_error_percent) < 3.0
    ('agree: oscillation', True)

    """
    check_arguments(compare_limit_cycle, locals(), ScenarioError)
    t = column_of("t_s", t_s, ScenarioError)
    r = column_of("reference_m", reference_m, ScenarioError)
    v = column_of("velocity_m_per_s", velocity_m_per_s, ScenarioError)
    if not (t.shape == r.shape == v.shape and t.size >= 16):
        raise ScenarioError(
            f"t_s, reference_m, velocity_m_per_s: shapes {t.shape}, {r.shape}, {v.shape} are not "
            "three equal columns of at least 16 rows; give three columns of one trace"
        )
    speed = np.gradient(r, t)
    sliding = (
        (speed > SLOWEST * np.max(speed, initial=0.0))
        & (r < joint.engagement_length_m)
        & np.isfinite(v)
    )
    cycles = measured_cycles(t[sliding], v[sliding], speed[sliding])
    oscillator = oscillator_of(pid, joint, mass_kg)
    stations = _stations(joint, t[sliding], r[sliding], speed[sliding])
    course = _course(oscillator, *stations, cycles)
    return _compared(cycles, stations, course)


def measured_cycles(t_s: ArrayLike, velocity_m_per_s: ArrayLike, mean_m_per_s: ArrayLike) -> Cycles:
    """Cut an oscillation of the speed into cycles, where it rises through its mean.

    Parameters
    ----------
    t_s : array_like
        Times in s, rising.
    velocity_m_per_s : array_like
        v, in m/s.
    mean_m_per_s : array_like
        The mean that it oscillates about, in m/s.

    Returns
    -------
    Cycles

    Raises
    ------
    ScenarioError
        The columns are not lists of numbers, or differ in length.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1.0, 1001)
    >>> found = measured_cycles(t, 0.2 + 0.1 * np.sin(50.0 * t), np.full_like(t, 0.2))
    >>> found.frequency_hz.round(2)[:2], found.amplitude_m_per_s.round(2)[:2]
    (array([7.96, 7.96]), array([0.1, 0.1]))

    """
    t = column_of("t_s", t_s, ScenarioError)
    v = column_of("velocity_m_per_s", velocity_m_per_s, ScenarioError)
    mean = column_of("mean_m_per_s", mean_m_per_s, ScenarioError)
    if not t.shape == v.shape == mean.shape:
        raise ScenarioError(
            f"t_s, velocity_m_per_s, mean_m_per_s: have {t.size}, {v.size} and {mean.size} rows, "
            "not the same number; give three columns of one trace"
        )
    d = v - mean
    up = np.flatnonzero((d[:-1] < 0.0) & (d[1:] >= 0.0))
    at = t[up] - d[up] * (t[up + 1] - t[up]) / (d[up + 1] - d[up])
    rows = []
    for (begin, end), (first, last) in zip(pairwise(at), pairwise(up + 1), strict=True):
        if last - first < 8:
            continue
        turn = np.exp(-2j * pi * (t[first:last] - begin) / (end - begin))
        amplitude = abs(2.0 * np.mean(d[first:last] * turn))
        rows.append(
            ((begin + end) / 2, 1.0 / (end - begin), amplitude, float(np.mean(mean[first:last])))
        )
    columns = np.array(rows).reshape(-1, 4).T
    return Cycles(*columns)


def _stations(joint: AnyJoint, t: Array, position: Array, speed: Array) -> Stations:
    """Times, speeds and positions: few, and most of them where friction changes with speed."""
    if t.size < 2:
        return t, speed, position
    v_s = sqrt(2.0) * (steepest_change_velocity(joint) or np.inf)
    change = np.abs(np.diff(np.minimum(speed / v_s, FLAT)))
    share = np.diff(t) / (t[-1] - t[0]) + 4.0 * change / max(float(np.sum(change)), 1e-300)
    along = np.concatenate([[0.0], np.cumsum(share)])
    rows = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], STATIONS)))
    rows = rows[rows < t.size]
    return t[rows], speed[rows], position[rows]


@dataclass(frozen=True)
class _Course:
    """The predicted oscillation at the stations of a motion."""

    amplitude: Array
    frequency_hz: Array
    steady_amplitude: Array
    steady_hz: Array
    growth: Array


def _course(
    oscillator: Oscillator | None, t: Array, speed: Array, position: Array, cycles: Cycles
) -> _Course:
    none = np.full(t.shape, nan)
    if oscillator is None or not t.size:
        return _Course(none, none, none, none, none)
    amplitudes = GRID * speed[:, None]
    sigma, w = oscillator.growth(amplitudes, speed[:, None], position[:, None])
    hz = w / (2.0 * pi)
    steady = np.array([_attracting(a, s) for a, s in zip(amplitudes, sigma, strict=True)])
    amplitude = _followed(t, speed, sigma, cycles)
    return _Course(
        amplitude, _at(amplitudes, hz, amplitude), steady, _at(amplitudes, hz, steady), sigma[:, 0]
    )


def _attracting(amplitude: Array, sigma: Array) -> float:
    """Largest amplitude below which an oscillation grows and above which it decays."""
    turns = np.flatnonzero((sigma[:-1] > 0.0) & (sigma[1:] <= 0.0))
    if not turns.size:
        return nan
    i = int(turns[-1])
    share = sigma[i] / (sigma[i] - sigma[i + 1])
    return float(amplitude[i] + share * (amplitude[i + 1] - amplitude[i]))


def _followed(t: Array, speed: Array, sigma: Array, cycles: Cycles) -> Array:
    """Integrate d ln A / dt = sigma from the run's first cycle, by Heun's rule in fine steps."""
    amplitude = np.full(t.shape, nan)
    if not cycles.t_s.size or t.size < 2:
        return amplitude
    at_s = float(cycles.t_s[0])
    log_a = float(np.log(max(cycles.amplitude_m_per_s[0], 1e-300)))
    rate = _Rate(t, speed, np.nan_to_num(sigma, nan=-1e3))
    for i in np.flatnonzero(t > at_s):
        fine = np.linspace(at_s, t[i], 9)
        for begin, end in pairwise(fine):
            first = rate(begin, log_a)
            second = rate(end, log_a + (end - begin) * first)
            log_a += 0.5 * (end - begin) * (first + second)
        at_s = float(t[i])
        amplitude[i] = np.exp(log_a)
    return amplitude


@dataclass(frozen=True)
class _Rate:
    """Growth rate at a time and an amplitude, between stations and amplitudes."""

    t: Array
    speed: Array
    sigma: Array

    def __call__(self, at_s: float, log_a: float) -> float:
        i = int(np.clip(np.searchsorted(self.t, at_s) - 1, 0, self.t.size - 2))
        share = (at_s - self.t[i]) / (self.t[i + 1] - self.t[i])
        logs = np.log(GRID)
        here, there = (
            np.interp(log_a - np.log(self.speed[k]), logs, self.sigma[k]) for k in (i, i + 1)
        )
        return float(here + share * (there - here))


def _at(amplitudes: Array, values: Array, wanted: Array) -> Array:
    return np.array(
        [
            np.interp(a, row, column) if np.isfinite(a) else nan
            for a, row, column in zip(wanted, amplitudes, values, strict=True)
        ]
    )


def _compared(cycles: Cycles, stations: Stations, course: _Course) -> LimitCycleComparison:
    t, speed, _ = stations
    predicted_at = np.interp(cycles.t_s, t, course.amplitude) if t.size else cycles.t_s
    predicted_hz = np.interp(cycles.t_s, t, course.frequency_hz) if t.size else cycles.t_s
    predicted = _longest(predicted_at > SEEN * cycles.speed_m_per_s)
    simulated = _longest(cycles.amplitude_m_per_s > SEEN * cycles.speed_m_per_s)
    both = np.intersect1d(predicted, simulated)
    return LimitCycleComparison(
        verdict=_verdict(bool(predicted.size), bool(simulated.size)),
        cycles=cycles,
        predicted_t_s=t,
        speed_m_per_s=speed,
        steady_amplitude_m_per_s=course.steady_amplitude,
        steady_frequency_hz=course.steady_hz,
        growth_per_s=course.growth,
        course_amplitude_m_per_s=course.amplitude,
        course_frequency_hz=course.frequency_hz,
        predicted_window_s=_window(cycles, predicted),
        simulated_window_s=_window(cycles, simulated),
        predicted_hz=_mean(predicted_hz[both]),
        simulated_hz=_mean(cycles.frequency_hz[both]),
        predicted_amplitude_m_per_s=_mean(predicted_at[both] ** 2) ** 0.5,
        simulated_amplitude_m_per_s=_mean(cycles.amplitude_m_per_s[both] ** 2) ** 0.5,
    )


def _longest(seen: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Rows of the longest unbroken stretch; none if it is too short to be more than a jolt."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(int)))
    stretches = [np.arange(begin, end) for begin, end in edges.reshape(-1, 2)]
    longest = max(stretches, key=len, default=np.arange(0))
    return longest if longest.size >= CYCLES_MIN else np.arange(0)


def _window(cycles: Cycles, rows: NDArray[np.intp]) -> tuple[float, float]:
    return (float(cycles.t_s[rows[0]]), float(cycles.t_s[rows[-1]])) if rows.size else (nan, nan)


def _mean(values: Array) -> float:
    return float(np.mean(values)) if values.size else nan


def _verdict(predicted: bool, simulated: bool) -> Verdict:
    if predicted and simulated:
        return "agree: oscillation"
    if predicted:
        return "only predicted"
    return "only simulated" if simulated else "agree: none"
