"""Simulate many extractions at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel

from breakaway import _core
from breakaway.base.arguments import check_arguments, check_choice, run_numbers
from breakaway.base.free_memory import check_fits
from breakaway.base.text import shown
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.model.scenario.distribution import Distribution
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.scenario.steps import steps_per_period
from breakaway.run.batch.batch import Batch
from breakaway.run.batch.columns import (
    check_paths,
    check_values,
    core_columns,
    with_nominal_controller,
)
from breakaway.run.batch.draw import Design, draw_columns
from breakaway.run.finished import RunMetrics
from breakaway.run.resolution import at_steps

METRICS = (*(field.name for field in fields(RunMetrics)), "outcome")
"""What can be asked of each run."""
RUNS_MAX = 2**32
"""One batch has fewer runs."""


def simulate_many(
    scenario: Scenario,
    runs: int | range,
    *,
    vary: Mapping[str, Distribution | ArrayLike] | None = None,
    design: Design = "random",
    metrics: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    instructions: str | None = None,
) -> Batch:
    """Simulate many extractions: the same scenario, other draws, and other parts.

    Every run has the bits of ``simulate(batch.scenario_of(i), run_index=batch.run_index[i])``, on
    any number of threads. Runs do not wait for the interpreter. A controller that is designed by
    pole placement is designed for the scenario as it stands, and does not know the numbers of a
    part; what else a scenario leaves open (residual friction, bounds) follows each part.

    Parameters
    ----------
    scenario : Scenario
        What the runs have in common. Its trace is not recorded; see `Batch.replay`.
    runs : int or range
        How many, starting at number 0; or their numbers among the runs of the scenario's seed, such
        as ``range(100, 200)``.
    vary : mapping, optional
        What differs from run to run besides the draws of the disturbance, by dotted path: a
        distribution, or one value for each run.
    design : {"random", "sobol", "latin_hypercube"}, optional
        How distributions are drawn from.
    metrics : sequence of str, optional
        What is wanted of each run: names of `RunMetrics`, and ``outcome``. Left out:
        everything. Metrics that are left out take no time. Those of a run that diverged end where
        it diverged.
    threads : int, optional
        Left out: one for each processor.
    progress : callable, optional
        Called about 20 times a second with the runs done and all runs. What it raises ends the
        batch.
    instructions : str, optional
        Instructions to compute with, one of ``breakaway._core.instructions()``. Left out: the
        fastest. The results are the same bits.

    Returns
    -------
    Batch

    Raises
    ------
    StudyError
        What is to vary, a metric or a number of runs is not valid, or the batch cannot fit into
        the free memory; nothing has run then.
    ScenarioError
        It is not a scenario, or the controller cannot be designed for this joint.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed").with_({"disturbance.var": 0.05})
    >>> batch = bk.simulate_many(
    ...     scenario,
    ...     runs=64,
    ...     vary={"joint.stiction_n": bk.LogUniform(low=400.0, high=500.0)},
    ...     metrics=["iae_m_s", "outcome"],
    ... )
    >>> int((batch["outcome"] == "released").sum())
    64

    """
    check_arguments(simulate_many, locals(), StudyError)
    vary = {} if vary is None else vary
    if instructions is not None:
        check_choice("instructions", instructions, _core.instructions(), StudyError)
    names = _wanted(metrics)
    numbers = run_numbers(runs, most=RUNS_MAX - 1)
    count = numbers.stop - numbers.start
    workers = thread_count(threads)
    nominal = with_nominal_controller(scenario)
    check_paths(nominal, vary)
    check_batch_fits(count, len(vary), len({*names} - {"outcome"}))
    columns = _columns(nominal, vary, numbers, design)
    check_values(nominal, columns, numbers.start)
    run_index = np.arange(numbers.start, numbers.stop, dtype=np.uint64)
    tell = None if progress is None else lambda done: progress(done, count)
    return run_columns(nominal, run_index, columns, names, workers, tell, instructions)


def check_batch_fits(runs: int, varied: int, metrics: int) -> None:
    """Refuse a batch that cannot fit into the free memory.

    Raises
    ------
    StudyError
        It cannot.

    """
    run, number, metric = 16, 24, 16  # bytes, those of copies among them
    each = run + number * varied + metric * metrics
    check_fits("runs", runs, each, "ask for fewer metrics, or for fewer runs at a time")


def run_columns(
    nominal: Scenario,
    run_index: NDArray[np.uint64],
    columns: Mapping[str, NDArray[np.float64]],
    names: Sequence[str],
    threads: int,
    tell: Callable[[int], None] | None = None,
    instructions: str | None = None,
) -> Batch:
    """Run any runs of a scenario whose controller is designed, each with its values; unchecked."""
    for column in (run_index, *columns.values()):
        column.setflags(write=False)
    metrics = {name: np.full(len(run_index), np.nan) for name in names if name != "outcome"}
    codes = np.zeros(len(run_index), dtype=np.uint8)
    done = 0

    def told(count: int) -> None:
        if tell:
            tell(done + count)

    for steps, rows in _of_equal_steps(nominal, columns, len(run_index)):
        shared, varied = core_columns(
            at_steps(nominal, steps), {path: column[rows] for path, column in columns.items()}
        )
        figures, ended = _core.run_many(
            shared,
            np.ascontiguousarray(run_index[rows]),
            [(place, np.ascontiguousarray(column)) for place, column in varied],
            list(metrics),
            "outcome" in names,
            threads,
            instructions or _core.instructions()[0],
            told,
        )
        for name, values in figures.items():
            metrics[name][rows] = np.frombuffer(values)
        if "outcome" in names:
            codes[rows] = np.frombuffer(ended, dtype=np.uint8)
        done += len(rows)
    for column in (codes, *metrics.values()):
        column.setflags(write=False)
    return Batch(
        scenario=nominal,
        run_index=run_index,
        varied=MappingProxyType(dict(columns)),
        metrics=MappingProxyType(metrics),
        outcome_codes=codes if "outcome" in names else None,
    )


def _of_equal_steps(
    nominal: Scenario, columns: Mapping[str, NDArray[np.float64]], runs: int
) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Give the runs by the integration steps that they need, most steps first.

    Longest guides come first: runs that end together share lanes best.
    """
    steps = np.full(runs, nominal.steps_per_period)
    if nominal.timing.steps_per_period == "auto":
        steps = np.broadcast_to(steps_per_period(nominal, columns), (runs,))
    for needed in np.unique(steps)[::-1]:
        rows = np.flatnonzero(steps == needed)
        if (length_m := columns.get("joint.engagement_length_m")) is not None:
            rows = rows[np.argsort(-length_m[rows], kind="stable")]
        yield int(needed), rows


