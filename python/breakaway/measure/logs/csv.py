"""Read a log from comma-separated values."""

from __future__ import annotations

import codecs
import csv
import io
import math
from array import array
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from breakaway.base.reading import open_regular
from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mapping import CsvMapping
from breakaway.measure.logs.raw import RawChannel, RawFile, check_names, frozen

LONGEST_ROW = 4 * 2**20
"""Most characters of a row."""

LONGEST_NUMBER = 400
"""Most characters of a number."""

EXCHANGED = str.maketrans(",.", ".,")
"""Where the decimal mark is a comma: 1.500 may be 1500 to whom wrote it, and 1.5 to another."""

CELLS_AT_ONCE, ROWS_AT_ONCE = 100_000, 20
"""About how many cells are texts at a time, but no fewer rows than these; the rest are numbers."""

BYTES_PER_CELL = 9
"""A number, and the room that its column keeps to grow."""

BYTES_PER_TEXT = 100
"""A cell as a text with its place in a list."""


def read_csv(path: Path, budget: Budget, layout: CsvMapping) -> RawFile:
    """Read a UTF-8 file of separated values with one header line.

    Empty lines are accepted at the end only. A column that holds anything but finite numbers
    is noted as unreadable; rows count from 1, after the header.

    Parameters
    ----------
    path : Path
        The file.
    budget : Budget
        What it may take.
    layout : CsvMapping
        Delimiter, decimal mark, lines above the header, units row.

    Raises
    ------
    LogError
        The file is not UTF-8, holds no header, a row has more or fewer cells than it, or a row,
        a name or the number of columns goes beyond its limit.

    """
    most_rows = _survey(path)
    with open_regular(path) as file:
        rows = _Rows(path, io.TextIOWrapper(file, encoding="utf-8-sig", newline=""), layout)
        header, units = _header(path, rows, layout)
        count = len(header)
        at_once = max(ROWS_AT_ONCE, CELLS_AT_ONCE // max(count, 1))
        passing = BYTES_PER_TEXT * count * min(at_once, most_rows)
        budget.take("its rows", BYTES_PER_CELL * count * most_rows, passing)
        columns = [_Column(layout.decimal) for _ in header]
        for block in _blocks(path, rows, count, at_once):
            plain = all(map(_is_plain, map("".join, block)))
            for column, cells in zip(columns, zip(*block, strict=True), strict=True):
                column.extend(cells, plain)
    return _gathered(path, header, units, columns)


def _gathered(path: Path, header: list[str], units: list[str], columns: list[_Column]) -> RawFile:
    """Return the columns by their names; each gives its numbers away as it is copied."""
    raw = RawFile(path)
    for name, unit, column in zip(header, units, columns, strict=True):
        if column.reason or name in raw:
            raw.refuse(name, column.reason)
        else:
            raw.channels[name] = RawChannel(column.give(), unit=unit)
    return raw


def _survey(path: Path) -> int:
    """Return how many rows there are at most; refuse what is not UTF-8."""
    decoder, block, marks, done = codecs.getincrementaldecoder("utf-8")(), b"", 1, 0
    with open_regular(path) as file:
        while not done or block:
            block = file.read(2**20)
            pending = len(decoder.getstate()[0])
            try:
                decoder.decode(block, final=not block)
            except UnicodeDecodeError as error:
                raise LogError(
                    f"{path.name}: byte {done - pending + error.start + 1} is not UTF-8 text; a "
                    "CSV log is a UTF-8 text file: save it as UTF-8, or name another format"
                ) from None
            marks += block.count(b"\n") + block.count(b"\r") - block.count(b"\r\n")
            done += len(block)
    return marks


class _Rows:
    """The rows of a table, each of limited length; empty ones at the end are left out."""

    def __init__(self, path: Path, text: io.TextIOWrapper, layout: CsvMapping) -> None:
        self.path, self.text = path, text
        self.length = 0
        self.lines = self._lines()
        self.cells = csv.reader(self.lines, delimiter=layout.delimiter, strict=True)
        self.found = self._found()

    def skip(self, count: int) -> None:
        """Leave out lines, whatever stands in them."""
        for _ in range(count):
            self.length = 0
            if next(self.lines, None) is None:
                break
        self.length = 0

    def _lines(self) -> Iterator[str]:
        while line := self.text.readline(LONGEST_ROW + 1):
            self.length += len(line)
            if self.length > LONGEST_ROW:
                raise LogError(
                    f"{self.path.name}: a row has more than {LONGEST_ROW:,} characters, the limit: "
                    "separate the rows with line breaks"
                )
            yield line

    def __iter__(self) -> Iterator[list[str]]:
        return self.found

    def _found(self) -> Iterator[list[str]]:
        empty = 0
        try:
            for row in self.cells:
                self.length = 0
                if not row:
                    empty += 1
                    continue
                for _ in range(empty):
                    yield []
                empty = 0
                yield row
        except csv.Error as error:
            raise LogError(
                f"{self.path.name}: is not comma-separated text ({error}); export it as CSV with "
                "one header line"
            ) from None


def _header(path: Path, rows: _Rows, layout: CsvMapping) -> tuple[list[str], list[str]]:
    """Return the names and the units (empty texts without a units row)."""
    rows.skip(layout.skip_rows)
    top = list(islice(rows, 1 + layout.units_row))
    if not top and not layout.skip_rows:
        raise LogError(f"{path.name}: the file holds only empty lines; export the log again")
    if len(top) < 1 + layout.units_row:
        raise LogError(
            f"{path.name}: there is no header below {layout.skip_rows} skipped lines; correct "
            "csv.skip_rows and csv.units_row in the mapping"
        )
    header = [cell.strip() for cell in top[0]]
    if not header:
        raise LogError(
            f"{path.name}: the header is an empty line; set csv.skip_rows in a mapping to the "
            "number of lines above it"
        )
    check_names(path, len(header), max(map(len, header), default=0))
    mark = next((mark for mark in ";\t," if mark in header[0]), None)
    if len(header) == 1 and mark:
        shown, decimal = mark.replace("\t", r"\t"), "." if mark == "," else ","
        raise LogError(
            f"{path.name}: the header '{brief(header[0])}' is one cell; columns must be separated "
            "by commas and decimals by points: export it so, or write a mapping with "
            f'csv = {{ delimiter = "{shown}", decimal = "{decimal}" }}'
        )
    units = [cell.strip().strip("[]()") for cell in top[1]] if layout.units_row else []
    units += [""] * (len(header) - len(units))
    return header, units[: len(header)]


def _blocks(path: Path, rows: _Rows, count: int, at_once: int) -> Iterator[list[list[str]]]:
    """Give the rows in blocks, each row with as many cells as the header."""
    found, done = iter(rows), 0
    while block := list(islice(found, at_once)):
        for row, cells in enumerate(block, start=done + 1):
            if len(cells) != count:
                raise LogError(
                    f"{path.name}: row {row}: {len(cells)} cells where the header has {count}; "
                    "every row must have as many as the header: repair the row, or export again; "
                    "csv.skip_rows in a mapping leaves out lines above the header"
                )
        done += len(block)
        yield block


class _Column:
    """The numbers of a column so far, or the reason why it cannot be read."""

    def __init__(self, decimal: str) -> None:
        self.decimal = decimal
        self.numbers = array("d")
        self.reason = ""

    def extend(self, cells: tuple[str, ...], plain: bool) -> None:
        """Add cells, unless one before was no number; ``plain``: all of them are `_is_plain`."""
        if self.reason:
            return
        begin = len(self.numbers)
        if (plain or _is_plain("".join(cells))) and max(map(len, cells)) <= LONGEST_NUMBER:
            try:
                self.numbers.extend(map(float, map(self._pointed, cells)))
            except ValueError:
                del self.numbers[begin:]
            else:
                if np.isfinite(np.frombuffer(self.numbers, offset=8 * begin)).all():
                    return
        place, why = next((k, why) for k, cell in enumerate(cells) if (why := self._why(cell)))
        self.reason = f"row {begin + place + 1}: {why}"
        self.numbers = array("d")

    def give(self) -> np.ndarray:
        """Return the numbers, and hold them no longer."""
        given, self.numbers = self.numbers, array("d")
        return frozen(np.frombuffer(given))

    def _pointed(self, cell: str) -> str:
        """Give a cell with a point for its decimal mark; the other mark makes it no number."""
        return cell if self.decimal == "." else cell.translate(EXCHANGED)

    def _why(self, cell: str) -> str:
        """Say why a cell is no finite number, or nothing."""
        plain = _is_plain(cell) and len(cell) <= LONGEST_NUMBER
        try:
            value = float(self._pointed(cell) if plain else "")
        except ValueError:
            value, reason = math.nan, "not a number"
        else:
            reason = "not finite"
        if math.isfinite(value):
            return ""
        return (
            f"{cell[:40]!r} is {reason}; it must be a finite number such as -1{self.decimal}5e-3: "
            "cut the row out, or export the log again"
        )


def _is_plain(text: str) -> bool:
    """Whether float() may see it: it reads 1_0 as 10 and digits of any script; both are damage."""
    return text.isascii() and "_" not in text
