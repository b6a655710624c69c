"""Read a log from comma-separated values."""

from __future__ import annotations

import codecs
import csv
import io
import math
from array import array
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.csv as arrow

from breakaway.base.one_line import counted
from breakaway.base.reading import open_regular
from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.mapping import CsvMapping
from breakaway.measure.logs.raw import (
    EXACT,
    RawChannel,
    RawFile,
    check_names,
    frozen,
    whole,
)
from breakaway.measure.logs.stamps import is_stamp, nanoseconds

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

Found = tuple[Array | str, npt.NDArray[np.intp] | None, int]
"""Numbers of a column or why there are none, the rows that they stand in where not all do, rows."""


@contextmanager
def open_csv(path: Path, budget: Budget, layout: CsvMapping) -> Iterator[RawFile]:
    """Open a text file of separated values with at most one header line.

    Arrow reads the cells. Where it finds one that is no finite number, they are read once more, row
    by row, to say which: rows count from 1, after the header. Blank lines are left out, and told.

    Parameters
    ----------
    path : Path
        The file.
    budget : Budget
        What it may take.
    layout : CsvMapping
        Encoding, delimiter, decimal mark, lines above the header, header, units row.

    Raises
    ------
    LogError
        The file is not of its encoding, holds no header, a row has more or fewer cells than it, or
        a row, a name or the number of columns goes beyond its limit.

    """
    raw = RawFile(path)
    encoding = layout.encoding or told_encoding(path)
    most_rows = _survey(path, encoding)
    with _text(path, encoding) as text:
        rows = _Rows(path, text, layout)
        header, units = _header(path, rows, layout)
        first_line = rows.lines_taken
        # A title in place of a header shows here: the first row has more cells.
        first = next(_blocks(path, rows, len(header), 1), [[""] * len(header)])[0]
    table = _Table(path, encoding, layout, header, first_line)
    reading = _Reading(raw, table, budget, most_rows)
    named_columns = zip(_told_apart(header), units, first, strict=True)
    for place, (name, unit, cell) in enumerate(named_columns):
        reading.places[name] = place
        if is_stamp(cell):
            reading.stamped.add(name)
        unit_there = "s" if name in reading.stamped else unit
        raw.list(ListedChannel(name, unit_there, "text"))
    raw.read = reading.read
    yield raw


@dataclass
class _Reading:
    """Reads the columns of an open file that are wanted."""

    raw: RawFile
    table: _Table
    budget: Budget
    most_rows: int
    places: dict[str, int] = field(default_factory=dict)
    stamped: set[str] = field(default_factory=set)
    """Columns whose first cell is a time stamp in words."""
    zero_ns: int | None = None

    def read(self, wanted: list[str]) -> None:
        """Read stamps, then numbers."""
        kept = len(wanted) * self.most_rows
        self.budget.take("its rows", 8 * kept, 10 * kept)
        self._read_stamps([name for name in wanted if name in self.stamped])
        self._read_numbers([name for name in wanted if name not in self.stamped])

    def _read_stamps(self, wanted: list[str]) -> None:
        """Read time stamps in words; all count from the first of any."""
        found = {name: self.table.stamps(self.places[name]) for name in wanted}
        starts = [int(one[0]) for one in found.values() if one is not None and one.size]
        if self.zero_ns is None and starts:
            self.zero_ns = min(starts)
        for name, one in found.items():
            if one is None:
                self.raw.give_up(name, "holds cells that are no time stamp such as the first one")
            else:
                self.raw.add(name, 1e-9 * (one - (self.zero_ns or 0)), None)

    def _read_numbers(self, wanted: list[str]) -> None:
        if not wanted:
            return
        columns = [self.places[name] for name in wanted]
        plain = self.table.by_arrow(columns)
        if plain:
            blank = self.most_rows - 1 - self.table.first_line - max(rows for *_, rows in plain)
            if blank > 0:
                self.raw.notice("blank", "", blank, f"{counted(blank, 'blank line')} left out")
        else:
            by_row = self.table.by_row(columns, self.budget, self.most_rows)
            plain = [(one, None, 0) for one in by_row]
        for name, (one, rows, _) in zip(wanted, plain, strict=True):
            if isinstance(one, str):
                self.raw.give_up(name, one)
                continue
            if rows is not None:
                words = f"one cell in {rows[1] - rows[0]} holds a value: read as a slower channel"
                self.raw.notice("slower", name, len(rows), words)
            is_large = one.size > 0 and float(np.max(np.abs(one))) > EXACT
            exact = self.table.integers(self.places[name]) if is_large and rows is None else None
            values = frozen(one) if exact is None else exact
            self.raw.channels[name] = RawChannel(values, rows=rows)


def _told_apart(header: list[str]) -> list[str]:
    """Number the names of columns that repeat: ``force#1``, ``force#2``."""
    count, seen = Counter(header), Counter[str]()
    names = []
    for name in header:
        seen[name] += 1
        names.append(f"{name}#{seen[name]}" if count[name] > 1 else name)
    return names


@contextmanager
def _text(path: Path, encoding: str) -> Iterator[io.TextIOWrapper]:
    with open_regular(path) as file, io.TextIOWrapper(file, encoding, newline="") as text:
        yield text


