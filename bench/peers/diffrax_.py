"""diffrax: the solver's own `step` in a `scan` over control periods; a batch is `vmap` of it.

Settings: float64, Heun's rule at a step of one control period. The force jumps at every period, so
no solver can step further, and whatever it carries from step to step is lost; of diffrax's explicit
solvers the two-stage ones are the cheapest, and within the tolerance in IAE. Tried, and slower: a
`diffeqsolve` for each period with the same rule, Bosh3 with error control, Tsit5 at one step, and
by far the implicit Kvaerno3. On all cores, a process for each core, as for JAX.
"""

from __future__ import annotations

from typing import Any

import diffrax
import jax.numpy as jnp

from .case import Batch, Case, Simulate
from .equations import control_of, rates_of
from .jax_ import ARRAYS, compiled
from .loop import Loop

SOLVER = diffrax.Heun()


def prepare(loop: Loop, _threads: int) -> Simulate:
    """All runs side by side, or one alone."""
    p = loop.numbers
    rates, control = rates_of(p, ARRAYS), control_of(p)
    plant = diffrax.ODETerm(lambda _, y, held: rates(*y, *held))

    def step(y: tuple, held: tuple) -> tuple[Any, ...]:
        fresh = SOLVER.init(plant, 0.0, p.period_s, y, held)
        x, v, z = SOLVER.step(plant, 0.0, p.period_s, y, held, fresh, made_jump=True)[0]
        return x, v, z * (x < p.engagement_length_m)

    def period(state: tuple, inputs: tuple) -> tuple[Any, ...]:
        x, v, z, integral, iae = state
        reference, rate, factor = inputs
        error = reference - x
        integral, force = control(error, rate - v, integral)
        x, v, z = step((x, v, z), (force, factor))
        return x, v, z, integral, iae + p.period_s * jnp.abs(error)

    return compiled(period, 5, loop)


CASES = [
    Case(
        name="diffrax",
        integrates="Heun, 1 step",
        settings="float64, solver.step in a scan, vmap",
        prepare=prepare,
        single_s=0.5,
        batch=Batch(runs=1024, duration_s=0.05, all_cores="processes"),
    )
]
