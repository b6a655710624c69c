"""The rows of a text file one by one, to say which of them is damaged, and how."""

from __future__ import annotations

import csv
import io
import math
from array import array
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.layout import Top
from breakaway.measure.logs.mapping import CsvMapping
from breakaway.measure.logs.raw import check_names
from breakaway.measure.logs.text_file import TextFile

LONGEST_ROW = 4 * 2**20
"""Most characters of a row."""

LONGEST_NUMBER = 400
"""Most characters of a number."""

EXCHANGED = str.maketrans(",.", ".,")
"""Where the decimal mark is a comma: 1.500 may be 1500 to whom wrote it, and 1.5 to another."""


class Rows:
    """The rows of a table, each of limited length; blank lines are left out."""

    def __init__(self, path: Path, text: io.TextIOWrapper, layout: CsvMapping) -> None:
        self.path, self.text = path, text
        self.length = self.lines_taken = 0
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
            self.lines_taken += 1
            if self.length > LONGEST_ROW:
                raise LogError(
                    f"{self.path.name}: a row has more than {LONGEST_ROW:,} characters, the limit: "
                    "separate the rows with line breaks"
                )
            yield line

    def __iter__(self) -> Iterator[list[str]]:
        return self.found

    def _found(self) -> Iterator[list[str]]:
        try:
            for row in self.cells:
                self.length = 0
                if row:
                    yield row
        except csv.Error as error:
            raise LogError(
                f"{self.path.name}: is not comma-separated text ({error}); export it as CSV with "
                "one header line"
            ) from None


def top_as_told(file: TextFile, layout: CsvMapping) -> Top:
    """Return what stands above the rows, as the mapping says, or one line of names."""
    with file.text() as text:
        rows = Rows(file.path, text, layout)
        names, units = _header(file.path, rows, layout)
        return Top(rows.lines_taken, names, units)


def _header(path: Path, rows: Rows, layout: CsvMapping) -> tuple[list[str], list[str]]:
    """Return the names and the units (empty texts without a units row)."""
    rows.skip(layout.skip_rows)
    if not layout.header:
        return _without_header(path, rows, layout)
    top = list(islice(rows, 1 + layout.units_row))
    if not top and not layout.skip_rows:
        raise LogError(f"{path.name}: the file holds only empty lines; export the log again")
    if len(top) < 1 + layout.units_row:
        raise LogError(
            f"{path.name}: there is no header below {layout.skip_rows} skipped lines; correct "
            "csv.skip_rows and csv.units_row in the mapping"
        )
    header = [cell.strip() for cell in top[0]]
    check_names(path, len(header), max(map(len, header), default=0))
    mark = next((mark for mark in ";\t," if mark in header[0]), None)
    if len(header) == 1 and mark:
        shown, decimal = mark.replace("\t", r"\t"), "." if mark == "," else ","
        raise LogError(
            f"{path.name}: the header '{brief(header[0])}' is one cell; columns must be separated "
            "by commas and decimals by points: export it so, or write a mapping with "
            f'csv = {{ delimiter = "{shown}", decimal = "{decimal}" }}'
        )
    if all(map(_is_number, header)):
        raise LogError(
            f"{path.name}: the header holds numbers alone, as where there is none; write a mapping "
            "with csv = { header = false }, in which columns are named column_1, column_2, ..."
        )
    units = [cell.strip().strip("[]()") for cell in top[1]] if layout.units_row else []
    units += [""] * (len(header) - len(units))
    return header, units[: len(header)]


def _without_header(path: Path, rows: Rows, layout: CsvMapping) -> tuple[list[str], list[str]]:
    """Return names by number; the rows begin after the lines that are skipped."""
    first = next(iter(rows), None)
    if first is None:
        raise LogError(f"{path.name}: the file holds only empty lines; export the log again")
    rows.lines_taken = layout.skip_rows
    return [f"column_{place}" for place in range(1, len(first) + 1)], [""] * len(first)


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def blocks(
    path: Path, rows: Rows, count: int, at_once: int, is_open: bool = False
) -> Iterator[list[list[str]]]:
    """Give the rows in blocks, each row with as many cells as the header."""
    found, done = iter(rows), 0
    while block := list(islice(found, at_once)):
        for row, cells in enumerate(block, start=done + 1):
            if len(cells) != count:
                raise LogError(
                    f"{path.name}: row {row}: {len(cells)} cells where the header has {count}; "
                    "every row must have as many as the header: repair the row, or drop such rows "
                    "with --drop-bad-rows (drop_bad_rows=True); csv.skip_rows in a mapping leaves "
                    "out lines above the header"
                )
            if is_open and cells[-1]:
                raise LogError(
                    f"{path.name}: row {row}: the last cell holds {brief(cells[-1])!r}, and no "
                    "column of the header stands above it: repair the row, or export again"
                )
        done += len(block)
        yield block


class NumberColumn:
    """The numbers of a column so far, or the reason why it cannot be read."""

    def __init__(self, decimal: str) -> None:
        self.decimal = decimal
        self.numbers = array("d")
        self.reason = ""

    def extend(self, cells: tuple[str, ...], plain: bool) -> None:
        """Add cells, unless one before was no number; ``plain``: all of them are `is_plain`."""
        if self.reason:
            return
        begin = len(self.numbers)
        if (plain or is_plain("".join(cells))) and max(map(len, cells)) <= LONGEST_NUMBER:
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

    def give(self) -> Array:
        """Return the numbers, and hold them no longer."""
        given, self.numbers = self.numbers, array("d")
        return np.array(np.frombuffer(given))

    def _pointed(self, cell: str) -> str:
        """Give a cell with a point for its decimal mark; the other mark makes it no number."""
        return cell if self.decimal == "." else cell.translate(EXCHANGED)

    def _why(self, cell: str) -> str:
        """Say why a cell is no finite number, or nothing."""
        plain = is_plain(cell) and len(cell) <= LONGEST_NUMBER
        try:
            value = float(self._pointed(cell) if plain else "")
        except ValueError:
            value, reason = math.nan, "not a number"
        else:
            reason = "not finite"
        if math.isfinite(value):
            return ""
        other = "," if self.decimal == "." else "."
        thousands = f" (or {other!r} stands between thousands)" if other in cell else ""
        return (
            f"{cell[:40]!r} is {reason}{thousands}; it must be a finite number such as "
            f"-1{self.decimal}5e-3: drop such rows with --drop-bad-rows (drop_bad_rows=True), or "
            "export the log again"
        )


def is_plain(text: str) -> bool:
    """Whether float() may see it: it reads 1_0 as 10 and digits of any script; both are damage."""
    return text.isascii() and "_" not in text
