"""Check the blocks of an MDF 4 file, so that damage can not send a reader astray.

asammdf follows links without end where damage made them a ring, and takes sizes as they are
written. Source: ASAM MDF 4.1, the block types and their links.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

from breakaway.errors import LogError
from breakaway.logs.raw import DEFLATE_RATIO

FOLLOWED = {
    b"##HD": (0, 1, 2, 3, 4, 5),
    b"##FH": (0,),
    b"##AT": (0,),
    b"##EV": (0,),
    b"##CH": (0,),
    b"##DG": (0, 1, 2),
    b"##CG": (0, 1),
    b"##CN": (0, 1, 4, 5),
    b"##CA": (0,),
}
"""Block type -> places of the links that lead on; the others lead to texts, or back."""

ALL_FOLLOWED = (b"##DL", b"##HL", b"##LD")
MOST_LINKS = 1_000_000


class _Blocks:
    """The bytes of a file as blocks."""

    def __init__(self, path: Path, data: mmap.mmap) -> None:
        self.path, self.data = path, data

    def links(self, place: int) -> list[int]:
        """Return the links that lead on from the block at a place, checked."""
        kind, length, count = self._head(place)
        self._check_claims(kind, place, length, count)
        if 24 + 8 * count > length or count > MOST_LINKS:
            raise self.damaged(place, f"claims {count} links")
        all_links = struct.unpack_from(f"<{count}Q", self.data, place + 24)
        if kind == b"##CC":  # all but the inverse, which leads back
            return [link for k, link in enumerate(all_links) if k != 3 and link]
        if kind in ALL_FOLLOWED:
            return [link for link in all_links if link]
        ways = [all_links[k] for k in FOLLOWED.get(kind, ()) if k < count and all_links[k]]
        # A channel of variable length may keep its data in a group that comes before its own.
        return [w for w in ways if kind != b"##CN" or self._head(w)[0] != b"##CG"]

    def _head(self, place: int) -> tuple[bytes, int, int]:
        if place + 24 > len(self.data):
            raise self.damaged(place, "begins beyond the end of the file")
        kind, length, count = struct.unpack_from("<4s4xQQ", self.data, place)
        if kind[:2] != b"##":
            raise self.damaged(place, "does not begin with ##")
        if length < 24 or place + length > len(self.data):
            raise self.damaged(place, f"claims {length} bytes")
        return kind, length, count

    def _check_claims(self, kind: bytes, place: int, length: int, count: int) -> None:
        """Refuse claims of more data than the file can hold."""
        body, most = place + 24 + 8 * count, DEFLATE_RATIO * len(self.data)
        if kind == b"##CG" and body + 32 <= place + length:
            cycles, data, invalid = struct.unpack_from("<8xQ8xII", self.data, body)
            # A record of no bytes holds virtual channels, which cost memory all the same.
            if cycles * max(data + invalid, 1) > most:
                raise self.damaged(place, f"claims {cycles} records of {data + invalid} bytes")
            self._check_records(place, data)
        if kind == b"##DZ" and body + 24 <= place + length:
            (size,) = struct.unpack_from("<8xQ", self.data, body)
            if size > most:
                raise self.damaged(place, f"claims {size} bytes behind compression")

    def _check_records(self, group: int, data_bytes: int) -> None:
        """Refuse channels that lie outside the records of their group."""
        seen = set()
        place = struct.unpack_from("<Q", self.data, group + 32)[0]
        while place and place not in seen:
            seen.add(place)
            kind, length, count = self._head(place)
            body = place + 24 + 8 * count
            if kind != b"##CN" or count < 8 or body + 16 > place + length:
                raise self.damaged(place, "is no channel")
            kind_of_channel, bit, byte, bits = struct.unpack_from("<BxxBII", self.data, body)
            virtual = kind_of_channel in (3, 6)
            if not virtual and 8 * byte + bit + bits > 8 * data_bytes:
                raise self.damaged(place, f"lies outside its record of {data_bytes} bytes")
            place = struct.unpack_from("<Q", self.data, place + 24)[0]

    def damaged(self, place: int, why: str) -> LogError:
        """Return the error for a damaged block."""
        return LogError(
            f"{self.path.name}: is damaged: the block at byte {place} {why}; export the log again"
        )


def check_blocks(path: Path) -> None:
    """Raise `LogError` unless a file is MDF 4 and its blocks form a tree within it."""
    with path.open("rb") as file:
        head = file.read(64)
        if len(head) < 64 or not head.startswith(b"MDF     "):
            raise LogError(
                f"{path.name}: is not a finalized MDF file; export the log again, or finalize it "
                "with the tool that recorded it"
            )
        if head[8:10] != b"4.":
            version = head[8:16].decode("ascii", errors="replace").strip("\0 ")
            raise LogError(f"{path.name}: is MDF version {version}; only 4 is read: convert it")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            _check_tree(_Blocks(path, data))


def _check_tree(blocks: _Blocks) -> None:
    """Walk all blocks depth first; a block that leads to itself is a ring."""
    open_blocks, done = {64}, set[int]()
    stack: list[tuple[int, Iterator[int]]] = [(64, iter(blocks.links(64)))]
    while stack:
        place, ways = stack[-1]
        way = next(ways, None)
        if way is None:
            stack.pop()
            open_blocks.discard(place)
            done.add(place)
        elif way in open_blocks:
            raise blocks.damaged(way, "leads to itself")
        elif way not in done:
            open_blocks.add(way)
            stack.append((way, iter(blocks.links(way))))
