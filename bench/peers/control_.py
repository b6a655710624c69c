"""python-control: `input_output_response` of a nonlinear system (`nlsys`).

It has no systems that are both sampled and continuous, so there are two ways, and both are here.

* sampled: the closed loop as one discrete-time system whose update is a control period, plant and
  all, with Runge-Kutta 4 written out. As fast as python-control gets; plant and controller as two
  systems under `interconnect` are several times slower. A batch has vectors for signals.
* continuous: the plant as a continuous system, and a response for each control period, integrated
  by `solve_ivp` with RK23 (rtol 1e-4, atol 1e-11, first step one period), which is faster than RK45
  and LSODA. Run after run.

On all cores, a process for each core.
"""

from __future__ import annotations

import control as ct
import numpy as np

from .case import Batch, Case, Simulate
from .equations import (
    ARRAYS,
    FLOATS,
    RULES,
    control_of,
    period_of,
    rates_of,
)
from .loop import FloatArray, Loop


def sampled(loop: Loop, _threads: int) -> Simulate:
    """The closed loop as one discrete-time system, with one or many runs as its signals."""
    p, count = loop.numbers, len(loop.runs)
    period = period_of("rk4", p, FLOATS if count == 1 else ARRAYS)

    def update(_: float, state: FloatArray, inputs: FloatArray, __: dict) -> FloatArray:
        reference, rate, *factors = inputs.tolist()
        if count == 1:
            return np.array(period(*state.tolist(), reference, rate, *factors))
        return np.concatenate(period(*state.reshape(6, count), reference, rate, inputs[2:]))

    # The state holds the IAE, and is given out one sample late: hence the sample more below.
    loop_system = ct.nlsys(
        update,
        lambda _, state, *__: state[-count:],
        inputs=2 + count,
        outputs=count,
        states=6 * count,
        dt=p.period_s,
    )
    held = np.repeat(loop.factors(), loop.hold_samples, axis=1)
    inputs = np.vstack([*loop.reference(), held])
    inputs = np.hstack([inputs, inputs[:, -1:]])
    time_s = np.arange(loop.samples + 1) * p.period_s

    def simulate() -> FloatArray:
        response = ct.input_output_response(loop_system, time_s, inputs)
        return np.atleast_2d(response.outputs)[:, -1]

    return simulate


def continuous(loop: Loop, _threads: int) -> Simulate:
    """The first run, a response for each control period."""
    p = loop.numbers
    rates, control = rates_of(p, FLOATS), control_of(p)
    plant = ct.nlsys(
        lambda _, y, held, __: np.array(rates(*y.tolist(), *held.tolist())),
        None,
        inputs=2,
        outputs=3,
        states=3,
    )
    reference, rate = loop.reference()
    factors = np.repeat(loop.factors()[0], loop.hold_samples)
    times_s = [0.0, p.period_s]
    settings = {"rtol": 1e-4, "atol": 1e-11, "first_step": p.period_s}
    solve_ivp = {"solve_ivp_method": "RK23", "solve_ivp_kwargs": settings}

    def simulate() -> FloatArray:
        (x, v, z), integral, iae = (0.0, 0.0, 0.0), 0.0, 0.0
        for r, dr, factor in zip(reference, rate, factors, strict=True):
            integral, force = control(r - x, dr - v, integral)
            iae += abs(r - x) * p.period_s
            held = np.array([[force, force], [factor, factor]])
            response = ct.input_output_response(plant, times_s, held, [x, v, z], **solve_ivp)
            x, v, z = response.states[:, -1]
            z *= x < p.engagement_length_m
        return np.array([iae])

    return simulate


CASES = [
    Case(
        name="python-control, sampled",
        integrates=RULES["rk4"],
        settings="closed loop as one discrete-time nlsys; batch: vectors for signals",
        prepare=sampled,
        single_s=0.05,
        batch=Batch(runs=1024, duration_s=0.01, all_cores="processes"),
        rule="rk4",
    ),
    Case(
        name="python-control, continuous",
        integrates="solve_ivp RK23, rtol 1e-4",
        settings="input_output_response for every period; run after run",
        prepare=continuous,
        single_s=0.02,
    ),
]
