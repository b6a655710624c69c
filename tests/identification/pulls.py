"""Pulls to slip from a solver of its own: a machine spring, a mass, and a contact that weakens."""

from pathlib import Path

import numpy as np

from breakaway.measure.logs import Log

RATE_HZ = 2000.0
STEPS = 10


def pulled(
    stiction_n: float,
    coulomb_n: float,
    *,
    stiffness_n_per_m: float = 6e7,
    weakening_m: float = 3e-4,
    machine_n_per_m: float = 5e6,
    mass_kg: float = 2.0,
    speed_m_per_s: float = 2e-3,
    at_drive: bool = False,
    noise_n: float = 4.0,
    noise_m: float = 3e-7,
    seed: int = 0,
) -> Log:
    """Pull a part through a machine spring by semi-implicit Euler steps.

    The contact is a spring in series with a slider, whose level falls with its slip from stiction
    to Coulomb friction along a straight line: none of the laws that the package simulates.
    """
    h = 1.0 / (STEPS * RATE_HZ)
    count = int(1.6 * RATE_HZ)
    x = v = slip = contact = 0.0
    rows = np.empty((count, 3))
    for k in range(count):
        for i in range(STEPS):
            drive = speed_m_per_s * max((k * STEPS + i) * h - 0.3, 0.0)
            force = machine_n_per_m * (drive - x) - 1500.0 * v
            v += h * (force - contact) / mass_kg
            x += h * v
            level = coulomb_n + (stiction_n - coulomb_n) * max(1.0 - slip / weakening_m, 0.0)
            trial = contact + stiffness_n_per_m * h * v
            contact = min(max(trial, -level), level)
            slip += abs(trial - contact) / stiffness_n_per_m
        rows[k] = k / RATE_HZ, x, machine_n_per_m * (drive - x)
    rng = np.random.default_rng(seed)
    t_s, way, load = rows.T
    way = way + load / machine_n_per_m if at_drive else way
    return Log(
        t_s=t_s,
        position_m=way + noise_m * rng.standard_normal(count),
        force_n=load + noise_n * rng.standard_normal(count),
    )


def written(log: Log, path: Path) -> Path:
    """Write a log as CSV."""
    rows = zip(log.t_s, log.position_m, log.force_n, strict=True)
    lines = ["t_s,position_m,force_n", *(",".join(f"{v:.9g}" for v in row) for row in rows)]
    path.write_text("\n".join(lines))
    return path
