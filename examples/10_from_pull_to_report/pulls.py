"""Parts are pulled until they slip: the logs are written, and joints identified from them.

The solver is none of the package's: a machine spring, a mass, and a contact that weakens by slip.
"""

from pathlib import Path

import numpy as np

import breakaway as bk

STEPS_PER_S = 20_000
TRUTH_N = {"part_1": (2400.0, 1300.0), "part_2": (3150.0, 1850.0), "part_3": (1900.0, 1150.0)}
"""Part -> its stiction and its Coulomb friction."""


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
    rate_hz: int = 2000,
    seed: int = 0,
) -> bk.Log:
    """Pull a part through a machine spring by semi-implicit Euler steps.

    The contact is a spring in series with a slider, whose level falls with its slip from stiction
    to Coulomb friction along a straight line. The position is that of the part, or ``at_drive``.
    """
    h = 1.0 / STEPS_PER_S
    every = STEPS_PER_S // rate_hz
    count = int(1.6 * rate_hz)
    x = v = slip = contact = 0.0
    rows = np.empty((count, 3))
    for k in range(count):
        for i in range(every):
            drive = speed_m_per_s * max((k * every + i) * h - 0.3, 0.0)
            force = machine_n_per_m * (drive - x) - 1500.0 * v
            v += h * (force - contact) / mass_kg
            x += h * v
            level = coulomb_n + (stiction_n - coulomb_n) * max(1.0 - slip / weakening_m, 0.0)
            trial = contact + stiffness_n_per_m * h * v
            contact = min(max(trial, -level), level)
            slip += abs(trial - contact) / stiffness_n_per_m
        rows[k] = k / rate_hz, x, machine_n_per_m * (drive - x)
    rng = np.random.default_rng(seed)
    t_s, way, load = rows.T
    way = way + load / machine_n_per_m if at_drive else way
    return bk.Log(
        t_s=t_s,
        position_m=way + noise_m * rng.standard_normal(count),
        force_n=load + noise_n * rng.standard_normal(count),
    )


def written(log: bk.Log, path: Path) -> Path:
    """Write a log as CSV."""
    rows = zip(log.t_s, log.position_m, log.force_n, strict=True)
    lines = [f"{t:.6g},{x:.7f},{force:.1f}" for t, x, force in rows]
    path.write_text("\n".join(["t_s,position_m,force_n", *lines, ""]))
    return path


def main() -> None:
    """Write the logs of three parts, and compare what they tell with the truth."""
    for seed, (name, truth) in enumerate(TRUTH_N.items()):
        log = pulled(*truth, rate_hz=500, seed=seed)
        path = written(log, Path(f"{name}.csv"))
        joint = bk.joint_from_pull(bk.read_log(path))
        for figure, true in zip(("stiction_n", "coulomb_n"), truth, strict=True):
            low, high = joint.interval[figure]
            print(f"{path}: {figure} is {low:.0f} to {high:.0f} N; the truth is {true:.0f} N")


if __name__ == "__main__":
    main()
