"""The parts of a population in files: each holds what one method did to some of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.comparison.asked import Asked
from breakaway.ask.studies.part_files import as_bytes, found, part_name, remove_beyond
from breakaway.ask.studies.pieces import Pieces
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import QUANTITIES
from breakaway.model.units import unit_of
from breakaway.run.trials import TRIAL_METRICS, Trial


@dataclass(frozen=True)
class Chunk:
    """Some parts of one trial, which share a file."""

    number: int
    """Place of the file among all."""
    law: Law
    """Friction law of the joints."""
    method: Method
    """How the parts are freed."""
    runs: range
    """Numbers of the parts."""


def chunks_of(asked: Asked) -> Iterator[Chunk]:
    """Give the chunks of all trials, in the order in which they are computed."""
    number = 0
    for law in asked.laws:
        for method in asked.methods:
            for start in range(0, asked.runs, asked.runs_per_part):
                runs = range(start, min(start + asked.runs_per_part, asked.runs))
                yield Chunk(number, law, method, runs)
                number += 1


def trial_schema() -> Any:  # noqa: ANN401 - pyarrow has no type stubs
    """Give the columns of a file: law, method, part, what the part is, what became of it."""
    arrow: Any = import_module("pyarrow")
    texts = arrow.dictionary(arrow.int8(), arrow.string())
    types: dict[str, Any] = {"law": texts, "method": texts, "run_index": arrow.uint64()}
    types |= dict.fromkeys([*QUANTITIES, *TRIAL_METRICS], arrow.float64())
    return arrow.schema(
        arrow.field(name, kind, nullable=False, metadata={"unit": unit_of(name).symbol})
        for name, kind in types.items()
    )


class TrialFiles:
    """The files of a comparison's chunks."""

    def __init__(self, asked: Asked, pieces: Pieces) -> None:
        self._asked, self._pieces = asked, pieces
        self._schema = trial_schema()

    def write(self, chunk: Chunk, trial: Trial) -> None:
        """Write a chunk, whole or not at all.

        Raises
        ------
        OutputError
            The folder can not be written, or the disk is full.

        """
        arrow: Any = import_module("pyarrow")
        same = np.zeros(len(chunk.runs), dtype=np.int8)
        texts = [
            arrow.DictionaryArray.from_arrays(arrow.array(same), [text])
            for text in (chunk.law, chunk.method.name)
        ]
        columns: list[NDArray[Any]] = [np.asarray(chunk.runs, dtype=np.uint64)]
        columns += [trial.parts[name] for name in QUANTITIES]
        columns += [trial.metrics[name] for name in TRIAL_METRICS]
        arrays = [*texts, *(arrow.array(column) for column in columns)]
        table = arrow.Table.from_arrays(arrays, schema=self._schema)
        self._pieces.write(part_name(chunk.number), as_bytes(table))

    def found(self, chunk: Chunk, say: Callable[[str], None]) -> bool:
        """Whether the file of a chunk is there as it was written; of another one, say so."""
        return found(self._pieces, chunk.number, f"{len(chunk.runs)} parts", say)

    def read(self, chunk: Chunk) -> Trial:
        """Read a chunk as the trial it was written from."""
        parquet: Any = import_module("pyarrow.parquet")
        path = self._pieces.folder / part_name(chunk.number)
        table = parquet.read_table(path, use_threads=False, partitioning=None)
        columns = {name: table[name].to_numpy() for name in (*QUANTITIES, *TRIAL_METRICS)}
        return Trial(
            population=self._asked.population,
            method=chunk.method,
            law=chunk.law,
            seed=self._asked.seed,
            runs=chunk.runs,
            parts={name: columns[name] for name in QUANTITIES},
            metrics={name: columns[name] for name in TRIAL_METRICS},
        )

    def remove_beyond(self, say: Callable[[str], None]) -> None:
        """Remove files that belong to no chunk, and say so.

        Raises
        ------
        OutputError
            One can not be removed.

        """
        count = sum(1 for _ in chunks_of(self._asked))
        remove_beyond(self._pieces, count, "comparison", say)
