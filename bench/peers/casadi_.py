"""CasADi: a symbolic function for one hold of the random factor, folded over all holds.

Settings: ten control periods as one SX graph with common subexpressions removed, `fold` over the
holds, and the whole compiled as C by gcc (-O3 -march=native -ffast-math); or, without a compiler,
run by CasADi's own virtual machine. Tried, and slower: folding single periods; the integrators that
come with CasADi, `rk` at one step a period by several times, and by far `cvodes`, which restarts at
every period and is off by more than the tolerance. A batch is `map` over runs, on all cores with
CasADi's "thread", since its wheels have no OpenMP.
"""

from __future__ import annotations

import tempfile
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from .case import Batch, Case, Simulate
from .equations import RULES, Operations, Rule, period_of
from .loop import Loop

EXPRESSIONS = Operations(ca.exp, ca.fabs, ca.fmin, ca.fmax, lambda a, b: a < b)
STATES = 6


def hold_of(rule: Rule, loop: Loop) -> ca.Function:
    """State after a hold, from the state before, the references of its samples, and its factor."""
    period = period_of(rule, loop.numbers, EXPRESSIONS)
    state = ca.SX.sym("state", STATES)
    inputs = ca.SX.sym("inputs", 2 * loop.hold_samples + 1)
    *references, factor = ca.vertsplit(inputs)
    after = ca.vertsplit(state)
    for r, dr in zip(references[::2], references[1::2], strict=True):
        after = period(*after, r, dr, factor)
    return ca.Function("hold", [state, inputs], [ca.vertcat(*after)], {"cse": True})


def compiled(run: ca.Function) -> ca.Function:
    """The same function through C."""
    arguments = [ca.MX.sym(run.name_in(k), *run.size_in(k)) for k in range(run.n_in())]
    with tempfile.TemporaryDirectory() as folder:
        through_c = {
            "jit": True,
            "jit_cleanup": False,
            "compiler": "shell",
            "jit_options": {
                "compiler": "gcc",
                "flags": ["-O3", "-march=native", "-ffast-math"],
                "directory": f"{folder}/",
                "cleanup": False,
            },
        }
        return ca.Function("run", arguments, [run(*arguments)], through_c)


def inputs_of(loop: Loop) -> ca.DM:
    """A column for each hold of each run: references and their rates in turn, then the factor."""
    references = np.stack(loop.reference(), axis=1).reshape(loop.holds, -1)
    factors = loop.factors()
    columns = np.empty((len(loop.runs), loop.holds, references.shape[1] + 1))
    columns[:, :, :-1], columns[:, :, -1] = references, factors
    return ca.DM(columns.reshape(-1, columns.shape[2]).T)


def prepare(rule: Rule, through_c: bool, loop: Loop, threads: int) -> Simulate:
    """All runs, mapped."""
    run: Any = hold_of(rule, loop).fold(loop.holds)
    run = compiled(run) if through_c else run
    if len(loop.runs) > 1:
        run = run.map(len(loop.runs), *(("thread", threads) if threads > 1 else ("serial",)))
    at_rest, inputs = ca.DM.zeros(STATES, len(loop.runs)), inputs_of(loop)
    return lambda: np.array(run(at_rest, inputs))[-1]


def _case(rule: Rule, through_c: bool) -> Case:
    return Case(
        name="CasADi, through C" if through_c else "CasADi, virtual machine",
        integrates=RULES[rule],
        settings="ten periods as one graph, fold; batch: map, all cores: map 'thread'",
        prepare=partial(prepare, rule, through_c),
        single_s=0.5,
        batch=Batch(runs=1024, duration_s=0.02, all_cores="threads"),
        rule=rule,
    )


CASES = [_case("rk4", True), _case("ours", True), _case("rk4", False)]
