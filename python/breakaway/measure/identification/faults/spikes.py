"""Single samples that stand out of their neighbors, and a log without them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.stats import norm

from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array, Log

FALSE_ALARMS = 1e-3
"""Chance that a channel of white noise has a spike."""

APART = 0.2
"""A spike's neighbors differ by at most this share of its height; those of a step by all of it."""

NEIGHBORS = 10
"""Samples before and after, without the nearest two, whose roughness a spike has to exceed."""

ROUGHER = 5.0
"""How far it has to exceed that."""

NEAR = 3
FAR = 13
"""From so many samples to so many on either side the channel has to go on straight past a spike."""

STRAIGHT = 0.3
"""What it may bend by, as a share of the spike's height."""

BEYOND = 0.5
RANGE = (0.005, 0.995)
"""Elsewhere, as where the part turns or starts, a spike has to leave the range of the channel,
between these quantiles, by this share of it."""

SHOWN = 5
"""Times that a message names."""

CHANNELS = ("position_m", "force_n")


def leave_out_spikes(log: Log) -> tuple[Log, tuple[Fault, ...]]:
    """Return the log with its spikes on the line between neighbors, and a fault per channel."""
    faults, values = [], {}
    for name in CHANNELS:
        column, places = log[name], spikes(log, name)
        if places.size == 0:
            continue
        filled = column.copy()
        filled[places] = 0.5 * (column[places - 1] + column[places + 1])
        values[name] = filled
        faults.append(_named(log, name, places))
    if not faults:
        return log, ()
    channels = [
        replace(channel, values=values[name]) if name in values else channel
        for name, channel in log.channels.items()
    ]
    cleaned = Log.from_channels(
        channels,
        source=log.source,
        sha256=log.sha256,
        ignored_columns=log.ignored_columns,
        history=(*log.history, *map(str, faults)),
    )
    return cleaned, tuple(faults)


def _named(log: Log, name: str, places: NDArray[np.intp]) -> Fault:
    times = ", ".join(f"{time:.6g}" for time in log.t_s[places[:SHOWN]])
    more = f" and {places.size - SHOWN} more" if places.size > SHOWN else ""
    word = "spike" if places.size == 1 else "spikes"
    return Fault(
        "spikes",
        "",
        float(places.size),
        f"{name}: {places.size} single-sample {word}, at {times} s{more}; left out of the fit, "
        "the line between the neighbors stands for them",
    )


def spikes(log: Log, name: str) -> NDArray[np.intp]:
    """Return the places of single samples that stand out.

    ::

        d_k = x_k - (x_{k-1} + x_{k+1}) / 2

    White noise of deviation s gives d the deviation s √1.5. A spike exceeds its quantile for
    `FALSE_ALARMS` in all samples, stands `ROUGHER` times out of what lies around it, and has
    neighbors that agree: a step, an impact or a slip takes more than one sample to come and go. A
    breakaway may take only one: where the part turns or starts, a spike has to leave the range of
    all others.
    """
    values = log[name]
    if len(values) < 4 * NEIGHBORS:
        return np.array([], dtype=np.intp)
    floor = noise_floor(log, name)
    noise = max(floor.white, floor.quantization)
    height = np.zeros_like(values)
    height[1:-1] = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    limit = -float(norm.ppf(0.5 * FALSE_ALARMS / len(values))) * np.sqrt(1.5) * noise
    apart = np.full_like(values, np.inf)
    apart[1:-1] = np.abs(values[2:] - values[:-2])
    stands_out = (height > limit) & (height > ROUGHER * _around(height))
    found = np.flatnonzero(stands_out & (apart < APART * height))
    low, high = np.quantile(values, RANGE)
    outside = np.maximum(low - values[found], values[found] - high) > BEYOND * (high - low)
    kept: NDArray[np.intp] = found[outside | _straight(values, found, height[found])]
    return kept


def _straight(values: Array, places: NDArray[np.intp], height: Array) -> NDArray[np.bool_]:
    """Whether the channel goes on straight past each place, within a share of the height there."""
    at = np.clip(places, FAR, len(values) - FAR - 1)
    before = (values[at - NEAR] - values[at - FAR]) / (FAR - NEAR)
    after = (values[at + FAR] - values[at + NEAR]) / (FAR - NEAR)
    across = (values[at + NEAR] - values[at - NEAR]) / (2 * NEAR)
    bend = np.abs(after - before) * (FAR - NEAR)
    step = np.abs(across - 0.5 * (before + after)) * 2 * NEAR
    straight: NDArray[np.bool_] = np.maximum(bend, step) < STRAIGHT * height
    return straight


def _around(height: Array) -> Array:
    """Return the largest height near each sample, without its own and the next."""
    side = maximum_filter1d(height, NEIGHBORS, mode="nearest")
    shift = NEIGHBORS // 2 + 2
    before, after = np.roll(side, shift), np.roll(side, -shift)
    before[:shift], after[-shift:] = 0.0, 0.0
    around: Array = np.maximum(before, after)
    return around
