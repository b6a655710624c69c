"""Read a log from an MDF 4 file."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.logs.budget import Budget
from breakaway.logs.mdf_blocks import check_blocks
from breakaway.logs.raw import RawFile, check_size, guarded, need
from breakaway.logs.units import stated

TIME = 1
"""The kind of master channel that counts time, not angle or distance."""


@guarded("an MDF 4 file", rings=True)
def read_mdf(path: Path, budget: Budget) -> RawFile:
    """Read the channels of a finalized MDF file of version 4.

    Each has the stamps of the time master of its group. Where several groups have a channel of
    one name, its name is ``group/channel`` with the number of the group, from 0.

    Raises
    ------
    LogError
        asammdf is missing, or the file is damaged or of another version.

    """
    check_blocks(path)
    asammdf = need("asammdf", "asammdf", "mdf", path, "MDF")
    raw = RawFile(path)
    with path.open("rb") as stream, asammdf.MDF(stream) as file:
        names = Counter(channel.name for group in file.groups for channel in group.channels)
        total = sum(group.channel_group.cycles_nr for group in file.groups)
        check_size(path, "the file", total)
        for number, group in enumerate(file.groups):
            for place, channel in enumerate(group.channels):
                if place == file.masters_db.get(number):
                    continue
                unique = names[channel.name] == 1
                name = channel.name if unique else f"{number}/{channel.name}"
                _add(raw, name, file, number, place)
    return raw


def _add(raw: RawFile, name: str, file: Any, number: int, place: int) -> None:  # noqa: ANN401
    found = file.get(group=number, index=place)
    samples = np.asarray(found.samples)
    master = file.masters_db.get(number)
    if master is None:
        raw.add(name, samples, None, found.unit or "")
        return
    clock = file.groups[number].channels[master]
    unit = stated(str(clock.unit or "s"), "t_s")
    if clock.sync_type != TIME or unit is None:
        raw.unreadable[name] = "the master channel of its group is no time in a known unit"
        return
    t_s = unit.factor * np.asarray(found.timestamps, dtype=np.float64)
    raw.add(name, samples, t_s, found.unit or "")
