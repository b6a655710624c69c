"""Read a log from comma-separated values."""

from __future__ import annotations

import csv
import hashlib
import io
import math
from pathlib import Path

import numpy as np

from breakaway.errors import LogError
from breakaway.logs.log import Log, missing, read_bytes

NAMES = {
    "t_s": "t_s",
    "position_m": "position_m",
    "x_m": "position_m",
    "force_n": "force_n",
    "reference_m": "reference_m",
}
"""Header name in lower case -> column of `Log`. All but ``reference_m`` are required."""


def read_csv(path: Path) -> Log:
    r"""Read a log from a UTF-8 file of comma-separated values with one header line.

    The header names each column together with its unit: ``t_s``, ``position_m`` (or ``x_m``),
    ``force_n`` and optionally ``reference_m``. Upper and lower case are the same here, so
    ``force_N`` is ``force_n``. Further columns may hold anything. Numbers have a decimal
    point. Empty lines are accepted at the end only.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Log
        With the names of all other columns in ``ignored_columns``.

    Raises
    ------
    LogError
        The file is missing, empty or not UTF-8; a column is missing or there twice; a row has
        more or fewer cells than the header; a cell of a column that is read is not a finite
        number; and as `Log` says. Rows count from 1, after the header.

    Notes
    -----
    Not checked: whether the numbers are in the unit that the header states.

    Examples
    --------
    >>> import tempfile
    >>> rows = "".join(f"{k / 100},{k * 1e-4},2.5,ok\n" for k in range(20))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "motor.csv"
    ...     _ = path.write_text("t_s,x_m,force_N,remark\n" + rows)
    ...     log = read_csv(path)
    >>> log.rows, float(log.force_n[0]), log.ignored_columns
    (20, 2.5, ('remark',))

    """
    data = read_bytes(path)
    rows = _rows(path, data)
    header = [cell.strip() for cell in rows[0]]
    places = _places(path, header)
    columns: dict[str, list[float]] = {column: [] for column in places}
    for row, cells in enumerate(rows[1:], start=1):
        if len(cells) != len(header):
            raise LogError(
                f"{path.name}: row {row}: {len(cells)} cells where the header has {len(header)}; "
                "every row must have as many as the header: repair the row, or export again"
            )
        for column, place in places.items():
            columns[column].append(_number(path, header[place], row, cells[place]))
    return Log(
        t_s=np.array(columns["t_s"]),
        position_m=np.array(columns["position_m"]),
        force_n=np.array(columns["force_n"]),
        reference_m=np.array(columns["reference_m"]) if "reference_m" in columns else None,
        source=path,
        sha256=hashlib.sha256(data).hexdigest(),
        ignored_columns=tuple(
            name for place, name in enumerate(header) if place not in places.values()
        ),
    )


def _rows(path: Path, data: bytes) -> list[list[str]]:
    try:
        text = data.decode("utf-8-sig").rstrip("\r\n")
    except UnicodeDecodeError as error:
        raise LogError(
            f"{path.name}: byte {error.start + 1} is not UTF-8 text; a CSV log is a UTF-8 text "
            "file: save it as UTF-8, or read a MATLAB file with format='emps'"
        ) from None
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error as error:
        raise LogError(
            f"{path.name}: is not comma-separated text ({error}); export it as CSV with one "
            "header line"
        ) from None
    if not rows:
        raise LogError(f"{path.name}: the file holds only empty lines; export the log again")
    return rows


def _places(path: Path, header: list[str]) -> dict[str, int]:
    """Return the place of each column of `Log` in the header."""
    places: dict[str, int] = {}
    for place, name in enumerate(header):
        column = NAMES.get(name.lower())
        if column is None:
            continue
        if column in places:
            raise LogError(
                f"{path.name}: columns '{header[places[column]]}' and '{name}' both give "
                f"'{column}'; one must: delete or rename the other"
            )
        places[column] = place
    for column in ("t_s", "position_m", "force_n"):
        if column not in places:
            if len(header) == 1 and any(mark in header[0] for mark in ";\t"):
                raise LogError(
                    f"{path.name}: the header '{header[0][:80]}' is one cell; columns must be "
                    "separated by commas and decimals by points: export it so"
                )
            raise missing(path, "column", column, header)
    return places


def _number(path: Path, name: str, row: int, cell: str) -> float:
    try:
        # float() reads 1_0 as 10 and digits of any script; in a log both are damage.
        value = float(cell if cell.isascii() and "_" not in cell else "")
    except ValueError:
        reason = "not a number"
    else:
        if math.isfinite(value):
            return value
        reason = "not finite"
    raise LogError(
        f"{path.name}: column '{name}', row {row}: {cell[:40]!r} is {reason}; it must be a "
        "finite number such as -1.5e-3: cut the row out, or export the log again"
    )
