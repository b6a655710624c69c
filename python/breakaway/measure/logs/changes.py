"""Changes to channels that users ask for: cut, resample, sort, drop. None happens by itself."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from breakaway.errors import LogError
from breakaway.measure.logs.channel import MINIMUM_ROWS, Array, Channel
from breakaway.measure.logs.findings import gaps

MOST_SAMPLES = 2**28
"""Most samples that a channel is resampled to: 2 GiB of numbers."""


def same_stamps(first: Channel, other: Channel) -> bool:
    """Whether two channels have the same time stamps."""
    return first.t_s is other.t_s or np.array_equal(first.t_s, other.t_s)


def difference(first: Channel, other: Channel) -> str:
    """Say how the time stamps of two channels differ, and what to do."""
    parts = []
    start = float(other.t_s[0] - first.t_s[0])
    if start:
        early, late = (first, other) if start > 0 else (other, first)
        parts.append(f"{early.name} starts {abs(start):.6g} s before {late.name}")
    rates = [_rate(first), _rate(other)]
    if not math.isclose(*rates, rel_tol=1e-3):
        parts.append(f"{first.name} is sampled at {rates[0]:.6g} Hz against {rates[1]:.6g} Hz")
    said = " and ".join(parts) or f"the stamps of {first.name} and {other.name} differ"
    return (
        f"{said}; these channels need one time base, and nothing is resampled silently: use "
        f'--resample-hz (log.resampled(rate_hz=...) or log.resampled(like="{first.name}"))'
    )


def _rate(channel: Channel) -> float:
    step = float(np.median(np.diff(channel.t_s)))
    return 1.0 / step if step else math.inf


def between(channels: Iterable[Channel], start_s: float, end_s: float) -> list[Channel]:
    """Return the samples whose stamps lie in a span."""
    cut = []
    for c in channels:
        inside = (c.t_s >= start_s) & (c.t_s <= end_s)
        if np.count_nonzero(inside) < MINIMUM_ROWS:
            raise LogError(
                f"from {start_s:.9g} s to {end_s:.9g} s '{c.name}' has "
                f"{np.count_nonzero(inside)} samples; at least {MINIMUM_ROWS} are needed, and it "
                f"spans {c.t_s.min():.9g} s to {c.t_s.max():.9g} s: choose a longer span"
            )
        cut.append(_taken(c, inside))
    return _sharing(cut)


def sorted_by_time(channel: Channel) -> Channel:
    """Return the samples in the order of their stamps."""
    return _taken(channel, np.argsort(channel.t_s, kind="stable"))


def without_repeated_stamps(channel: Channel) -> Channel:
    """Return the samples whose stamp differs from that of the sample before."""
    return _taken(channel, np.concatenate([[True], np.diff(channel.t_s) != 0.0]))


def resampled(
    channels: Mapping[str, Channel], rate_hz: float | None, like: str | None, across_gaps: bool
) -> tuple[list[Channel], str]:
    """Return all channels on one time base, and the words for the history."""
    for channel in channels.values():
        channel.check_increasing()
    start = max(float(c.t_s[0]) for c in channels.values())
    end = min(float(c.t_s[-1]) for c in channels.values())
    if not start < end:
        raise LogError(
            f"the channels do not overlap (the last starts at {start:.9g} s, the first ends at "
            f"{end:.9g} s); they must, to have one time base: leave one out of the mapping"
        )
    stamps, how = _stamps(channels, rate_hz, like, start, end)
    crossed = [text for c in channels.values() for text in _crossed(c, stamps)]
    if crossed and not across_gaps:
        raise LogError(
            f"{crossed[0]}; nothing is interpolated across gaps: cut the log with "
            "--between (log.between), or ask for a straight line in Python with across_gaps=True"
        )
    over = f", across {len(crossed)} gaps" if crossed else ""
    new = [
        Channel(c.name, stamps, np.interp(stamps, c.t_s, c.values), c.from_name, c.unit)
        for c in channels.values()
    ]
    return _sharing(new), f"interpolated linearly to {how}{over}"


def _stamps(
    channels: Mapping[str, Channel],
    rate_hz: float | None,
    like: str | None,
    start: float,
    end: float,
) -> tuple[Array, str]:
    if (rate_hz is None) == (like is None):
        raise LogError("resampled needs either rate_hz or like, the name of a channel")
    if like is not None:
        t_s = channels[like].t_s
        stamps = t_s[(t_s >= start) & (t_s <= end)]
        how = f"the stamps of {like}"
    else:
        rate = float(rate_hz or 0.0)
        if not (math.isfinite(rate) and 0.0 < rate * (end - start) < MOST_SAMPLES):
            raise LogError(
                f"rate_hz is {rate_hz!r}; it must be > 0 and give fewer than {MOST_SAMPLES} "
                f"samples in {end - start:.6g} s"
            )
        # A sample at the very end is not lost to rounding.
        stamps = start + np.arange(math.floor((end - start) * rate * (1 + 1e-12)) + 1) / rate
        stamps = np.minimum(stamps, end)
        how = f"{rate:.9g} Hz"
    if len(stamps) < MINIMUM_ROWS:
        raise LogError(
            f"from {start:.9g} s to {end:.9g} s, where all channels overlap, lie {len(stamps)} "
            f"samples of {how}; at least {MINIMUM_ROWS} are needed: take a higher rate"
        )
    return stamps, how


def _crossed(channel: Channel, stamps: Array) -> list[str]:
    """Return the gaps of a channel that lie between the first and the last of ``stamps``."""
    return [
        f"'{channel.name}' has a gap of {channel.t_s[k + 1] - channel.t_s[k]:.4g} s after "
        f"{channel.t_s[k]:.9g} s"
        for k in gaps(channel.t_s)
        if channel.t_s[k] < stamps[-1] and channel.t_s[k + 1] > stamps[0]
    ]


def _taken(channel: Channel, rows: npt.NDArray[np.bool_ | np.intp]) -> Channel:
    return Channel(
        channel.name, channel.t_s[rows], channel.values[rows], channel.from_name, channel.unit
    )


def _sharing(channels: list[Channel]) -> list[Channel]:
    """Let channels with equal stamps share them."""
    shared: list[Channel] = []
    for c in channels:
        twin = next((other for other in shared if same_stamps(c, other)), None)
        t_s = c.t_s if twin is None else twin.t_s
        shared.append(Channel(c.name, t_s, c.values, c.from_name, c.unit))
    return shared
