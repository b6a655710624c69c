"""JAX: `jit` of a `scan` over control periods; a batch is `vmap` of it.

Settings: float64. One period in the body of the scan and no unrolling, which makes it slower. The
rule is written out: Runge-Kutta 4 at a control period, or ours. On all cores, a process for each
core: `pmap` and `shard_map` over CPU devices were not faster.
"""

from __future__ import annotations

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from .case import Batch, Case, Simulate
from .equations import RULES, Function, Operations, Rule, period_of
from .loop import Loop

jax.config.update("jax_enable_x64", True)

ARRAYS = Operations(jnp.exp, jnp.abs, jnp.minimum, jnp.maximum, jnp.less)


def prepare(rule: Rule, loop: Loop, _threads: int) -> Simulate:
    """All runs side by side, or one alone."""
    period = period_of(rule, loop.numbers, ARRAYS)
    return compiled(lambda state, inputs: period(*state, *inputs), 6, loop)


def compiled(period: Function, states: int, loop: Loop) -> Simulate:
    """Scans a period over all runs; the IAE is its last state."""

    def hold(state: tuple, inputs: tuple) -> tuple:
        reference, rate, factor = inputs

        def one(state: tuple, sample: tuple) -> tuple:
            return period(state, (*sample, factor)), None

        return lax.scan(one, state, (reference, rate))

    def run(reference: jax.Array, rate: jax.Array, factors: jax.Array) -> jax.Array:
        at_rest = (jnp.zeros(()),) * states
        return lax.scan(hold, at_rest, (reference, rate, factors))[0][-1]

    by_hold = [jnp.asarray(a.reshape(loop.holds, -1)) for a in loop.reference()]
    if len(loop.runs) == 1:
        run_all, factors = jax.jit(run), jnp.asarray(loop.factors()[0])
    else:
        run_all = jax.jit(jax.vmap(run, in_axes=(None, None, 0)))
        factors = jnp.asarray(loop.factors())
    return lambda: np.atleast_1d(run_all(*by_hold, factors))


def _case(rule: Rule) -> Case:
    return Case(
        name="JAX",
        integrates=RULES[rule],
        settings="float64, scan over periods, vmap over runs",
        prepare=partial(prepare, rule),
        single_s=0.5,
        batch=Batch(runs=1024, duration_s=0.05, all_cores="processes"),
        rule=rule,
    )


CASES = [_case("rk4"), _case("ours")]
