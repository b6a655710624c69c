"""The blocks of an MDF 4 file: each is checked to lie within the file before it is used.

Source: ASAM MDF 4.1, the general layout of blocks.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from io import BufferedReader
from typing import Any

from breakaway.errors import LogError

HEAD = struct.Struct("<4s4xQQ")
"""Type, length in bytes, number of links."""

FIRST = 64
"""Place of the header block, behind the identification."""

HEAD_BYTES = 256

MOST_LINKS = 1_000_000
LONGEST_TEXT = 2000
"""Most links, and most bytes of a text that is read, of one block."""

_MARKUP_TEXT = re.compile(r"<TX\b[^<>]*>([^<>]*)</TX>")
_ENTITIES = {"&lt;": "<", "&gt;": ">", "&quot;": '"', "&apos;": "'", "&amp;": "&"}


@dataclass(frozen=True)
class Block:
    """A block: where it is, where it leads, and where its content is."""

    kind: str
    """Type, such as ``CN``."""

    place: int
    links: tuple[int, ...]
    content: int
    """Where the content begins."""

    end: int
    """Where the content ends."""
    head: bytes
    """The first bytes of the block, up to `HEAD_BYTES`, so that most need no second look."""

    def link(self, number: int) -> int:
        """Return where a link leads; 0 stands for nowhere."""
        return self.links[number] if number < len(self.links) else 0


class Blocks:
    """The blocks of an open file.

    The file is read, not mapped into memory: one that shrinks meanwhile must not end the process.
    """

    def __init__(self, name: str, file: BufferedReader) -> None:
        self.name = name
        self._file = file
        self._size = file.seek(0, 2)
        self._seen: set[int] = set()
        self._texts: dict[int, str] = {}

    def read(self, place: int, count: int) -> bytes:
        """Return bytes of the file."""
        self._file.seek(place)
        found = self._file.read(count)
        if len(found) != count:
            raise self.damaged(place, "is cut off")
        return found

    def block(self, place: int, *kinds: str) -> Block:
        """Return the block of one of some kinds at a place."""
        if place + HEAD.size > self._size:
            raise self.damaged(place, "begins beyond the end of the file")
        head = self.read(place, min(HEAD_BYTES, self._size - place))
        kind, length, count = HEAD.unpack_from(head)
        name = kind[2:].decode("latin-1")
        if kind[:2] != b"##" or name not in kinds:
            raise self.damaged(place, f"is of type {name!r}, not {' or '.join(kinds)}")
        if length < HEAD.size + 8 * count or place + length > self._size or count > MOST_LINKS:
            raise self.damaged(place, f"claims {length} bytes with {count} links")
        content = HEAD.size + 8 * count
        raw_links = head[HEAD.size : content]
        if content > len(head):
            raw_links = self.read(place + HEAD.size, 8 * count)
        links = struct.unpack(f"<{count}Q", raw_links)
        return Block(name, place, links, place + content, place + length, head[:length])

    def part(self, block: Block, offset: int, count: int) -> bytes:
        """Return bytes of the content of a block."""
        begin = block.content - block.place + offset
        if block.place + begin + count > block.end:
            raise self.damaged(block.place, "is too short")
        if begin + count <= len(block.head):
            return block.head[begin : begin + count]
        return self.read(block.place + begin, count)

    def kind(self, place: int) -> str:
        """Return the type of the block at a place."""
        return self.read(place, 4)[2:].decode("latin-1")

    def chain(self, place: int, kind: str) -> Iterator[Block]:
        """Give a block and those that its first link leads to, each once in a file."""
        while place:
            block = self.once(place, kind)
            yield block
            place = block.link(0)

    def once(self, place: int, *kinds: str) -> Block:
        """Return a block that may be met once in a file, so that no way through it is a ring."""
        if place in self._seen:
            raise self.damaged(place, "belongs to two places, or leads to itself")
        self._seen.add(place)
        return self.block(place, *kinds)

    def unpack(self, block: Block, layout: str, offset: int = 0) -> tuple[Any, ...]:
        """Return numbers from the content of a block; ``layout`` as `struct` has it."""
        return struct.unpack(layout, self.part(block, offset, struct.calcsize(layout)))

    def text(self, place: int) -> str:
        """Return a text, or that of the element TX of a markup; nothing of 0.

        The markup is searched, not parsed: no entities but the five of XML are known.
        """
        if not place:
            return ""
        if place not in self._texts:  # many channels may share one
            self._texts[place] = self._text(place)
        return self._texts[place]

    def _text(self, place: int) -> str:
        block = self.block(place, "TX", "MD")
        if block.end - block.content > LONGEST_TEXT:
            raise self.damaged(place, f"is a text of more than {LONGEST_TEXT} bytes")
        content = self.part(block, 0, block.end - block.content)
        text = content.split(b"\0")[0].decode("utf-8", errors="backslashreplace")
        if block.kind == "TX":
            return text
        found = _MARKUP_TEXT.search(text)
        return re.sub("&[a-z]+;", lambda m: _ENTITIES.get(m[0], m[0]), found[1]) if found else ""

    def damaged(self, place: int, why: str) -> LogError:
        """Return the error for a damaged block."""
        return LogError(
            f"{self.name}: is damaged: the block at byte {place} {why}; export the log again"
        )


def open_blocks(name: str, file: BufferedReader) -> Blocks:
    """Return the blocks of a file.

    Raises
    ------
    LogError
        It is not a finalized MDF file of version 4.

    """
    head = file.read(FIRST)
    if len(head) < FIRST or not head.startswith(b"MDF     ") or any(head[60:64]):
        raise LogError(
            f"{name}: is not a finalized MDF file; export the log again, or finalize it "
            "with the tool that recorded it"
        )
    if head[8:10] != b"4.":
        version = head[8:16].decode("ascii", errors="replace").strip("\0 ")
        raise LogError(f"{name}: is MDF version {version}; only version 4 is read: convert it")
    return Blocks(name, file)
