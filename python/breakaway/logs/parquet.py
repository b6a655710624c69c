"""Read a log from a Parquet file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from breakaway.logs.budget import Budget
from breakaway.logs.raw import RawFile, check_size, guarded

STAMPS_PER_S = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


@guarded("a Parquet file")
def read_parquet(path: Path, budget: Budget) -> RawFile:
    """Read the columns of a Parquet file.

    The unit of a column is taken from its metadata ``unit``, where it has this. Time stamps of
    date and time become seconds after the first.

    Raises
    ------
    LogError
        The file is damaged.

    """
    raw = RawFile(path)
    file = pq.ParquetFile(path)
    check_size(path, "the table", file.metadata.num_rows * max(file.metadata.num_columns, 1))
    for field in file.schema_arrow:
        if file.schema_arrow.names.count(field.name) > 1:
            raw.unreadable[field.name] = "there are several of this name; rename all but one"
            continue
        if not _is_number(field.type) and not pa.types.is_timestamp(field.type):
            raw.unreadable[field.name] = f"is of type {field.type}; it must be real numbers"
            continue
        _add(raw, field, file.read(columns=[field.name]).column(0))
    return raw


def _add(raw: RawFile, field: Any, column: Any) -> None:  # noqa: ANN401 - pyarrow has no types
    if column.null_count:
        raw.unreadable[field.name] = (
            f"{column.null_count} values are missing; every row must have one: cut these rows out"
        )
        return
    unit = (field.metadata or {}).get(b"unit", b"").decode(errors="replace")
    if pa.types.is_timestamp(field.type):
        ticks = column.cast(pa.int64()).to_numpy()
        values = (ticks - ticks[0] if len(ticks) else ticks) / STAMPS_PER_S[field.type.unit]
        raw.add(field.name, values, None, "s")
        return
    raw.add(field.name, np.asarray(column.to_numpy()), None, unit)


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))
