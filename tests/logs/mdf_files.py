"""MDF files for tests: written by asammdf, or block by block where it writes no such thing."""

import struct
import warnings
from pathlib import Path
from typing import Any

import asammdf
import numpy as np
from asammdf.blocks.v4_blocks import ChannelConversion

ROWS = 50
T_S = np.arange(ROWS) / 100.0
UNSIGNED, SIGNED, FLOAT = 0, 2, 4
"""Types of data, the lowest byte first; one more has the highest first."""


def write(folder: Path, *groups: list[asammdf.Signal], **options: Any) -> Path:
    """Write a file of some groups with asammdf."""
    path = folder / "motor.mf4"
    compression = options.pop("compression", 0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with asammdf.MDF(**({"version": "4.10"} | options)) as file:
            for group in groups:
                file.append(group)
            saved = file.save(path.with_suffix(""), overwrite=True, compression=compression)
    return Path(saved)


def signal(name: str, t_s: np.ndarray, unit: str = "", scale: float = 1.0) -> asammdf.Signal:
    """Return a signal that is proportional to time."""
    return asammdf.Signal(scale * t_s, t_s, unit=unit, name=name)


def converted(raw: np.ndarray, conversion: ChannelConversion) -> asammdf.Signal:
    """Return a force of raw values with a conversion, whose unit is N."""
    t_s = np.arange(len(raw)) / 100.0
    return asammdf.Signal(raw, t_s, unit="N", name="force", conversion=conversion)


class Maker:
    """Writes a file block by block."""

    def __init__(self, **identification: Any) -> None:
        self.data = bytearray(b"MDF     4.10    by hand".ljust(64, b"\0"))
        self.data[28:30] = struct.pack("<H", 410)
        self._head = self.block("HD", [0] * 6, bytes(32))

    def block(self, kind: str, links: list[int], content: bytes = b"") -> int:
        """Add a block, and return where it is."""
        self.data += bytes(-len(self.data) % 8)
        place, length = len(self.data), 24 + 8 * len(links) + len(content)
        self.data += struct.pack("<4sIQQ", b"##" + kind.encode(), 0, length, len(links))
        self.data += struct.pack(f"<{len(links)}Q", *links) + content
        return place

    def link(self, place: int, number: int, to: int) -> None:
        """Set a link of a block."""
        struct.pack_into("<Q", self.data, place + 24 + 8 * number, to)

    def text(self, text: str) -> int:
        """Add a text."""
        return self.block("TX", [], text.encode() + b"\0")

    def channel(self, name: str, following: int = 0, /, **told: Any) -> int:
        """Add a channel, by default one of 64 bits at the beginning of a record."""
        keys = ("kind", "counts", "data", "first_bit", "first_byte", "bits", "flags", "invalid_bit")
        numbers = dict.fromkeys(keys, 0) | {"data": FLOAT, "bits": 64}
        numbers |= {key: told[key] for key in keys if key in told}
        links = [following, told.get("parts", 0), self.text(name), 0]
        links += [told.get("conversion", 0), 0, told.get("unit", 0), 0]
        body = struct.pack("<BBBBIIII", *(numbers[key] for key in keys)) + bytes(52)
        return self.block("CN", links, body)

    def group(self, channels: int, records: int, size: int, /, **told: int) -> int:
        """Add a group of channels, which is the first of a chain."""
        links = [told.get("following", 0), channels, 0, 0, 0, 0]
        flags, invalid = told.get("flags", 0), told.get("invalid_bytes", 0)
        body = struct.pack("<QQH6xII", told.get("record_id", 0), records, flags, size, invalid)
        return self.block("CG", links, body)

    def finish(self, path: Path, *data_groups: tuple[int, int, int]) -> Path:
        """Write the file, of data groups of a group, a block of data, and bytes of a number."""
        place, number = self._head, 0
        for group, data, id_bytes in data_groups:
            following = self.block("DG", [0, group, data, 0], bytes([id_bytes]) + bytes(7))
            self.link(place, number, following)
            place = following
        path.write_bytes(self.data)
        return path
