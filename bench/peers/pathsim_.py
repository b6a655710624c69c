"""PathSim: an `ODE` block for the plant and a sampled `Wrapper` block for the PID.

Settings: fixed steps of one control period with explicit solvers. SSPRK22 is the cheapest within
the tolerance; RK4 is here too, because we have it as well. Tried, and slower: RKBS32, RKDP54, and
by far the implicit ESDIRK32. A single run has its rates in plain floats. A batch has one block for
all plants and one for all controllers, with a port for each signal of each run, since what PathSim
takes is mostly Python calls per block.

On all cores, a process for each core.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from pathsim import Connection, Simulation
from pathsim.blocks import ODE, Wrapper
from pathsim.solvers import RK4, SSPRK22

from .case import Batch, Case, Simulate
from .equations import ARRAYS, FLOATS, RULES, Function, Rule, control_of, rates_of
from .loop import FloatArray, Loop


class SampledPid:
    """From (x, v) to (F, n) of all runs, called once a period."""

    def __init__(self, loop: Loop) -> None:
        self.control = control_of(loop.numbers)
        self.period_s, self.hold = loop.numbers.period_s, loop.hold_samples
        self.reference, self.rate = (a.tolist() for a in loop.reference())
        self.factors = loop.factors().T.copy()
        self.count = len(loop.runs)
        self.sample = 0
        self.integral = self.iae = np.zeros(self.count)

    def __call__(self, *measured: float) -> FloatArray:
        i, self.sample = self.sample, self.sample + 1
        if i == len(self.reference):  # the sample at the end of the run, which counts no more
            return np.zeros(2 * self.count)
        x, v = np.array(measured).reshape(2, -1)
        error = self.reference[i] - x
        self.integral, force = self.control(error, self.rate[i] - v, self.integral)
        self.iae = self.iae + self.period_s * np.abs(error)
        return np.concatenate((force, self.factors[i // self.hold]))


def plant_rates(loop: Loop) -> Function:
    """The rates of all runs, in floats where there is one."""
    p, count = loop.numbers, len(loop.runs)
    if count == 1:
        rates = rates_of(p, FLOATS)
        return lambda y, held, _: np.array(rates(*y.tolist(), *held.tolist()))
    rates = rates_of(p, ARRAYS)
    return lambda y, held, _: np.concatenate(rates(*y.reshape(3, count), *held.reshape(2, count)))


def prepare(solver: type, loop: Loop, _threads: int) -> Simulate:
    """All runs, stacked."""
    ports = slice(0, 2 * len(loop.runs))
    rates, period_s = plant_rates(loop), loop.numbers.period_s

    def simulate() -> FloatArray:
        pid = SampledPid(loop)
        plant, controller = ODE(rates, np.zeros(3 * len(loop.runs))), Wrapper(pid, period_s)
        wires = [
            Connection(plant[ports], controller[ports]),
            Connection(controller[ports], plant[ports]),
        ]
        simulation = Simulation([plant, controller], wires, dt=period_s, Solver=solver, log=False)
        simulation.run((loop.samples - 0.5) * period_s, adaptive=False)
        return pid.iae

    return simulate


def _case(solver: type, integrates: str, rule: Rule | None) -> Case:
    return Case(
        name="PathSim",
        integrates=integrates,
        settings="ODE block and sampled Wrapper block; batch: ports for all runs",
        prepare=partial(prepare, solver),
        single_s=0.05,
        batch=Batch(runs=1024, duration_s=0.01, all_cores="processes"),
        rule=rule,
    )


CASES = [_case(SSPRK22, "SSPRK22, 1 step", None), _case(RK4, RULES["rk4"], "rk4")]
