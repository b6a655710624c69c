"""Where a part rests and where it moves, from its measured position."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from breakaway.errors import LogError
from breakaway.measure.logs.log import Array, Log

Places = npt.NDArray[np.intp]

GAP = 2.5
"""A time step of more than this many median steps is a gap."""

SHORTEST_STEP_S = 1e-9
"""Time steps below this are no measurement."""

HALF_WINDOW = 2
"""Samples on either side over which a speed is taken, at least."""

RESOLVED = 5.0
"""A displacement counts from this many standard deviations of the position's noise."""

REST_SHARE = 0.1
"""By default a part rests below this share of the speed at which it covers half of its way."""

SLIP_SHARE = 0.01
"""By default a move below this share of the whole travel is presliding, not a slip."""

DIFFERENCE = 3
"""Order of the difference that removes the motion from a channel and leaves its noise."""


@dataclass(frozen=True)
class Stretch:
    """Successive samples, from ``first`` to ``last``, with one direction: -1, 0 (rest) or 1."""

    direction: int
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class Stretches:
    """A log cut into rest and motion, and what it was cut with.

    ``position_m`` went through a median of three samples; ``speed_m_per_s`` is NaN where a
    gap leaves too few samples. ``gaps`` are the places of the last sample before each gap.
    ``seen_from`` is the first sample whose speed is known.
    """

    t_s: Array
    position_m: Array
    speed_m_per_s: Array
    gaps: Places
    seen_from: int
    resolution_m: float
    rest_speed_m_per_s: float
    min_slip_m: float
    window_s: float
    stretches: tuple[Stretch, ...]

    def starts(self) -> tuple[Stretch, ...]:
        """Return the motions that start from a rest that the log shows."""
        return tuple(
            after
            for before, after in pairwise(self.stretches)
            if before.direction == 0 and self.shows_rest(self.rest_since(before), after.first)
        )

    def rest_since(self, rest: Stretch) -> int:
        """Return the first sample of a rest after the last gap over which the part moved."""
        return max([rest.first, *(gap + 1 for gap in self.jumps(rest.first, rest.last))])

    def shows_rest(self, first: int, move: int) -> bool:
        """Whether a rest from ``first`` to ``move`` was recorded for as long as a speed needs."""
        known = np.isfinite(self.speed_m_per_s[first:move]).any()
        return bool(known and self.seen_s(first, move) >= self.window_s)

    def seen_s(self, first: int, last: int) -> float:
        """Return the time from one sample to another without that of the gaps."""
        inside = self.gaps[(self.gaps >= first) & (self.gaps < last)]
        lost = self.t_s[inside + 1] - self.t_s[inside]
        return float(self.t_s[last] - self.t_s[first] - lost.sum())

    def jumps(self, first: int, last: int) -> list[int]:
        """Return the gaps from ``first`` to ``last`` over which a part that rests moved."""
        inside = self.gaps[(self.gaps >= first) & (self.gaps < last)]
        return [int(g) for g in inside if self.moved_over(int(g))]

    def moved_over(self, gap: int) -> bool:
        """Whether the part is elsewhere after a gap than a part at rest could be."""
        way = abs(self.position_m[gap + 1] - self.position_m[gap])
        free = self.rest_speed_m_per_s * (self.t_s[gap + 1] - self.t_s[gap])
        return bool(way > max(RESOLVED * self.resolution_m, min(free, self.min_slip_m)))


def find_stretches(
    log: Log,
    *,
    rest_speed_m_per_s: float | None = None,
    min_rest_s: float = 0.1,
    min_slip_m: float | None = None,
    gap_s: float | None = None,
) -> Stretches:
    """Cut a log into stretches of rest and of motion in either direction.

    The speed of a sample is the way over a window about it, divided by its time; no window
    reaches over a gap. The window is doubled, from five samples, until the ways that exceed
    five standard deviations of the position's noise make up half of the travel.

    Parameters
    ----------
    log : Log
        A log with position; time steps may be uneven but must be positive.
    rest_speed_m_per_s : float, optional
        The part rests below this speed. By default a tenth of the speed at which it covers half
        of its way, and no less than the noise allows.
    min_rest_s : float
        A shorter standstill, say at a reversal, is no rest; but at the start of a log any
        standstill is one, because it began before.
    min_slip_m : float, optional
        A smaller move is presliding, and belongs to the rest. By default 1 % of the travel,
        and no less than ten standard deviations of the position's noise.
    gap_s : float, optional
        A longer time step is a gap; by default 2.5 median steps.

    Returns
    -------
    Stretches
        One stretch of rest where the part never moves.

    Raises
    ------
    LogError
        Time does not increase, or nearly all samples are cut off by gaps.

    Notes
    -----
    Not checked: outliers of two samples and more, which look like moves.

    Examples
    --------
    >>> t_s = np.arange(200) / 100.0
    >>> log = Log(t_s=t_s, position_m=0.01 * np.maximum(t_s - 1.0, 0.0), force_n=t_s)
    >>> [(s.direction, s.first) for s in find_stretches(log).stretches]
    [(0, 0), (1, 100)]

    """
    t_s, steps = log.t_s, _steps(log)
    gaps = np.flatnonzero(steps > (GAP * np.median(steps) if gap_s is None else gap_s))
    position = median_filter(log.position_m, size=3, mode="nearest")
    resolution = noise(log.position_m)
    half, typical = _window(log, position, gaps, resolution)
    way, time = _over_windows(t_s, position, gaps, half)
    floor = RESOLVED * resolution / (2 * half * float(np.median(steps)))
    limit = max(REST_SHARE * typical, floor) if rest_speed_m_per_s is None else rest_speed_m_per_s
    speed = way / time
    if min_slip_m is None:
        min_slip_m = max(SLIP_SHARE * float(np.ptp(position)), 2.0 * RESOLVED * resolution)
    states = np.where(np.abs(speed) > limit, np.sign(speed), 0.0) if typical else 0.0 * speed
    known = np.flatnonzero(np.isfinite(speed))
    stretches = _merged(_filled(states, known), t_s, position, min_slip_m, min_rest_s)
    return Stretches(
        t_s=t_s,
        position_m=position,
        speed_m_per_s=speed,
        gaps=gaps,
        seen_from=int(known[0]),
        resolution_m=resolution,
        rest_speed_m_per_s=float(limit),
        min_slip_m=min_slip_m,
        window_s=2 * half * float(np.median(steps)),
        stretches=tuple(stretches),
    )


