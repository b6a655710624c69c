"""A pull from rest to slip: what it tells of a joint, each figure with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from breakaway.base.one_line import counted
from breakaway.errors import LogError
from breakaway.measure.identification.events import BreakawayEvent, BreakawayReport, at_part_quiet
from breakaway.measure.identification.sliding import SlidingLevel
from breakaway.measure.identification.stretches import noise
from breakaway.measure.logs.log import Array, Log

Z95 = 1.959964
"""Standard deviations of a 95 % interval."""

RISE = (0.05, 0.5)
"""Shares of the rise of the load over which the compliance is fitted: later the joint yields."""

FEWEST_ROWS = 8
"""Fewest rows in that share of the rise that tell a stiffness."""

LARGEST = 3.0
"""The largest of some hundred noisy samples about a peak exceeds it by so many times the noise."""

YIELD_FACTOR = 2.0
"""Inertia hides how steeply friction falls: up to this many times as steeply as the load."""


@dataclass(frozen=True, kw_only=True)
class Seen:
    """A figure with its 95 % interval; the upper end is infinite for a bound from below."""

    value: float
    low: float
    high: float
    at_least: str = ""
    """Why it is a bound from below; empty where it is none."""

    @property
    def standard_error(self) -> float:
        """Half of the interval's finite part, in standard deviations."""
        ends = [abs(end - self.value) for end in (self.low, self.high) if math.isfinite(end)]
        return max(ends) / Z95

    def draws(self, rng: np.random.Generator, count: int) -> Array:
        """Draw values: normal on either side, as wide as the interval is there."""
        z = rng.standard_normal(count)
        width = np.where(z < 0.0, self.value - self.low, self.high - self.value) / Z95
        return np.asarray(self.value + z * width)


@dataclass(frozen=True, kw_only=True)
class Pull:
    """What the first start from rest of a log tells; None for what it does not show."""

    event: BreakawayEvent
    stiction_n: Seen
    coulomb_n: Seen | None
    stiffness_n_per_m: Seen | None
    release_speed_m_per_s: Seen | None
    sliding_speed_m_per_s: float | None
    zero_error_n: float
    notes: tuple[str, ...]


def pull_of(report: BreakawayReport, log: Log) -> Pull:
    """Tell what a pull shows of a joint.

    ::

        stiction     F_s = the largest load before the slip
        Coulomb      F_c = the load of steady sliding, at its speed
        stiffness    k   = dF/dx where the load begins to rise, by x = a + F/k + c F²
        release      v   = the largest speed from the peak until the load is that of sliding

    Parameters
    ----------
    report : BreakawayReport
        Of the log.
    log : Log
        As it was measured.

    Raises
    ------
    LogError
        The log shows no start from rest, or the report is of another log.

    """
    if (report.name, report.sha256) != (log.name, log.sha256):
        raise LogError(f"report: is of {report.name}, not of {log.name}; search this log")
    if not report.events:
        why = "; ".join(report.refused) or "it has no start from rest"
        raise LogError(f"{log.name}: no joint comes of this log: {why}")
    event = report.events[0]
    level = _steady(report, event)
    rows = _Rows.of(report, log, event, level)
    _check_sign(log, event, rows, level)
    stiffness, bend_n = rows.stiffness()
    zero_n = rows.zero_error_n(report)
    sliding = None
    if rows.slide_n is not None and level is not None:
        gain = 0.0 if report.rig is None else 0.01 * report.rig.force_calibration_percent
        errors = (level.spread_n, report.offset_error_n or 0.0, gain * rows.slide_n)
        half = Z95 * math.hypot(*errors) + zero_n
        sliding = _around(rows.slide_n, half, half)
    return Pull(
        event=event,
        stiction_n=_no_less(_stiction(event, zero_n, bend_n), sliding),
        coulomb_n=sliding,
        stiffness_n_per_m=stiffness,
        release_speed_m_per_s=rows.release_speed(),
        sliding_speed_m_per_s=None if level is None else level.speed_m_per_s,
        zero_error_n=zero_n,
        notes=tuple(_notes(report, event, level, zero_n, bend_n)),
    )


def _check_sign(log: Log, event: BreakawayEvent, rows: _Rows, level: SlidingLevel | None) -> None:
    """Refuse a part that moves against its force."""
    slides = 1.0 if level is None or rows.slide_n is not None else -1.0
    for force, does in ((event.breakaway_force_n, "starts to move"), (slides, "slides")):
        if force <= 0.0:
            raise LogError(
                f"{log.name}: the part {does} against the force, at {event.time_s:.6g} s; a force "
                "counts positive where it drives the position up: give it another sign in the "
                "mapping, or its offset"
            )


