"""Read a log from a table in a text file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as arrow

from breakaway.base.one_line import counted
from breakaway.base.text import brief
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.csv_rows import NumberColumn, Rows, blocks, is_plain, top_as_told
from breakaway.measure.logs.footer import find_footer
from breakaway.measure.logs.layout import Seen, look
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.mapping import CsvMapping
from breakaway.measure.logs.raw import (
    EXACT,
    RawChannel,
    RawFile,
    check_names,
    ends,
    frozen,
    whole,
)
from breakaway.measure.logs.stamps import LOST, is_stamp, nanoseconds
from breakaway.measure.logs.text_file import ONE_BYTE, TextFile, survey

CELLS_AT_ONCE, ROWS_AT_ONCE = 100_000, 20
"""About how many cells are texts at a time, but no fewer rows than these; the rest are numbers."""

BYTES_PER_CELL = 9
"""A number, and the room that its column keeps to grow."""

BYTES_PER_TEXT = 100
"""A cell as a text with its place in a list."""

MOST_SEEN_LINES, MOST_SEEN_CHARACTERS = 200, 2**18
"""How much of a file is looked at to see its layout."""

PLAIN = {
    ".": r"\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\s*",
    ",": r"\s*[+-]?(?:[0-9]+,?[0-9]*|,[0-9]+)(?:[eE][+-]?[0-9]+)?\s*",
}
"""Decimal mark -> a number."""

BYTES_PER_CHANGE = 60
"""A cell as a text of Arrow, with its copies while it is changed."""

Found = tuple[Array | str, npt.NDArray[np.intp] | None, int]
"""Numbers of a column or why there are none, the rows that they stand in where not all do, rows."""


@contextmanager
def open_csv(path: Path, budget: Budget, layout: CsvMapping) -> Iterator[RawFile]:
    """Open a text file with a table of numbers.

    How it is laid out the mapping says, and where it says nothing, the first lines where they can
    be read in one way. Arrow reads the cells. Where it finds one that is no finite number, they are
    read once more, row by row, to say which: rows count from 1, after the header.

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
    file = survey(path, layout.encoding)
    seen = look(path, _first_lines(file, layout.skip_rows), layout)
    layout = seen.layout
    file = _without_footer(raw, replace(file, squeezes=layout.delimiter == " "), seen)
    top = seen.top or top_as_told(file, layout)
    if top.is_ragged and file.encoding in ONE_BYTE:
        file = replace(file, padded=(layout.delimiter.encode(), len(top.names) - 1))
    check_names(path, len(top.names), max(map(len, top.names), default=0))
    names = _told_apart(top.names)
    is_open = seen.top is not None and names[-1] == ""
    _tell_layout(raw, seen, file)
    with file.text() as text:
        rows = Rows(path, text, layout)
        rows.skip(top.lines)
        # A title in place of a header shows here: the first row has more cells.
        first = next(blocks(path, rows, len(top.names), 1), [[""] * len(top.names)])[0]
    table = _Table(file, layout, len(top.names), top.lines, is_open)
    reading = _Reading(raw, table, budget)
    shown = names[:-1] if is_open else names
    for place, (name, unit, cell) in enumerate(zip(shown, top.units, first, strict=False)):
        reading.places[name] = place
        if is_stamp(cell):
            reading.stamped.add(name)
        unit_there = "s" if name in reading.stamped else unit
        raw.list(ListedChannel(name, unit_there, "text"))
    raw.read = reading.read
    yield raw


def _first_lines(file: TextFile, skipped: int) -> list[str]:
    """Return the lines that tell the layout, as far as they are not too long."""
    lines, room = [], MOST_SEEN_CHARACTERS
    with file.text() as text:
        for number in range(skipped + MOST_SEEN_LINES):
            line = text.readline(room + 1)
            room -= len(line)
            if not line or room < 0:
                break
            if number >= skipped:
                lines.append(line)
    return lines


def _without_footer(raw: RawFile, file: TextFile, seen: Seen) -> TextFile:
    """Leave out what stands below the table, and say so."""
    footer = None if seen.reading is None else find_footer(file, seen.reading)
    if footer is None:
        return file
    count = len(footer.rows)
    words = f"{counted(count, 'row')} below the table left out, such as '{brief(footer.rows[0])}'"
    raw.notice("footer", "", count, words)
    return replace(file, end=footer.begin, lines=file.lines - footer.lines)


