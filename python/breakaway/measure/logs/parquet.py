"""Read a log from a Parquet file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from breakaway.base.reading import open_regular
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.raw import RawFile, check_names, guarded

NS_PER_STAMP = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}

DEEPEST = 8
"""Most names from a column of structures to a number."""

ROWS_AT_ONCE = 2**16
"""Rows that are unpacked at a time."""


@guarded("a Parquet file")
def open_parquet(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a Parquet file, whose channels are its columns.

    The unit of a column is taken from its metadata ``unit``, where it has this. Time stamps of
    date and time become seconds after the first stamp of all such columns that are read; times of
    day and durations become seconds. Fields of structures are ``column.field``.

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


@dataclass(frozen=True)
class _Column:
    """A column of numbers, or a field of a column of structures."""

    path: tuple[str, ...]
    """Name of the column, and those of the fields within it."""
    type: Any
    unit: str

    @property
    def name(self) -> str:
        """Its name as a mapping takes it."""
        return ".".join(self.path)


def _list(raw: RawFile, file: Any) -> dict[str, _Column]:  # noqa: ANN401 - pyarrow has no types
    """List the columns that are numbers or times; note the others."""
    columns = [one for field in file.schema_arrow for one in _leaves(field, ())]
    count = Counter(one.name for one in columns)
    for one in columns:
        if count[one.name] > 1 or not (_is_number(one.type) or _is_time(one.type)):
            raw.refuse(one.name, f"is of type {one.type}; it must be real numbers")
        else:
            unit = "s" if _is_time(one.type) else one.unit
            raw.list(ListedChannel(one.name, unit, str(one.type), file.metadata.num_rows))
    return {one.name: one for one in columns if one.name not in raw.unreadable}


def _leaves(field: Any, above: tuple[str, ...]) -> Iterator[_Column]:  # noqa: ANN401
    """Give a column, or the fields of its structures, however deep."""
    path = (*above, field.name)
    if pa.types.is_struct(field.type) and len(path) < DEEPEST:
        for place in range(field.type.num_fields):
            yield from _leaves(field.type.field(place), path)
        return
    yield _Column(path, field.type, _unit(field))


def _unit(field: Any) -> str:  # noqa: ANN401 - pyarrow has no types
    return str((field.metadata or {}).get(b"unit", b"").decode(errors="replace"))


def _read(raw: RawFile, one: _Column, file: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return the values of a column, times as whole numbers; None where some are missing."""
    values = np.empty(file.metadata.num_rows, np.int64 if _is_whole(one.type) else np.float64)
    done = missing = 0
    for batch in file.iter_batches(ROWS_AT_ONCE, columns=[one.name], use_threads=False):
        column = batch.column(one.path[0])
        for name in one.path[1:]:
            column = pc.struct_field(column, name)
        missing += column.null_count
        if not missing:
            numbers = _plain(column, one.type).to_numpy(zero_copy_only=False)
            values[done : done + len(numbers)] = numbers
        done += len(column)
    if done != len(values):
        raise ValueError(f"'{one.name}' has {done} of {len(values)} rows")
    if missing:
        reason = f"{missing} values are missing; every row must have one: cut these rows out"
        raw.give_up(one.name, reason)
        return None
    return values


def _plain(column: Any, kind: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return times as the whole numbers that they are kept as, decimals as numbers."""
    if pa.types.is_time32(kind):
        return column.cast(pa.int32())
    if _is_time(kind):
        return column.cast(pa.int64())
    return column.cast(pa.float64()) if pa.types.is_decimal(kind) else column


def _add(raw: RawFile, fields: dict[str, _Column], found: dict[str, Any]) -> None:
    """Add columns; all stamps with a date count from the first of any."""
    stamps = {name for name in found if _is_stamp(fields[name].type) and len(found[name])}
    zero_ns = min((int(found[n][0]) * NS_PER_STAMP[fields[n].type.unit] for n in stamps), default=0)
    for name, values in found.items():
        if name not in stamps:
            kind = fields[name].type
            seconds = NS_PER_STAMP[kind.unit] * 1e-9 if _is_time(kind) else 1.0
            raw.add(name, values if seconds == 1.0 else seconds * values, None)
            continue
        unit_ns = NS_PER_STAMP[fields[name].type.unit]
        first = int(values[0])
        # Whole numbers are subtracted before they become seconds, which would round them.
        late_s = (first * unit_ns - zero_ns) * 1e-9
        raw.add(name, late_s + (values - first) * (unit_ns * 1e-9), None)


def _is_whole(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    """Whether int64 holds all values of a type, which float64 may round."""
    return _is_time(kind) or bool(pa.types.is_integer(kind) and not pa.types.is_uint64(kind))


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    numbers = (pa.types.is_integer, pa.types.is_floating, pa.types.is_decimal)
    return any(one(kind) for one in numbers)


def _is_time(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    """Whether a type is a stamp with a date, a time of day, or a duration."""
    return _is_stamp(kind) or bool(pa.types.is_time(kind) or pa.types.is_duration(kind))


def _is_stamp(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    return bool(pa.types.is_timestamp(kind))