def _steady(report: BreakawayReport, event: BreakawayEvent) -> SlidingLevel | None:
    """Give the longest steady sliding after a start: what is slid within a slip is no level."""
    after = [
        level
        for level in report.sliding
        if level.direction == event.direction and level.end_s > event.time_s
    ]
    return max(after, key=lambda level: level.end_s - level.start_s, default=None)


def is_pull(report: BreakawayReport) -> bool:
    """Whether a log is a pull to slip: it starts from rest, and the part never turns around."""
    ways = {level.direction for level in report.sliding} | {e.direction for e in report.events}
    return bool(report.events) and len(ways) == 1


def _stiction(event: BreakawayEvent, zero_n: float, bend_n: float) -> Seen:
    value = event.breakaway_force_n
    half = Z95 * event.breakaway_error_n + zero_n
    below = half + LARGEST * event.force_noise_n
    if event.is_lower_bound:
        low = max(value - below, 0.0)
        return Seen(value=value, low=low, high=math.inf, at_least=event.reason)
    return _around(value, below, half + (event.unseen_gain_n or 0.0) + bend_n)


def _no_less(held: Seen, sliding: Seen | None) -> Seen:
    """Give stiction that is no less than sliding friction: where no peak stands out, a bound."""
    if sliding is None or held.value > sliding.value:
        return held
    why = (
        f"the largest load before the slip, {held.value:.4g} N, does not exceed that of sliding, "
        f"{sliding.value:.4g} N, and a joint holds at least what it slides with"
    )
    return replace(held, value=sliding.value, high=math.inf, at_least=held.at_least or why)


def _around(value: float, below: float, above: float) -> Seen:
    return Seen(value=value, low=max(value - below, 0.0), high=value + above)


def _notes(
    report: BreakawayReport,
    event: BreakawayEvent,
    level: SlidingLevel | None,
    zero_n: float,
    bend_n: float,
) -> list[str]:
    notes = [
        "stiction_n is the load that broke the joint loose at this loading rate; a law whose "
        "friction falls with speed, such as LuGre, lets go below its F_s, the more so the faster "
        "the load rises"
    ]
    if len(report.events) > 1:
        later = counted(len(report.events) - 1, "later start")
        notes.append(f"the first start from rest counts, at {event.time_s:.6g} s; not {later}")
    if report.offset_n is None:
        notes.append(
            f"the offset of the force is not known ({report.offset_reason}); the load at rest "
            f"before the pull, {zero_n:.3g} N, widens the intervals of both forces"
        )
    if bend_n > 0.0 and not event.is_lower_bound:
        notes.append(
            f"the joint yields before its peak; its stiction may lie up to {bend_n:.3g} N above "
            "the largest load, and the interval allows for that"
        )
    if level is not None:
        notes.append(
            f"coulomb_n is the load of sliding at {level.speed_m_per_s:.3g} m/s; if friction falls "
            "further above that speed, it is less, and so it is in the draws"
        )
    if report.spikes:
        notes.append(f"{counted(len(report.spikes), 'single sample')} of the force count as none")
    return notes


