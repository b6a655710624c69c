"""Read a log from a TDMS file."""

from __future__ import annotations

import re
from collections.abc import Generator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.base.one_line import counted
from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.raw import RawFile, check_claim, check_names, guarded, need
from breakaway.measure.logs.tdms_segments import Segments, read_segments

MOST_SCALES = 8
"""Most scales of a channel: each may take two before it, so that n need 2ⁿ passes."""

SCALES = {
    "AdvancedAPI",
    "Add",
    "Linear",
    "Polynomial",
    "RTD",
    "Strain",
    "Subtract",
    "Table",
    "Thermistor",
    "Thermocouple",
}
"""Kinds of scales that npTDMS computes. Of any other it returns the raw counts."""

UNSET = np.datetime64("1904-01-02", "ns")
"""A start before this was never set: LabVIEW writes its epoch, 1904, then."""


@guarded("a TDMS file")
def open_tdms(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a TDMS file, whose channels are named ``group/channel``.

    A channel with the properties of a waveform (``wf_increment``) has stamps of its own:
    ``wf_start_offset`` and so on in steps of ``wf_increment``, in s after the earliest
    ``wf_start_time`` of the file. A recording that was appended begins at its own start. The unit
    is the property ``unit_string``. A channel of dates with times is in s after the first of them.

    Raises
    ------
    LogError
        npTDMS is missing, the file is damaged, or takes more memory than it may.

    """
    nptdms = need("nptdms", "npTDMS", "tdms", path, "TDMS")
    raw = RawFile(path)
    with open_regular(path) as stream:
        segments = read_segments(stream, budget)
        if segments.cut_off:
            cut_off = "the recording is cut off within its last segment, as by a loss of power"
            raw.notice("cut_off", "", 1, cut_off)
        with nptdms.TdmsFile.open(stream) as file:
            channels = {
                f"{group.name}/{channel.name}": (group, channel)
                for group in file.groups()
                for channel in group.channels()
            }
            check_names(path, len(channels))
            for name, (group, channel) in channels.items():
                _list(raw, name, channel, (file, group, channel), segments)
            zero = _first_moment([channel for _, channel in channels.values()], segments)
            _note_unset(raw, [channel for _, channel in channels.values()], segments)

            def read(wanted: list[str]) -> None:
                moments = [name for name in wanted if channels[name][1].dtype.kind == "M"]
                _read_moments(raw, budget, {name: channels[name][1] for name in moments}, zero)
                for name in wanted:
                    if name not in moments:
                        _read(raw, budget, name, channels[name][1], segments, zero)

            raw.read = read
            yield raw


def _list(
    raw: RawFile,
    name: str,
    channel: Any,  # noqa: ANN401 - npTDMS has no types
    levels: tuple[Any, ...],
    segments: Segments,
) -> None:
    """List a channel, or note why it cannot be read."""
    # Before its type is asked for: npTDMS takes memory for as many scales as are claimed.
    reason = next((why for one in levels if (why := _no_scale(one.properties))), "")
    if not reason and channel.dtype.kind not in "fiubM":
        reason = f"is of type {channel.dtype}; it must be real numbers"
    units = segments.values_of(channel.path, "unit_string")
    if not reason and len(units) > 1:
        reason = (
            f"changes its unit within the file, from {units[0]!r} to {units[1]!r}: export the "
            "recordings apart"
        )
    is_moment = not reason and channel.dtype.kind == "M"
    unit = "s" if is_moment else str(channel.properties.get("unit_string", ""))
    if reason:
        raw.refuse(name, reason, unit)
        return
    step = float(channel.properties.get("wf_increment", 0.0))
    rate_hz = 1.0 / step if step else None
    kind, count = str(channel.dtype), len(channel)
    raw.list(ListedChannel(name, unit, kind, count, rate_hz, has_stamps=bool(step)))


def _note_unset(raw: RawFile, channels: list[Any], segments: Segments) -> None:
    """Note starts that were never set."""
    count = sum(
        moment <= UNSET
        for channel in channels
        for moment in segments.values_of(channel.path, "wf_start_time")
    )
    if count:
        words = f"{counted(count, 'start')} of 1904, which was never set, ignored"
        raw.notice("unset_start", "", count, words)


def _read_moments(
    raw: RawFile, budget: Budget, channels: Mapping[str, Any], zero: np.datetime64 | None
) -> None:
    """Read channels of dates with times, as s after the first of them, or of any recording."""
    found = {}
    for name, channel in channels.items():
        check_claim(raw.path, f"'{name}'", len(channel), raw.path.stat().st_size)
        budget.take(f"'{name}'", 8 * len(channel), 32 * len(channel))
        found[name] = channel[:].astype("datetime64[ns]").astype(np.int64)
    firsts = [int(one[0]) for one in found.values() if one.size]
    begin = min([*firsts, *([] if zero is None else [int(zero.astype(np.int64))])], default=0)
    for name, one in found.items():
        raw.add(name, 1e-9 * (one - begin), None)


def _read(
    raw: RawFile,
    budget: Budget,
    name: str,
    channel: Any,  # noqa: ANN401 - npTDMS has no types
    segments: Segments,
    zero: np.datetime64 | None,
) -> None:
    size, file_bytes = channel.dtype.itemsize, raw.path.stat().st_size
    check_claim(raw.path, f"'{name}'", len(channel), file_bytes)
    stamps = 8 if "wf_increment" in channel.properties else 0
    # Its raw values, their scaled ones, and a piece of the file.
    budget.take(f"'{name}'", (8 + stamps) * len(channel), (8 + size) * len(channel) + file_bytes)
    starts = segments.starts_of(channel.path)
    if len(starts) > 1 and sum(count for _, _, count in starts) != len(channel):
        raw.give_up(
            name,
            f"holds {len(starts)} recordings, each with a start of its own, and how many values "
            "are of which cannot be told: export them apart",
        )
        return
    raw.add(name, channel[:], _stamps(channel, starts, zero))


def _no_scale(properties: Mapping[str, Any]) -> str:
    """Say why the scales of a channel cannot be followed, or nothing."""
    count = properties.get("NI_Number_Of_Scales", 0)
    if not isinstance(count, int | np.integer):
        return f"states {str(count)[:40]!r} scales, which is not a number: export scaled values"
    if properties.get("NI_Scaling_Status") == "scaled":
        return ""
    if not 0 <= count <= MOST_SCALES:
        return f"states {count} scales; at most {MOST_SCALES} are followed: export scaled values"
    for key, kind in properties.items():
        found = re.fullmatch(r"NI_Scale\[(\d+)\]_Scale_Type", key)
        if found and (len(found[1]) > 1 or int(found[1]) >= MOST_SCALES):
            return f"has the scale {found[1][:40]}; at most {MOST_SCALES} are followed"
        if found and str(kind) not in SCALES:
            return (
                f"is scaled by {str(kind)[:40]!r}, which is unknown, and its raw values are not a "
                "measurement: export scaled values"
            )
    return ""


def _first_moment(channels: list[Any], segments: Segments) -> np.datetime64 | None:
    """Return the earliest start of all recordings; a start that was never set counts as none."""
    starts = [
        moment
        for channel in channels
        for moment in segments.values_of(channel.path, "wf_start_time")
        if moment > UNSET
    ]
    return min(starts, default=None)


def _stamps(
    channel: Any,  # noqa: ANN401 - npTDMS has no types
    starts: list[tuple[np.datetime64 | None, float, int]],
    zero: np.datetime64 | None,
) -> Array | None:
    """Return the stamps of a waveform, each recording from its own start; or None."""
    step = float(channel.properties.get("wf_increment", 0.0))
    if not step:
        return None
    parts = []
    for moment, offset_s, count in starts or [(None, 0.0, len(channel))]:
        if zero is not None and moment is not None and moment > UNSET:
            late = moment.astype(np.int64) - zero.astype(np.int64)
            offset_s += int(late) * 1e-9
        parts.append(offset_s + step * np.arange(count if len(starts) > 1 else len(channel)))
    return np.concatenate(parts)
