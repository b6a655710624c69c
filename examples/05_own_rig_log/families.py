"""Eleven kinds of logs: sound ones that tell more or less, and ones with a fault."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from rig import (
    DURATION_S,
    ROWS_PER_S,
    STEPS_PER_ROW,
    WAVES,
    Array,
    Truth,
    drawn,
    fine_times,
    friction_along,
    recorded,
    two_way,
)

import breakaway as bk
from breakaway.measure.identification.rig_file import RigFile
from friction import LAWS


def heavy(truth: Truth, case: int) -> Truth:
    """Make every other part heavy enough for its inertia to show."""
    rng = np.random.default_rng([20_260_006, case])
    share = float(np.exp(rng.uniform(np.log(0.3), np.log(3.0)))) if case % 2 else 0.0
    fastest = truth.top_speed_m_per_s * 2.0 * np.pi * max(hertz for _, hertz in WAVES)
    return replace(truth, mass_kg=share * truth.coulomb_n / fastest)


def late(truth: Truth, case: int) -> Truth:
    """Delay the position of a part by 1 or 5 ms."""
    return replace(heavy(truth, case), delay_s=5e-3 if case % 2 else 1e-3)


def with_drift(truth: Truth, case: int) -> Truth:
    """Let the force drift by 0.3 of the Coulomb level over the record."""
    return replace(heavy(truth, case), drift_n_per_s=0.3 * truth.coulomb_n / DURATION_S)


def with_warming(truth: Truth, case: int) -> Truth:
    """Let friction fall to 70 % over the record."""
    return replace(heavy(truth, case), warming_per_s=-0.3 / DURATION_S)


def with_play(truth: Truth, case: int) -> Truth:
    """Put a play of 20 um between drive and part."""
    return replace(heavy(truth, case), backlash_m=20e-6)


@dataclass(frozen=True)
class Family:
    """A kind of log; ``fault`` is what a verdict has to name, empty for sound logs."""

    make: Callable[[Truth, int], bk.Log]
    fault: str = ""
    part: Callable[[Truth, int], Truth] = heavy


def along(truth: Truth, x: Array, case: int, warmth: Array | None = None) -> bk.Log:
    """Record a path that is imposed."""
    h = 1.0 / (ROWS_PER_S * STEPS_PER_ROW)
    inertia = truth.mass_kg * np.gradient(np.gradient(x, h), h)
    friction = friction_along(truth, x, h, warmth)
    return recorded(truth, x, friction + inertia + truth.offset_n, case)


def to_and_fro(truth: Truth, case: int) -> bk.Log:
    """Move the part to and fro for four seconds."""
    return along(truth, two_way(truth, fine_times(DURATION_S)), case)


def short(truth: Truth, case: int) -> bk.Log:
    """Move the part to and fro once."""
    return along(truth, two_way(truth, fine_times(1.0)), case)


def one_way(truth: Truth, case: int) -> bk.Log:
    """Pull the part out, from rest, slower and faster; it never comes back."""
    t_s = fine_times(DURATION_S)
    moving = np.clip((t_s - 0.3) / 0.2, 0.0, 1.0)
    swing = 0.52 + 0.3 * np.sin(7.0 * t_s) + 0.18 * np.sin(19.0 * t_s)
    speed = truth.top_speed_m_per_s * swing * moving**2 * (3.0 - 2.0 * moving)
    return along(truth, np.cumsum(speed) * t_s[1], case)


def presliding(truth: Truth, case: int) -> bk.Log:
    """Load the joint to and fro below breakaway."""
    t_s = fine_times(DURATION_S)
    rng = np.random.default_rng([20_260_002, case])
    size = rng.uniform(0.2, 0.5) * truth.deflection_m
    x = 0.7 * np.sin(2.0 * np.pi * 0.7 * t_s) + 0.3 * np.sin(2.0 * np.pi * 1.9 * t_s)
    fine = replace(truth, position_quantum_m=min(truth.position_quantum_m, size / 200.0))
    rise = np.minimum(t_s, 1.0)
    return along(fine, size * x * rise**2 * (3.0 - 2.0 * rise), case)


def slipping(truth: Truth, case: int) -> Truth:
    """Make a part that slips in 4 to 100 ms behind `spring_of`, with a peak that makes it slip."""
    rng = np.random.default_rng([20_260_003, case])
    slip_s = float(np.exp(rng.uniform(np.log(0.004), np.log(0.1))))
    mass = spring_of(truth, case) * (slip_s / np.pi) ** 2
    peaked = replace(truth, mass_kg=mass, stiction_ratio=float(rng.uniform(1.2, 2.0)))
    damper = float(rng.uniform(0.1, 1.0)) * np.sqrt(truth.stiffness_n_per_m * mass)
    slow = 2.0 * drive_speed(peaked, case)
    return replace(peaked, stribeck_velocity_m_per_s=slow, damping_n_s_per_m=damper)


def spring_of(truth: Truth, case: int) -> float:
    """Return the stiffness in N/m of what pulls."""
    rng = np.random.default_rng([20_260_004, case])
    return truth.stiffness_n_per_m / float(rng.uniform(5.0, 50.0))


def drive_speed(truth: Truth, case: int) -> float:
    """Return the speed in m/s of a pull that makes the part slip six times."""
    jump_m = 2.0 * truth.coulomb_n * (truth.stiction_ratio - 1.0) / spring_of(truth, case)
    return 6.0 * jump_m / DURATION_S


def stick_slip(truth: Truth, case: int) -> bk.Log:
    """Pull the part slowly through a spring, so that it sticks and slips."""
    spring, drive = spring_of(truth, case), drive_speed(truth, case)
    natural = np.sqrt((truth.stiffness_n_per_m + spring) / truth.mass_kg)
    steps = max(STEPS_PER_ROW, int(natural / (0.3 * ROWS_PER_S)))
    t_s = fine_times(DURATION_S, steps)
    h = float(t_s[1])
    joint = LAWS[truth.law](truth)
    x = v = friction = 0.0
    path, force = np.zeros_like(t_s), np.zeros_like(t_s)
    for step, t in enumerate(t_s[1:], start=1):
        pull = spring * (drive * t - x)
        v += h * (pull - friction) / truth.mass_kg
        x += h * v
        friction = joint.move(h * v, h)
        path[step], force[step] = x, spring * (drive * t - x)
    fine = replace(truth, position_quantum_m=min(truth.position_quantum_m, np.ptp(path) / 1e4))
    return recorded(fine, path, force + truth.offset_n, case, steps)


def delayed(truth: Truth, case: int) -> bk.Log:
    """Record the position late by 1 to 5 ms."""
    log = to_and_fro(truth, case)
    rows = round(truth.delay_s * ROWS_PER_S)
    late = np.concatenate([np.full(rows, log.position_m[0]), log.position_m[:-rows]])
    return replace(log, position_m=late)


def drifting(truth: Truth, case: int) -> bk.Log:
    """Let the force drift by 0.3 of the Coulomb level."""
    log = to_and_fro(truth, case)
    return replace(log, force_n=log.force_n + truth.drift_n_per_s * log.t_s)


def warming(truth: Truth, case: int) -> bk.Log:
    """Let friction fall to 70 % over the record."""
    t_s = fine_times(DURATION_S)
    return along(truth, two_way(truth, t_s), case, 1.0 + truth.warming_per_s * t_s)


def backlash(truth: Truth, case: int) -> bk.Log:
    """Drive the part through a play of 20 um, and record the position of the drive."""
    h = 1.0 / (ROWS_PER_S * STEPS_PER_ROW)
    drive = two_way(truth, fine_times(DURATION_S))
    joint = LAWS[truth.law](truth)
    force, resisted, ahead = np.zeros_like(drive), 0.0, 0.0
    for step, move in enumerate(np.diff(drive).tolist(), start=1):
        side = 1.0 if ahead == 0.0 else -1.0
        touches = resisted * side > 0.0 and ahead in (0.0, truth.backlash_m)
        gap = ahead - move
        ahead = ahead if touches else min(max(gap, 0.0), truth.backlash_m)
        moves = move if touches else ahead - gap
        resisted = joint.move(moves, h) if moves else 0.0
        if touches and resisted * side < 0.0:
            resisted = 0.0
        force[step] = resisted
    inertia = truth.mass_kg * np.gradient(np.gradient(drive, h), h)
    return recorded(truth, drive, force + inertia + truth.offset_n, case)


def spiked(truth: Truth, case: int) -> bk.Log:
    """Replace the force of three samples by the largest that the load cell gives."""
    log = to_and_fro(truth, case)
    rng = np.random.default_rng([20_260_004, case])
    force = log.force_n.copy()
    force[rng.integers(200, log.rows - 200, 3)] = 5.0 * float(np.max(np.abs(force)))
    return replace(log, force_n=force)


def soft_rig(truth: Truth, case: int) -> bk.Log:
    """Record the position of a drive behind a spring, softer than the joint."""
    log = to_and_fro(truth, case)
    x = log.position_m + log.force_n / rig_stiffness(truth, case)
    return replace(
        log, position_m=np.round(x / truth.position_quantum_m) * truth.position_quantum_m
    )


def rig_stiffness(truth: Truth, case: int) -> float:
    """Return the stiffness in N/m between the part and the sensor of its position."""
    rng = np.random.default_rng([20_260_005, case])
    return truth.stiffness_n_per_m / float(rng.uniform(1.0, 10.0))


def rig_of(family: str, truth: Truth, case: int) -> RigFile:
    """Return what is known of the rig: where its sensor is, or how soft it is."""
    if family == "soft rig":
        return RigFile(stiffness_n_per_m=rig_stiffness(truth, case))
    return RigFile(position_sensor="part")


FAMILIES = {
    "two-way": Family(to_and_fro),
    "one-way": Family(one_way),
    "stick-slip": Family(stick_slip, part=slipping),
    "presliding only": Family(presliding),
    "short": Family(short),
    "delayed": Family(delayed, "delay", late),
    "drifting": Family(drifting, "drift", with_drift),
    "warming": Family(warming, "warming", with_warming),
    "backlash": Family(backlash, "backlash", with_play),
    "spikes": Family(spiked, "spikes"),
    "soft rig": Family(soft_rig),
}


def log_of(family: str, law: str, case: int) -> tuple[Truth, bk.Log]:
    """Draw a rig and give its log."""
    one = FAMILIES[family]
    truth = one.part(drawn(case, law), case)
    return truth, one.make(truth, case)


if __name__ == "__main__":
    for name in FAMILIES:
        truth, log = log_of(name, "lugre", 0)
        print(f"{name}: {log.rows} rows over {log.position_m.max() - log.position_m.min():.2g} m")