@dataclass(frozen=True)
class _Rows:
    """The rows of a pull: time, way and load in its direction, from rest to the end of the log."""

    t_s: Array
    way_m: Array
    load_n: Array
    begin: int
    peak: int
    event: BreakawayEvent
    slide_n: float | None
    noise_m: float
    joint_alone: bool
    stiffness_error: float
    """Relative standard uncertainty of the rig's compliance, as a part of the joint's."""

    @classmethod
    def of(
        cls, report: BreakawayReport, log: Log, event: BreakawayEvent, level: SlidingLevel | None
    ) -> _Rows:
        at_part = at_part_quiet(log, report.rig)[0]
        since = event.time_s - event.rest_s if event.load_start_s is None else event.load_start_s
        rig = report.rig
        slide = 0.0 if level is None else level.force_n - (report.offset_n or 0.0)
        return cls(
            t_s=at_part.t_s,
            way_m=event.direction * at_part.position_m,
            load_n=event.direction * (at_part.force_n - (report.offset_n or 0.0)),
            begin=int(np.searchsorted(at_part.t_s, since)),
            peak=int(np.searchsorted(at_part.t_s, event.time_s)),
            event=event,
            slide_n=event.direction * slide if event.direction * slide > 0.0 else None,
            noise_m=noise(log.position_m),
            joint_alone=rig is not None and rig.stiffness_is_told,
            stiffness_error=0.0
            if rig is None or rig.stiffness_n_per_m is None
            else rig.stiffness_error_n_per_m / rig.stiffness_n_per_m**2,
        )

    def zero_error_n(self, report: BreakawayReport) -> float:
        """Give how far the force may be from its zero: where unknown, the load at rest."""
        if report.offset_n is not None or self.event.load_start_s is None:
            return 0.0
        rest = self.load_n[: self.begin]
        return abs(float(np.median(rest))) if rest.size else abs(float(self.load_n[self.begin]))

    def stiffness(self) -> tuple[Seen | None, float]:
        """Give the stiffness at the start of the rise, and how far stiction may exceed the peak.

        The second is the way that the joint yields before its peak times how steeply friction
        falls after it.
        """
        load, way = self.load_n[self.begin : self.peak + 1], self.way_m[self.begin : self.peak + 1]
        if load.size == 0:
            return None, 0.0
        rise = load - load[0]
        inside = (rise >= RISE[0] * rise[-1]) & (rise <= RISE[1] * rise[-1])
        if np.count_nonzero(inside) < FEWEST_ROWS or rise[-1] <= 0.0:
            return None, 0.0
        compliance, error = self._compliance(rise[inside], way[inside])
        yielded = float(way[-1] - way[0]) - compliance * float(rise[-1])
        bend_n = YIELD_FACTOR * max(yielded, 0.0) * self._fall_n_per_m()
        return self._told(compliance, error), bend_n

    def _compliance(self, load: Array, way: Array) -> tuple[float, float]:
        """Fit x = a + F/k + c F², and return 1/k with its standard error."""
        scale = float(load.max())
        matrix = np.vander(load / scale, 3, increasing=True)
        found, *_ = np.linalg.lstsq(matrix, way, rcond=None)
        rest = way - matrix @ found
        variance = max(float(rest @ rest) / max(len(way) - 3, 1), self.noise_m**2)
        error = math.sqrt(variance * np.linalg.inv(matrix.T @ matrix)[1, 1]) / scale
        return float(found[1]) / scale, math.hypot(error, self.stiffness_error)

    def _told(self, compliance: float, error: float) -> Seen | None:
        softest = compliance + Z95 * error
        if softest <= 0.0:
            return None
        stiffest = compliance - Z95 * error
        if not self.joint_alone:
            why = "it is that of joint and rig in series; a rig file (--rig) tells the joint's"
            value = 1.0 / (compliance if stiffest > 0.0 else softest)
            return Seen(value=value, low=1.0 / softest, high=math.inf, at_least=why)
        if stiffest <= 0.0:
            why = "the position barely moves before the slip, against its noise"
            return Seen(value=1.0 / softest, low=1.0 / softest, high=math.inf, at_least=why)
        return Seen(value=1.0 / compliance, low=1.0 / softest, high=1.0 / stiffest)

    def _fall_n_per_m(self) -> float:
        """Give how steeply the load falls over the way, from its peak to half of the fall."""
        slide = self.slide_n
        if slide is None:
            return 0.0
        load = self.load_n[self.peak :]
        below = np.flatnonzero(load <= 0.5 * (load[0] + slide))
        if not below.size:
            return 0.0
        way = float(self.way_m[self.peak + below[0]] - self.way_m[self.peak])
        fallen = float(load[0] - load[below[0]])
        return fallen / way if way > self.noise_m else 0.0

    def release_speed(self) -> Seen | None:
        """Give the largest speed, over two samples, from the peak until the load is the level."""
        slide = self.slide_n
        if slide is None:
            return None
        down = np.flatnonzero(self.load_n[self.peak :] <= slide)
        last = self.peak + int(down[0]) + 2 if down.size else len(self.t_s)
        t, x = self.t_s[self.peak - 1 : last + 1], self.way_m[self.peak - 1 : last + 1]
        if self.peak < 1 or len(t) < 3:
            return None
        speed = (x[2:] - x[:-2]) / (t[2:] - t[:-2])
        fastest = int(np.argmax(speed))
        half = Z95 * math.sqrt(2.0) * self.noise_m / float(t[fastest + 2] - t[fastest])
        value = float(speed[fastest])
        return _around(value, half, half) if value > 0.0 else None
