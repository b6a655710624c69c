"""Raw values from records: integers of any width and floating-point numbers."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from breakaway.measure.logs.mdf.conversion import Raw
from breakaway.measure.logs.mdf.records import Records
from breakaway.measure.logs.mdf.structure import (
    ALL_INVALID,
    OF_VARIABLE_LENGTH,
    SOME_INVALID,
    VIRTUAL,
    Channel,
)

NUMBERS = ("u", "i", "f")
WIDTHS_OF_FLOATS = (16, 32, 64)


def why_not_numbers(channel: Channel) -> str:
    """Return why a channel holds no numbers that can be read; nothing where it does."""
    kind = channel.data[-1] if channel.data[0] in "<>" else channel.data
    if channel.is_array:
        return "is an array or a union in each row; it must be one real number"
    if channel.kind == OF_VARIABLE_LENGTH:
        return "has samples of variable length; it must be real numbers"
    if channel.flags & ALL_INVALID:
        return "all its samples are marked invalid; record it again"
    if channel.kind in VIRTUAL:
        return ""
    if kind not in NUMBERS:
        return f"is {kind}; it must be real numbers"
    if kind == "f" and (channel.first_bit or channel.bits not in WIDTHS_OF_FLOATS):
        return f"is a floating-point number of {channel.bits} bits; it must have 16, 32 or 64"
    if not 0 < channel.bits <= 64 - channel.first_bit:
        return f"has {channel.bits} bits from bit {channel.first_bit}; it must be 1 to 64 in all"
    return ""


def raw_values(channel: Channel, records: Records, first_row: int) -> Raw:
    """Return the raw values of a channel that holds numbers, one for each record."""
    if channel.kind in VIRTUAL:
        return np.arange(first_row, first_row + len(records))
    order, kind = channel.data[0], channel.data[1]
    width = (channel.first_bit + channel.bits + 7) // 8
    field = records[:, channel.first_byte : channel.first_byte + width]
    if not channel.first_bit and channel.bits in (8, 16, 32, 64):
        return np.ascontiguousarray(field).view(f"{order}{kind}{width}").reshape(-1)
    return _of_bits(field if order == "<" else field[:, ::-1], channel, is_signed=kind == "i")


def _of_bits(field: Records, channel: Channel, is_signed: bool) -> Raw:
    """Return integers of some bits of up to 8 bytes, the lowest first."""
    padded = np.zeros((len(field), 8), np.uint8)
    padded[:, : field.shape[1]] = field
    whole = padded.view("<u8").reshape(-1)
    to_the_top = whole << np.uint64(64 - channel.first_bit - channel.bits)
    if is_signed:
        signed: npt.NDArray[np.int64] = to_the_top.view("<i8") >> np.int64(64 - channel.bits)
        return signed
    return to_the_top >> np.uint64(64 - channel.bits)


def invalid(channel: Channel, data_bytes: int, records: Records) -> npt.NDArray[np.bool_] | None:
    """Return which records have a sample that is marked invalid; None where no bit says so."""
    if not channel.flags & SOME_INVALID:
        return None
    byte, bit = divmod(channel.invalid_bit, 8)
    marked: npt.NDArray[np.bool_] = (records[:, data_bytes + byte] & (1 << bit)) != 0
    return marked
