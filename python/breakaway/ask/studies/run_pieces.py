"""The pieces of a study: columns of runs, written whole and read back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.ask.durable.pieces import as_bytes
from breakaway.ask.studies.levels import Level
from breakaway.ask.studies.points import Point
from breakaway.model.units import unit_of
from breakaway.run.batch.batch import Batch

LARGE = 1000
"""Fewest runs of a stretch whose columns are read one by one."""


@dataclass(frozen=True)
class Stretch:
    """Some runs of one point within a piece."""

    point: int
    """Number of the point."""
    rows: range
    """Its runs, counted from the first of the point."""
    offset: int
    """Row of the piece where they start."""


def laid_out(
    points: Sequence[Point], first_point: int, runs_per_piece: int
) -> Iterator[list[Stretch]]:
    """Lay points out into pieces of equal length, the last one shorter.

    Small points share a piece, and large ones take several.
    """
    stretches: list[Stretch] = []
    filled = 0
    for number, point in enumerate(points, first_point):
        start, count = 0, len(point.runs)
        while start < count:
            taken = min(count - start, runs_per_piece - filled)
            stretches.append(Stretch(number, range(start, start + taken), filled))
            start, filled = start + taken, filled + taken
            if filled == runs_per_piece:
                yield stretches
                stretches, filled = [], 0
    if stretches:
        yield stretches


class RunPieces:
    """The columns of a study's pieces, and the files they are in."""

    def __init__(
        self,
        folder: Path,
        labels: Mapping[str, str],
        varied: Sequence[str],
        metrics: Sequence[str],
    ) -> None:
        self._folder = folder
        self._schema = piece_schema(labels, varied, metrics)
        self._kept: tuple[str, Any] = ("", None)

    def as_bytes(self, batches: Sequence[tuple[Stretch, Point, Batch]]) -> bytes:
        """Give the file of a piece."""
        arrow: Any = import_module("pyarrow")
        tables = [self._table(stretch, point, batch) for stretch, point, batch in batches]
        return as_bytes(arrow.concat_tables(tables))

    def _table(self, stretch: Stretch, point: Point, batch: Batch) -> Any:  # noqa: ANN401 - no stubs
        arrow: Any = import_module("pyarrow")
        columns: dict[str, Any] = {"point": np.full(len(batch), stretch.point, dtype=np.int32)}
        columns["run_index"] = batch.run_index
        columns |= {name: [label] * len(batch) for name, label in point.labels.items()}
        columns |= {**batch.varied, **batch.metrics}
        nowhere = np.full(len(batch), np.nan)  # what varies, but has no place in this scenario
        arrays = [
            arrow.array(columns.get(field.name, nowhere), type=field.type)
            for field in self._schema
            if field.name != "outcome"
        ]
        codes = arrow.array(_codes(batch))
        arrays.append(arrow.DictionaryArray.from_arrays(codes, list(OUTCOMES)))
        return arrow.Table.from_arrays(arrays, schema=self._schema)

    def column(self, name: str, piece: str, stretch: Stretch) -> NDArray[Any]:
        """Read a column of a stretch of a piece; outcomes as their places among the outcomes."""
        values = self._read(piece, name, stretch).slice(stretch.offset, len(stretch.rows))
        if name != "outcome":
            column: NDArray[Any] = values.to_numpy()
            return column
        chunks = [chunk.indices.to_numpy() for chunk in values.chunks]
        return np.concatenate(chunks)

    def _read(self, piece: str, name: str, stretch: Stretch) -> Any:  # noqa: ANN401 - no stubs
        """Read a column of a piece; one that small points share is kept as a whole."""
        parquet: Any = import_module("pyarrow.parquet")
        path = self._folder / piece
        if len(stretch.rows) >= LARGE:
            return parquet.read_table(path, columns=[name], use_threads=False, partitioning=None)[
                name
            ]
        if self._kept[0] != piece:
            self._kept = (
                piece,
                parquet.read_table(path, use_threads=False, partitioning=None),
            )
        return self._kept[1][name]


def piece_schema(labels: Mapping[str, str], varied: Sequence[str], metrics: Sequence[str]) -> Any:  # noqa: ANN401 - pyarrow has no type stubs
    """Give the columns of a piece: point and run, labels, what varies, metrics, outcome.

    Parameters
    ----------
    labels : mapping
        Names of what tells points apart -> the name of their type in pyarrow.
    varied : sequence of str
        Paths of what differs from run to run.
    metrics : sequence of str
        Recorded metrics.

    Examples
    --------
    >>> piece_schema({"disturbance.var": "double"}, [], ["peak_force_n"]).names
    ['point', 'run_index', 'disturbance.var', 'peak_force_n', 'outcome']

    """
    arrow: Any = import_module("pyarrow")
    texts = arrow.dictionary(arrow.int8(), arrow.string())
    types: dict[str, Any] = {"point": arrow.int32(), "run_index": arrow.uint64()}
    types |= {name: arrow.type_for_alias(alias) for name, alias in labels.items()}
    types |= dict.fromkeys([*varied, *metrics], arrow.float64())
    types["outcome"] = texts
    return arrow.schema(
        arrow.field(name, kind, nullable=False, metadata={"unit": unit_of(name).symbol})
        for name, kind in types.items()
    )


def label_types(points: Sequence[Point]) -> dict[str, str]:
    """Give the name of the type, in pyarrow, of what tells points apart."""
    return {name: _type_of([point.labels[name] for point in points]) for name in points[0].labels}


def _type_of(levels: Sequence[Level]) -> str:
    kinds = {type(level) for level in levels}
    names = {bool: "bool", int: "int64", float: "double", str: "string"}
    return names[kinds.pop()] if len(kinds) == 1 else "double"


def _codes(batch: Batch) -> NDArray[np.int8]:
    assert batch.outcome_codes is not None  # a study always asks for it
    return batch.outcome_codes.astype(np.int8)
