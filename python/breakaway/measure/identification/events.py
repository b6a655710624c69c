"""Breakaway from rest in a log of position and force: what it took, and what the log hides."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.base.text import shown
from breakaway.errors import LogError
from breakaway.measure.identification.faults.spikes import spikes
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.sliding import (
    FAST,
    FEWEST_SAMPLES,
    Reversal,
    SlidingLevel,
    estimate_offset,
    friction,
    reversals,
    sliding_levels,
)
from breakaway.measure.identification.stretches import (
    RESOLVED,
    Places,
    Stretch,
    Stretches,
    find_stretches,
    noise,
)
from breakaway.measure.logs.log import Array, Log

SIGNIFICANCE = 5.0
"""A force differs from another by this many standard deviations of its noise."""

LEVEL = 0.1
"""Forces within this share of the sliding friction of the sliding level count as at the level."""

LOADING = (0.1, 0.9)
"""Shares of the rise of the load between which its rate is fitted."""

LOAD_STARTS = 0.05
"""The load starts where it last was within this share of its rise."""

WORTH = 0.25
"""A peak that a gap may hide is reported if it exceeds the sliding level by this share."""

PROMINENT = 0.5
"""A peak after no rest is taken as a breakaway if it exceeds the sliding level by this share."""

RISING_SAMPLES = 3
"""Fewest samples within the rise of a load that show how it rises."""

FILTER_RISE = 0.35
"""Rise of a step through a low-pass from 10 to 90 %, in periods of its cutoff."""

SATURATED_SAMPLES = 4
"""A peak of as many equal samples is cut off."""


@dataclass(frozen=True)
class Spike:
    """A single sample of the force that stands alone."""

    time_s: float
    force_n: float


@dataclass(frozen=True, kw_only=True)
class BreakawayEvent:
    """A start from rest: what load the joint held, and what it took to keep sliding.

    Forces are magnitudes in the direction of motion, at the part where a rig is given. Those
    named ``raw`` are with the offset of the sensor; the others have the report's offset taken off
    where it is known, else they equal the raw ones.

    Attributes
    ----------
    time_s : float
        Time of the peak on the log's clock.
    direction : int
        1 where the position rises, -1 where it falls.
    breakaway_force_n, raw_breakaway_force_n : float
        Largest load from rest until sliding is established.
    sliding_force_n, raw_sliding_force_n : float or None
        Median force of the steady sliding that follows; None where none does.
    breakaway_over_sliding : float or None
        Ratio of the two; None where no sliding follows or its force is not positive.
    presliding_displacement_m : float or None
        Way from the start of loading to the peak; None where that start is not in the log.
    loading_rate_n_per_s : float or None
        Slope of a line through the load between 10 and 90 % of its rise; None where fewer than
        three samples lie there, or a gap does.
    load_start_s : float or None
        Time at which the load starts to grow.
    rest_s : float
        How long the part is seen at rest before, without the time of gaps.
    fallen_share : float or None
        How much of the way from the peak down to the sliding level was recorded before a gap,
        or before the log ends: 1 where there is none. None where that way is no longer than
        a tenth of the sliding friction, or the sliding level is not known.
    is_lower_bound : bool
        Whether the joint may have held more than was recorded.
    reason : str
        Why it is a lower bound; empty where it is not one.
    force_noise_n : float
        Standard deviation of the force's noise.
    breakaway_error_n : float
        Standard uncertainty of ``breakaway_force_n``, from noise and offset, and of a rig from
        the load cell's gain and the inertia that was taken off.
    sliding_error_n : float or None
        That of ``sliding_force_n``, from offset and gain.
    unseen_gain_n : float or None
        What the load gains in one time step and in the time constant of the rig's filter: about
        as much may the peak exceed the recorded one.

    """

    time_s: float
    direction: int
    breakaway_force_n: float
    raw_breakaway_force_n: float
    sliding_force_n: float | None
    raw_sliding_force_n: float | None
    breakaway_over_sliding: float | None
    presliding_displacement_m: float | None
    loading_rate_n_per_s: float | None
    load_start_s: float | None
    rest_s: float
    fallen_share: float | None
    is_lower_bound: bool
    reason: str
    force_noise_n: float
    breakaway_error_n: float
    sliding_error_n: float | None
    unseen_gain_n: float | None


@dataclass(frozen=True, kw_only=True)
class BreakawayReport(OneLine):
    """What a log shows of breakaway, and why it does not show more.

    ``offset_n`` is None, with its reason, where it cannot be estimated. ``spikes`` are single
    samples of the force that stand alone and are taken for no load. ``gaps_s`` has the
    stamps before and after each gap. ``rig`` and ``settings`` are what the search was made with.
    """

    name: str
    sha256: str | None
    events: tuple[BreakawayEvent, ...]
    refused: tuple[str, ...]
    reversals: tuple[Reversal, ...]
    sliding: tuple[SlidingLevel, ...]
    offset_n: float | None
    offset_error_n: float | None
    offset_reason: str
    force_noise_n: float
    spikes: tuple[Spike, ...]
    position_resolution_m: float
    rest_speed_m_per_s: float
    speed_window_s: float
    gaps_s: tuple[tuple[float, float], ...]
    rig: RigFile | None
    settings: Mapping[str, float | None]

    def __repr__(self) -> str:
        bounds = sum(event.is_lower_bound for event in self.events)
        events = f"{counted(len(self.events), 'event')}, {counted(bounds, 'lower bound')}"
        return f"<breakaway in {shown(self.name)}: {events}, {len(self.refused)} refused>"


def find_breakaway_events(
    log: Log,
    *,
    rest_speed_m_per_s: float | None = None,
    min_rest_s: float = 0.1,
    min_slip_m: float | None = None,
    gap_s: float | None = None,
    sliding_window_s: float | None = None,
    passed_share: float = 0.5,
    offset_n: float | None = None,
    rig: RigFile | None = None,
) -> BreakawayReport:
    """Find every start from rest in a log, and the load that it took.

    ::

        breakaway         F_b = max d (F - F_0)    from rest until sliding is established
        sliding           F_c = median d (F - F_0) over the window of steady sliding after it
        offset            F_0 = (F_up + F_down) / 2,  medians of steady sliding either way

    with d the direction of motion. Rest and motion are told apart as `find_stretches`
    describes. Sliding is established once the part has half of its median speed and the load
    has come back to a tenth of its excess over the sliding level; a load that stays at that
    level for as long as it took to get there has no peak. A gap of the log is never
    interpolated: a peak beside one, or that may lie in one, makes the event a lower bound, or,
    where the load before it did not come to the sliding level, a refusal. So does a load that
    rises within fewer than three samples. A single sample that stands alone is no load: it is
    listed, and the load before it is taken to last. A part that never moves gives one lower
    bound, the largest load that it held.

    Background: C. Canudas de Wit et al., "A new model for control of systems with friction",
    IEEE Transactions on Automatic Control 40(3), 1995, shows how the breakaway force falls with
    the loading rate, which is why each event has its rate.

    Parameters
    ----------
    log : Log
        Position and force; the force counts positive where it drives the position up.
    rest_speed_m_per_s : float, optional
        The part rests below this speed, > 0. By default a tenth of the speed at which it covers
        half of its way, and no less than the noise of the position allows.
    min_rest_s : float
        A shorter standstill within the log is no rest, >= 0.
    min_slip_m : float, optional
        A smaller move is presliding, >= 0. By default 1 % of the travel.
    gap_s : float, optional
        A longer time step is a gap, > 0. By default 2.5 median steps.
    sliding_window_s : float, optional
        Time of sliding over which its level is taken, > 0. By default until the next rest or
        turn.
    passed_share : float
        A peak before a gap counts as seen if the load had fallen by this share of the way to
        the sliding level, > 0 and <= 1.
    offset_n : float, optional
        Known offset of the force sensor; 0 leaves the force as it is. By default it is
        estimated.
    rig : RigFile, optional
        What lies between the part and the sensors: position and force at the part are searched,
        a rise that its filter cannot follow makes a lower bound, and the uncertainty of the
        load cell's gain goes into all errors.

    Returns
    -------
    BreakawayReport

    Raises
    ------
    LogError
        A setting is out of range, time does not increase, gaps leave too few samples, or the
        part neither moves nor is loaded.

    Notes
    -----
    Not checked: inertia, so the acceleration times the part's mass must be small against
    friction, or be taken off before; friction that differs between the directions, which looks
    like an offset; a delay between force and position; moves too small or too slow for the noise of
    the position; a log that begins within the standstill of a turn, which looks like a rest.
    The largest of many noisy samples exceeds the mean by about their noise.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(400) / 100.0
    >>> x = 0.01 * np.maximum(t_s - 1.0, 0.0)
    >>> load = np.where(t_s <= 1.0, 90.0 * t_s, 40.0 + 50.0 * np.exp(-(t_s - 1.0) / 0.02))
    >>> report = find_breakaway_events(Log(t_s=t_s, position_m=x, force_n=load))
    >>> event = report.events[0]
    >>> event.breakaway_force_n, round(event.sliding_force_n, 3), event.is_lower_bound
    (90.0, 40.0, False)
    >>> report.offset_reason
    'the part slides only one way; give offset_n'

    """
    check_arguments(find_breakaway_events, locals(), LogError)
    settings: dict[str, float | None] = {
        "rest_speed_m_per_s": rest_speed_m_per_s,
        "min_rest_s": min_rest_s,
        "min_slip_m": min_slip_m,
        "gap_s": gap_s,
        "sliding_window_s": sliding_window_s,
        "passed_share": passed_share,
        "offset_n": offset_n,
    }
    _check_settings(settings)
    at_part, quiet, places = at_part_quiet(log, rig)
    cut = find_stretches(
        at_part,
        rest_speed_m_per_s=rest_speed_m_per_s,
        min_rest_s=min_rest_s,
        min_slip_m=min_slip_m,
        gap_s=gap_s,
    )
    levels = sliding_levels(cut, at_part.force_n)
    offset, error, why = (
        estimate_offset(levels) if offset_n is None else (float(offset_n), 0.0, "given")
    )
    search = _Search(
        log.name, cut, at_part.force_n, places, noise(at_part.force_n), offset, error,
        sliding_window_s,
        passed_share, friction(levels, offset), rig or RigFile(),
        quiet.force_n - at_part.force_n,
    )  # fmt: skip
    events, refused = search.starts()
    return BreakawayReport(
        name=log.name,
        sha256=log.sha256,
        events=tuple(events),
        refused=tuple(refused),
        reversals=reversals(cut),
        sliding=levels,
        offset_n=offset,
        offset_error_n=error,
        offset_reason=why,
        force_noise_n=search.noise_n,
        spikes=tuple(Spike(float(log.t_s[k]), float(log.force_n[k])) for k in places),
        position_resolution_m=cut.resolution_m,
        rest_speed_m_per_s=cut.rest_speed_m_per_s,
        speed_window_s=cut.window_s,
        gaps_s=tuple((float(cut.t_s[g]), float(cut.t_s[g + 1])) for g in cut.gaps),
        rig=rig,
        settings=settings,
    )


def at_part_quiet(log: Log, rig: RigFile | None) -> tuple[Log, Log, Places]:
    """Return a log without single-sample spikes at the part, as it was measured, and their places.

    The load before a spike is taken to last.
    """
    places = spikes(log, "force_n")
    held = log.force_n.copy()
    held[places] = held[places - 1]
    quiet = Log(force_n=held, channels=log.channels, source=log.source, sha256=log.sha256)
    return (quiet if rig is None else rig.at_part(quiet)), quiet, places


@dataclass(frozen=True)
class _Start:
    """A start that is looked at: its rest and motion, and the load along its direction.

    The arrays begin with the log; ``end`` is the last sample of the motion.
    """

    direction: int
    rest: int
    move: int
    end: int
    load: Array
    fast: npt.NDArray[np.bool_]
    level: float | None


@dataclass(frozen=True)
class _Search:
    """All that the search for the events of one log needs to know."""

    name: str
    cut: Stretches
    force_n: Array
    spikes: Places
    noise_n: float
    offset_n: float | None
    offset_error_n: float | None
    window_s: float | None
    passed_share: float
    friction_n: float
    rig: RigFile
    inertia_n: Array

    @property
    def tolerance_n(self) -> float:
        """Forces that differ by less are one level."""
        return max(SIGNIFICANCE * self.noise_n, LEVEL * self.friction_n)

    def starts(self) -> tuple[list[BreakawayEvent], list[str]]:
        """Look at every start in turn."""
        stretches = self.cut.stretches
        if len(stretches) == 1 and stretches[0].direction == 0:
            jumps = self.cut.jumps(0, stretches[0].last)
            return ([], [self._in_gap(g) for g in jumps]) if jumps else ([self._never()], [])
        found: list[BreakawayEvent | str] = []
        if stretches[0].direction:
            found.append(self._without_rest(stretches[0]))
        for k, stretch in enumerate(stretches):
            if stretch.direction == 0:
                found += [self._in_gap(g) for g in self.cut.jumps(stretch.first, stretch.last)]
                if k + 1 < len(stretches) and not self._started_in_gap(stretch):
                    found.append(self._from_rest(self.cut.rest_since(stretch), stretches[k + 1]))
        events = [event for event in found if isinstance(event, BreakawayEvent)]
        return events, [reason for reason in found if isinstance(reason, str)]

    def _started_in_gap(self, rest: Stretch) -> bool:
        """Whether a part that moved over a gap of a rest did not come to rest after it."""
        since = self.cut.rest_since(rest)
        return since > rest.first and not self.cut.shows_rest(since, rest.last + 1)

    def _in_gap(self, gap: int) -> str:
        t_s, x = self.cut.t_s, self.cut.position_m
        return (
            f"the move of {1e3 * (x[gap + 1] - x[gap]):.3g} mm at {t_s[gap]:.6g} s fell into a gap "
            f"of {t_s[gap + 1] - t_s[gap]:.3g} s; its breakaway was not recorded"
        )

    def _start(self, rest: int, motion: Stretch) -> _Start:
        load = motion.direction * self.force_n
        speed = motion.direction * self.cut.speed_m_per_s
        inside = np.zeros(len(load), dtype=bool)
        inside[motion.first : motion.last + 1] = True
        moving = speed[inside & (speed > self.cut.rest_speed_m_per_s)]
        fast = inside & (speed >= FAST * (np.median(moving) if moving.size else np.inf))
        start = _Start(motion.direction, rest, motion.first, motion.last, load, fast, None)
        places = np.flatnonzero(fast)
        if places.size < FEWEST_SAMPLES:
            return start
        # The first pass knows no peak yet; the second takes the level after it.
        since = int(places[0])
        for _ in range(2):
            start = replace(start, level=self._level(start, since))
            since = self._peak(start)
            if not self._is_down(start, since).any():  # a load that grew to the end
                return replace(start, level=None)
        return start

    def _level(self, start: _Start, since: int) -> float | None:
        """Return the median load over the window of steady sliding after a sample."""
        t_s = self.cut.t_s
        after = np.flatnonzero(start.fast)
        after = after[after >= self._settled(start, since)] if start.level is not None else after
        end_s = (
            math.inf if self.window_s is None or not after.size else t_s[after[0]] + self.window_s
        )
        near = after[t_s[after] <= end_s]
        # Few samples, say before a gap: take as many as a level needs.
        chosen = near if near.size >= FEWEST_SAMPLES else after[:FEWEST_SAMPLES]
        return float(np.median(start.load[chosen])) if chosen.size else start.level

    def _settled(self, start: _Start, peak: int) -> int:
        """Return the first sample after the peak at which sliding is established."""
        down = self._is_down(start, peak)
        return peak + int(np.argmax(down)) if down.any() else start.end

    def _is_down(self, start: _Start, peak: int) -> npt.NDArray[np.bool_]:
        """Tell for each sample from the peak on whether it slides at the sliding level."""
        load, level = start.load[peak : start.end + 1], start.level
        if level is None:
            return np.zeros(len(load), dtype=bool)
        excess = max(LEVEL * (load[0] - level), SIGNIFICANCE * self.noise_n)
        return np.asarray(start.fast[peak : start.end + 1] & (load <= level + excess))

    def _peak(self, start: _Start) -> int:
        """Return the sample with the largest load from rest until sliding is established."""
        load = start.load[start.rest : start.end + 1]
        if start.level is None:
            return start.rest + int(np.argmax(load))
        fast = start.fast[start.rest : start.end + 1]
        above = load > start.level + self.tolerance_n
        reached = _first((load >= start.level - self.tolerance_n) & fast | above)
        exceeded = _first(above)
        if reached is None:
            return start.rest + int(np.argmax(load))
        if exceeded is None or self._dwells(start, reached, exceeded):
            return start.rest + int(np.argmax(load[: reached + 1]))
        top = np.maximum.accumulate(load)
        settled = load <= start.level + np.maximum(LEVEL * (top - start.level), 3.0 * self.noise_n)
        settled[: max(exceeded, int(np.argmax(fast)))] = False
        last = _first(settled)
        return start.rest + int(np.argmax(load[: len(load) if last is None else last + 1]))

    def _dwells(self, start: _Start, reached: int, exceeded: int) -> bool:
        """Whether the load stays at the level for as long as it took to get there."""
        t_s = self.cut.t_s[start.rest :]
        begin = self._load_start(start, start.rest + reached) - start.rest
        slack = 3.0 * float(np.median(np.diff(self.cut.t_s)))
        return bool(t_s[exceeded] - t_s[reached] > t_s[reached] - t_s[begin] + slack)

    def _load_start(self, start: _Start, peak: int) -> int:
        load = start.load[start.rest : peak + 1]
        # A median of three, so that one odd sample is not the lowest load.
        smooth = np.median(np.stack([load[:-2], load[1:-1], load[2:]]), axis=0)
        low = float(smooth.min() if smooth.size else load.min())
        limit = low + max(4.0 * self.noise_n, LOAD_STARTS * (load[-1] - low))
        below = np.flatnonzero(load <= limit)
        return start.rest + int(below[-1])

    def _from_rest(self, rest: int, motion: Stretch) -> BreakawayEvent | str:
        t_s = self.cut.t_s
        if not self.cut.shows_rest(rest, motion.first):
            if rest == 0:
                return self._without_rest(motion)
            return (
                f"the start at {t_s[motion.first]:.6g} s: too few samples show the part at rest "
                "before it; its breakaway was not recorded"
            )
        start = self._start(rest, motion)
        peak = self._peak(start)
        reason = self._hidden(start, peak)
        worth = max(SIGNIFICANCE * self.noise_n, WORTH * self.friction_n)
        if self._gap_before(start, peak) and self._excess(start, peak) <= worth:
            return (
                f"the start at {t_s[motion.first]:.6g} s: {reason}; the recorded load hardly "
                "exceeds the sliding level, so its breakaway was not recorded"
            )
        load_seen = not self._loaded_at_start(start, peak)
        return self._event(start, peak, reason, load_seen=load_seen)

    def _excess(self, start: _Start, peak: int) -> float:
        """Return by how much a peak exceeds the sliding level; infinite where there is none."""
        return math.inf if start.level is None else float(start.load[peak] - start.level)

    def _without_rest(self, motion: Stretch) -> BreakawayEvent | str:
        """Judge a log that shows no rest before it moves: its loading, or only sliding."""
        start = self._start(0, motion)
        peak = self._peak(start)
        grown = start.load[peak] - start.load[0] > self.tolerance_n
        prominent = max(self.tolerance_n, PROMINENT * self.friction_n)
        if start.level is not None and grown and self._excess(start, peak) > prominent:
            reason = self._hidden(start, peak) or self._already_loaded(start)
            return self._event(start, peak, reason, load_seen=False)
        return f"{self._how_it_begins()}; its breakaway was not recorded"

    def _how_it_begins(self) -> str:
        first, t_s = self.cut.seen_from, self.cut.t_s
        speed = abs(float(self.cut.speed_m_per_s[first]))
        if speed <= self.cut.rest_speed_m_per_s:
            return f"shows no rest of {self.cut.window_s:.2g} s before it first moves"
        moving = f"is already moving at {1e3 * speed:.2g} mm/s"
        if first == 0:
            return f"{moving} in the first sample"
        samples = "sample" if first == 1 else f"{first} samples"
        gap = t_s[first] - t_s[first - 1]
        return f"{moving} after the gap of {gap:.3g} s that follows the first {samples}"

    def _already_loaded(self, start: _Start) -> str:
        return (
            f"the log starts with the load already growing, at {start.load[0]:.4g} N; a higher "
            "peak may lie before it"
        )

    def _hidden(self, start: _Start, peak: int) -> str:
        """Say what may hide a higher load than the recorded peak; empty where nothing does."""
        reasons = [self._gap_before(start, peak), self._after(start, peak)]
        reasons += [self._saturated(peak), self._loaded_at_start(start, peak)]
        reasons += [self._beside_spike(start, peak), self._steep(start, peak)]
        return next((reason for reason in reasons if reason), "")

    def _gap_before(self, start: _Start, peak: int) -> str:
        begin = self._load_start(start, peak)
        t_s, gaps = self.cut.t_s, self.cut.gaps
        for gap in gaps[(gaps >= begin) & (gaps < peak)]:
            if gap + 1 >= min(start.move, peak) or self.cut.moved_over(int(gap)):
                return (
                    f"a gap of {t_s[gap + 1] - t_s[gap]:.3g} s lies between the start of loading "
                    "and the recorded peak"
                )
        return ""

    def _fallen(self, start: _Start, peak: int) -> tuple[float | None, int | None]:
        """Return the share of the fall that was recorded, and the gap or end that follows it."""
        last = start.end if start.level is None else self._settled(start, peak)
        flat = self._excess(start, peak) <= self.tolerance_n
        if flat:  # no fall says that the peak is over: the level itself has to be seen
            last = min(last + FEWEST_SAMPLES, start.end)
        gaps = self.cut.gaps[(self.cut.gaps >= peak) & (self.cut.gaps < last)]
        ends = start.level is None and self._ends_loaded(start, peak)
        if not gaps.size and not ends:
            return 1.0, None
        stop = int(gaps[0]) if gaps.size else len(start.load) - 1
        if start.level is None or flat:
            return None, stop
        drop = float(start.load[peak] - start.load[stop])
        return min(drop / self._excess(start, peak), 1.0), stop

    def _ends_loaded(self, start: _Start, peak: int) -> bool:
        """Whether the log ends without another move, and with the load still near its peak."""
        if any(stretch.direction and stretch.first > start.end for stretch in self.cut.stretches):
            return False
        rise = start.load[peak] - start.load[start.rest : peak + 1].min()
        fallen = start.load[peak] - np.median(start.load[max(peak, len(start.load) - 3) :])
        return bool(fallen <= max(SIGNIFICANCE * self.noise_n, LEVEL * rise))

    def _after(self, start: _Start, peak: int) -> str:
        share, stop = self._fallen(start, peak)
        if stop is None:
            return ""
        significant = start.load[peak] - start.load[stop] > SIGNIFICANCE * self.noise_n
        if share is not None and share >= self.passed_share and significant:
            return ""
        t_s = self.cut.t_s
        samples = f"{stop - peak} sample{'' if stop - peak == 1 else 's'}"
        if stop == len(t_s) - 1:
            return f"the log ends {samples} after the recorded peak, before sliding is established"
        fallen = "" if not share else f", when {100 * share:.0f} % of the fall was recorded"
        gap = f"a gap of {t_s[stop + 1] - t_s[stop]:.3g} s"
        if stop == peak:
            return f"{gap} follows the recorded peak at once{fallen}"
        return f"{gap} begins {samples} after the recorded peak{fallen}"

    def _beside_spike(self, start: _Start, peak: int) -> str:
        """Say so where a single sample stands alone between the peak and sliding."""
        last = peak + 1 if start.level is None else self._settled(start, peak)
        beside = self.spikes[(self.spikes >= max(start.move, peak) - 1) & (self.spikes <= last)]
        if not beside.size:
            return ""
        return (
            f"a single sample at {self.cut.t_s[beside[0]]:.6g} s stands alone beside the peak; the "
            "joint held more if it is no disturbance"
        )

    def _steep(self, start: _Start, peak: int) -> str:
        """Say so where the load rises too fast for the samples, or for the rig's filter."""
        begin = self._load_start(start, peak)
        rise = start.load[peak] - start.load[begin]
        places = np.flatnonzero(self._rising(start, begin, peak)) + begin
        if rise <= SIGNIFICANCE * self.noise_n:
            return ""
        if places.size < RISING_SAMPLES:
            return (
                f"the load rises by {rise:.4g} N with {counted(places.size, 'sample')} on the way; "
                "a higher peak may lie between two samples"
            )
        lasts = float(self.cut.t_s[places[-1]] - self.cut.t_s[places[0]])
        filter_hz = self.rig.filter_hz
        if filter_hz is None or lasts > 2.0 * FILTER_RISE / filter_hz:
            return ""
        return (
            f"the load rises within {lasts:.2g} s, which the rig's filter of {filter_hz:g} Hz does "
            "not follow; the peak was higher"
        )

    def _saturated(self, peak: int) -> str:
        force = self.force_n
        if force[peak] not in (force.max(), force.min()):
            return ""
        same = np.flatnonzero(force[peak:] != force[peak])
        count = int(same[0]) if same.size else len(force) - peak
        if count < SATURATED_SAMPLES:
            return ""
        return (
            f"{count} samples stand at the largest force of the log, {force[peak]:.6g} N, as if "
            "cut off"
        )

    def _loaded_at_start(self, start: _Start, peak: int) -> str:
        """Say so where the log begins amid the loading."""
        if start.rest > 0 or self._load_start(start, peak) > max(1.0, 2.0 * LOAD_STARTS * peak):
            return ""
        zero = start.direction * (self.offset_n or 0.0)
        rise = start.load[: peak + 1]
        held = start.load[0] - zero
        if held <= max(SIGNIFICANCE * self.noise_n, LOAD_STARTS * (start.load[peak] - zero)):
            return ""
        # A preload that stands still is a state of rest; only one that grows was cut.
        tenth = rise[: max(3, len(rise) // 10)]
        if tenth[-1] - tenth[0] <= SIGNIFICANCE * self.noise_n:
            return ""
        return self._already_loaded(start)

    def _event(self, start: _Start, peak: int, reason: str, *, load_seen: bool) -> BreakawayEvent:
        t_s, x = self.cut.t_s, self.cut.position_m
        begin = self._load_start(start, peak)
        way = start.direction * float(x[peak] - x[begin])
        rate = self._rate(start, begin, peak)
        zero = start.direction * (self.offset_n or 0.0)
        held = float(start.load[peak])
        force = held - zero
        slide = None if start.level is None else start.level - zero
        ratio = None if slide is None or slide <= self.noise_n else force / slide
        gain = 0.01 * self.rig.force_calibration_percent
        unknown = math.hypot(self.offset_error_n or 0.0, gain * force)
        return BreakawayEvent(
            time_s=float(t_s[peak]),
            direction=start.direction,
            breakaway_force_n=force,
            raw_breakaway_force_n=held,
            sliding_force_n=slide,
            raw_sliding_force_n=start.level,
            breakaway_over_sliding=ratio,
            presliding_displacement_m=way if load_seen else None,
            loading_rate_n_per_s=rate,
            load_start_s=float(t_s[begin]) if load_seen else None,
            rest_s=self.cut.seen_s(start.rest, min(start.move, peak)),
            fallen_share=self._fallen(start, peak)[0],
            is_lower_bound=bool(reason),
            reason=reason,
            force_noise_n=self.noise_n,
            breakaway_error_n=math.hypot(self.noise_n, unknown, float(self.inertia_n[peak])),
            sliding_error_n=None
            if slide is None
            else math.hypot(self.offset_error_n or 0.0, gain * slide),
            unseen_gain_n=None if rate is None else abs(rate) * self._blind_s,
        )

    @property
    def _blind_s(self) -> float:
        """A time step, and the time constant of the rig's filter."""
        filter_hz = self.rig.filter_hz
        lag_s = 0.0 if filter_hz is None else 1.0 / (2.0 * math.pi * filter_hz)
        return float(np.median(np.diff(self.cut.t_s))) + lag_s

    def _rate(self, start: _Start, begin: int, peak: int) -> float | None:
        """Fit the slope of the load between 10 and 90 % of its rise."""
        if np.any((self.cut.gaps >= begin) & (self.cut.gaps < peak)):
            return None
        load, t_s = start.load[begin : peak + 1], self.cut.t_s[begin : peak + 1]
        inside = self._rising(start, begin, peak)
        few = np.count_nonzero(inside) < RISING_SAMPLES
        if few or load[-1] - load[0] <= SIGNIFICANCE * self.noise_n:
            return None
        t = t_s[inside] - t_s[inside].mean()
        return float(t @ load[inside] / (t @ t))

    def _rising(self, start: _Start, begin: int, peak: int) -> npt.NDArray[np.bool_]:
        """Tell which samples from ``begin`` to the peak lie between 10 and 90 % of the rise."""
        load = start.load[begin : peak + 1]
        low, high = (load[0] + share * (load[-1] - load[0]) for share in LOADING)
        return np.asarray((load >= low) & (load <= high))

    def _never(self) -> BreakawayEvent:
        """Give the largest load that a part held which never moved."""
        force = self.force_n - (self.offset_n or 0.0)
        peak = int(np.argmax(np.abs(force)))
        if abs(force[peak]) <= SIGNIFICANCE * self.noise_n:
            raise LogError(
                f"{self.name}: the part neither moves (its travel must exceed "
                f"{RESOLVED:g} times the noise of the position, {self.cut.resolution_m:.3g} m) nor "
                f"is loaded (largest force {abs(force[peak]):.3g} N, which must exceed "
                f"{SIGNIFICANCE:g} times its noise of {self.noise_n:.3g} N): record a log in which "
                "it is"
            )
        direction = 1 if force[peak] > 0.0 else -1
        load = direction * self.force_n
        last = len(load) - 1
        start = _Start(direction, 0, last, last, load, np.zeros(len(load), dtype=bool), None)
        reason = "the part never moves; it held this load"
        load_seen = not self._loaded_at_start(start, peak)
        return self._event(start, peak, reason, load_seen=load_seen)


def _first(mask: npt.NDArray[np.bool_]) -> int | None:
    return int(np.argmax(mask)) if mask.any() else None


def _check_settings(settings: Mapping[str, float | None]) -> None:
    """Raise `LogError` for a setting out of its range."""
    ranges = {
        "rest_speed_m_per_s": (0.0, False, math.inf, "m/s"),
        "min_rest_s": (0.0, True, math.inf, "s"),
        "min_slip_m": (0.0, True, math.inf, "m"),
        "gap_s": (0.0, False, math.inf, "s"),
        "sliding_window_s": (0.0, False, math.inf, "s"),
        "passed_share": (0.0, False, 1.0, ""),
        "offset_n": (-math.inf, True, math.inf, "N"),
    }
    for name, (low, with_low, high, unit) in ranges.items():
        value = settings[name]
        if value is None:
            continue
        if not (
            math.isfinite(value) and (low < value or (with_low and value == low)) and value <= high
        ):
            least = "finite" if low == -math.inf else f"{'>=' if with_low else '>'} {low:g}"
            most = f" and <= {high:g}" if math.isfinite(high) else ""
            raise LogError(f"{name} is {value:g}; it must be {least}{most} {unit}".rstrip())
