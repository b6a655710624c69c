"""The pieces of a comparison: each holds what one method did to some parts in one case."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.comparison.asked import Asked
from breakaway.ask.durable.pieces import as_bytes
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import OF_A_PART
from breakaway.model.units import unit_of
from breakaway.run.trials import TRIAL_METRICS, Case, Trial


@dataclass(frozen=True)
class TrialPiece:
    """Some parts of one trial, which share a piece."""

    case: Case
    """Friction law of the joints, and how their friction varies."""
    method: Method
    """How the parts are freed."""
    runs: range
    """Numbers of the parts."""


def pieces_of(asked: Asked) -> Iterator[TrialPiece]:
    """Give the pieces of all trials, in the order in which they are computed."""
    parts, step = asked.numbers, asked.runs_per_piece
    for case in asked.cases:
        for method in asked.methods:
            for start in range(0, len(parts), step):
                yield TrialPiece(case, method, parts[start : start + step])


def trial_schema() -> Any:  # noqa: ANN401 - pyarrow has no type stubs
    """Give the columns of a piece: case, method, part, what the part is, what became of it."""
    arrow: Any = import_module("pyarrow")
    texts = arrow.dictionary(arrow.int8(), arrow.string())
    types: dict[str, Any] = dict.fromkeys(("law", "variation", "method"), texts)
    types |= {"run_index": arrow.uint64()}
    types |= dict.fromkeys([*OF_A_PART, *TRIAL_METRICS], arrow.float64())
    return arrow.schema(
        arrow.field(name, kind, nullable=False, metadata={"unit": unit_of(name).symbol})
        for name, kind in types.items()
    )


def trial_as_bytes(trial: Trial) -> bytes:
    """Give the file of a piece."""
    arrow: Any = import_module("pyarrow")
    same = np.zeros(len(trial.runs), dtype=np.int8)
    texts = [
        arrow.DictionaryArray.from_arrays(arrow.array(same), [text])
        for text in (trial.law, trial.variation, trial.method.name)
    ]
    columns: list[NDArray[Any]] = [np.asarray(trial.runs, dtype=np.uint64)]
    columns += [trial.parts[name] for name in OF_A_PART]
    columns += [trial.metrics[name] for name in TRIAL_METRICS]
    arrays = [*texts, *(arrow.array(column) for column in columns)]
    return as_bytes(arrow.Table.from_arrays(arrays, schema=trial_schema()))


def read_trial(path: Path, asked: Asked, piece: TrialPiece) -> Trial:
    """Read a piece as the trial it was written from."""
    parquet: Any = import_module("pyarrow.parquet")
    table = parquet.read_table(path, use_threads=False, partitioning=None)
    columns = {name: table[name].to_numpy() for name in (*OF_A_PART, *TRIAL_METRICS)}
    return Trial(
        population=asked.population,
        method=piece.method,
        law=piece.case.law,
        variation=piece.case.variation,
        seed=asked.seed,
        runs=piece.runs,
        parts={name: columns[name] for name in OF_A_PART},
        metrics={name: columns[name] for name in TRIAL_METRICS},
    )