def noise(values: Array) -> float:
    """Return the standard deviation of a channel's noise, or that of its rounding if larger.

    The third differences cancel slow motion and turn white noise of variance s² into one of
    20 s²; their median ignores steps. The smallest distance q of two levels gives q/√12.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> round(noise(np.sin(np.arange(5000) / 500.0) + 0.01 * rng.standard_normal(5000)), 3)
    0.01

    """
    third = np.diff(values, n=DIFFERENCE)
    white = 1.4826 * float(np.median(np.abs(third - np.median(third)))) / 20.0**0.5
    levels = np.diff(np.unique(values))
    # What rounding in a conversion of units leaves is no level.
    levels = levels[levels > 1e-9 * np.abs(values).max()]
    rounding = float(levels.min()) / 12.0**0.5 if levels.size else 0.0
    return max(float(white), rounding)


def _steps(log: Log) -> Array:
    steps = np.diff(log.t_s)
    worst = int(np.argmin(steps))
    if steps[worst] < SHORTEST_STEP_S:
        raise LogError(
            f"{log.name}: column 't_s', row {worst + 2}: the step from the row before is "
            f"{steps[worst]:.6g} s; it must be at least {SHORTEST_STEP_S:g} s: sort the log by "
            "time and drop repeated stamps"
        )
    return steps


def _window(log: Log, position: Array, gaps: Places, resolution: float) -> tuple[int, float]:
    """Return half a window in samples, and the speed at which half of the way is covered."""
    travel = float(np.ptp(position))
    half, longest = HALF_WINDOW, max(HALF_WINDOW, len(position) // 8)
    while half <= longest:
        way, time = _over_windows(log.t_s, position, gaps, half)
        known = np.isfinite(way)
        if 2 * np.count_nonzero(known) < len(known):
            raise LogError(
                f"{log.name}: column 't_s': {len(gaps)} gaps in {len(known)} rows leave most rows "
                "without neighbors, so rest and motion cannot be told apart: record evenly, or "
                "raise gap_s"
            )
        counts = known & (np.abs(way) > RESOLVED * resolution)
        speed = np.abs(way[counts] / time[counts])
        covered = speed * np.gradient(log.t_s)[counts]
        if travel > RESOLVED * resolution and covered.sum() >= 0.5 * travel:
            typical = _weighted_median(speed, covered)
            # A window in which half of that speed is resolved; at most twice as long.
            need = RESOLVED * resolution / (0.5 * typical * float(np.median(np.diff(log.t_s))))
            return min(max(half, ceil(0.5 * need)), 2 * half), typical
        half *= 2
    return HALF_WINDOW, 0.0


def _over_windows(t_s: Array, position: Array, gaps: Places, half: int) -> tuple[Array, Array]:
    """Return way and time over the window of each sample; NaN where it has no two neighbors."""
    here = np.arange(len(t_s))
    edges = np.concatenate([[0], gaps + 1, [len(t_s)]])
    which = np.searchsorted(edges, here, side="right")
    low = np.maximum(here - half, edges[which - 1])
    high = np.minimum(here + half, edges[which] - 1)
    few = high - low < 2
    way = np.where(few, np.nan, position[high] - position[low])
    return way, np.where(few, np.nan, t_s[high] - t_s[low])


def _weighted_median(values: Array, weights: Array) -> float:
    order = np.argsort(values)
    summed = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(summed, 0.5 * summed[-1])])


def _filled(states: Array, known: Places) -> npt.NDArray[np.int8]:
    """Give samples of unknown speed the state of the last known one, or of the first."""
    last = np.searchsorted(known, np.arange(len(states)), side="right") - 1
    return states[known[np.maximum(last, 0)]].astype(np.int8)


def _merged(
    states: npt.NDArray[np.int8], t_s: Array, position: Array, min_slip_m: float, min_rest_s: float
) -> list[Stretch]:
    """Count small moves as rest, then short standstills as part of the motion about them."""
    for stretch in _runs(states):
        if abs(position[stretch.last] - position[stretch.first]) < min_slip_m:
            states[stretch.first : stretch.last + 1] = 0
    runs = _runs(states)
    for before, stretch in pairwise(runs):
        short = t_s[stretch.last] - t_s[stretch.first] < min_rest_s
        if stretch.direction == 0 and short and stretch is not runs[-1]:
            states[stretch.first : stretch.last + 1] = before.direction
    return _runs(states)


def _runs(states: npt.NDArray[np.int8]) -> list[Stretch]:
    starts = np.concatenate([[0], np.flatnonzero(np.diff(states)) + 1])
    ends = np.append(starts[1:], len(states)) - 1
    return [Stretch(int(states[a]), int(a), int(b)) for a, b in zip(starts, ends, strict=True)]
