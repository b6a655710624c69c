"""The records of groups: from blocks of data, packed or not, in slices of bounded size.

Source: ASAM MDF 4.1, the blocks DT, DL, HL and DZ, and sorted and unsorted records.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mdf.blocks import Block, Blocks
from breakaway.measure.logs.mdf.structure import DataGroup, Group

CHUNK_BYTES = 2**22
"""Bytes that are read at once, and that a slice has at least, where a group has as many."""

PACKED = "<2sBxIQQ"
"""What a packed block says: type of the data, way, columns, size of the data, packed size."""

DEFLATED, TRANSPOSED = 0, 1
"""Ways of packing."""

Records = npt.NDArray[np.uint8]
"""One record a row, without the number of its group."""


def slices(
    blocks: Blocks, data_group: DataGroup, budget: Budget
) -> Iterator[tuple[Group, int, Records]]:
    """Give the records of a data group in slices, with their group and the row of the first.

    Raises
    ------
    LogError
        The data is damaged, takes more memory than it may, or holds more or fewer records than
        the groups claim.

    """
    rows = dict.fromkeys(data_group.groups, 0)
    data = _chunks(blocks, data_group.data, budget)
    split = _unsorted if data_group.id_bytes else _sorted
    for group, records in split(blocks, data_group, data):
        first = rows[group]
        rows[group] += len(records)
        if rows[group] > group.records:
            break
        yield group, first, records
    for group in data_group.groups:
        if not group.is_vlsd and rows[group] != group.records:
            raise LogError(
                f"{blocks.name}: is damaged: group {group.number} claims {group.records} records; "
                f"its data holds {'more' if rows[group] > group.records else 'fewer'}: "
                "export the log again, or finalize it with the tool that recorded it"
            )


def _sorted(
    blocks: Blocks, data_group: DataGroup, data: Iterator[bytes]
) -> Iterator[tuple[Group, Records]]:
    """Split the data of one group."""
    for group in data_group.groups:
        if group.is_vlsd:
            return
        size = group.record_bytes
        if not size:  # virtual channels alone
            for first in range(0, group.records, CHUNK_BYTES):
                yield group, np.empty((min(CHUNK_BYTES, group.records - first), 0), np.uint8)
            return
        pending = bytearray()
        for chunk in data:
            pending += chunk
            if len(pending) >= max(size, CHUNK_BYTES):
                yield group, _whole_records(pending, size)
        yield group, _whole_records(pending, size)
        if pending:
            raise blocks.damaged(data_group.data, f"ends within a record of {size} bytes")


def _whole_records(pending: bytearray, size: int) -> Records:
    """Take the records that are whole from the bytes before those that are not."""
    whole = len(pending) // size * size
    records = np.frombuffer(bytes(pending[:whole]), np.uint8).reshape(-1, size)
    del pending[:whole]
    return records


def _unsorted(
    blocks: Blocks, data_group: DataGroup, data: Iterator[bytes]
) -> Iterator[tuple[Group, Records]]:
    """Split the data of several groups, in which the number of the group is before each record."""
    groups = {group.record_id: group for group in data_group.groups}
    if len(groups) < len(data_group.groups):
        raise blocks.damaged(data_group.data, "belongs to two groups with the same number")
    pending, begun = bytearray(), 0
    for chunk in data:
        pending += chunk
        if len(pending) - begun < CHUNK_BYTES:
            continue
        yield from _split(blocks, data_group, groups, pending)
        begun = len(pending)
    yield from _split(blocks, data_group, groups, pending)
    if pending:
        raise blocks.damaged(data_group.data, "ends within a record")


def _split(
    blocks: Blocks, data_group: DataGroup, groups: dict[int, Group], pending: bytearray
) -> Iterator[tuple[Group, Records]]:
    """Take the records that are whole, and give those of each group together."""
    data, width, place = bytes(pending), data_group.id_bytes, 0
    starts: dict[int, list[int]] = {number: [] for number in groups}
    # By the bytes that stand in the file: all records are walked through one by one.
    known = {
        number.to_bytes(width, "little"): (
            0 if group.is_vlsd else width + group.record_bytes,
            starts[number].append,
        )
        for number, group in groups.items()
        if number < 1 << 8 * width
    }
    while place + width <= len(data):
        found = known.get(data[place : place + width])
        if found is None:
            number = int.from_bytes(data[place : place + width], "little")
            raise blocks.damaged(data_group.data, f"holds a record of an unknown group {number}")
        size, add = found
        if not size:
            told = data[place + width : place + width + 4]
            size = width + 4 + int.from_bytes(told, "little")
        if place + size > len(data):
            break
        add(place)
        place += size
    del pending[:place]
    for number, places in starts.items():
        group = groups[number]
        if places and not group.is_vlsd:
            rows = np.asarray(places)[:, None] + np.arange(width, width + group.record_bytes)
            yield group, np.frombuffer(data, np.uint8)[rows]


def _chunks(blocks: Blocks, place: int, budget: Budget) -> Iterator[bytes]:
    """Give the data behind a link, without packing, in pieces of at most `CHUNK_BYTES`."""
    for block in _data_blocks(blocks, place):
        if block.kind == "DZ":
            data = _unpacked(blocks, block, budget)
            for begin in range(0, len(data), CHUNK_BYTES):
                yield data[begin : begin + CHUNK_BYTES]
            continue
        for begin in range(block.content, block.end, CHUNK_BYTES):
            yield blocks.read(begin, min(CHUNK_BYTES, block.end - begin))


def _data_blocks(blocks: Blocks, place: int) -> Iterator[Block]:
    if not place:
        return
    if blocks.kind(place) in ("LD", "DV"):
        raise LogError(
            f"{blocks.name}: stores its records by column, as in MDF 4.2; that is not supported: "
            "export it by row, as MDF 4.1"
        )
    block = blocks.once(place, "DT", "DZ", "DL", "HL") if blocks.kind(place) != "DL" else None
    if block is not None and block.kind != "HL":
        yield block
        return
    for part in blocks.chain(block.link(0) if block else place, "DL"):
        for link in part.links[1:]:
            yield blocks.once(link, "DT", "DZ")


def _unpacked(blocks: Blocks, block: Block, budget: Budget) -> bytes:
    kind, way, columns, size, packed_size = blocks.unpack(block, PACKED)
    begin = block.content + struct.calcsize(PACKED)
    if kind != b"DT" or begin + packed_size > block.end or (way == TRANSPOSED and not columns):
        raise blocks.damaged(block.place, "is packed, but its packing header is inconsistent")
    if way not in (DEFLATED, TRANSPOSED):
        raise LogError(
            f"{blocks.name}: is packed by method {way}, which is not supported; export it "
            "unpacked, or as MDF 4.1"
        )
    budget.take(f"the packed block at byte {block.place}", 0, 2 * size + packed_size)
    unpacker = zlib.decompressobj()
    data = unpacker.decompress(blocks.read(begin, packed_size), size + 1)
    if len(data) != size:
        raise blocks.damaged(block.place, f"claims {size} bytes, but holds more or fewer")
    if way == DEFLATED:
        return data
    matrix = np.frombuffer(data, np.uint8)[: size // columns * columns].reshape(columns, -1)
    return matrix.T.tobytes() + data[matrix.size :]
