"""Decode MATLAB files of version 5 to 7.2.

scipy reads these too, but takes types and sizes as they are written, so that a damaged file can
end the process; here each is checked. Cells, objects, function handles and references are noted as
unreadable, and their content is not looked at. Source: MathWorks, "MAT-File Format", data elements.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO, Literal

import numpy as np

from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.raw import DEFLATE_RATIO, MOST_COLUMNS, RawFile

Order = Literal["<", ">"]
"""Which byte of a number comes first: the lowest or the highest."""

HEADER, TAG = 128, 8
ORDERS: dict[bytes, Order] = {b"IM": "<", b"MI": ">"}
MATRIX, COMPRESSED = 14, 15
TYPES = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
"""Type of an element that holds numbers -> that of its array."""

STRUCTURE, TEXT, OPAQUE, NUMBERS = 2, 4, 17, range(6, 16)
UTF_8 = 16
CLASSES = {1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse", 16: "function handle"}
"""Classes of matrices; those of full matrices of numbers are 6 to 15."""

LABELS = {"Name": "Data", "label": "values"}
"""Field with a text -> the field beside it whose name that is."""
OBJECT = (
    "is an object of MATLAB, such as a timeseries or timetable, whose layout is not public: save "
    "its numbers, such as t = ts.Time; x = ts.Data; save('log.mat', 't', 'x')"
)
DEEPEST = 8
"""Most structures within structures."""

COMPLEX = 0x0800
MOST_DIMENSIONS = 32


@dataclass(frozen=True)
class _Variable:
    """A top-level element of a file: where its content is, and its size once unpacked."""

    kind: int
    place: int
    stored: int
    size: int


def decode(raw: RawFile, stream: BinaryIO, budget: Budget) -> None:
    """Add the vectors of a file, the channels of its matrices, and the fields of its structures.

    Raises
    ------
    ValueError
        The file is damaged.
    LogError
        It takes more memory than it may.

    """
    stream.seek(HEADER - 2)
    order = ORDERS.get(stream.read(2))
    if order is None:
        raise ValueError("the header does not state the order of bytes")
    variables = list(_variables(stream, order))
    for number, one in enumerate(variables, start=1):
        budget.take(f"variable {number}", 0, one.size + one.stored)
    for one in variables:
        stream.seek(one.place)
        content = stream.read(one.stored)
        if one.kind == COMPRESSED:
            content = _unpacked(content, one.size)
        _add_matrix(raw, budget, memoryview(content), order)


def _variables(stream: BinaryIO, order: Order) -> Iterator[_Variable]:
    """Give the top-level elements of a file; none claims more than the file can hold."""
    end = stream.seek(0, 2)
    place = HEADER
    while place < end:
        stream.seek(place)
        kind, stored = _tag(stream.read(TAG), order)
        place += TAG
        if place + stored > end:
            raise ValueError(f"an element claims {stored} bytes of {end - place}")
        inner, size = kind, stored
        if kind == COMPRESSED:
            begin = stream.read(min(stored, 2 * HEADER))
            inner, size = _tag(zlib.decompressobj().decompress(begin, TAG), order)
            if size > DEFLATE_RATIO * stored:
                raise ValueError(f"an element claims {size} bytes behind {stored}")
        if inner != MATRIX:
            raise ValueError(f"an element of type {inner} stands where a matrix must")
        yield _Variable(kind, place, stored, size)
        place += stored if kind == COMPRESSED else -(-stored // 8) * 8


def _tag(data: bytes, order: Order) -> tuple[int, int]:
    if len(data) < TAG:
        raise ValueError("an element is cut off")
    kind, size = struct.unpack(order + "II", data)
    return kind, size


def _unpacked(content: bytes, size: int) -> bytes:
    """Return the content of the one element that is packed, no more than it claims."""
    unpacked = zlib.decompressobj().decompress(content, TAG + size)
    if len(unpacked) < TAG + size:
        raise ValueError(f"an element claims {size} bytes of {len(unpacked) - TAG}")
    return unpacked[TAG:]


def _elements(data: memoryview, order: Order) -> Iterator[tuple[int, memoryview]]:
    """Give the type and the content of each element."""
    place = 0
    while place < len(data):
        if place + 8 > len(data):
            raise ValueError("an element is cut off")
        kind, size = struct.unpack_from(order + "II", data, place)
        begin = place + 8
        if kind >> 16:  # a small element holds its size and up to 4 bytes within its tag
            kind, size, begin = kind & 0xFFFF, kind >> 16, place + 4
            if size > 4:
                raise ValueError(f"a small element claims {size} bytes")
        if begin + size > len(data):
            raise ValueError(f"an element claims {size} bytes of {len(data) - begin}")
        yield kind, data[begin : begin + size]
        place = (begin + size + 7) // 8 * 8


def _numbers(element: tuple[int, memoryview], order: Order) -> np.ndarray:
    kind, content = element
    if kind not in TYPES:
        raise ValueError(f"an element of type {kind} stands where numbers must")
    return np.frombuffer(content, np.dtype(TYPES[kind]).newbyteorder(order))


def _text(content: memoryview) -> str:
    return bytes(content).split(b"\0")[0].decode("latin-1")


@dataclass(frozen=True)
class _Matrix:
    """A matrix: what its header says, and the elements behind it."""

    kind: int
    is_complex: bool
    shape: tuple[int, ...]
    name: str
    parts: Iterator[tuple[int, memoryview]]


def _opened(content: memoryview, order: Order) -> _Matrix:
    """Read the header of a matrix."""
    parts = _elements(content, order)
    flags = int(_numbers(next(parts), order)[0])
    kind = flags & 0xFF
    if kind == OPAQUE:  # has no shape, but a name
        return _Matrix(kind, False, (), _text(next(parts)[1]), parts)
    shape = [int(n) for n in _numbers(next(parts), order)[: MOST_DIMENSIONS + 1]]
    if len(shape) > MOST_DIMENSIONS or min(shape, default=0) < 0:
        raise ValueError(f"a matrix has negative dimensions, or more than {MOST_DIMENSIONS}")
    return _Matrix(kind, bool(flags & COMPLEX), tuple(shape), _text(next(parts)[1]), parts)


def _add_matrix(
    raw: RawFile,
    budget: Budget,
    content: memoryview,
    order: Order,
    name: str = "",
    depth: int = 0,
) -> None:
    """Add a matrix; its own name counts unless it is a field, which has the name given."""
    if not len(content):  # an empty field
        raw.give(name, np.zeros(0), None)
        return
    one = _opened(content, order)
    name = name or one.name
    if one.kind == OPAQUE:
        raw.refuse(name, OBJECT)
    elif one.kind == STRUCTURE and 1 <= math.prod(one.shape) <= MOST_COLUMNS:
        if depth == DEEPEST:
            raw.refuse(name, f"lies deeper than {DEEPEST} structures; move it up")
            return
        _add_structures(raw, budget, name, one, order, depth)
    elif one.kind not in NUMBERS:
        what = CLASSES.get(one.kind, str(one.kind))
        raw.refuse(name, f"is of class {what}; it must be a vector of real numbers")
    elif one.is_complex:
        raw.refuse(name, "is of type complex; it must be a vector of real numbers")
    else:
        numbers = _numbers(next(one.parts), order)
        budget.take(f"'{name}'", 8 * numbers.size, len(content))
        raw.give(name, numbers.reshape(one.shape, order="F"), None)


def _add_structures(
    raw: RawFile, budget: Budget, name: str, one: _Matrix, order: Order, depth: int
) -> None:
    """Add the fields of structures, as ``name.field`` or ``name#2.field``.

    Data beside a text that names them have that name: ``Data`` beside ``Name``, as dSPACE writes,
    and ``values`` beside ``label``, as Simulink does.
    """
    width = int(_numbers(next(one.parts), order)[0])
    texts = next(one.parts)[1]
    if width <= 0:
        raise ValueError(f"the names of fields are {width} bytes long")
    fields = [_text(texts[place : place + width]) for place in range(0, len(texts), width)]
    count = math.prod(one.shape)
    for number in range(1, count + 1):
        contents = {field: _field(next(one.parts)) for field in fields}
        prefix = name if count == 1 else f"{name}#{number}"
        for field, content in contents.items():
            told = next((label for label, data in LABELS.items() if data == field), "")
            label = _label(contents.get(told), order)
            full = f"{name}.{label}" if label else f"{prefix}.{field}"
            _add_matrix(raw, budget, content, order, full, depth + 1)


def _field(element: tuple[int, memoryview]) -> memoryview:
    kind, content = element
    if kind != MATRIX:
        raise ValueError(f"an element of type {kind} stands where a field must")
    return content


def _label(content: memoryview | None, order: Order) -> str:
    """Return a text that names what stands beside it, or nothing."""
    if content is None or not len(content):
        return ""
    one = _opened(content, order)
    element = next(one.parts, None) if one.kind == TEXT else None
    if element is None:
        return ""
    kind, data = element
    if kind == UTF_8:
        text = bytes(data).decode("utf-8", "replace")
    else:
        text = "".join(map(chr, _numbers(element, order).tolist()))
    return text.strip() if text.isprintable() else ""
