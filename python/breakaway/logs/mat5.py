"""Decode MATLAB files of version 5 to 7.2.

scipy reads these too, but takes types and sizes as they are written, so that a damaged file can
end the process; here each is checked. Source: MathWorks, "MAT-File Format", data elements.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from typing import Literal

import numpy as np

from breakaway.logs.raw import DEFLATE_RATIO, RawFile

Order = Literal["<", ">"]
"""Which byte of a number comes first: the lowest or the highest."""

HEADER = 128
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

STRUCTURE, NUMBERS = 2, range(6, 16)
CLASSES = {1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse"}
"""Classes of matrices; those of full matrices of numbers are 6 to 15."""

COMPLEX = 0x0800


def decode(raw: RawFile, data: bytes) -> None:
    """Add the vectors of a file, and the vectors that are fields of its structures.

    Raises
    ------
    ValueError
        The file is damaged.

    """
    order = ORDERS.get(data[126:128])
    if order is None:
        raise ValueError("the header does not state the order of bytes")
    for kind, content in _elements(data[HEADER:], order):
        if kind == COMPRESSED:
            most = DEFLATE_RATIO * len(content) + HEADER
            unpacked = zlib.decompressobj().decompress(content, most)
            kind, content = next(_elements(unpacked, order), (0, b""))
        if kind != MATRIX:
            raise ValueError(f"an element of type {kind} stands where a matrix must")
        _add_matrix(raw, content, order)


def _elements(data: bytes, order: Order) -> Iterator[tuple[int, bytes]]:
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
        end = begin + size
        place = end if kind == COMPRESSED else (end + 7) // 8 * 8


def _numbers(element: tuple[int, bytes], order: Order) -> np.ndarray:
    kind, content = element
    if kind not in TYPES:
        raise ValueError(f"an element of type {kind} stands where numbers must")
    return np.frombuffer(content, np.dtype(TYPES[kind]).newbyteorder(order))


def _add_matrix(raw: RawFile, content: bytes, order: Order, name: str = "") -> None:
    """Add a matrix; its own name counts unless it is a field, which has the name given."""
    if not content:  # an empty field
        raw.add(name, np.zeros(0), None)
        return
    parts = _elements(content, order)
    flags = int(_numbers(next(parts), order)[0])
    shape = [int(n) for n in _numbers(next(parts), order)]
    own = next(parts)[1].decode("latin-1")
    kind, is_field = flags & 0xFF, bool(name)
    name = name or own
    if kind == STRUCTURE and math.prod(shape) == 1 and not is_field:
        _add_fields(raw, name, parts, order)
    elif kind not in NUMBERS:
        what = CLASSES.get(kind, str(kind))
        raw.unreadable[name] = f"is of class {what}; it must be a vector of real numbers"
    elif flags & COMPLEX:
        raw.unreadable[name] = "is of type complex; it must be a vector of real numbers"
    else:
        raw.add(name, _numbers(next(parts), order).reshape(shape, order="F"), None)


def _add_fields(raw: RawFile, name: str, parts: Iterator[tuple[int, bytes]], order: Order) -> None:
    """Add the fields of a structure as ``name.field``."""
    width = int(_numbers(next(parts), order)[0])
    texts = next(parts)[1]
    if width <= 0:
        raise ValueError(f"the names of fields are {width} bytes long")
    for place in range(0, len(texts), width):
        field = texts[place : place + width].split(b"\0")[0].decode("latin-1")
        kind, content = next(parts)
        if kind != MATRIX:
            raise ValueError(f"an element of type {kind} stands where a field must")
        _add_matrix(raw, content, order, f"{name}.{field}")
