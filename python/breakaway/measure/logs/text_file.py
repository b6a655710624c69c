"""The bytes of a text file: their encoding, how many lines they hold, and which of them count."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from breakaway.base.reading import open_regular
from breakaway.errors import LogError

BLOCK = 2**20
"""Bytes that are read at a time."""

LONGEST_LINE = 2**23
"""More bytes than these are no line that a reader takes; they are not kept together."""

ASCII = bytes(range(128))

CERTAIN = frozenset("µ°²³·±×ØÄÖÜäöüß".encode("cp1252"))
"""Bytes that cp1252 and Latin-1 share, that occur in names and units, and that no other common
encoding uses for such: a file of these beside ASCII is read as cp1252."""

ONE_BYTE = ("utf-8", "utf-8-sig", "cp1252", "latin-1")
"""Encodings in which the bytes of ASCII stand for nothing else."""

BLANKS = re.compile(rb" +(?=[\r\n]|\Z)|(?:(?<=\n)|\A) +")


@dataclass(frozen=True)
class TextFile:
    """A text file whose bytes were checked once.

    Parameters
    ----------
    path : Path
        The file.
    encoding : str
        How its bytes are text.
    lines : int
        How many lines it has, blank ones included.
    is_told : bool
        Whether the encoding was given, or is told by the first bytes, or is UTF-8.
    end : int, optional
        Bytes that count; what follows is none of the table.
    squeezes : bool
        Whether runs of blanks become one, and none stay at the ends of lines.
    padded : tuple of bytes and int, optional
        The mark between cells, and how many of them a shorter row is filled up to.

    """

    path: Path
    encoding: str
    lines: int
    is_told: bool = True
    end: int | None = None
    squeezes: bool = False
    padded: tuple[bytes, int] | None = None

    @contextmanager
    def binary(self) -> Iterator[BinaryIO]:
        """Open the bytes that count."""
        with open_regular(self.path) as file:
            if self.end is None and self.padded is None and not self.squeezes:
                yield file
            else:
                chunks = _chunks(file, self.end)
                if self.squeezes:
                    chunks = map(_squeezed, _whole_lines(chunks))
                if self.padded is not None:
                    mark, count = self.padded
                    chunks = (_filled(lines, mark, count) for lines in _whole_lines(chunks))
                raw = _Stream(chunks)
                with io.BufferedReader(raw, BLOCK) as stream:
                    yield stream

    @contextmanager
    def text(self) -> Iterator[io.TextIOWrapper]:
        """Open the text, with its line breaks as they are."""
        with self.binary() as file, io.TextIOWrapper(file, self.encoding, newline="") as text:
            yield text


class _Stream(io.RawIOBase):
    """Chunks of bytes as a file."""

    def __init__(self, chunks: Iterator[bytes]) -> None:
        self.chunks = chunks
        self.rest = memoryview(b"")

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any, /) -> int:  # noqa: ANN401 - any buffer can be written to
        if not self.rest:
            self.rest = memoryview(next(self.chunks, b""))
        count = min(len(buffer), len(self.rest))
        buffer[:count] = self.rest[:count]
        self.rest = self.rest[count:]
        return count


def _chunks(file: BinaryIO, end: int | None) -> Iterator[bytes]:
    left = end
    while block := file.read(BLOCK if left is None else min(BLOCK, left)):
        left = None if left is None else left - len(block)
        yield block


def _whole_lines(chunks: Iterator[bytes]) -> Iterator[bytes]:
    """Give chunks that end where a line does."""
    rest = b""
    for chunk in chunks:
        whole, mark, rest = (rest + chunk).rpartition(b"\n")
        if mark:
            yield whole + mark
        if len(rest) > LONGEST_LINE:
            yield rest
            rest = b""
    if rest:
        yield rest


def _squeezed(lines: bytes) -> bytes:
    r"""Make one blank of each run, and none of those at the ends of lines.

    >>> _squeezed(b"  1.5   2 \n  3  4")
    b'1.5 2\n3 4'
    """
    return re.sub(rb"  +", b" ", BLANKS.sub(b"", lines))


def _filled(lines: bytes, mark: bytes, count: int) -> bytes:
    r"""Add marks to rows that have fewer.

    >>> _filled(b"1;2;3\n4\n\n", b";", 2)
    b'1;2;3\n4;;\n\n'
    """
    full = []
    for line in lines.splitlines(keepends=True):
        text = line.rstrip(b"\r\n")
        missing = count - text.count(mark)
        full.append(text + missing * mark + line[len(text) :] if text and missing > 0 else line)
    return b"".join(full)


def survey(path: Path, given: str | None) -> TextFile:
    """Check the encoding of a file, and count its lines.

    Raises
    ------
    LogError
        It is not of the encoding given; or of UTF-8, and not certainly of another.

    """
    encoding = given or _told_by_mark(path)
    decoder = codecs.getincrementaldecoder(encoding)()
    done = lines = 0
    wrong: int | None = None
    others: set[int] = set()
    last = b""
    with open_regular(path) as file:
        while block := file.read(BLOCK):
            text = block
            if wrong is None and not (block.isascii() and encoding in ONE_BYTE):
                pending = len(decoder.getstate()[0])
                try:
                    decoded = decoder.decode(block)
                except UnicodeDecodeError as error:
                    wrong = done - pending + error.start + 1
                else:
                    text = block if encoding in ONE_BYTE else decoded.encode()
            if encoding in ONE_BYTE and not block.isascii():
                others.update(block.translate(None, ASCII))
            lines += _breaks(text, last)
            last = text[-1:]
            done += len(block)
    if wrong is None and decoder.getstate()[0]:
        wrong = done
    lines += last not in (b"\n", b"\r", b"")
    if wrong is None:
        return TextFile(path, encoding, lines)
    if given is None and encoding == "utf-8" and others <= CERTAIN:
        return TextFile(path, "cp1252", lines, is_told=False)
    raise LogError(
        f"{path.name}: byte {wrong} is not {encoding.removesuffix('-sig').upper()} text; a text "
        "log is read as UTF-8 unless a mapping says otherwise: save it so, write "
        'csv = { encoding = "cp1252" } for one from Windows, or name another format'
    )


def _breaks(text: bytes, before: bytes) -> int:
    """Count the line breaks of a block; ``before`` is the byte before it."""
    count = text.count(b"\n")
    if b"\r" in text:
        count += text.count(b"\r") - text.count(b"\r\n")
    return count - (before == b"\r" and text.startswith(b"\n"))


def _told_by_mark(path: Path) -> str:
    """Return the encoding that the first bytes of a file tell for certain, else UTF-8."""
    with open_regular(path) as file:
        head = file.read(4)
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    return "utf-8-sig" if head.startswith(codecs.BOM_UTF8) else "utf-8"
