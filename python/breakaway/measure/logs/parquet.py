"""Read a log from a Parquet file."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.raw import RawFile, check_names, guarded

STAMPS_PER_S = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}

ROWS_AT_ONCE = 2**16
"""Rows that are unpacked at a time."""


@guarded("a Parquet file")
def read_parquet(path: Path, budget: Budget) -> RawFile:
    """Read the columns of a Parquet file.

    The unit of a column is taken from its metadata ``unit``, where it has this. Time stamps of
    date and time become seconds after the first.

    Columns that are kept in another file cannot be read: no other file is opened.

    Raises
    ------
    LogError
        The file is damaged, or takes more memory than it may.

    """
    raw = RawFile(path)
    with open_regular(path) as stream, pq.ParquetFile(stream, pre_buffer=False) as file:
        check_names(path, file.metadata.num_columns)
        wanted = _wanted(raw, file)
        # A column is held packed and unpacked, and its rows once more as they come. What the file
        # says of single columns is not asked: where that is damaged, pyarrow ends the process.
        groups = [file.metadata.row_group(place) for place in range(file.metadata.num_row_groups)]
        passing = 2 * max((one.total_byte_size for one in groups), default=0) + 16 * ROWS_AT_ONCE
        budget.take("its columns", 8 * file.metadata.num_rows * len(wanted), passing)
        for field in wanted:
            _add(raw, field, file)
    return raw


def _wanted(raw: RawFile, file: Any) -> list[Any]:  # noqa: ANN401 - pyarrow has no types
    """Return the fields that are numbers or stamps; note the others."""
    fields = list(file.schema_arrow)
    count = Counter(field.name for field in fields)
    for field in fields:
        if count[field.name] > 1 or not (_is_number(field.type) or _is_stamp(field.type)):
            raw.refuse(field.name, f"is of type {field.type}; it must be real numbers")
    return [field for field in fields if field.name not in raw]


def _add(raw: RawFile, field: Any, file: Any) -> None:  # noqa: ANN401 - pyarrow has no types
    values = np.empty(file.metadata.num_rows, np.int64 if _is_stamp(field.type) else np.float64)
    done = missing = 0
    for batch in file.iter_batches(ROWS_AT_ONCE, columns=[field.name], use_threads=False):
        column = batch.column(field.name)
        missing += column.null_count
        if not missing:
            numbers = column.cast(pa.int64()) if _is_stamp(field.type) else column
            values[done : done + len(numbers)] = numbers.to_numpy(zero_copy_only=False)
        done += len(column)
    if done != len(values):
        raise ValueError(f"'{field.name}' has {done} of {len(values)} rows")
    if missing:
        reason = f"{missing} values are missing; every row must have one: cut these rows out"
        raw.refuse(field.name, reason)
    elif _is_stamp(field.type):
        after = values - values[0] if done else values
        raw.add(field.name, after / STAMPS_PER_S[field.type.unit], None, "s")
    else:
        unit = (field.metadata or {}).get(b"unit", b"").decode(errors="replace")
        raw.add(field.name, values, None, unit)


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _is_stamp(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_timestamp(kind))
