"""Groups and channels of an MDF 4 file. Source: ASAM MDF 4.1, the blocks HD, DG, CG and CN."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from breakaway.errors import LogError
from breakaway.measure.logs.mdf.blocks import FIRST, Block, Blocks
from breakaway.measure.logs.raw import MOST_NAMES

MASTERS, VIRTUAL = (2, 3), (3, 6)
"""Types of channels that count along a group, and of those whose raw value is the row."""

OF_VARIABLE_LENGTH = 1
TIME = 1
"""What a master channel counts: time, not angle, distance or index."""

VLSD_GROUP, ALL_INVALID, SOME_INVALID = 1, 1, 2
"""Flags of groups and of channels."""

KINDS_OF_DATA = {
    0: "<u",
    1: ">u",
    2: "<i",
    3: ">i",
    4: "<f",
    5: ">f",
    **dict.fromkeys((6, 7, 8, 9), "text"),
    10: "bytes",
    11: "bytes",
    12: "bytes",
    13: "a date",
    14: "a time of day",
    15: "complex",
    16: "complex",
}
"""Type of data -> order of bytes and kind of a number, or what it is instead."""


@dataclass(frozen=True, eq=False)
class Channel:
    """Where the raw values of a channel are, and what they mean."""

    name: str
    kind: int
    counts: int
    """What it counts as a master; see `TIME`."""
    data: str
    """One of `KINDS_OF_DATA`."""
    first_bit: int
    first_byte: int
    bits: int
    flags: int
    invalid_bit: int
    """Place of the bit that marks a sample invalid, where the flags say that there is one."""
    conversion: int
    """Place of the conversion block; 0 for none."""
    unit: int | None
    """Place of the text of the unit; None for that of the conversion."""
    is_array: bool

    @property
    def is_time(self) -> bool:
        """Whether it counts time along its group."""
        return self.kind in MASTERS and self.counts == TIME


@dataclass(frozen=True, eq=False)
class Group:
    """Channels that are recorded together, one record for all at each time."""

    number: int
    """Its number among the groups of the file that hold channels, from 0."""
    record_id: int
    records: int
    data_bytes: int
    invalid_bytes: int
    """Bytes of a record behind its data, which hold the bits that mark samples invalid."""
    is_vlsd: bool
    """Whether it holds samples of variable length in place of channels."""
    channels: tuple[Channel, ...]

    @property
    def record_bytes(self) -> int:
        """Bytes of a record, without the number of the group."""
        return self.data_bytes + self.invalid_bytes


@dataclass(frozen=True)
class DataGroup:
    """Groups whose records lie in the same data."""

    id_bytes: int
    """Bytes of the number of the group before each record; 0 where there is one group."""
    data: int
    """Place of the block of data; 0 for none."""
    groups: tuple[Group, ...]


def data_groups(blocks: Blocks) -> list[DataGroup]:
    """Return all groups of a file with their channels.

    Attachments, events, sources, comments and the history of a file are not looked at.

    Raises
    ------
    LogError
        A block is damaged.

    """
    found, number, channels = [], 0, 0
    for block in blocks.chain(blocks.block(FIRST, "HD").link(0), "DG"):
        (id_bytes,) = blocks.unpack(block, "<B")
        groups = []
        for inner in blocks.chain(block.link(1), "CG"):
            group = _group(blocks, inner, number)
            groups.append(group)
            number += not group.is_vlsd
            channels += len(group.channels)
            if channels > MOST_NAMES:
                raise LogError(
                    f"{blocks.name}: has more than {MOST_NAMES:,} channels; export fewer of them"
                )
        if id_bytes not in (0, 1, 2, 4, 8) or (not id_bytes and len(groups) > 1):
            raise blocks.damaged(block.place, f"numbers {len(groups)} groups by {id_bytes} bytes")
        found.append(DataGroup(id_bytes, block.link(2), tuple(groups)))
    return found


def _group(blocks: Blocks, block: Block, number: int) -> Group:
    record_id, records, flags, data_bytes, invalid_bytes = blocks.unpack(block, "<QQH6xII")
    is_vlsd = bool(flags & VLSD_GROUP)
    channels = [] if is_vlsd else [_channel(blocks, b) for b in _channel_blocks(blocks, block)]
    for channel in channels:
        last = 8 * channel.first_byte + channel.first_bit + channel.bits
        if channel.kind not in VIRTUAL and last > 8 * data_bytes:
            raise blocks.damaged(block.place, f"has a record of {data_bytes} bytes, too few")
        if channel.flags & SOME_INVALID and channel.invalid_bit >= 8 * invalid_bytes:
            raise blocks.damaged(block.place, f"has {invalid_bytes} invalidation bytes, too few")
    return Group(number, record_id, records, data_bytes, invalid_bytes, is_vlsd, tuple(channels))


def _channel_blocks(blocks: Blocks, group: Block) -> Iterator[Block]:
    """Give the channels of a group, and behind each those that it is composed of."""
    open_chains = [blocks.chain(group.link(1), "CN")]
    while open_chains:
        block = next(open_chains[-1], None)
        if block is None:
            open_chains.pop()
            continue
        yield block
        if block.link(1) and blocks.kind(block.link(1)) == "CN":
            open_chains.append(blocks.chain(block.link(1), "CN"))


def _channel(blocks: Blocks, block: Block) -> Channel:
    kind, counts, data, first_bit, first_byte, bits, flags, invalid_bit = blocks.unpack(
        block, "<BBBBIIII"
    )
    return Channel(
        name=blocks.text(block.link(2)),
        kind=kind,
        counts=counts,
        data=KINDS_OF_DATA.get(data, f"kind {data}"),
        first_bit=first_bit,
        first_byte=first_byte,
        bits=bits,
        flags=flags,
        invalid_bit=invalid_bit,
        conversion=block.link(4),
        unit=block.link(6) or None,
        is_array=bool(block.link(1)) and blocks.kind(block.link(1)) != "CN",
    )
