"""Read a log from an MDF 4 file."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.mdf.blocks import Blocks, open_blocks
from breakaway.measure.logs.mdf.conversion import Conversion, ConversionError, NoNumber, identity
from breakaway.measure.logs.mdf.conversion_blocks import Conversions
from breakaway.measure.logs.mdf.records import Records, slices
from breakaway.measure.logs.mdf.structure import MASTERS, Channel, DataGroup, Group, data_groups
from breakaway.measure.logs.mdf.values import first_invalid, raw_values, why_not_numbers
from breakaway.measure.logs.raw import RawFile, guarded
from breakaway.measure.logs.units import stated

NO_ROWS: Array = np.zeros(0)


@dataclass
class _Series:
    """The values of a channel while its records are read, or why there are none."""

    channel: Channel
    unit: str
    convert: Conversion
    values: Array = field(default_factory=lambda: NO_ROWS)
    why_not: str = ""

    def read(self, group: Group, first_row: int, records: Records) -> None:
        """Read the values of some records."""
        invalid = first_invalid(self.channel, group.data_bytes, records)
        if invalid is not None:
            self._give_up(f"row {first_row + invalid + 1}: the sample is marked invalid")
            return
        try:
            values = self.convert(raw_values(self.channel, records, first_row))
        except NoNumber as error:
            self._give_up(f"row {first_row + error.place + 1}: {error.why}")
        except ConversionError as error:
            self._give_up(str(error))
        else:
            self.values[first_row : first_row + len(records)] = values

    def _give_up(self, why_not: str) -> None:
        self.values, self.why_not = NO_ROWS, why_not


@guarded("an MDF 4 file")
def read_mdf(path: Path, budget: Budget) -> RawFile:
    """Read the channels of a finalized MDF file of version 4.

    Each has the stamps of the time master of its group. Where several groups have a channel of
    one name, its name is ``group/channel`` with the number of the group, from 0. Conversions
    are applied as the standard states them; a channel with one that gives texts, or that is not
    understood, cannot be read, and its raw values are never given instead. The same holds for
    a channel with a sample that is marked invalid.

    Attachments, events and comments are not looked at, and frames of a bus are not decoded.

    Parameters
    ----------
    path : Path
        The file.
    budget : Budget
        How much memory it may take.

    Raises
    ------
    LogError
        The file is damaged, of another version, or takes more memory than it may.

    """
    raw = RawFile(path)
    with open_regular(path) as file:
        blocks = open_blocks(path.name, file)
        found = data_groups(blocks)
        conversions = Conversions(blocks)
        groups = [group for data_group in found for group in data_group.groups]
        names = Counter(channel.name for group in groups for channel in group.channels)
        for data_group in found:
            read = _read_data_group(blocks, conversions, data_group, budget)
            for group, series in zip(data_group.groups, read, strict=True):
                _add(raw, group, series, names)
    return raw


def _read_data_group(
    blocks: Blocks, conversions: Conversions, data_group: DataGroup, budget: Budget
) -> list[list[_Series]]:
    """Return the channels of each group."""
    found = {}
    for group in data_group.groups:
        found[group] = [_begin(blocks, conversions, channel) for channel in group.channels]
        readable = [series for series in found[group] if not series.why_not]
        budget.take(f"group {group.number}", 8 * group.records * len(readable))
        for series in readable:
            series.values = np.empty(group.records)
    for group, first_row, records in slices(blocks, data_group, budget):
        for series in found[group]:
            if not series.why_not:
                series.read(group, first_row, records)
    return list(found.values())


def _begin(blocks: Blocks, conversions: Conversions, channel: Channel) -> _Series:
    if channel.unit is None:
        unit = conversions.unit(channel.conversion)
    else:
        unit = blocks.text(channel.unit)
    series = _Series(channel, unit, identity, why_not=why_not_numbers(channel))
    if not series.why_not:
        try:
            series.convert = conversions.at(channel.conversion)
        except ConversionError as error:
            series.why_not = str(error)
    return series


def _add(raw: RawFile, group: Group, found: list[_Series], names: Counter[str]) -> None:
    """Add the channels of a group, all with the stamps of its time master."""
    clock = next((series for series in found if series.channel.is_time), None)
    t_s, why_no_stamps = _stamps(clock, found)
    for series in found:
        if series is clock:
            continue
        name = series.channel.name
        if names[name] > 1:
            name = f"{group.number}/{name}"
        why_not = series.why_not or why_no_stamps
        if why_not:
            raw.refuse(name, why_not)
        else:
            raw.add(name, series.values, t_s, series.unit)


def _stamps(clock: _Series | None, found: list[_Series]) -> tuple[Array | None, str]:
    """Return the stamps of a group in seconds, and why there are none although it has a master."""
    if clock is None:
        counts = any(series.channel.kind in MASTERS for series in found)
        return None, "the master channel of its group is not time" if counts else ""
    unit = stated(clock.unit or "s", "t_s")
    if unit is None:
        return None, f"the time of its group is in {clock.unit[:40]!r}, which is not a known unit"
    if clock.why_not:
        return None, f"the time of its group cannot be read: {clock.why_not}"
    return unit.factor * clock.values, ""
