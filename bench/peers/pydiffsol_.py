"""pydiffsol: the loop as a hybrid model in DiffSL, compiled by LLVM, solved by Tsit45.

Settings: time is counted in control periods, since the solver takes 1e-5 s for no time at all.

* A single run is one call: an event stops it at every sample and resets it to the next held force,
  and the random factors are a table in the model. rtol 1e-6, atol 1e-12: looser ones take as long,
  and locate the events so that the IAE is off by more than is allowed here.
* In a batch a table would mean a model for each run. So 64 runs are stacked into one model of
  vectors, and each hold of the factor is one call with the states and factors as its parameters.
  rtol 1e-4, atol 1e-10 are enough. More runs in a model were not faster.

Tried, and slower: ESDIRK34, TR-BDF2 and BDF. On all cores, a process for each core.
"""

from __future__ import annotations

import numpy as np
import pydiffsol as ds

from .case import Batch, Case, Simulate
from .equations import control_of
from .loop import FloatArray, Loop, Numbers

STACKED = 64


def solver(model: str, rtol: float) -> ds.Ode:
    """The compiled model."""
    ode = ds.Ode(model, matrix_type=ds.nalgebra_dense, ode_solver=ds.tsit45)
    ode.rtol, ode.atol, ode.h0 = rtol, 1e-6 * rtol, 1.0
    return ode


def equations(p: Numbers, i: str) -> str:
    """Friction, and what the next sample decides; `i` is the index of vectors over runs."""
    h, length = p.period_s, p.engagement_length_m
    return f"""
    share{i} {{ x{i} / {length!r} }}
    coulomb{i} {{ {p.coulomb_n!r} + {p.residual_n - p.coulomb_n!r} * share{i} }}
    peak{i} {{ {p.stiction_n - p.coulomb_n!r} * (1 - share{i}) }}
    ratio{i} {{ v{i} / {p.stribeck_velocity_m_per_s!r} }}
    level{i} {{ coulomb{i} + peak{i} * exp(-ratio{i} * ratio{i}) }}
    slip{i} {{ v{i} - {p.stiffness_n_per_m!r} * abs(v{i}) / level{i} * z{i} }}
    inside{i} {{ heaviside({length!r} - x{i}) }}
    joint{i} {{ inside{i} * ({p.stiffness_n_per_m!r} * z{i} + {p.damping_n_s_per_m!r} * slip{i}) }}
    push{i} {{ {h / p.mass_kg!r} * (f{i} - n{i} * joint{i}) }}
    tau {{ k * {h / p.motion_s!r} }}
    r {{ {p.distance_m!r} * tau * tau * tau * (10 + tau * (6 * tau - 15)) }}
    rate {{ {30 * p.distance_m / p.motion_s!r} * tau * tau * (1 - tau) * (1 - tau) }}
    e{i} {{ r - x{i} }}
    after{i} {{ a{i} + {p.ki_n_per_m_s * h!r} * e{i} }}
    next{i} {{ {p.kp_n_per_m!r} * e{i} + after{i} + {p.kd_n_s_per_m!r} * (rate - v{i}) }}
    """


def motion(p: Numbers, i: str) -> str:
    """The rates in a period, and the reset at the sample that ends it."""
    h = p.period_s
    return f"""
    F_i {{ {h!r} * v{i}, push{i}, {h!r} * slip{i}, zero{i}, zero{i}, zero{i}, 0 }}
    reset_i {{
        x{i}, v{i}, z{i} * inside{i}, after{i}, next{i}, s{i} + {h!r} * abs(e{i}), k + 1
    }}
    """


def table(values: FloatArray) -> str:
    return ", ".join(map(repr, values.tolist()))


def one(loop: Loop, _threads: int) -> Simulate:
    """The first run in one call; sample 0 finds everything at rest, so it starts at sample 1."""
    factors = np.repeat(loop.factors()[0], loop.hold_samples)
    model = f"""
    in_i {{ unused = 0 }}
    samples_i {{ {table(np.arange(loop.samples + 1.0))} }}
    factors_i {{ {table(np.append(factors, factors[-1]))} }}
    u_i {{ x = 0, v = 0, z = 0, a = 0, f = 0, s = 0, k = 1 }}
    zero {{ 0 }}
    n {{ interp1d(samples_i, factors_i, k - 1) }}
    {equations(loop.numbers, "")}
    {motion(loop.numbers, "")}
    stop {{ k - t }}
    """
    ode = solver(model, rtol=1e-6)
    unused, end = np.zeros(1), loop.samples - 0.5
    return lambda: ode.solve(unused, end).ys[5, -1:]


def stacked_model(p: Numbers) -> str:
    """Some runs side by side from any sample on; their states and factors are parameters."""
    spans = [f"({k * STACKED}:{(k + 1) * STACKED})" for k in range(7)]
    starts = [f"{span}: {name}0 = 0" for span, name in zip(spans, "xvzafsn", strict=True)]
    states = [f"{span}: {name} = {name}0_i" for span, name in zip(spans[:6], "xvzafs", strict=True)]
    return f"""
    in_i {{ {", ".join(starts)}, k0 = 0 }}
    u_i {{ {", ".join(states)}, k = k0 }}
    zero_i {{ (0:{STACKED}): 0 }}
    n_i {{ n0_i }}
    {equations(p, "_i")}
    {motion(p, "_i")}
    stop {{ k - k0 + 1 - t }}
    """


def stacked(loop: Loop, _threads: int) -> Simulate:
    """All runs, so many at a time, a call for each hold."""
    ode, control = solver(stacked_model(loop.numbers), rtol=1e-4), control_of(loop.numbers)
    factors = loop.factors().reshape(-1, STACKED, loop.holds)
    starts = [a[:: loop.hold_samples] for a in loop.reference()]

    def group(factors: FloatArray) -> FloatArray:
        x, v, z, integral, _, iae = np.zeros((6, STACKED))
        for h, (r, dr) in enumerate(zip(*starts, strict=True)):
            # The first sample of a hold is ours, since an event at the start is not seen.
            integral, force = control(r - x, dr - v, integral)
            iae = iae + loop.numbers.period_s * np.abs(r - x)
            first = float(h * loop.hold_samples + 1)
            start = np.concatenate([x, v, z, integral, force, iae, factors[:, h], [first]])
            end = ode.solve(start, float(loop.hold_samples)).ys[: 6 * STACKED, -1]
            x, v, z, integral, _, iae = end.reshape(6, STACKED)
        return iae

    return lambda: np.concatenate([group(share) for share in factors])


CASES = [
    Case(
        name="pydiffsol",
        integrates="Tsit45, rtol 1e-6, batch 1e-4",
        settings=f"hybrid DiffSL model, LLVM; batch: {STACKED} runs in a model, a call per hold",
        prepare=stacked,
        first_run=one,
        single_s=0.1,
        batch=Batch(runs=2 * STACKED, duration_s=0.05, all_cores="processes"),
    )
]
