"""SciPy: `scipy.integrate.ode("dopri5")`, restarted at every control period.

Settings: first step one control period; rtol 1e-4, atol 1e-11, with which it takes that one step in
nearly every period. Of all SciPy offers this restarts the fastest: it is compiled and calls Python
only for the rates. Tried, and slower: every method of `solve_ivp`, by far Radau and BDF. `odeint`
and the multistep methods of `ode` take as long, but restart at low order, and their IAE is off by
more than the tolerance. Within one control period the joint is not stiff, so implicit methods gain
nothing.

A single run has its rates in plain floats, which is faster than arrays of length one; a batch
stacks all runs in one state vector and shares the steps. On all cores, a process for each core.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import ode

from .case import Batch, Case, Simulate
from .equations import ARRAYS, FLOATS, Function, control_of, rates_of
from .loop import FloatArray, Loop

RTOL, ATOL = 1e-4, 1e-11


def solver(rates: Function, period_s: float) -> ode:
    """The solver, with the held force and factor as parameters."""
    return ode(rates).set_integrator("dopri5", rtol=RTOL, atol=ATOL, first_step=period_s)


def one(loop: Loop, _threads: int) -> Simulate:
    """The first run alone, in floats."""
    p = loop.numbers
    rates, control = rates_of(p, FLOATS), control_of(p)
    reference, rate = (a.tolist() for a in loop.reference())
    factors = np.repeat(loop.factors()[0], loop.hold_samples).tolist()

    def simulate() -> FloatArray:
        plant = solver(lambda _, y, *held: rates(*y.tolist(), *held), p.period_s)
        x = v = z = integral = iae = 0.0
        for r, dr, factor in zip(reference, rate, factors, strict=True):
            integral, force = control(r - x, dr - v, integral)
            iae += abs(r - x) * p.period_s
            plant.set_f_params(force, factor).set_initial_value((x, v, z), 0.0)
            x, v, z = plant.integrate(p.period_s).tolist()
            z *= x < p.engagement_length_m
        return np.array([iae])

    return simulate


def stacked(loop: Loop, _threads: int) -> Simulate:
    """All runs in one state vector."""
    p = loop.numbers
    rates, control = rates_of(p, ARRAYS), control_of(p)
    reference, rate = loop.reference()
    factors = loop.factors().T.copy()

    def simulate() -> FloatArray:
        plant = solver(
            lambda _, y, *held: np.concatenate(rates(*y.reshape(3, -1), *held)), p.period_s
        )
        (x, v, z), integral, iae = np.zeros((3, len(loop.runs))), 0.0, 0.0
        for i, (r, dr) in enumerate(zip(reference, rate, strict=True)):
            integral, force = control(r - x, dr - v, integral)
            iae = iae + np.abs(r - x) * p.period_s
            plant.set_f_params(force, factors[i // loop.hold_samples])
            plant.set_initial_value(np.concatenate((x, v, z)), 0.0)
            x, v, z = plant.integrate(p.period_s).reshape(3, -1)
            z = z * (x < p.engagement_length_m)
        return np.asarray(iae)

    return simulate


CASES = [
    Case(
        name="SciPy",
        integrates="ode('dopri5'), rtol 1e-4",
        settings="restarted at every period; batch: one stacked state vector",
        prepare=stacked,
        first_run=one,
        single_s=0.5,
        batch=Batch(runs=1024, duration_s=0.02, all_cores="processes"),
    )
]
