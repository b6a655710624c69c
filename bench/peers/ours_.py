"""breakaway: one run and a batch, with its own rule and with Runge-Kutta 4.

Runge-Kutta 4 at one step a period is what most peers use. The scenario refuses it at steps that
long, because they are close to instability (`bench.peers.edge`); here its timing is set past that
check, so that rule and code can be told apart. A single run computes all metrics, not the IAE
alone.
"""

from __future__ import annotations

from functools import partial

import numpy as np

import breakaway as bk

from .case import Batch, Case, Simulate
from .equations import RULES, Rule
from .loop import Loop, scenario


def scenario_for(rule: Rule, duration_s: float) -> bk.Scenario:
    """The disturbed loop with one step in a period."""
    disturbed = scenario(duration_s)
    if rule == "ours":
        return disturbed
    unchecked = disturbed.timing.model_copy(update={"integrator": "rk4", "steps_per_period": 1})
    return disturbed.model_copy(update={"timing": unchecked})


def one(rule: Rule, loop: Loop, _threads: int) -> Simulate:
    """A single run, as a user calls it."""
    disturbed, run = scenario_for(rule, loop.duration_s), loop.runs[0]
    return lambda: np.array([bk.simulate(disturbed, run_index=run).metrics.iae_m_s])


def many(rule: Rule, loop: Loop, threads: int) -> Simulate:
    """The first runs of the seed."""
    disturbed, count = scenario_for(rule, loop.duration_s), len(loop.runs)
    simulate = partial(bk.simulate_many, disturbed, runs=count, metrics=["iae_m_s"])
    return lambda: np.asarray(simulate(threads=threads)["iae_m_s"])


def _case(rule: Rule, batch: Batch) -> Case:
    return Case(
        name="breakaway",
        integrates=RULES[rule],
        settings="from Python; single: simulate, all metrics; batch: simulate_many, IAE",
        prepare=partial(many, rule),
        first_run=partial(one, rule),
        single_s=0.5,
        batch=batch,
        rule=rule,
    )


CASES = [
    _case("ours", Batch(runs=1024, duration_s=0.5, all_cores="threads")),
    _case("rk4", Batch(runs=64, duration_s=0.1, all_cores="threads")),
]