def _wanted(metrics: Sequence[str] | None) -> Sequence[str]:
    if metrics is None:
        return METRICS
    if not metrics:
        raise StudyError(f"metrics: {shown(metrics)} is empty; give some of {', '.join(METRICS)}")
    for name in metrics:
        check_choice("metrics", name, METRICS, StudyError)
    return tuple(dict.fromkeys(metrics))


def _columns(
    scenario: Scenario,
    vary: Mapping[str, Distribution | ArrayLike],
    runs: range,
    design: Design,
) -> dict[str, NDArray[np.float64]]:
    """Give one column for each path, in the order of ``vary``."""
    distributions = {path: d for path, d in vary.items() if isinstance(d, BaseModel)}
    drawn = draw_columns(distributions, runs, seed=scenario.seed, design=design)
    return {
        path: drawn[path] if path in drawn else _given(path, values, len(runs))
        for path, values in vary.items()
    }


def _given(path: str, values: object, count: int) -> NDArray[np.float64]:
    try:
        column = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise StudyError(
            f"vary[{path!r}]: {shown(values)} is neither a distribution nor numbers"
        ) from None
    if column.shape != (count,):
        raise StudyError(
            f"vary[{path!r}]: has the shape {column.shape}; give one value for each of {count} runs"
        )
    return column
