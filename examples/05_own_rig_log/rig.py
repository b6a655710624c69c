"""A rig that exists in software only: it moves a part whose friction is known, and measures it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import breakaway as bk
from friction import LAWS, Levels

Array = NDArray[np.float64]

ROWS_PER_S = 1000.0
DURATION_S = 4.0
STEPS_PER_ROW = 8


@dataclass(frozen=True)
class Truth(Levels):
    """A part and its joint, and the sensors that see them."""

    offset_n: float
    top_speed_m_per_s: float
    force_noise_n: float
    force_quantum_n: float
    position_quantum_m: float
    mass_kg: float = 0.0
    law: str = "lugre"
    delay_s: float = 0.0
    drift_n_per_s: float = 0.0
    warming_per_s: float = 0.0
    backlash_m: float = 0.0

    @property
    def stiction_n(self) -> float:
        """F_s."""
        return self.coulomb_n * self.stiction_ratio

    @property
    def coulomb_plus_offset_n(self) -> float:
        """What a pull at low friction shows."""
        return self.coulomb_n + self.offset_n

    @property
    def stiction_plus_offset_n(self) -> float:
        """What a pull shows at breakaway."""
        return self.stiction_n + self.offset_n

    def above_coulomb_n(self, speed_m_per_s: float) -> float:
        """Return by how much sliding friction is above the Coulomb level at a speed."""
        peak = (self.stiction_ratio - 1.0) * np.exp(
            -((speed_m_per_s / self.stribeck_velocity_m_per_s) ** 2)
        )
        if self.law == "two_regions":  # slides at the Coulomb level at any speed
            peak = 0.0
        return float(self.coulomb_n * peak + self.viscous_n_s_per_m * speed_m_per_s)

    @property
    def deflection_m(self) -> float:
        """The deflection at which the joint slides."""
        return self.coulomb_n / self.stiffness_n_per_m


def drawn(case: int, law: str = "lugre") -> Truth:
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
        law=law,
    )


WAVES = ((1.00, 1.1), (0.30, 2.9), (0.08, 6.7))
"""Share and frequency in Hz of the waves that make a motion."""


def two_way(truth: Truth, t_s: Array) -> Array:
    """Return the position of a sum of waves that starts at rest."""
    weight = sum(share for share, _ in WAVES)
    x = np.zeros_like(t_s)
    for share, hertz in WAVES:
        omega = 2.0 * np.pi * hertz
        x += truth.top_speed_m_per_s * share / weight / omega * (1.0 - np.cos(omega * t_s))
    return x


def fine_times(duration_s: float, steps: int = STEPS_PER_ROW) -> Array:
    """Return the times of the steps that a rig is solved at."""
    return np.arange(int(duration_s * ROWS_PER_S) * steps) / (ROWS_PER_S * steps)


def friction_along(truth: Truth, x: Array, h: float, warmth: Array | None = None) -> Array:
    """Return the friction force along a path in steps of h seconds."""
    joint = LAWS[truth.law](truth)
    factors = np.ones_like(x) if warmth is None else warmth
    force = np.zeros_like(x)
    for step, (dx, factor) in enumerate(zip(np.diff(x), factors[1:], strict=True), start=1):
        force[step] = joint.move(float(dx), h, float(factor)) if dx else force[step - 1]
    return force


def recorded(truth: Truth, x: Array, force: Array, case: int, steps: int = STEPS_PER_ROW) -> bk.Log:
    """Keep a row of every few steps, with noise and quantization."""
    rng = np.random.default_rng([20_260_001, case])
    x, force = x[::steps], force[::steps]
    noisy = force + truth.force_noise_n * rng.standard_normal(len(force))
    return bk.Log(
        t_s=np.arange(len(x)) / ROWS_PER_S,
        position_m=np.round(x / truth.position_quantum_m) * truth.position_quantum_m,
        force_n=np.round(noisy / truth.force_quantum_n) * truth.force_quantum_n,
    )


def measured(truth: Truth, case: int) -> bk.Log:
    """Move the part to and fro, and record."""
    t_s = fine_times(DURATION_S)
    h = float(t_s[1])
    x = two_way(truth, t_s)
    inertia = truth.mass_kg * np.gradient(np.gradient(x, h), h)
    return recorded(truth, x, friction_along(truth, x, h) + inertia + truth.offset_n, case)


if __name__ == "__main__":
    log = measured(drawn(0), 0)
    print(f"{log.rows} rows of a rig with {drawn(0)}")
