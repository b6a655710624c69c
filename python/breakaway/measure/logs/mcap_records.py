"""Decode the records of an MCAP file, as far as they hold messages.

Attachments, metadata, schemas and indexes are passed over, not looked at. Source: the MCAP format
specification, mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import pyarrow as pa

from breakaway.measure.logs.budget import Budget

MAGIC = b"\x89MCAP0\r\n"
HEAD = struct.Struct("<BQ")
FOOTER, CHANNEL, MESSAGE, CHUNK, DATA_END = 2, 4, 5, 6, 15
CODECS = {"lz4": "lz4", "zstd": "zstd"}
"""Compression of a chunk -> its name in Arrow."""

BLOCK = 2**20


@dataclass(frozen=True)
class Topic:
    """A channel of a file."""

    name: str
    encoding: str


@dataclass(frozen=True)
class Message:
    """A message, with its times of publishing, 0 for none, and of logging in ns."""

    topic: Topic
    published_ns: int
    logged_ns: int
    data: memoryview


class CutOffError(ValueError):
    """The file ends within a record, as where the recorder was stopped by a crash."""


def messages(stream: BinaryIO, budget: Budget) -> Iterator[Message]:
    """Give the messages of a file in the order of the file.

    Raises
    ------
    CutOffError
        The file ends within a record; what was given before is whole.
    ValueError
        The file is damaged.
    LogError
        A record takes more memory than it may.

    """
    if stream.read(len(MAGIC)) != MAGIC:
        raise ValueError("it does not begin as one")
    topics: dict[int, Topic] = {}
    for kind, content in _records(stream, budget):
        inner = _inner(content, budget) if kind == CHUNK else [(kind, content)]
        for one, body in inner:
            if one == CHANNEL:
                number, topic = _topic(body)
                topics[number] = topic
            elif one == MESSAGE:
                number, _, logged, published = struct.unpack_from("<HIQQ", body)
                yield Message(topics[number], published, logged, body[22:])


def _records(stream: BinaryIO, budget: Budget) -> Iterator[tuple[int, memoryview]]:
    """Give chunks, channels and messages; check the sum of all bytes where the file states one."""
    begin = stream.tell()
    end = stream.seek(0, 2)
    stream.seek(begin)
    check = zlib.crc32(MAGIC)
    while True:
        head = stream.read(HEAD.size)
        if len(head) < HEAD.size:
            raise CutOffError("its end is cut off")
        kind, length = HEAD.unpack(head)
        if length > end - stream.tell():
            raise CutOffError(f"a record claims {length} bytes of {end - stream.tell()}")
        if kind == DATA_END:
            (stated,) = struct.unpack("<I", stream.read(length)[:4])
            if stated not in (0, check):
                raise ValueError("its checksum does not match its bytes")
            return
        check = zlib.crc32(head, check)
        if kind in (CHUNK, CHANNEL, MESSAGE):
            budget.take("a record", 0, 2 * length)
            content = stream.read(length)
            check = zlib.crc32(content, check)
            yield kind, memoryview(content)
        elif kind == FOOTER:
            raise ValueError("it ends before its data do")
        else:
            for done in range(0, length, BLOCK):
                check = zlib.crc32(stream.read(min(BLOCK, length - done)), check)


def _inner(chunk: memoryview, budget: Budget) -> Iterator[tuple[int, memoryview]]:
    """Give the records of a chunk."""
    size, stated = struct.unpack_from("<16xQI", chunk)
    compression, place = _text(chunk, 28)
    (packed,) = struct.unpack_from("<Q", chunk, place)
    if packed != len(chunk) - place - 8:
        raise ValueError(f"a chunk claims {packed} bytes of {len(chunk) - place - 8}")
    budget.take("a chunk", 0, 2 * len(chunk) + size)
    data = _unpacked(chunk[place + 8 :], compression, size)
    if len(data) != size or stated not in (0, zlib.crc32(data)):
        raise ValueError("the size or checksum of a chunk does not match its bytes")
    place = 0
    while place < size:
        kind, length = HEAD.unpack_from(data, place)
        place += HEAD.size
        if length > size - place:
            raise ValueError(f"a record claims {length} bytes of {size - place}")
        yield kind, data[place : place + length]
        place += length


def _unpacked(data: memoryview, compression: str, size: int) -> memoryview:
    """Return the content of a chunk, but no more than a byte beyond what it claims."""
    if not compression:
        return data
    if compression not in CODECS:
        raise ValueError(f"a chunk is compressed by {compression[:40]!r}")
    with pa.CompressedInputStream(pa.BufferReader(data), CODECS[compression]) as stream:
        return memoryview(stream.read(size + 1))


def _topic(body: memoryview) -> tuple[int, Topic]:
    (number,) = struct.unpack_from("<H", body)
    name, place = _text(body, 4)
    encoding, _ = _text(body, place)
    return number, Topic(name, encoding)


def _text(data: memoryview, place: int) -> tuple[str, int]:
    """Return the text at a place, and where it ends."""
    (length,) = struct.unpack_from("<I", data, place)
    end = place + 4 + length
    if end > len(data):
        raise ValueError(f"a text claims {length} bytes of {len(data) - place - 4}")
    return str(data[place + 4 : end], "utf-8"), end
