"""Rows that are dropped because that was asked for: cells that are no numbers, repeated stamps."""

from __future__ import annotations

import numpy as np

from breakaway.base.one_line import counted
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.raw import RawFile

Columns = tuple[Array, Array]
"""Stamps and values of a channel."""


def without_bad_rows(raw: RawFile, channels: list[Columns]) -> list[Columns]:
    """Drop rows in which a stamp or a value is not finite, or a stamp repeats the one before.

    Channels with the same stamps lose the same rows. What is dropped is counted, as a finding and
    in the history; damaged rows that the reader has dropped are counted with them.
    """
    found = list(channels)
    damaged, repeated = raw.dropped, 0
    for group in _groups(channels):
        t_s = channels[group[0]][0]
        good = np.isfinite(t_s)
        for place in group:
            if len(channels[place][1]) != len(t_s):
                return channels
            good &= np.isfinite(channels[place][1])
        damaged += int(np.count_nonzero(~good))
        rows = np.flatnonzero(good)
        again = np.concatenate([[False], np.diff(t_s[rows]) == 0.0])[: len(rows)]
        repeated += int(np.count_nonzero(again))
        rows = rows[~again]
        if len(rows) < len(t_s):
            kept = _frozen(t_s[rows])
            for place in group:
                found[place] = (kept, _frozen(channels[place][1][rows]))
    _tell(raw, damaged, repeated)
    return found


def _groups(channels: list[Columns]) -> list[list[int]]:
    """Return the places of channels with the same stamps."""
    groups: list[list[int]] = []
    for place, (t_s, _) in enumerate(channels):
        for group in groups:
            if _are_same(channels[group[0]][0], t_s):
                group.append(place)
                break
        else:
            groups.append([place])
    return groups


def _are_same(one: Array, other: Array) -> bool:
    return one is other or np.array_equal(one, other, equal_nan=True)


def _frozen(values: Array) -> Array:
    values.setflags(write=False)
    return values


def _tell(raw: RawFile, damaged: int, repeated: int) -> None:
    words = (
        f"{counted(damaged + repeated, 'bad row')} dropped as asked for: {damaged} with a cell "
        f"missing or no finite number, {repeated} whose stamp repeats the one before"
    )
    raw.history = (*raw.history, words)
    if damaged + repeated:
        raw.notice("dropped", "", damaged + repeated, words)
