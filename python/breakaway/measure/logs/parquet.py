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

    Raises
    ------
    LogError
        The file is damaged, or takes more memory than it may.

    """
    raw = RawFile(path)
    with open_regular(path) as stream, pq.ParquetFile(stream, pre_buffer=False) as file:
        check_names(path, file.metadata.num_columns)
        wanted = _wanted(raw, file)
        for name, chunks in _chunks(file.metadata, {field.name for field in wanted}).items():
            if any(chunk.file_path for chunk in chunks):
                raw.refuse(name, "is kept in another file, which is not opened: export its values")
            # A chunk is held packed and unpacked, and its rows once more as they come.
            sizes = [c.total_uncompressed_size + c.total_compressed_size for c in chunks]
            passing = max(sizes, default=0) + 16 * ROWS_AT_ONCE
            budget.take(f"'{name}'", 8 * file.metadata.num_rows, passing)
        for field in wanted:
            if field.name not in raw:
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


def _chunks(metadata: Any, names: set[str]) -> dict[str, list[Any]]:  # noqa: ANN401
    """Return what the file says of each piece of a column: one for each group of rows."""
    places = {
        name: place
        for place in range(metadata.num_columns)
        if (name := metadata.schema.column(place).path) in names
    }
    groups = [metadata.row_group(place) for place in range(metadata.num_row_groups)]
    return {name: [group.column(place) for group in groups] for name, place in places.items()}


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
