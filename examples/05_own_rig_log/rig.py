"""A rig that exists in software only: it moves a part whose friction is known, and measures it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import breakaway as bk

Array = NDArray[np.float64]

ROWS_PER_S = 1000.0
DURATION_S = 4.0


@dataclass(frozen=True)
class Truth:
    """A part and its joint, and the sensors that see them."""

    coulomb_n: float
    viscous_n_s_per_m: float
    stiction_ratio: float
    stribeck_velocity_m_per_s: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    offset_n: float
    top_speed_m_per_s: float
    force_noise_n: float
    force_quantum_n: float
    position_quantum_m: float


def drawn(case: int) -> Truth:
    """Draw a rig: levels, stiffness, damping and speeds over four decades."""
    rng = np.random.default_rng([20_260_000, case])

    def decades(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    coulomb = decades(0.1, 1000.0)
    deflection_m = decades(2e-6, 2e-4)
    speed = decades(0.003, 0.3)
    return Truth(
        coulomb_n=coulomb,
        viscous_n_s_per_m=decades(0.01, 1.0) * coulomb / speed,
        stiction_ratio=float(rng.uniform(1.0, 2.0)),
        stribeck_velocity_m_per_s=decades(0.02, 0.2) * speed,
        stiffness_n_per_m=coulomb / deflection_m,
        damping_n_s_per_m=decades(0.003, 0.3) * coulomb / speed,
        offset_n=float(rng.uniform(-0.2, 0.2)) * coulomb,
        top_speed_m_per_s=speed,
        force_noise_n=decades(0.002, 0.02) * coulomb,
        force_quantum_n=decades(0.0005, 0.005) * coulomb,
        position_quantum_m=decades(5e-8, 5e-7),
    )


def motion(truth: Truth, t_s: Array) -> tuple[Array, Array]:
    """Return position and velocity: a sum of waves that starts at rest."""
    top = truth.top_speed_m_per_s
    waves = [(1.00, 1.1), (0.30, 2.9), (0.08, 6.7)]
    weight = sum(share for share, _ in waves)
    x, v = np.zeros_like(t_s), np.zeros_like(t_s)
    for share, hertz in waves:
        omega = 2.0 * np.pi * hertz
        v += top * share / weight * np.sin(omega * t_s)
        x += top * share / weight / omega * (1.0 - np.cos(omega * t_s))
    return x, v


def measured(truth: Truth, case: int) -> bk.Log:
    """Move the part, solve the bristle's equation by SciPy, and record with noise and steps."""
    t_s = np.arange(int(DURATION_S * ROWS_PER_S)) / ROWS_PER_S
    x, v = motion(truth, t_s)

    def level(speed: float | Array) -> float | Array:
        decay = np.exp(-((speed / truth.stribeck_velocity_m_per_s) ** 2))
        return truth.coulomb_n * (1.0 + (truth.stiction_ratio - 1.0) * decay)

    def rate(time: float, z: Array) -> Array:
        speed = float(motion(truth, np.array([time]))[1][0])
        return np.array([speed - truth.stiffness_n_per_m * abs(speed) / level(speed) * z[0]])

    # Steps of at most a row, or the solver leaps over a reversal.
    accuracy = {"rtol": 1e-7, "atol": 1e-13, "max_step": 1.0 / ROWS_PER_S}
    solved = solve_ivp(rate, (0.0, t_s[-1]), [0.0], t_eval=t_s, method="LSODA", **accuracy)
    z = solved.y[0]
    slope = v - truth.stiffness_n_per_m * np.abs(v) / level(v) * z
    force = truth.stiffness_n_per_m * z + truth.damping_n_s_per_m * slope
    force = force + truth.viscous_n_s_per_m * v + truth.offset_n
    rng = np.random.default_rng([20_260_001, case])
    noisy = force + truth.force_noise_n * rng.standard_normal(len(force))
    return bk.Log(
        t_s=t_s,
        position_m=np.round(x / truth.position_quantum_m) * truth.position_quantum_m,
        force_n=np.round(noisy / truth.force_quantum_n) * truth.force_quantum_n,
    )


if __name__ == "__main__":
    log = measured(drawn(0), 0)
    print(f"{log.rows} rows of a rig with {drawn(0)}")
