"""The loop that every peer simulates: its numbers, its random factors, and our answer to it.

    m dv/dt = F − n R,   dx/dt = v,   dz/dt = v − k_e |v| z / g,   R = k_e z + c dz/dt
    g = F_c(x) + (F_s(x) − F_c(x)) exp(−(v/v_s)²),   R = 0 and z = 0 for x ≥ l_f

sampled every T_s with F held, and n = 1 + var·w held over ten periods:

    e = r − x,   I ← I + ki e T_s,   F = kp e + I + kd (dr/dt − v),   IAE = Σ |e| T_s

The numbers are those of the preset `paper_as_computed` and of the gains that `breakaway` designs
for it; the draws w are those of `breakaway`, run by run.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

import breakaway as bk

FloatArray = npt.NDArray[np.float64]
WordArray = npt.NDArray[np.uint64]

VAR = 0.1
HOLD_S = 1e-4
SEED = 0
ORACLE_STEPS = 100
"""Runge-Kutta steps in a control period of the checking run, 1e-7 s each."""


class Numbers(NamedTuple):
    """Plant, controller and reference."""

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    stiction_n: float
    coulomb_n: float
    residual_n: float
    stribeck_velocity_m_per_s: float
    engagement_length_m: float
    kp_n_per_m: float
    ki_n_per_m_s: float
    kd_n_s_per_m: float
    period_s: float
    distance_m: float
    motion_s: float


def scenario(duration_s: float, **changes: object) -> bk.Scenario:
    """The disturbed loop, shortened but with the same reference, without a trace."""
    disturbed = {"disturbance.var": VAR, "disturbance.hold_s": HOLD_S}
    shortened = {"timing.duration_s": duration_s, "trace.every_samples": 0}
    preset = bk.load_scenario("paper_as_computed")
    return preset.with_({**disturbed, **shortened, "seed": SEED, **changes})


def numbers() -> Numbers:
    """Every number of the loop, from the resolved preset."""
    resolved = bk.resolve(scenario(HOLD_S))
    match resolved.joint, resolved.controller, resolved.reference:
        case (
            bk.Lugre(viscous_n_s_per_m=0.0, residual_n=float(residual_n)) as joint,
            bk.Pid(gains=bk.Gains() as gains),
            bk.MinimumJerk(start_s=0.0) as motion,
        ):
            pass
        case other:
            raise ValueError(f"the peers have no such joint, controller or reference: {other}")
    return Numbers(
        mass_kg=resolved.part.mass_kg,
        stiffness_n_per_m=joint.stiffness_n_per_m,
        damping_n_s_per_m=joint.damping_n_s_per_m,
        stiction_n=joint.stiction_n,
        coulomb_n=joint.coulomb_n,
        residual_n=residual_n,
        stribeck_velocity_m_per_s=joint.stribeck_velocity_m_per_s,
        engagement_length_m=joint.engagement_length_m,
        kp_n_per_m=gains.kp_n_per_m,
        ki_n_per_m_s=gains.ki_n_per_m_s,
        kd_n_s_per_m=gains.kd_n_s_per_m,
        period_s=resolved.timing.control_period_s,
        distance_m=motion.distance_m,
        motion_s=motion.duration_s,
    )


def philox4x32(counter: list[WordArray], key: tuple[int, int]) -> list[WordArray]:
    """Philox4x32-10 (Salmon et al., SC 2011) of four counter words and two key words."""
    low, half = np.uint64(0xFFFF_FFFF), np.uint64(32)
    c0, c1, c2, c3 = counter
    for turn in range(10):
        k0 = np.uint64((key[0] + turn * 0x9E37_79B9) & 0xFFFF_FFFF)
        k1 = np.uint64((key[1] + turn * 0xBB67_AE85) & 0xFFFF_FFFF)
        p0, p1 = c0 * np.uint64(0xD251_1F53), c2 * np.uint64(0xCD9E_8D57)
        c0, c1, c2, c3 = (p1 >> half) ^ c1 ^ k0, p1 & low, (p0 >> half) ^ c3 ^ k1, p0 & low
    return [c0, c1, c2, c3]


def uniform(runs: npt.ArrayLike, draws: int, seed: int = SEED) -> FloatArray:
    """Our first draws on [-1, 1) of some runs: an array over (run, number of the draw)."""
    run = np.asarray(runs, dtype=np.uint64)[:, None]
    index = np.arange(draws, dtype=np.uint64)[None, :]
    low = np.uint64(0xFFFF_FFFF)
    zero = np.zeros((run.size, draws), dtype=np.uint64)
    counter = [zero + index, zero, zero + (run & low), zero + (run >> np.uint64(32))]
    words = philox4x32(counter, (seed & 0xFFFF_FFFF, seed >> 32))
    bits = ((words[1] << np.uint64(32)) | words[0]) >> np.uint64(11)
    return np.asarray(bits * 2.0**-52 - 1.0, dtype=np.float64)


@dataclass(frozen=True)
class Loop:
    """What is simulated: some runs over some time, a whole number of holds."""

    numbers: Numbers
    runs: tuple[int, ...]
    duration_s: float

    @property
    def samples(self) -> int:
        """Control samples of a run."""
        return self.holds * self.hold_samples

    @property
    def holds(self) -> int:
        """Times that the random factor is held in a run."""
        return round(self.duration_s / HOLD_S)

    @property
    def hold_samples(self) -> int:
        """Control samples that share a random factor."""
        return round(HOLD_S / self.numbers.period_s)

    def reference(self) -> tuple[FloatArray, FloatArray]:
        """Minimum jerk: r in m and dr/dt in m/s at every sample."""
        distance_m, motion_s = self.numbers.distance_m, self.numbers.motion_s
        tau = np.arange(self.samples) * self.numbers.period_s / motion_s
        position = tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)
        rate = 30.0 * tau**2 * (1.0 - tau) ** 2
        return distance_m * position, distance_m / motion_s * rate

    def factors(self) -> FloatArray:
        """The factor n on the joint force: an array over (run, hold)."""
        return 1.0 + VAR * uniform(self.runs, self.holds)

    def shared_out(self, parts: int) -> list[Loop]:
        """The same runs in as many loops, in order."""
        shares = np.array_split(np.array(self.runs), parts)
        return [replace(self, runs=tuple(share.tolist())) for share in shares]


def oracle_iae_m_s(duration_s: float, run: int) -> float:
    """IAE of a run by our Runge-Kutta integrator at 1e-7 s."""
    fine = {"timing.integrator": "rk4", "timing.steps_per_period": ORACLE_STEPS}
    return bk.simulate(scenario(duration_s, **fine), run_index=run).metrics.iae_m_s
