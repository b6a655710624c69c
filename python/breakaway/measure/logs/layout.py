"""How a text file is laid out, as its first lines show it.

Taken is only what can be read in one way; else the mapping, or what it leaves open, counts. Lines
are split by each mark that may stand between cells. A reading holds where rows of numbers follow
each other; one in which every cell is a number beats one with other cells.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

from breakaway.base.one_line import counted
from breakaway.errors import LogError
from breakaway.measure.logs.mapping import CsvMapping
from breakaway.measure.logs.names import bracketed
from breakaway.measure.logs.stamps import is_stamp
from breakaway.measure.logs.units import is_unit

MARKS = {";": "semicolons", "\t": "tabs", ",": "commas", " ": "blanks"}
"""What may stand between cells, a run of blanks as one -> its name."""

FEWEST_ROWS = 3
"""As many rows of numbers in a row make a table."""

MOST_BAD = 0.25
"""A column of numbers may have this share of other cells, to be refused later by their rows."""

NUMBER = {
    mark: re.compile(rf"\s*[+-]?(?:{digits}(?:[eE][+-]?\d+)?|nan|inf)\s*", re.IGNORECASE | re.ASCII)
    for mark, digits in ((".", r"(?:\d+\.?\d*|\.\d+)"), (",", r"(?:\d+(?:,\d+)?|,\d+)"))
}
"""Decimal mark -> a number."""

THOUSANDS = re.compile(r"\s*[+-]?[1-9]\d{0,2}(?:[.,]\d{3})+\s*")
"""1.100 may be 1.1 or 1100."""

LONGEST_MS = 12
"""Digits of a time in ms since a start; one in 100 ns since 1601 has more."""


@dataclass(frozen=True)
class Top:
    """What stands above the rows: how many lines, and a name and a unit for each cell of a row."""

    lines: int
    names: list[str]
    units: list[str]
    skipped: int = 0
    """How many lines stand above the names."""
    has_header: bool = True
    is_ragged: bool = False
    """Whether rows get shorter where columns on the right have ended."""


@dataclass(frozen=True)
class Reading:
    """Lines split by one mark, and which of their cells are numbers."""

    mark: str
    decimal: str
    rows: list[tuple[int, list[str]]]
    """Number of the line and cells, blank lines left out."""
    width: int
    """Cells of a row of numbers."""
    columns: list[int]
    """Those that hold numbers or stamps."""
    blank: set[int]
    """Those that hold nothing."""
    is_whole: bool
    """Whether there are no others."""
    good: int
    """How many cells are numbers or stamps."""

    def is_row(self, cells: Sequence[str]) -> bool:
        """Whether cells are a row of numbers, of which some may be damaged."""
        first = self.columns[0]
        if len(cells) != self.width or not is_value(cells[first], self.decimal):
            return False
        if any(cells[column].strip() for column in self.blank if column < first):
            return False
        good = sum(is_value(cells[column], self.decimal) for column in self.columns)
        return 2 * good > len(self.columns)


@dataclass(frozen=True)
class Seen:
    """The layout of a file, and what is to be told of it."""

    layout: CsvMapping
    reading: Reading | None = None
    top: Top | None = None
    notes: list[str] = field(default_factory=list)


def look(path: Path, lines: list[str], given: CsvMapping) -> Seen:
    """Complete the layout that a mapping gives by what the first lines show for certain.

    Raises
    ------
    LogError
        The marks in the numbers may be decimal marks, or stand between thousands.

    """
    fixed = given.model_fields_set
    reading = _reading(lines, given)
    if reading is None:
        return Seen(given)
    if "decimal" not in fixed and reading.mark != ",":
        _check_thousands(path, reading)
    seen = {"delimiter": reading.mark, "decimal": reading.decimal}
    notes = []
    if reading.mark != given.delimiter or reading.decimal != given.decimal:
        notes.append(f"cells are separated by {MARKS.get(reading.mark, reading.mark)}")
        notes[0] += f", the decimal mark is '{reading.decimal}'"
    top = None if fixed & {"skip_rows", "header", "units_row"} else _top(lines, reading)
    layout = given.model_copy(update={k: v for k, v in seen.items() if k not in fixed})
    return Seen(layout, reading, top, notes + (_told(top) if top else []))


def _told(top: Top) -> list[str]:
    """Say what stands above the rows, beyond a header in the first line."""
    notes = []
    if top.skipped:
        notes.append(f"{counted(top.skipped, 'line')} above the header left out")
    if any(top.units):
        shown = ", ".join(unit or "-" for unit in top.units[:20])
        notes.append(f"the units stand below the header: {shown}")
    return notes


def split(line: str, mark: str) -> list[str]:
    """Split a line into cells.

    Examples
    --------
    >>> split('a;"b;c"', ";"), split("  1.5   2 ", " ")
    (['a', 'b;c'], ['1.5', '2'])

    """
    text = re.sub(" +", " ", line.strip()) if mark == " " else line.rstrip("\r\n")
    try:
        return next(csv.reader([text], delimiter=mark), [])
    except csv.Error:
        return [text]


def is_value(cell: str, decimal: str) -> bool:
    """Whether a cell is a number or a stamp.

    Examples
    --------
    >>> [is_value(cell, ",") for cell in ("1,5e-3", "1.5", "8:00:00", "x", "")]
    [True, False, True, False, False]

    """
    return NUMBER[decimal].fullmatch(cell) is not None or is_stamp(cell)


def _reading(lines: list[str], given: CsvMapping) -> Reading | None:
    """Return the one way to read the lines, or None."""
    fixed = given.model_fields_set
    found = []
    for mark in [given.delimiter] if "delimiter" in fixed else MARKS:
        rows = [(n, split(line, mark)) for n, line in enumerate(lines) if line.strip()]
        decimals = [given.decimal] if "decimal" in fixed else NUMBER
        ways = [way for decimal in decimals if (way := _way(rows, mark, decimal))]
        found += [max(ways, key=lambda way: (len(way.columns), way.good))] if ways else []
    if any(way.is_whole for way in found):
        found = [way for way in found if way.is_whole]
    return found[0] if len(found) == 1 else None


def _way(rows: list[tuple[int, list[str]]], mark: str, decimal: str) -> Reading | None:
    """Return how lines that were split read by one decimal mark; None where as no table."""
    run = _longest_run([cells for _, cells in rows], decimal)
    if len(run) < FEWEST_ROWS or (mark == " " and re.search("[;\t]", "".join(run[0]))):
        return None
    columns = [
        [cell for cell in found if cell.strip()] for found in zip_longest(*run, fillvalue="")
    ]
    values = [sum(is_value(cell, decimal) for cell in found) for found in columns]
    blank = {place for place, found in enumerate(columns) if not found}
    numbers = [
        place
        for place, found in enumerate(columns)
        if found and len(found) - values[place] <= MOST_BAD * len(found)
    ]
    others = len(columns) - len(blank) - len(numbers)
    if len(numbers) < max(2, 1 + others):
        return None
    way = Reading(mark, decimal, rows, len(columns), numbers, blank, others == 0, sum(values))
    return way if sum(map(way.is_row, run)) >= FEWEST_ROWS else None


def _longest_run(rows: list[list[str]], decimal: str) -> list[list[str]]:
    """Return the longest run of rows that are mostly numbers, none wider than the first of it."""
    best: list[list[str]] = []
    run: list[list[str]] = []
    for cells in rows:
        filled = [cell for cell in cells if cell.strip()]
        good = sum(is_value(cell, decimal) for cell in filled)
        is_row = len(cells) > 1 and 2 * good > len(filled)
        goes_on = is_row and bool(run) and len(cells) <= len(run[0])
        run = [*run, cells] if goes_on else [cells] if is_row else []
        best = max(best, run, key=len)
    return best


def _check_thousands(path: Path, reading: Reading) -> None:
    """Refuse marks that may stand between thousands."""
    rows = [cells for _, cells in reading.rows if reading.is_row(cells)]
    marked = [c for cells in rows for k in reading.columns if re.search("[.,]", c := cells[k])]
    marked = [cell for cell in marked if not is_stamp(cell)]
    if marked and all(map(THOUSANDS.fullmatch, marked)):
        mark = reading.mark.replace("\t", r"\t")
        raise LogError(
            f"{path.name}: whether '{marked[0].strip()}' has a decimal mark or one between "
            f"thousands, the file does not show; write a mapping with csv = {{ delimiter = "
            f'"{mark}", decimal = "{reading.decimal}" }} for a decimal mark; numbers with marks '
            "between thousands must be exported without them"
        )


def _first(reading: Reading) -> int:
    """Return the place of the first row of numbers."""
    return next(k for k, (_, cells) in enumerate(reading.rows) if reading.is_row(cells))


def _top(lines: list[str], reading: Reading) -> Top | None:
    """Return what stands above the rows, or None where that is not certain."""
    first = _first(reading)
    begin, cells = reading.rows[first]
    if first == 0:
        if all(is_value(cell, reading.decimal) for cell in cells if cell.strip()):
            names = [f"column_{place}" for place in range(1, reading.width + 1)]
            return Top(begin, names, [""] * reading.width, has_header=False)
        return None
    if (scope := _of_twincat(reading, first)) is not None:
        return scope
    block: list[list[str]] = []
    below = begin
    for number, above in reversed(reading.rows[:first]):
        fitted = _fitted(above, lines[number], reading)
        if fitted is None or (block and number != below - 1):
            break
        block.insert(0, fitted)
        below = number
    if not block:
        return None
    has_units = len(block) > 1 and _are_units(block[-1])
    names = block[-1 - has_units]
    is_certain = has_units or len(block) == 1 or all(bracketed(name)[1] for name in names if name)
    if not (is_certain and _are_names(names, reading)):
        return None
    units = [one.strip("[]()").strip("-") if has_units else "" for one in block[-1]]
    return Top(begin, names, units, reading.rows[first - 1 - has_units][0])


def _fitted(cells: list[str], line: str, reading: Reading) -> list[str] | None:
    """Return the cells of a line above the rows, one for each cell of a row, or None."""
    width = reading.width
    if reading.mark == " " and len(cells) != width:
        cells = re.split(r" {2,}", line.strip())
    cells = [cell.strip() for cell in cells]
    if cells and cells[0][:1] in ("#", "%"):
        bare = cells[0].lstrip("#% ")
        cells = [bare, *cells[1:]] if bare else cells[1:]
        cells = re.split(" +", line.strip().lstrip("#% ")) if reading.mark == " " else cells
    if len(cells) == width + 1 and cells[-1] in ("", "Comment"):
        return cells[:width]
    if len(cells) == width - 1 and width - 1 in reading.blank:
        return [*cells, ""]
    return cells if len(cells) == width else None


def _are_names(cells: list[str], reading: Reading) -> bool:
    """Whether each column has a name, but for a blank one behind the last mark."""
    if any(is_value(cell, reading.decimal) for cell in cells):
        return False
    named = cells[:-1] if reading.width - 1 in reading.blank else cells
    return all(named)


def _are_units(cells: Iterable[str]) -> bool:
    """Whether every cell is a unit, in brackets or known, or blank.

    >>> _are_units(["s", "[mm]", "(N)", ""]), _are_units(["s", "mm", "on"]), _are_units(["", ""])
    (True, False, False)
    """
    filled = [cell for cell in cells if cell not in ("", "-")]
    bracketed = re.compile(r"\[[^\[\]]*\]|\([^()]*\)")
    return bool(filled) and all(bracketed.fullmatch(cell) or is_unit(cell) for cell in filled)


def _of_twincat(reading: Reading, first: int) -> Top | None:
    """Return the top of an export of TwinCAT Scope, whose header has a line for each property.

    A column whose cells repeat the names of the properties holds the time in ms.
    """
    lines, row = reading.rows[first]
    top = {cells[0]: (n, cells) for n, cells in reading.rows[:first] if len(cells) == len(row)}
    if not {"Name", "SampleTime[ms]", "Unit"} <= top.keys():
        return None
    above, given = top["Name"]
    names, units = [], []
    for name, unit, cell in zip(given, top["Unit"][1], row, strict=True):
        is_time = (name, unit) == ("Name", "Unit")
        names.append("Time" if is_time else name)
        since_start = is_time and len(cell.partition(reading.decimal)[0]) <= LONGEST_MS
        told = "" if is_time or unit == "(None)" else unit.partition(" (")[0]
        units.append("ms" if since_start else told)
    return Top(lines, names, units, above, is_ragged=names.count("Time") > 1)
