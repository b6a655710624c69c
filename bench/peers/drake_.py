"""Drake: a diagram of plant, sampled PID, reference and random factor, in a `Simulator`.

Settings: no Python in the loop. The plant is a `SymbolicVectorSystem`, the PID a discrete
`LinearSystem` whose state is (I, F, n), the reference a polynomial `TrajectorySource`, the factor a
zero-order-hold one that switches half a period early, so that rounding cannot hide a switch from
the sample it is for. The position at the samples is logged, and the IAE summed from the log.
`runge_kutta2` at one step a period is the cheapest integrator within the tolerance. Tried, and
slower: runge_kutta3, runge_kutta5, and by far radau3 and implicit_euler; plant and PID as Python
systems. (Reference and |e| cannot be `SymbolicVectorSystem`s too: one without continuous state
refuses to be in a diagram that has some.) Past the end of the guide R is 0, but z is left.

Run after run; on all cores, a process for each core.
"""

from __future__ import annotations

import numpy as np
from pydrake.polynomial import Polynomial
from pydrake.symbolic import Variable, if_then_else
from pydrake.symbolic import abs as absolute
from pydrake.symbolic import exp as exponential
from pydrake.symbolic import max as maximum
from pydrake.symbolic import min as minimum
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem
from pydrake.systems.primitives import (
    LinearSystem,
    LogVectorOutput,
    Multiplexer,
    SymbolicVectorSystem,
    TrajectorySource,
)
from pydrake.trajectories import PiecewisePolynomial

from .case import Case, Simulate
from .equations import Operations, rates_of
from .loop import HOLD_S, FloatArray, Loop, Numbers

EXPRESSIONS = Operations(
    exponential, absolute, minimum, maximum, lambda a, b: if_then_else(a < b, 1.0, 0.0)
)


def plant(p: Numbers) -> LeafSystem:
    """From (F, n) to (x, v)."""
    x, v, z, force, factor = (Variable(name) for name in ("x", "v", "z", "force", "factor"))
    rates = rates_of(p, EXPRESSIONS)(x, v, z, force, factor)
    return SymbolicVectorSystem(
        state=[x, v, z], input=[force, factor], dynamics=list(rates), output=[x, v]
    )


def pid(p: Numbers) -> LeafSystem:
    """From (r, dr/dt, x, v, n) to (F, n), held."""
    kp, ki_period, kd = p.kp_n_per_m, p.ki_n_per_m_s * p.period_s, p.kd_n_s_per_m
    error, error_rate = np.array([1, 0, -1, 0, 0]), np.array([0, 1, 0, -1, 0])
    force = (kp + ki_period) * error + kd * error_rate
    inputs = np.array([ki_period * error, force, [0, 0, 0, 0, 1]])
    state = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    return LinearSystem(state, inputs, np.eye(3)[1:], np.zeros((2, 5)), p.period_s)


def reference(p: Numbers) -> LeafSystem:
    """r and dr/dt."""
    scale = p.distance_m / p.motion_s ** np.arange(6)
    motion = Polynomial(scale * np.array([0.0, 0.0, 0.0, 10.0, -15.0, 6.0]))
    path = PiecewisePolynomial([np.array([[motion]], dtype=object)], [0.0, p.motion_s])
    return TrajectorySource(path, output_derivative_order=1)


def factor(loop: Loop) -> LeafSystem:
    """n of the first run."""
    held = loop.factors()[0]
    switches_s = np.arange(loop.holds + 1) * HOLD_S - 0.5 * loop.numbers.period_s
    path = PiecewisePolynomial.ZeroOrderHold(switches_s, np.append(held, held[-1])[None, :])
    return TrajectorySource(path)


def prepare(loop: Loop, _threads: int) -> Simulate:
    """The first run."""
    p, builder = loop.numbers, DiagramBuilder()
    systems = [reference(p), plant(p), factor(loop), Multiplexer([2, 2, 1]), pid(p)]
    source, part, draws, sensors, controller = (builder.AddSystem(s) for s in systems)
    for k, system in enumerate((source, part, draws)):
        builder.Connect(system.get_output_port(), sensors.get_input_port(k))
    builder.Connect(sensors.get_output_port(), controller.get_input_port())
    builder.Connect(controller.get_output_port(), part.get_input_port())
    log = LogVectorOutput(part.get_output_port(), builder, p.period_s)
    diagram = builder.Build()
    reference_m = loop.reference()[0]

    def simulate() -> FloatArray:
        simulator = Simulator(diagram)
        ResetIntegratorFromFlags(simulator, "runge_kutta2", p.period_s)
        simulator.Initialize()
        simulator.AdvanceTo((loop.samples - 0.5) * p.period_s)
        position_m = log.FindLog(simulator.get_context()).data()[0, : loop.samples]
        return np.array([np.abs(reference_m - position_m).sum() * p.period_s])

    return simulate


CASES = [
    Case(
        name="Drake",
        integrates="runge_kutta2, 1 step",
        settings="symbolic plant, LinearSystem PID, logged; run after run",
        prepare=prepare,
        single_s=0.5,
    )
]
