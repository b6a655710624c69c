"""Read a log from an MDF 4 file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.mdf.blocks import Blocks, open_blocks
from breakaway.measure.logs.mdf.conversion import Conversion, ConversionError, NoNumber, identity
from breakaway.measure.logs.mdf.conversion_blocks import Conversions
from breakaway.measure.logs.mdf.records import Records, slices
from breakaway.measure.logs.mdf.structure import MASTERS, Channel, DataGroup, Group, data_groups
from breakaway.measure.logs.mdf.values import invalid, raw_values, why_not_numbers
from breakaway.measure.logs.raw import RawFile, guarded
from breakaway.measure.logs.units import stated

NO_ROWS: Array = np.zeros(0)
Marks = npt.NDArray[np.bool_]


@dataclass
class _Series:
    """The values of a channel while its records are read, or why there are none."""

    channel: Channel
    unit: str
    convert: Conversion
    values: Array = field(default_factory=lambda: NO_ROWS)
    valid: Marks | None = None
    """Which samples are not marked invalid, where some are."""
    why_not: str = ""

    def read(self, group: Group, first_row: int, records: Records) -> None:
        """Read the values of some records."""
        rows = slice(first_row, first_row + len(records))
        marked = invalid(self.channel, group.data_bytes, records)
        if marked is not None:
            if self.valid is None:
                self.valid = np.ones(len(self.values), dtype=np.bool_)
            self.valid[rows] = ~marked
        try:
            values = self.convert(raw_values(self.channel, records, first_row))
        except NoNumber as error:
            self._give_up(f"row {first_row + error.place + 1}: {error.why}")
        except ConversionError as error:
            self._give_up(str(error))
        else:
            self.values[rows] = values

    def _give_up(self, why_not: str) -> None:
        self.values, self.why_not = NO_ROWS, why_not


@guarded("an MDF 4 file")
def open_mdf(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a finalized MDF file of version 4.

    Each channel has the stamps of the time master of its group. Where several groups have a channel
    of one name, its name is ``group/channel`` with the number of the group, from 0. Conversions
    are applied as the standard states them; a channel with one that gives texts, or that is not
    understood, cannot be read, and its raw values are never given instead. Samples that are marked
    invalid are left out, which shows as a gap.

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
        names = _names(found)
        for group in (group for data_group in found for group in data_group.groups):
            _list(raw, blocks, conversions, group, names)

        def read(wanted: list[str]) -> None:
            for data_group in found:
                chosen = {
                    group: [one for one in group.channels if names[one] in wanted]
                    for group in data_group.groups
                }
                if any(chosen.values()):
                    _read_data_group(raw, blocks, conversions, data_group, chosen, names, budget)

        raw.read = read
        yield raw


Names = dict[Channel, str]


def _names(found: list[DataGroup]) -> Names:
    """Return the name of each channel, with the number of its group where others have it too."""
    groups = [group for data_group in found for group in data_group.groups]
    count = Counter(channel.name for group in groups for channel in group.channels)
    return {
        one: f"{group.number}/{one.name}" if count[one.name] > 1 else one.name
        for group in groups
        for one in group.channels
    }


def _list(
    raw: RawFile, blocks: Blocks, conversions: Conversions, group: Group, names: Names
) -> None:
    """List the channels of a group but its time master, or note why they cannot be read."""
    clock = _clock(group)
    why_no_stamps = _why_no_stamps(blocks, conversions, group, clock)
    for channel in group.channels:
        if channel is clock:
            continue
        series = _begin(blocks, conversions, channel)
        why_not = series.why_not or why_no_stamps
        if why_not:
            raw.refuse(names[channel], why_not)
        else:
            has_stamps = clock is not None
            listed = (names[channel], series.unit, channel.data, group.records)
            raw.list(ListedChannel(*listed, has_stamps=has_stamps))


def _clock(group: Group) -> Channel | None:
    return next((channel for channel in group.channels if channel.is_time), None)


def _why_no_stamps(
    blocks: Blocks, conversions: Conversions, group: Group, clock: Channel | None
) -> str:
    """Return why a group has no stamps in seconds although it has a master."""
    if clock is None:
        counts = any(channel.kind in MASTERS for channel in group.channels)
        return "the master channel of its group is not time" if counts else ""
    series = _begin(blocks, conversions, clock)
    if stated(series.unit or "s", "t_s") is None:
        return f"the time of its group is in {series.unit[:40]!r}, which is not a known unit"
    return f"the time of its group cannot be read: {series.why_not}" if series.why_not else ""


def _read_data_group(
    raw: RawFile,
    blocks: Blocks,
    conversions: Conversions,
    data_group: DataGroup,
    chosen: dict[Group, list[Channel]],
    names: Names,
    budget: Budget,
) -> None:
    """Read the channels that are wanted of each group, with their stamps."""
    found: dict[Group, list[_Series]] = {}
    for group, channels in chosen.items():
        clock = _clock(group)
        asked = [*channels, *([clock] if clock is not None and channels else [])]
        found[group] = [_begin(blocks, conversions, channel) for channel in asked]
        budget.take(f"group {group.number}", 8 * group.records * len(asked))
        for series in found[group]:
            series.values = np.empty(group.records)
    for group, first_row, records in slices(blocks, data_group, budget):
        for series in found[group]:
            if not series.why_not:
                series.read(group, first_row, records)
    for group, channels in chosen.items():
        if channels:
            _add(raw, found[group], names)


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


def _add(raw: RawFile, found: list[_Series], names: Names) -> None:
    """Add the channels of a group, all with the stamps of its time master."""
    clock = next((series for series in found if series.channel.is_time), None)
    t_s = None
    if clock is not None and not clock.why_not:
        unit = stated(clock.unit or "s", "t_s")
        t_s = (unit.factor if unit else 1.0) * clock.values
    for series in found:
        name = names[series.channel]
        if series is clock:
            continue
        if series.why_not or (clock is not None and clock.why_not):
            late = clock.why_not if clock is not None else ""
            raw.give_up(name, series.why_not or f"the time of its group cannot be read: {late}")
            continue
        valid = _both(series.valid, None if clock is None else clock.valid)
        if valid is None:
            raw.add(name, series.values, t_s)
        else:
            left_out = int(np.sum(~valid))
            raw.notice("invalid", name, left_out, f"{left_out} samples marked invalid left out")
            raw.add(name, series.values[valid], None if t_s is None else t_s[valid])


def _both(one: Marks | None, other: Marks | None) -> Marks | None:
    """Return where both are valid; None where all is."""
    marks = [each for each in (one, other) if each is not None]
    valid = np.logical_and.reduce(marks) if marks else None
    return None if valid is None or valid.all() else valid
