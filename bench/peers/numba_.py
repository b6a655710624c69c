"""numba: the loop in plain Python, compiled.

Settings: `fastmath` and `error_model="numpy"`, every number of the loop a constant of the
compilation, every function inlined. numba has no solvers, so the rule is written out: Runge-Kutta 4
at the largest step there is, a control period, since the force jumps at the next; the explicit
midpoint rule, the cheapest that is as accurate as ours; and ours. `bench.peers.edge` shows how far
from instability they are.

* scalar: run after run with `numpy.exp`; on all cores, `prange` over runs.
* lanes: 16 runs side by side in the inner loop, which LLVM then vectorizes. That takes an
  exponential without a call, so it is written as a polynomial: the wheels of llvmlite come without
  the patch for Intel's vector library, and `numpy.exp` stops the vectorizer.
"""

from __future__ import annotations

from functools import partial

import numba
import numpy as np

from .case import Batch, Case, Simulate
from .equations import RULES, Function, Operations, Rule, period_of
from .loop import FloatArray, Loop

LANES = 16

compiled = numba.njit(error_model="numpy", fastmath=True)
parallel = numba.njit(error_model="numpy", fastmath=True, parallel=True)
inlined = numba.njit(error_model="numpy", fastmath=True, inline="always")


@inlined
def below(a: float, b: float) -> float:
    return 1.0 if a < b else 0.0


@inlined
def exp_of_negative(y: float) -> float:
    """exp(y) for y ≤ 0 to 1e-14, without a call: a series for y/64, squared six times."""
    t = max(y, -40.0) * (1.0 / 64.0)
    p = 1.0 + t * (1.0 / 8.0) * (1.0 + t * (1.0 / 9.0))
    p = 1.0 + t * (1.0 / 6.0) * (1.0 + t * (1.0 / 7.0) * p)
    p = 1.0 + t * (1.0 / 4.0) * (1.0 + t * (1.0 / 5.0) * p)
    p = 1.0 + t * (1.0 + t * (1.0 / 2.0) * (1.0 + t * (1.0 / 3.0) * p))
    p = p * p
    p = p * p
    p = p * p
    p = p * p
    p = p * p
    return p * p


SCALARS = Operations(np.exp, abs, min, max, below)
SIDE_BY_SIDE = Operations(exp_of_negative, abs, min, max, below)


def scalar(rule: Rule, loop: Loop, threads: int) -> Simulate:
    """One run after another, or `prange` over them."""
    period, hold = period_of(rule, loop.numbers, SCALARS, inlined), loop.hold_samples

    @compiled
    def run(reference: FloatArray, rate: FloatArray, factors: FloatArray) -> float:
        x = v = z = joint = integral = iae = 0.0
        for i in range(reference.size):
            x, v, z, joint, integral, iae = period(
                x, v, z, joint, integral, iae, reference[i], rate[i], factors[i // hold]
            )
        return iae

    def every(reference: FloatArray, rate: FloatArray, factors: FloatArray) -> FloatArray:
        iae = np.empty(factors.shape[0])
        for k in numba.prange(factors.shape[0]):
            iae[k] = run(reference, rate, factors[k])
        return iae

    numba.set_num_threads(threads)
    runs = compiled(every) if threads == 1 else parallel(every)
    return partial(runs, *loop.reference(), loop.factors())


def lanes(rule: Rule, loop: Loop, threads: int) -> Simulate:
    """Runs side by side, `LANES` at a time; `prange` over such groups."""
    group = group_of(period_of(rule, loop.numbers, SIDE_BY_SIDE, inlined), loop.hold_samples)

    def every(reference: FloatArray, rate: FloatArray, factors: FloatArray) -> FloatArray:
        iae = np.empty((factors.shape[0], LANES))
        for k in numba.prange(factors.shape[0]):
            iae[k] = group(reference, rate, factors[k])
        return iae.ravel()

    numba.set_num_threads(threads)
    runs = compiled(every) if threads == 1 else parallel(every)
    by_group = loop.factors().reshape(-1, LANES, loop.holds).swapaxes(1, 2)
    return partial(runs, *loop.reference(), np.ascontiguousarray(by_group))


def group_of(period: Function, hold: int) -> Function:
    """The loop for as many runs as there are lanes; their factors are over (hold, lane)."""

    @compiled
    def group(reference: FloatArray, rate: FloatArray, factors: FloatArray) -> FloatArray:
        x, v, z = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
        joint, integral, iae = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
        for i in range(reference.size):
            r, dr, h = reference[i], rate[i], i // hold
            for k in range(LANES):
                x[k], v[k], z[k], joint[k], integral[k], iae[k] = period(
                    x[k], v[k], z[k], joint[k], integral[k], iae[k], r, dr, factors[h, k]
                )
        return iae

    return group


def _cases() -> list[Case]:
    rules: list[Rule] = ["rk4", "rk2", "ours"]
    one_by_one = [
        Case(
            name="numba, scalar",
            integrates=RULES[rule],
            settings="fastmath, inlined; all cores: prange",
            prepare=partial(scalar, rule),
            single_s=0.5,
            batch=Batch(runs=64, duration_s=0.5, all_cores="threads"),
            rule=rule,
        )
        for rule in rules
    ]
    side_by_side = [
        Case(
            name="numba, lanes",
            integrates=RULES[rule],
            settings=f"{LANES} runs in the inner loop, polynomial exp; all cores: prange",
            prepare=partial(lanes, rule),
            single_s=None,
            batch=Batch(runs=512, duration_s=0.5, all_cores="threads"),
            rule=rule,
        )
        for rule in rules
    ]
    return one_by_one + side_by_side


CASES = _cases()