def _tell_layout(raw: RawFile, seen: Seen, file: TextFile) -> None:
    """Say how the file is read beyond what its mapping says."""
    raw.history = tuple(seen.notes)
    if not file.is_told:
        raw.history += (f"the text is read as {file.encoding}",)
    if seen.top is not None and not seen.top.has_header:
        words = "there is no header: the columns are named column_1, column_2, ..."
        raw.notice("no_header", "", 1, words)


@dataclass
class _Reading:
    """Reads the columns of an open file that are wanted."""

    raw: RawFile
    table: _Table
    budget: Budget
    places: dict[str, int] = field(default_factory=dict)
    stamped: set[str] = field(default_factory=set)
    """Columns whose first cell is a time stamp in words."""
    zero_ns: int | None = None

    def read(self, wanted: list[str]) -> None:
        """Read stamps, then numbers."""
        kept = len(wanted) * self.table.file.lines
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
            if one is None and self.raw.keeps_bad and self._read_damaged([name]):
                continue
            if one is None:
                self.raw.give_up(name, "holds cells that are no time stamp such as the first one")
            else:
                self.raw.add(name, 1e-9 * (one - (self.zero_ns or 0)), None)

    def _read_numbers(self, wanted: list[str]) -> None:
        if not wanted:
            return
        columns = [self.places[name] for name in wanted]
        plain = self.table.by_arrow(columns)
        if plain is None and self.raw.keeps_bad and self._read_damaged(wanted):
            return
        if plain:
            self._tell_blank(max(rows for *_, rows in plain))
        else:
            plain = [(one, None, 0) for one in self.table.by_row(columns, self.budget)]
        for name, (one, rows, count) in zip(wanted, plain, strict=True):
            if isinstance(one, str):
                self.raw.give_up(name, one)
                continue
            if rows is not None:
                self._tell_slower(name, rows, count)
            is_large = one.size > 0 and float(np.nanmax(np.abs(one))) > EXACT
            exact = self.table.integers(self.places[name]) if is_large and rows is None else None
            values = frozen(one) if exact is None else exact
            self.raw.channels[name] = RawChannel(values, rows=rows)

    def _read_damaged(self, wanted: list[str]) -> bool:
        """Read columns of which rows will be dropped: NaN where a cell is no number or stamp."""
        self.budget.take("its cells", 0, len(wanted) * BYTES_PER_CHANGE * self.table.file.lines)
        found = self.table.damaged([self.places[name] for name in wanted])
        if found is None:
            return False
        self.raw.dropped = self.table.ragged
        for name, one in zip(wanted, found, strict=True):
            if name in self.stamped:
                stamps = nanoseconds(one, lost=True)
                good = stamps != LOST
                if self.zero_ns is None and good.any():
                    self.zero_ns = int(stamps[good][0])
                values = np.where(good, 1e-9 * (stamps - (self.zero_ns or 0)), np.nan)
            else:
                values = as_numbers(one, self.table.layout.decimal)
            rows = np.flatnonzero(np.isfinite(values))
            slower = _is_slower(rows)
            if slower:
                self._tell_slower(name, rows, len(values))
            kept = frozen(values[rows] if slower else values)
            self.raw.channels[name] = RawChannel(kept, rows=rows if slower else None)
        return True

    def _tell_blank(self, rows: int) -> None:
        blank = self.table.file.lines - self.table.first_line - rows
        if blank > 0 and not any(one.kind == "blank" for one in self.raw.findings):
            self.raw.notice("blank", "", blank, f"{counted(blank, 'blank line')} left out")

    def _tell_slower(self, name: str, rows: npt.NDArray[np.intp], count: int) -> None:
        if ends(rows):
            words = f"the last {counted(count - len(rows), 'cell')} hold nothing: it ends before"
            self.raw.notice("ends", name, count - len(rows), words)
        else:
            words = f"one cell in {rows[1] - rows[0]} holds a value: read as a slower channel"
            self.raw.notice("slower", name, len(rows), words)


def _told_apart(header: list[str]) -> list[str]:
    """Number the names of columns that repeat: ``force#1``, ``force#2``."""
    count, seen = Counter(header), Counter[str]()
    names = []
    for name in header:
        seen[name] += 1
        names.append(f"{name}#{seen[name]}" if count[name] > 1 else name)
    return names


