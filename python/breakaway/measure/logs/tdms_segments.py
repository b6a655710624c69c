"""The segments of a TDMS file: what each says of its channels; npTDMS tells only what is last.

Source: National Instruments, "TDMS File Format Internal Structure".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any, BinaryIO, Literal

import numpy as np

from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.raw import MOST_NAMES

Order = Literal["<", ">"]

LEAD_IN = struct.Struct("<4sI4xQQ")
HAS_OBJECTS, HAS_NEW_LIST, HAS_DATA, IS_BIG_ENDIAN = 1 << 1, 1 << 2, 1 << 3, 1 << 6
BYTES_PER_SEGMENT, BYTES_PER_ENTRY, LEAST_OBJECT = 500, 8, 12

NO_DATA, AS_BEFORE = 2**32 - 1, 0
"""Index of raw data of an object without values in a segment, and of one with as many as before."""

SCALERS = {0x1269: 20, 0x126A: 17}
"""Index of raw data of DAQmx -> bytes of a scaler."""

SIZES = {1: 1, 2: 2, 3: 4, 4: 8, 5: 1, 6: 2, 7: 4, 8: 8, 9: 4, 10: 8, 0x19: 4, 0x1A: 8, 0x21: 1}
SIZES |= {0x44: 16, 0x0008000C: 8, 0x0010000D: 16}
"""Type of data -> bytes of a value."""

TEXT, STAMP, DOUBLE = 0x20, 0x44, 10
EPOCH = np.datetime64("1904-01-01T00:00:00", "ns")
KEPT = ("unit_string", "wf_start_time", "wf_start_offset")
"""Properties that are kept: those whose change within a file matters."""


@dataclass
class Object:
    """What is known of a channel as segments go by."""

    said: dict[str, list[Any]] = field(default_factory=dict)
    starts: list[list[Any]] = field(default_factory=list)
    """Moment of the start, its offset in s, and how many values follow until the next start."""
    count: int = 0
    size: int = 0
    """Values in a chunk, and bytes of one; 0 where these are not known."""


@dataclass
class Segments:
    """What all segments of a file say."""

    objects: dict[str, Object] = field(default_factory=dict)
    cut_off: bool = False

    def values_of(self, path: str, name: str) -> list[Any]:
        """Return the different values that a property of a channel takes, in their order."""
        return self.objects[path].said.get(name, []) if path in self.objects else []

    def starts_of(self, path: str) -> list[tuple[Any, float, int]]:
        """Return start, offset in s and count of each recording of a channel."""
        if path not in self.objects:
            return []
        starts = self.objects[path].starts
        return [(a, b, c) for a, b, c in starts if c or len(starts) == 1]


def read_segments(stream: BinaryIO, budget: Budget) -> Segments:
    """Read what the segments of a file say, and ask for the memory that npTDMS takes for them.

    Raises
    ------
    ValueError
        The file is damaged.
    LogError
        It takes more memory than it may.

    """
    end = stream.seek(0, 2)
    found, place, entries = Segments(), 0, 0
    active: list[str] = []
    while place + LEAD_IN.size <= end:
        stream.seek(place)
        tag, flags, length, raw_at = LEAD_IN.unpack(stream.read(LEAD_IN.size))
        if tag != b"TDSm":
            raise ValueError(f"a segment begins with {tag!r}")
        order: Order = ">" if flags & IS_BIG_ENDIAN else "<"
        if order == ">":
            length, raw_at = (_turned(number) for number in (length, raw_at))
        told = place + LEAD_IN.size + length
        stop, raw_at = min(told, end), place + LEAD_IN.size + raw_at
        if told > end:  # also where the length was not written yet
            found.cut_off = True
            if raw_at > end:
                break
        if flags & HAS_OBJECTS:
            (number,) = struct.unpack(f"{order}I", stream.read(4))
            if number * LEAST_OBJECT > end - place:
                raise ValueError(f"a segment claims {number} objects")
            # Those told may be new, or repeat others.
            entries = min(number + (0 if flags & HAS_NEW_LIST else entries), 2 * MOST_NAMES)
        budget.take("its segments", BYTES_PER_SEGMENT + BYTES_PER_ENTRY * entries)
        if flags & HAS_OBJECTS:
            if flags & HAS_NEW_LIST:
                active = []
            _read_objects(stream, order, number, found, active)
        if flags & HAS_DATA:
            _count_values(found, active, stop - raw_at)
        place = told
    stream.seek(0)
    return found


def _read_objects(
    stream: BinaryIO, order: Order, number: int, found: Segments, active: list[str]
) -> None:
    """Read the objects of a segment: their indices of raw data, and properties that are kept."""
    for _ in range(number):
        path = _text(stream, order)
        one = found.objects.setdefault(path, Object())
        index = _number(stream, order, "I")
        if index not in (NO_DATA, AS_BEFORE):
            _read_index(stream, order, index, one)
        if index != NO_DATA and path not in active:
            active.append(path)
        if index == NO_DATA and path in active:
            active.remove(path)
        changed = {}
        for _ in range(_number(stream, order, "I")):
            name, value = _text(stream, order), _property(stream, order)
            if name in KEPT and value is not None:
                changed[name] = value
        _note(one, changed)


def _read_index(stream: BinaryIO, order: Order, header: int, one: Object) -> None:
    """Read how many values of an object are in a chunk, and how large one is."""
    kind = _number(stream, order, "I")
    stream.read(4)
    one.count = _number(stream, order, "Q")
    one.size = SIZES.get(kind, 0)
    if header in SCALERS:  # of DAQmx, whose chunks are laid out in another way
        one.size = 0
        for _ in range(_number(stream, order, "I")):
            stream.read(SCALERS[header])
        for _ in range(_number(stream, order, "I")):
            stream.read(4)
    elif kind == TEXT:
        stream.read(8)


def _note(one: Object, changed: dict[str, Any]) -> None:
    for name, value in changed.items():
        values = one.said.setdefault(name, [])
        if value not in values:
            values.append(value)
    if {"wf_start_time", "wf_start_offset"} & changed.keys() or not one.starts:
        before: list[Any] = one.starts[-1][:2] if one.starts else [None, 0.0]
        moment = changed.get("wf_start_time", before[0])
        offset_s = float(changed.get("wf_start_offset", before[1]))
        if not one.starts or [moment, offset_s] != before:
            one.starts.append([moment, offset_s, 0])


def _count_values(found: Segments, active: list[str], raw_bytes: int) -> None:
    """Add the values of a segment to the recordings that they are of."""
    objects = [found.objects[path] for path in active if found.objects[path].count]
    chunk = sum(one.count * one.size for one in objects)
    if chunk and all(one.size for one in objects):
        for one in objects:
            one.starts[-1][2] += raw_bytes // chunk * one.count


def _turned(number: int) -> int:
    """Return a number of 8 bytes that was read in the other order."""
    return int.from_bytes(number.to_bytes(8, "little"), "big")


def _number(stream: BinaryIO, order: Order, kind: str) -> int:
    data = stream.read(struct.calcsize(kind))
    (value,) = struct.unpack(order + kind, data)
    return int(value)


def _text(stream: BinaryIO, order: Order) -> str:
    length = _number(stream, order, "I")
    data = stream.read(length)
    if len(data) < length:
        raise ValueError("a text is cut off")
    return data.decode("utf-8", errors="replace")


def _property(stream: BinaryIO, order: Order) -> Any:  # noqa: ANN401 - of any type
    """Read a property: a text, a time stamp or a double; of other types only the place after it."""
    kind = _number(stream, order, "I")
    if kind == TEXT:
        return _text(stream, order)
    if kind not in SIZES:
        raise ValueError(f"a property is of type {kind:#x}")
    data = stream.read(SIZES[kind])
    if kind == DOUBLE:
        return float(struct.unpack(f"{order}d", data)[0])
    return _moment(data, order) if kind == STAMP else None


def _moment(data: bytes, order: Order) -> np.datetime64:
    """Return a time stamp: seconds since 1904, and 2⁻⁶⁴ s."""
    if order == "<":
        fraction, seconds = struct.unpack("<Qq", data)
    else:
        seconds, fraction = struct.unpack(">qQ", data)
    if not -(2**32) < seconds < 2**33:
        raise ValueError(f"a time stamp lies {seconds} s after 1904")
    return EPOCH + np.timedelta64(seconds, "s") + np.timedelta64(fraction * 10**9 >> 64, "ns")
