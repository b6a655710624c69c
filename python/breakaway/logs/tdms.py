"""Read a log from a TDMS file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from breakaway.logs.budget import Budget
from breakaway.logs.channel import Array
from breakaway.logs.raw import RawFile, check_size, guarded, need


@guarded("a TDMS file")
def read_tdms(path: Path, budget: Budget) -> RawFile:
    """Read the channels of a TDMS file, whose names are ``group/channel``.

    A channel with the properties of a waveform (``wf_increment``) has stamps of its own:
    ``wf_start_offset`` and so on in steps of ``wf_increment``, in s after the earliest
    ``wf_start_time`` of the file. The unit is the property ``unit_string``.

    Raises
    ------
    LogError
        npTDMS is missing, or the file is damaged.

    """
    nptdms = need("nptdms", "npTDMS", "tdms", path, "TDMS")
    raw = RawFile(path)
    with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        starts = [s for c in channels if (s := c.properties.get("wf_start_time")) is not None]
        zero = min((np.datetime64(s, "ns") for s in starts), default=None)
        for channel in channels:
            name = f"{channel.group_name}/{channel.name}"
            if channel.dtype.kind not in "fiub":
                raw.unreadable[name] = f"is of type {channel.dtype}; it must be real numbers"
                continue
            check_size(path, name, len(channel), path.stat().st_size)
            unit = str(channel.properties.get("unit_string", ""))
            raw.add(name, channel[:], _stamps(channel, zero), unit)
    return raw


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
