"""What the motion of a log shows of its joint: turns, whether it broke away, and stick-slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.measure.identification.guess import MOVING
from breakaway.measure.logs.log import Array

Whole = NDArray[np.integer[Any]]

STILL = 0.02
"""A part stands still below this share of its top speed."""

FASTER = 0.2
"""A part slips above this share of its top speed."""

PLATEAU = 1.2
"""A joint slides where twice the travel raises its force by less than this factor."""

PLATEAU_SHARE = 0.2
"""Share of the largest change of force from which a plateau counts."""

FEWEST_ROWS = 8
"""Fewest rows between two turns that show a plateau."""

COMES_BACK = 0.2
"""Travel one way, over that the other way, from which a part moves to and fro."""

FEWEST_SLIPS = 3
"""Fewest slips that make stick-slip."""

RARE = 0.05
"""Fewer slips do where they take less than this share of a log."""

FALL = 0.05
"""Share of the force by which it falls in a slip, at least."""

HALFWAY = (0.25, 0.75)
"""Share of the fall that has happened halfway, for a spring 0.5; at a peak of friction nearly 1."""


@dataclass(frozen=True, eq=False)
class Turns:
    """Rows cut where the direction changes.

    ``direction`` is that of the stretch, ``stretch`` the number of the stretch that a
    row is of, ``since_m`` the way since its turn and ``rows_since`` the rows since it.
    """

    direction: Array
    stretch: Whole
    since_m: Array
    rows_since: Whole

    @property
    def count(self) -> int:
        """How many stretches there are."""
        return int(self.stretch[-1]) + 1


def find_turns(x: Array, v: Array) -> Turns:
    """Cut rows where the part is farthest before it goes back; standing still is no turn."""
    moving = np.flatnonzero(np.abs(v) > STILL * float(np.quantile(np.abs(v), 0.99)))
    signs = np.sign(v[moving])
    starts = [0]
    for place in np.flatnonzero(np.diff(signs)):
        before, after = moving[place], moving[place + 1]
        starts.append(int(before + np.argmax(signs[place] * x[before : after + 1])))
    changes = np.zeros(len(x), dtype=np.intp)
    changes[starts[1:]] = 1
    stretch = np.cumsum(changes)
    first = np.array(starts)[stretch]
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(x)))])
    directions = signs[np.concatenate([[0], np.flatnonzero(np.diff(signs)) + 1])]
    return Turns(directions[stretch], stretch, way - way[first], np.arange(len(v)) - first)


def to_and_fro(x: Array, v: Array) -> int:
    """Return how often the part turns from motion one way to motion the other way.

    It is 0 where the part hardly comes back: a part that is pulled one way may swing as it slips.
    """
    steps = np.diff(x)
    back, forth = float(-steps[steps < 0.0].sum()), float(steps[steps > 0.0].sum())
    if min(back, forth) < COMES_BACK * max(back, forth):
        return 0
    moving = v[np.abs(v) > MOVING * float(np.quantile(np.abs(v), 0.99))]
    return int(np.count_nonzero(np.diff(np.sign(moving))))


def broke_away(
    turns: Turns, force: Array, noise_m: float, noise_n: float
) -> tuple[bool, bool] | None:
    """Return whether the force levels off on the way up, and down, as it does once a joint slides.

    A joint that is only loaded gives a force that goes on rising with the way since the turn: by
    more than a factor of 1.2 while the way doubles. None where no stretch is long enough to say.
    """
    judged, found = False, {1.0: False, -1.0: False}
    for number in range(turns.count):
        here = np.flatnonzero(turns.stretch == number)
        way = turns.since_m[here]
        if len(here) < FEWEST_ROWS or way[-1] < 10.0 * noise_m:
            continue
        levels = _levels_off(way, _change(turns, here, force), noise_n)
        judged = judged or levels is not None
        found[float(turns.direction[here[-1]])] |= bool(levels)
    return (found[1.0], found[-1.0]) if judged else None


def _change(turns: Turns, here: Whole, force: Array) -> Array:
    """Return the force since a turn, in the direction of motion."""
    before = float(np.median(force[max(here[0] - 2, 0) : here[0] + 1]))
    change: Array = turns.direction[here] * (force[here] - before)
    return change


def _levels_off(way: Array, change: Array, noise_n: float) -> bool | None:
    """Whether the force levels off in one stretch; None where it hardly changes."""
    found = np.interp(way[-1] / 2.0 ** np.arange(7), way, change)
    told = found[1:] > max(PLATEAU_SHARE * float(change.max()), 10.0 * noise_n)
    if not told.any():
        return None
    return bool(np.any(found[:-1][told] < PLATEAU * found[1:][told] - 3.0 * noise_n))


def passages(v: Array, slow_m_per_s: float) -> int:
    """Return how often a part goes through speeds below a limit."""
    slow = (np.abs(v) < slow_m_per_s).astype(int)
    return int(np.count_nonzero(np.diff(slow) > 0) + slow[0])


def stick_slip(x: Array, v: Array, force: Array) -> tuple[int, int]:
    """Return how often a part slips after it stuck, and the median rows of a slip.

    A slip is faster than a fifth of the top speed, and the part stands nearly still before the
    next one in the same direction. Over a slip the force falls in step with the way, as that of
    the spring behind which it slips. One or two count where the part is slow for all the rest.
    Zero where that is not how the part moves.
    """
    speed = np.abs(v)
    top = float(np.quantile(speed, 0.999))
    fast = np.concatenate([[0], (speed > FASTER * top).astype(int), [0]])
    edges = np.flatnonzero(np.diff(fast))
    starts, ends = np.maximum(edges[::2] - 1, 0), np.minimum(edges[1::2], len(v) - 1)
    ways = x[ends] - x[starts]
    onward = np.abs(ways) > 0.3 * np.abs(ways).max(initial=0.0)
    starts, ends, ways = starts[onward], ends[onward], ways[onward]
    if len(starts) == 0:
        return 0, 0
    rare = np.sum(ends - starts) < RARE * len(v)
    pauses = zip(ends[:-1], starts[1:], strict=True)
    stuck = np.array(
        [bool(np.any(speed[end : start + 1] < STILL * top)) for end, start in pauses], dtype=bool
    )
    again = stuck & (np.sign(ways[1:]) == np.sign(ways[:-1]))
    falls = np.sign(ways) * (force[starts] - force[ends])
    shares = [
        float(np.interp(0.5, (x[a : b + 1] - x[a]) / way, (force[a] - force[a : b + 1]) / fall))
        for a, b, way, fall in zip(starts, ends, ways, np.sign(ways) * falls, strict=True)
        if fall != 0.0
    ]
    falls_enough = np.median(falls) > FALL * np.median(np.abs(force))
    in_step = bool(shares) and HALFWAY[0] < np.median(shares) < HALFWAY[1]
    often = np.sum(again) >= FEWEST_SLIPS - 1
    if not (often or (rare and np.all(again))) or not (falls_enough and in_step):
        return 0, 0
    return len(starts), int(np.median(ends - starts)) - 1
