"""What stands below the table of a text file: statistics, a mark of the end, a row cut short."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from breakaway.base.reading import open_regular
from breakaway.measure.logs.layout import Reading, is_value, split
from breakaway.measure.logs.text_file import ONE_BYTE, TextFile

SEARCHED = 2**16
"""Bytes at the end of a file in which the last row is looked for."""

MOST_ROWS = 20
"""More rows than these are no footer."""


@dataclass(frozen=True)
class Footer:
    """Where the table ends, in bytes; and the lines and rows below it."""

    begin: int
    lines: int
    rows: list[str]


def find_footer(file: TextFile, reading: Reading) -> Footer | None:
    """Return what follows the last row of a table, or None for nothing that is certain.

    It is text where a row has a number first, nothing at all between the marks, or a last row with
    fewer cells. Whatever else follows stays for the reader to refuse.
    """
    if file.encoding not in ONE_BYTE:
        return None
    with open_regular(file.path) as stream:
        size = stream.seek(0, 2)
        stream.seek(max(0, size - SEARCHED))
        lines = stream.read().splitlines(keepends=True)
    begin, rows = size, list[str]()
    for below, line in enumerate(reversed(lines)):
        text = line.decode(file.encoding, "replace")
        cells = split(text, reading.mark)
        if text.strip():
            if reading.is_row(cells):
                return Footer(begin, below, rows[::-1]) if rows else None
            if rows == ["EOF"] and len(cells) < reading.width:
                return Footer(begin, below, rows)
            if len(rows) >= MOST_ROWS or not _is_below(cells, reading, is_last=not rows):
                return None
            rows.append(text.strip())
        begin -= len(line)
    return None


def _is_below(cells: Sequence[str], reading: Reading, *, is_last: bool) -> bool:
    """Whether cells are certainly no row of the table."""
    filled = [cell for cell in cells if cell.strip()]
    if not filled:
        return True
    first = reading.columns[0]
    if len(cells) == reading.width:
        text = cells[first].strip()
        return bool(text) and not is_value(text, reading.decimal)
    if not is_value(filled[0], reading.decimal):
        return True
    return is_last and len(cells) < reading.width
