"""Read a log from comma-separated values."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from breakaway.errors import LogError
from breakaway.logs.budget import Budget
from breakaway.logs.mapping import CsvMapping
from breakaway.logs.raw import RawChannel, RawFile


def read_csv(path: Path, budget: Budget, layout: CsvMapping) -> RawFile:
    """Read a UTF-8 file of separated values with one header line.

    Empty lines are accepted at the end only. A column that holds anything but finite numbers
    is noted as unreadable; rows count from 1, after the header.

    Parameters
    ----------
    path : Path
        The file.
    layout : CsvMapping
        Delimiter, decimal mark, lines above the header, units row.

    Raises
    ------
    LogError
        The file is not UTF-8, holds no header, or a row has more or fewer cells than it.

    """
    header, units, rows = _split(path, budget, layout)
    raw = RawFile(path)
    for place, name in enumerate(header):
        if name in raw.names:
            raw.channels.pop(name, None)
            raw.unreadable[name] = "there are several of this name; rename all but one"
            continue
        values = np.empty(len(rows))
        for row, cells in enumerate(rows):
            value, reason = _number(cells[place], layout.decimal)
            if reason:
                raw.unreadable[name] = f"row {row + 1}: {reason}"
                break
            values[row] = value
        else:
            raw.channels[name] = RawChannel(values, unit=units[place])
    return raw


def _split(
    path: Path, budget: Budget, layout: CsvMapping
) -> tuple[list[str], list[str], list[list[str]]]:
    """Return the header, the units (empty texts without a units row), and the rows."""
    table = _table(path, budget, layout)[layout.skip_rows :]
    if len(table) < 1 + layout.units_row:
        raise LogError(
            f"{path.name}: there is no header below {layout.skip_rows} skipped lines; correct "
            "csv.skip_rows and csv.units_row in the mapping"
        )
    header = [cell.strip() for cell in table[0]]
    if len(header) == 1 and any(mark in header[0] for mark in ";\t,"):
        raise LogError(
            f"{path.name}: the header '{header[0][:80]}' is one cell; columns must be separated "
            "by commas and decimals by points: export it so, or write a mapping with "
            'csv = { delimiter = ";", decimal = "," }'
        )
    first = 1 + layout.units_row
    for row, cells in enumerate(table[first:], start=1):
        if len(cells) != len(header):
            raise LogError(
                f"{path.name}: row {row}: {len(cells)} cells where the header has {len(header)}; "
                "every row must have as many as the header: repair the row, or export again"
            )
    units = [cell.strip().strip("[]()") for cell in table[1]] if layout.units_row else []
    units += [""] * (len(header) - len(units))
    return header, units, table[first:]


def _table(path: Path, budget: Budget, layout: CsvMapping) -> list[list[str]]:
    try:
        text = path.read_bytes().decode("utf-8-sig").rstrip("\r\n")
    except UnicodeDecodeError as error:
        raise LogError(
            f"{path.name}: byte {error.start + 1} is not UTF-8 text; a CSV log is a UTF-8 text "
            "file: save it as UTF-8, or name another format"
        ) from None
    try:
        table = list(
            csv.reader(io.StringIO(text, newline=""), delimiter=layout.delimiter, strict=True)
        )
    except csv.Error as error:
        raise LogError(
            f"{path.name}: is not comma-separated text ({error}); export it as CSV with one "
            "header line"
        ) from None
    if not table:
        raise LogError(f"{path.name}: the file holds only empty lines; export the log again")
    return table


def _number(cell: str, decimal: str) -> tuple[float, str]:
    """Return the number in a cell, and why it is none."""
    try:
        # float() reads 1_0 as 10 and digits of any script; in a log both are damage.
        value = float(cell.replace(decimal, ".") if cell.isascii() and "_" not in cell else "")
    except ValueError:
        reason = "not a number"
    else:
        if math.isfinite(value):
            return value, ""
        reason = "not finite"
    return math.nan, (
        f"{cell[:40]!r} is {reason}; it must be a finite number such as -1.5e-3: cut the row "
        "out, or export the log again"
    )
