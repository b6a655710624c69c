"""Simulate one extraction."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from breakaway import _core
from breakaway.base.arguments import check_arguments, check_whole
from breakaway.errors import ScenarioError
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.finished import Outcome, Run, RunMetrics
from breakaway.run.resolution import core_job, resolve


def simulate(scenario: Scenario, *, run_index: int = 0) -> Run:
    """Simulate an extraction to its end, or until it diverges.

    Parameters
    ----------
    scenario : Scenario
        What is simulated.
    run_index : int, optional
        Number of the run among the runs of the scenario's seed, 0 to 2^64 - 1: the same scenario,
        seed and number give the same bits on any machine and any number of threads.

    Returns
    -------
    Run

    Raises
    ------
    ScenarioError
        It is not a scenario, or the controller cannot be designed for this joint.
    KeyboardInterrupt
        Ctrl-C; the loop asks about every 16,000 steps.

    Examples
    --------
    >>> import breakaway as bk
    >>> run = bk.simulate(bk.load_scenario("paper_as_computed"))
    >>> str(run.outcome), f"{run.metrics.iae_m_s:.4e}", f"{run.metrics.peak_force_n:.1f}"
    ('released', '3.0361e-06', '601.4')

    """
    check_arguments(simulate, locals(), ScenarioError)
    check_whole("run_index", run_index, ScenarioError, 0, 2**64 - 1)
    resolved = resolve(scenario)
    outcome, figures, columns = _core.run_one(core_job(resolved, run_index))
    trace = {name: np.frombuffer(values) for name, values in columns.items() if values}
    return Run(
        outcome=Outcome(outcome),
        metrics=RunMetrics(**figures),
        trace=MappingProxyType(trace),
        scenario=resolved,
        seed=resolved.seed,
        run_index=int(run_index),
    )
