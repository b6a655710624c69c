"""Read a log from a Parquet file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.raw import RawFile, check_names, guarded

NS_PER_STAMP = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}

ROWS_AT_ONCE = 2**16
"""Rows that are unpacked at a time."""


@guarded("a Parquet file")
def open_parquet(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a Parquet file, whose channels are its columns.

    The unit of a column is taken from its metadata ``unit``, where it has this. Time stamps of
    date and time become seconds after the first stamp of all such columns that are read.

    Columns that are kept in another file cannot be read: no other file is opened.

    Raises
    ------
    LogError
        The file is damaged, or takes more memory than it may.

    """
    raw = RawFile(path)
    with open_regular(path) as stream, pq.ParquetFile(stream, pre_buffer=False) as file:
        check_names(path, file.metadata.num_columns)
        fields = _list(raw, file)

        def read(wanted: list[str]) -> None:
            # A column is held packed and unpacked, and its rows once more as they come. What the
            # file says of single columns is not asked: where that is damaged, pyarrow ends the
            # process.
            groups = [file.metadata.row_group(n) for n in range(file.metadata.num_row_groups)]
            passing = 2 * max((one.total_byte_size for one in groups), default=0)
            rows = file.metadata.num_rows
            budget.take("its columns", 8 * rows * len(wanted), passing + 16 * ROWS_AT_ONCE)
            found = {name: _read(raw, fields[name], file) for name in wanted}
            _add(raw, fields, {name: one for name, one in found.items() if one is not None})

        raw.read = read
        yield raw


def _list(raw: RawFile, file: Any) -> dict[str, Any]:  # noqa: ANN401 - pyarrow has no types
    """List the columns that are numbers or stamps; note the others."""
    fields = list(file.schema_arrow)
    count = Counter(field.name for field in fields)
    for field in fields:
        unit = "s" if _is_stamp(field.type) else _unit(field)
        if count[field.name] > 1 or not (_is_number(field.type) or _is_stamp(field.type)):
            raw.refuse(field.name, f"is of type {field.type}; it must be real numbers")
        else:
            rows = file.metadata.num_rows
            raw.list(ListedChannel(field.name, unit, str(field.type), rows))
    return {field.name: field for field in fields if field.name not in raw.unreadable}


def _unit(field: Any) -> str:  # noqa: ANN401 - pyarrow has no types
    return str((field.metadata or {}).get(b"unit", b"").decode(errors="replace"))


def _read(raw: RawFile, field: Any, file: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return the values of a column, stamps as whole numbers; None where some are missing."""
    values = np.empty(file.metadata.num_rows, np.int64 if _is_whole(field.type) else np.float64)
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
        raw.give_up(field.name, reason)
        return None
    return values


def _add(raw: RawFile, fields: dict[str, Any], found: dict[str, Any]) -> None:
    """Add columns; all stamps count from the first of any."""
    stamps = {name for name in found if _is_stamp(fields[name].type) and len(found[name])}
    zero_ns = min((int(found[n][0]) * NS_PER_STAMP[fields[n].type.unit] for n in stamps), default=0)
    for name, values in found.items():
        if name not in stamps:
            raw.add(name, values, None)
            continue
        unit_ns = NS_PER_STAMP[fields[name].type.unit]
        first = int(values[0])
        # Whole numbers are subtracted before they become seconds, which would round them.
        late_s = (first * unit_ns - zero_ns) * 1e-9
        raw.add(name, late_s + (values - first) * (unit_ns * 1e-9), None)


def _is_whole(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    """Whether int64 holds all values of a type, which float64 may round."""
    return _is_stamp(kind) or bool(pa.types.is_integer(kind) and not pa.types.is_uint64(kind))


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _is_stamp(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_timestamp(kind))
