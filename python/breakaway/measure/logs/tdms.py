"""Read a log from a TDMS file."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.raw import MOST_NAMES, RawFile, check_claim, check_names, guarded, need

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

LEAD_IN = struct.Struct("<4sI4xQ8x")
HAS_OBJECTS, HAS_NEW_LIST, IS_BIG_ENDIAN = 1 << 1, 1 << 2, 1 << 6
BYTES_PER_SEGMENT, BYTES_PER_ENTRY, LEAST_OBJECT = 500, 8, 12


@guarded("a TDMS file")
def read_tdms(path: Path, budget: Budget) -> RawFile:
    """Read the channels of a TDMS file, whose names are ``group/channel``.

    A channel with the properties of a waveform (``wf_increment``) has stamps of its own:
    ``wf_start_offset`` and so on in steps of ``wf_increment``, in s after the earliest
    ``wf_start_time`` of the file. The unit is the property ``unit_string``.

    Raises
    ------
    LogError
        npTDMS is missing, the file is damaged, or takes more memory than it may.

    """
    nptdms = need("nptdms", "npTDMS", "tdms", path, "TDMS")
    raw = RawFile(path)
    with open_regular(path) as stream:
        _ask_for_segments(stream, budget)
        with nptdms.TdmsFile.open(stream) as file:
            channels = {
                f"{group.name}/{channel.name}": (group, channel)
                for group in file.groups()
                for channel in group.channels()
            }
            check_names(path, len(channels))
            for name, (group, channel) in channels.items():
                _check(raw, budget, name, channel, (file, group, channel))
            zero = _first_moment([channel for _, channel in channels.values()])
            for name, (_, channel) in channels.items():
                if name not in raw:
                    unit = str(channel.properties.get("unit_string", ""))
                    raw.add(name, channel[:], _stamps(channel, zero), unit)
    return raw


def _ask_for_segments(stream: BinaryIO, budget: Budget) -> None:
    """Ask for the memory of the lists of objects: npTDMS keeps one for each segment."""
    end = stream.seek(0, 2)
    place, count = 0, 0
    while place + LEAD_IN.size <= end:
        stream.seek(place)
        tag, flags, length = LEAD_IN.unpack(stream.read(LEAD_IN.size))
        if tag != b"TDSm":
            raise ValueError(f"a segment begins with {tag!r}")
        if flags & HAS_OBJECTS:
            (told,) = struct.unpack(">I" if flags & IS_BIG_ENDIAN else "<I", stream.read(4))
            if told * LEAST_OBJECT > end - place:
                raise ValueError(f"a segment claims {told} objects")
            # Those told may be new, or repeat others.
            count = min(told + (0 if flags & HAS_NEW_LIST else count), 2 * MOST_NAMES)
        budget.take("its segments", BYTES_PER_SEGMENT + BYTES_PER_ENTRY * count)
        if flags & IS_BIG_ENDIAN:
            length = int.from_bytes(length.to_bytes(8, "little"), "big")
        place += LEAD_IN.size + length
    stream.seek(0)


def _check(
    raw: RawFile,
    budget: Budget,
    name: str,
    channel: Any,  # noqa: ANN401 - npTDMS has no types
    levels: tuple[Any, ...],
) -> None:
    """Note why a channel cannot be read, or ask for its memory."""
    # Before its type is asked for: npTDMS takes memory for as many scales as are claimed.
    reason = next((why for one in levels if (why := _no_scale(one.properties))), "")
    if not reason and channel.dtype.kind not in "fiub":
        reason = f"is of type {channel.dtype}; it must be real numbers"
    if reason:
        raw.refuse(name, reason)
        return
    size, file_bytes = channel.dtype.itemsize, raw.path.stat().st_size
    check_claim(raw.path, f"'{name}'", len(channel), file_bytes)
    stamps = 8 if "wf_increment" in channel.properties else 0
    # Its raw values, their scaled ones, and a piece of the file.
    budget.take(f"'{name}'", (8 + stamps) * len(channel), (8 + size) * len(channel) + file_bytes)


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


def _first_moment(channels: list[Any]) -> np.datetime64 | None:
    starts = [s for c in channels if (s := c.properties.get("wf_start_time")) is not None]
    return min((np.datetime64(s, "ns") for s in starts), default=None)


def _stamps(channel: Any, zero: np.datetime64 | None) -> Array | None:  # noqa: ANN401
    """Return the stamps of a waveform, or None."""
    step = float(channel.properties.get("wf_increment", 0.0))
    if not step:
        return None
    start = float(channel.properties.get("wf_start_offset", 0.0))
    moment = channel.properties.get("wf_start_time")
    if zero is not None and moment is not None:
        late = np.datetime64(moment, "ns").astype(np.int64) - zero.astype(np.int64)
        start += int(late) * 1e-9
    return np.asarray(start + step * np.arange(len(channel)), dtype=np.float64)
