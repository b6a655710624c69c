"""Decode MATLAB files of version 4.

Source: MathWorks, "MAT-File Format", version 4: a header of 20 bytes, the name, the numbers column
by column.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.raw import RawFile

HEADER = struct.Struct("5i")
TYPES = {0: "f8", 1: "f4", 2: "i4", 3: "i2", 4: "u2", 5: "u1"}
"""Third digit of the type of a matrix -> that of its array."""

ORDERS = {0: "<", 1: ">"}
"""First digit of the type of a matrix -> order of its bytes; the others are of old machines."""

KINDS = {1: "text", 2: "sparse"}
"""Last digit of the type of a matrix that is not full -> what it is."""


@dataclass(frozen=True)
class _Matrix:
    """A matrix: its name, its numbers, and where they begin."""

    name: str
    dtype: np.dtype[np.generic]
    shape: tuple[int, int]
    place: int
    reason: str

    @property
    def count(self) -> int:
        """Number of its elements."""
        return self.shape[0] * self.shape[1]


def decode(raw: RawFile, stream: BinaryIO, budget: Budget) -> None:
    """Add the vectors of a file.

    Raises
    ------
    ValueError
        The file is damaged.
    LogError
        It takes more memory than it may.

    """
    wanted = []
    for matrix in _matrices(stream):
        if matrix.reason:
            raw.refuse(matrix.name, matrix.reason)
        else:
            passing = matrix.count * matrix.dtype.itemsize
            budget.take(f"'{matrix.name}'", 8 * matrix.count, passing)
            wanted.append(matrix)
    for matrix in wanted:
        stream.seek(matrix.place)
        content = stream.read(matrix.count * matrix.dtype.itemsize)
        numbers = np.frombuffer(content, matrix.dtype)
        raw.give(matrix.name, numbers.reshape(matrix.shape, order="F"), None)


def _matrices(stream: BinaryIO) -> list[_Matrix]:
    """Return all matrices of a file, each checked to lie within it."""
    end = stream.seek(0, 2)
    found, place = [], 0
    while place < end:
        stream.seek(place)
        matrix, place = _matrix(stream.read(HEADER.size), stream, end)
        found.append(matrix)
    return found


def _matrix(head: bytes, stream: BinaryIO, end: int) -> tuple[_Matrix, int]:
    """Return the matrix whose header was read, and where the next begins."""
    if len(head) < HEADER.size:
        raise ValueError("a header is cut off")
    order = "<" if 0 <= struct.unpack_from("<i", head)[0] < 5000 else ">"
    kind, rows, columns, imaginary, length = struct.unpack(f"{order}5i", head)
    machine, rest, number, form = kind // 1000, kind // 100 % 10, kind // 10 % 10, kind % 10
    if ORDERS.get(machine) != order or rest or number not in TYPES or form not in (0, 1, 2):
        raise ValueError(f"a matrix is of type {kind}")
    if min(rows, columns) < 0 or not 0 < length <= end:
        raise ValueError(f"a matrix claims {rows} x {columns} elements, and {length} for its name")
    name = stream.read(length).split(b"\0")[0].decode("latin-1")
    dtype, place = np.dtype(order + TYPES[number]), stream.tell()
    size = rows * columns * dtype.itemsize * (2 if imaginary else 1)
    if place + size > end:
        raise ValueError(f"'{name}' claims {size} bytes of {end - place}")
    reason = f"is of class {KINDS[form]}; it must be a vector of real numbers" if form else ""
    if imaginary and not reason:
        reason = "is of type complex; it must be a vector of real numbers"
    return _Matrix(name, dtype, (rows, columns), place, reason), place + size