@dataclass
class _Table:
    """The rows below the header of a file, read by Arrow, or one by one."""

    file: TextFile
    layout: CsvMapping
    width: int
    """Cells of a row."""
    first_line: int
    """How many lines are above the rows."""
    is_open: bool
    """Whether each row ends with a mark, behind which there is nothing."""
    ragged: int = 0
    """Rows of more or fewer cells that were left out."""

    def by_arrow(self, columns: list[int]) -> list[Found] | None:
        """Return the numbers of columns, in which rows they stand, and how many rows there are.

        None where a cell or a row is not as it must be. Blank cells are, in a column of a slower
        channel, one that has a value in every so many-th row, and below the end of a shorter one.
        """
        table = self._read(columns, pa.float64())
        if table is None:
            return None
        found: list[Found] = []
        for _ in columns:
            column = table.column(0)
            table = table.remove_column(0)
            rows = np.flatnonzero(column.is_valid().to_numpy()) if column.null_count else None
            if rows is not None and not (_is_slower(rows) or ends(rows)):
                return None
            values = _numbers(column.drop_null() if rows is not None else column)
            if not np.isfinite(values).all():
                return None
            found.append((values, rows, len(column)))
        return found

    def stamps(self, column: int) -> npt.NDArray[np.int64] | None:
        """Return a column of time stamps in words, in ns; None where one is none."""
        table = self._read([column], pa.string())
        found = None if table is None else nanoseconds(table.column(0))
        return None if found is None or (found == LOST).any() else found

    def integers(self, column: int) -> npt.NDArray[np.int64] | None:
        """Return a column of whole numbers as they are; None where it has others."""
        table = self._read([column], pa.int64())
        return None if table is None else whole(table.column(0).drop_null().to_numpy())

    def damaged(self, columns: list[int]) -> list[Any] | None:
        """Return the cells of columns as texts; rows of more or fewer cells are left out."""
        self.ragged = 0

        def leave_out(_: Any) -> str:  # noqa: ANN401 - pyarrow has no types
            self.ragged += 1
            return "skip"

        table = self._read(columns, pa.string(), leave_out)
        return None if table is None else table.columns

    def _read(self, columns: list[int], kind: Any, leave_out: Any = None) -> Any:  # noqa: ANN401
        names = [str(place) for place in range(self.width)]
        chosen = [names[place] for place in dict.fromkeys(columns)]
        kinds = dict.fromkeys(chosen, kind) | ({names[-1]: pa.null()} if self.is_open else {})
        options = {
            "read_options": arrow.ReadOptions(
                column_names=names, skip_rows=self.first_line, encoding=self.file.encoding
            ),
            "parse_options": arrow.ParseOptions(
                delimiter=self.layout.delimiter, invalid_row_handler=leave_out
            ),
            "convert_options": arrow.ConvertOptions(
                include_columns=list(kinds),
                column_types=kinds,
                null_values=["", " "],
                strings_can_be_null=False,
                decimal_point=self.layout.decimal,
            ),
        }
        try:
            with self.file.binary() as stream:
                return arrow.read_csv(stream, **options).select(chosen)
        except pa.ArrowInvalid:
            return None

    def by_row(self, columns: list[int], budget: Budget) -> list[Array | str]:
        """Return the numbers of columns, or why one cannot be read."""
        lines = self.file.lines
        at_once = max(ROWS_AT_ONCE, CELLS_AT_ONCE // max(self.width, 1))
        passing = BYTES_PER_TEXT * self.width * min(at_once, lines)
        budget.take("its cells", BYTES_PER_CELL * len(columns) * lines, passing)
        found = [NumberColumn(self.layout.decimal) for _ in columns]
        path = self.file.path
        with self.file.text() as text:
            rows = Rows(path, text, self.layout)
            rows.skip(self.first_line)
            for block in blocks(path, rows, self.width, at_once, self.is_open):
                plain = all(map(is_plain, map("".join, block)))
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


def as_numbers(column: Any, decimal: str) -> Array:  # noqa: ANN401 - pyarrow has no types
    """Return texts as numbers, and NaN for what is none.

    Examples
    --------
    >>> as_numbers(pa.chunked_array([["1.5", " -2e3 ", "1_0", "OVL", ""]]), ".").tolist()
    [1.5, -2000.0, nan, nan, nan]

    """
    is_number = pc.match_substring_regex(column, rf"^(?:{PLAIN[decimal]})$")
    text = pc.replace_substring_regex(column, r"^\s*\+?(.*?)\s*$", r"\1")
    text = pc.replace_substring(text, ",", ".") if decimal == "," else text
    numbers = pc.if_else(is_number, text, None).cast(pa.float64())
    values: Array = numbers.to_numpy().astype(np.float64)
    values[~np.isfinite(values)] = np.nan
    return values