@dataclass(frozen=True)
class _Table:
    """The rows below the header of a file, read by Arrow, or one by one."""

    path: Path
    encoding: str
    layout: CsvMapping
    header: list[str]
    first_line: int
    """How many lines are above the rows."""

    def by_arrow(self, columns: list[int]) -> list[Found] | None:
        """Return the numbers of columns, in which rows they stand, and how many rows there are.

        None where a cell or a row is not as it must be. Blank cells are, in a column of a slower
        channel: one that has a value in every so many-th row.
        """
        table = self._read(columns, pa.float64())
        if table is None:
            return None
        found: list[Found] = []
        for column in table.columns:
            rows = np.flatnonzero(column.is_valid().to_numpy()) if column.null_count else None
            if rows is not None and not _is_slower(rows):
                return None
            values = _numbers(column.drop_null() if rows is not None else column)
            if not np.isfinite(values).all():
                return None
            found.append((values, rows, len(column)))
        return found

    def stamps(self, column: int) -> npt.NDArray[np.int64] | None:
        """Return a column of time stamps in words, in ns; None where one is none."""
        table = self._read([column], pa.string())
        return None if table is None else nanoseconds(table.column(0))

    def integers(self, column: int) -> npt.NDArray[np.int64] | None:
        """Return a column of whole numbers as they are; None where it has others."""
        table = self._read([column], pa.int64())
        return None if table is None else whole(table.column(0).to_numpy())

    def _read(self, columns: list[int], kind: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
        names = [str(place) for place in range(len(self.header))]
        chosen = [names[place] for place in columns]
        options = {
            "read_options": arrow.ReadOptions(
                column_names=names, skip_rows=self.first_line, encoding=self.encoding
            ),
            "parse_options": arrow.ParseOptions(delimiter=self.layout.delimiter),
            "convert_options": arrow.ConvertOptions(
                include_columns=chosen,
                column_types=dict.fromkeys(chosen, kind),
                null_values=[""],
                decimal_point=self.layout.decimal,
            ),
        }
        try:
            with open_regular(self.path) as file:
                return arrow.read_csv(file, **options)
        except pa.ArrowInvalid:
            return None

    def by_row(self, columns: list[int], budget: Budget, most_rows: int) -> list[Array | str]:
        """Return the numbers of columns, or why one cannot be read."""
        count = len(self.header)
        at_once = max(ROWS_AT_ONCE, CELLS_AT_ONCE // max(count, 1))
        passing = BYTES_PER_TEXT * count * min(at_once, most_rows)
        budget.take("its cells", BYTES_PER_CELL * len(columns) * most_rows, passing)
        found = [_Column(self.layout.decimal) for _ in columns]
        with _text(self.path, self.encoding) as text:
            rows = _Rows(self.path, text, self.layout)
            rows.skip(self.first_line)
            for block in _blocks(self.path, rows, count, at_once):
                plain = all(map(_is_plain, map("".join, block)))
                by_column = list(zip(*block, strict=True))
                for column, place in zip(found, columns, strict=True):
                    column.extend(by_column[place], plain)
        return [column.reason or column.give() for column in found]


def _is_slower(rows: npt.NDArray[np.intp]) -> bool:
    """Whether values stand in every so many-th row."""
    steps = np.diff(rows)
    return steps.size > 0 and bool(np.all(steps == steps[0]) and steps[0] > 1)


def _numbers(column: Any) -> Array:  # noqa: ANN401 - pyarrow has no types
    """Return a column of Arrow as an array of its own."""
    values = np.empty(len(column), np.float64)
    done = 0
    for chunk in column.chunks:
        values[done : done + len(chunk)] = chunk.to_numpy()
        done += len(chunk)
    return values


def told_encoding(path: Path) -> str:
    """Return the encoding that the first bytes of a file tell for certain, else UTF-8."""
    with open_regular(path) as file:
        head = file.read(4)
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    return "utf-8-sig" if head.startswith(codecs.BOM_UTF8) else "utf-8"


def _survey(path: Path, encoding: str) -> int:
    """Return how many lines there are at most; refuse what is not of the encoding."""
    decoder, block, marks, done = codecs.getincrementaldecoder(encoding)(), b"", 1, 0
    plain = encoding in ("utf-8", "utf-8-sig", "cp1252", "latin-1")
    with open_regular(path) as file:
        while not done or block:
            block = file.read(2**20)
            pending = len(decoder.getstate()[0])
            try:
                text = decoder.decode(block, final=not block)
            except UnicodeDecodeError as error:
                raise LogError(
                    f"{path.name}: byte {done - pending + error.start + 1} is not "
                    f"{encoding.removesuffix('-sig').upper()} text; a CSV log is read as UTF-8 "
                    "unless a mapping says otherwise: save it so, write "
                    'csv = { encoding = "cp1252" } for one from Windows, or name another format'
                ) from None
            lines = block if plain else text.encode()
            marks += lines.count(b"\n") + lines.count(b"\r") - lines.count(b"\r\n")
            done += len(block)
    return marks


class _Rows:
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


def _header(path: Path, rows: _Rows, layout: CsvMapping) -> tuple[list[str], list[str]]:
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


def _without_header(path: Path, rows: _Rows, layout: CsvMapping) -> tuple[list[str], list[str]]:
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

    def give(self) -> Array:
        """Return the numbers, and hold them no longer."""
        given, self.numbers = self.numbers, array("d")
        return np.array(np.frombuffer(given))

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
        other = "," if self.decimal == "." else "."
        thousands = f" (or {other!r} stands between thousands)" if other in cell else ""
        return (
            f"{cell[:40]!r} is {reason}{thousands}; it must be a finite number such as "
            f"-1{self.decimal}5e-3: cut the row out, or export the log again"
        )


def _is_plain(text: str) -> bool:
    """Whether float() may see it: it reads 1_0 as 10 and digits of any script; both are damage."""
    return text.isascii() and "_" not in text
