"""One method on many parts: what happened to each of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.base.arguments import check_arguments, run_numbers
from breakaway.base.equality import ByValue
from breakaway.base.one_line import OneLine, counted
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import OF_A_PART, Gentleness, PartPopulation
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.scenario.variation import VariationKind
from breakaway.run.batch import check_batch_fits, run_columns
from breakaway.run.finished import Run
from breakaway.run.trials.parts import draw_parts, part_columns, scenario_of

Array = NDArray[np.float64]

TRIAL_METRICS = (
    "time_to_release_s",
    "time_to_breakaway_s",
    "peak_force_n",
    "peak_over_breakaway",
    "largest_jump_m",
    "release_velocity_m_per_s",
    "largest_impact_work_j",
    "impulse_n_s",
    "impacts",
    "saturation_time_s",
    "rms_current_a",
    "stack_cycles",
    "stack_loss_w",
    "stack_tension_n",
    "stop_reason",
    "final_position_m",
)
"""What is recorded of each part."""


@dataclass(frozen=True, eq=False)
class Trial(OneLine, ByValue):
    """A method on parts of a population, as columns: one value for each part."""

    population: PartPopulation
    """Where the parts are from."""
    method: Method
    """How they were freed."""
    law: Law
    """The friction law of their joints."""
    variation: VariationKind
    """How their friction varies."""
    seed: int
    """Seed of parts, disturbances and noise."""
    runs: range
    """Numbers of the parts."""
    parts: Mapping[str, Array]
    """The parts' quantities."""
    metrics: Mapping[str, Array]
    """What happened to them; NaN for what did not happen."""

    def __repr__(self) -> str:
        parts = counted(len(self.runs), "part")
        where = f"{self.method.name!r} on {self.population.name!r}, {self.law}, {self.variation}"
        return f"<trial of {where}: {int(self.released.sum()):,} of {parts} released>"

    @property
    def released(self) -> NDArray[np.bool_]:
        """Whether each part is free."""
        return np.isfinite(self.metrics["time_to_release_s"])

    def within(self, limits: Gentleness) -> NDArray[np.bool_]:
        """Whether each part is free and suffered no more than the limits.

        Parameters
        ----------
        limits : Gentleness
            What it may suffer, such as ``population.strict``.

        """
        check_arguments(Trial.within, locals(), StudyError)
        return np.asarray(
            self.released
            & (self.metrics["peak_over_breakaway"] <= limits.peak_over_breakaway_max)
            & (self.metrics["largest_jump_m"] <= limits.jump_max_m)
            & (self.metrics["release_velocity_m_per_s"] <= limits.release_velocity_max_m_per_s)
        )

    def scenario(self, i: int) -> Scenario:
        """Give the scenario of the part in row ``i``, checked.

        Parameters
        ----------
        i : int
            Row of the part.

        """
        check_arguments(Trial.scenario, locals(), StudyError)
        place = self._row(i)
        row = {name: values[place : place + 1] for name, values in self.parts.items()}
        asked = (self.population, self.method, self.law, self.variation)
        base = scenario_of(*asked, seed=self.seed)
        columns = part_columns(*asked, row)
        return base.with_({path: float(values[0]) for path, values in columns.items()})

    def replay(self, i: int, *, trace_every: int = 1) -> Run:
        """Simulate the part in row ``i`` again, with its trace; its metrics are the same bits.

        Parameters
        ----------
        i : int
            Row of the part.
        trace_every : int, optional
            The trace keeps a row every so many samples.

        """
        check_arguments(Trial.replay, locals(), StudyError)
        from breakaway.run.simulation import simulate

        scenario = self.scenario(i).with_({"trace.every_samples": trace_every})
        return simulate(scenario, run_index=self.runs[self._row(i)])

    def _row(self, i: int) -> int:
        if not -len(self.runs) <= i < len(self.runs):
            raise StudyError(f"row {i}: the trial has {len(self.runs)} parts")
        return i % len(self.runs)


def run_trial(
    population: PartPopulation,
    method: Method,
    *,
    law: Law = "lugre",
    variation: VariationKind | None = None,
    runs: int | range,
    seed: int,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Trial:
    """Try a method on parts of a population.

    Each part takes the integration steps that it and the method's rig need, as "auto" in
    `timing.steps_per_period`; the results do not depend on the threads.

    Parameters
    ----------
    population : PartPopulation
        Where the parts are from.
    method : Method
        How they are freed.
    law : str, optional
        The friction law of their joints.
    variation : {"field", "part", "paper_random_factor", "none"}, optional
        How their friction varies: along the way, from part to part, anew in time as in the paper,
        or not at all. Left out: as the population says.
    runs : int or range
        How many parts, starting at number 0; or their numbers. The same numbers and seed are the
        same parts for every method.
    seed : int
        Seed of parts, disturbances and noise, 0 to 2^63 - 1.
    threads : int, optional
        Left out: one for each processor.
    progress : callable, optional
        Called about 20 times a second with the parts done and all parts. What it raises ends the
        trial.

    Raises
    ------
    ScenarioError
        It is not a population, or not a method.
    StudyError
        Another argument has a wrong type or is out of range, or the trial cannot fit into the free
        memory; nothing has run then.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import breakaway as bk
    >>> population, method = bk.load_population("seized_parts"), bk.load_method("steady_feed")
    >>> trial = bk.run_trial(population, method, runs=8, seed=1)
    >>> int(trial.released.sum())
    8

    """
    check_arguments(run_trial, locals(), StudyError)
    workers = thread_count(threads)
    variation = variation or population.variation
    numbers = run_numbers(runs)
    check_batch_fits(numbers.stop - numbers.start, len(OF_A_PART), len(TRIAL_METRICS))
    parts = draw_parts(population, numbers, seed=seed)
    asked = (population, method, law, variation)
    batch = run_columns(
        scenario_of(*asked, seed=seed),
        np.arange(numbers.start, numbers.stop, dtype=np.uint64),
        part_columns(*asked, parts),
        TRIAL_METRICS,
        workers,
        progress and (lambda done: progress(done, len(numbers))),
    )
    metrics = dict(batch.metrics)
    return Trial(*asked, seed, numbers, parts, metrics)
