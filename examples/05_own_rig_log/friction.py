"""Four friction laws, solved in closed form over each short step; none is this project's code."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

PIECES_PER_DEFLECTION = 10
"""Pieces of a step in which the part moves by the deflection at which it slides."""

SATURATED = 4.0
"""A step that moves the part by so many deflections ends in sliding, however it began."""


@dataclass(frozen=True)
class Levels:
    """What the four laws have in common: their steady curve, spring and damper."""

    coulomb_n: float
    viscous_n_s_per_m: float
    stiction_ratio: float
    stribeck_velocity_m_per_s: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float

    def at(self, v: float) -> float:
        """Return the level of sliding friction in N at a speed."""
        decay = math.exp(-min((v / self.stribeck_velocity_m_per_s) ** 2, 700.0))
        return self.coulomb_n * (1.0 + (self.stiction_ratio - 1.0) * decay)


class Friction(Protocol):
    """A law with its state."""

    def move(self, dx: float, h: float, warmth: float = 1.0) -> float:
        """Move the part by dx meters in h seconds; return the friction force in N after it.

        ``warmth`` is a factor on the levels.
        """
        ...


@dataclass
class Lugre:
    """LuGre (Canudas de Wit et al., IEEE TAC 40(3), 1995)."""

    levels: Levels
    z: float = 0.0

    def move(self, dx: float, h: float, warmth: float = 1.0) -> float:
        """Move the part."""
        one, v = self.levels, dx / h
        level = warmth * one.at(v)
        self.stretch(dx, level)
        slip = self.slips(level, v)
        slope = v - slip * one.stiffness_n_per_m * abs(v) / level * self.z
        bristle = one.stiffness_n_per_m * self.z + one.damping_n_s_per_m * slope
        return bristle + one.viscous_n_s_per_m * v

    def slips(self, level: float, v: float) -> float:
        """Return the share of the motion that slips."""
        del level, v
        return 1.0

    def stretch(self, dx: float, level: float) -> None:
        """Move the end of the bristle."""
        turns = abs(dx) * self.levels.stiffness_n_per_m / level
        steady = math.copysign(level / self.levels.stiffness_n_per_m, dx)
        self.z = steady + (self.z - steady) * math.exp(-turns)


@dataclass
class ElastoPlastic(Lugre):
    """Elasto-plastic (Dupont et al., IEEE TAC 47(5), 2002): LuGre with an elastic range."""

    elastic_share: float = 0.6

    def slips(self, level: float, v: float) -> float:
        """Return the share of the motion that slips: none within the elastic range."""
        if self.z * v <= 0.0:
            return 0.0
        load = abs(self.z) * self.levels.stiffness_n_per_m / level
        s = min(max((load - self.elastic_share) / (1.0 - self.elastic_share), 0.0), 1.0)
        return 0.5 - 0.5 * math.cos(math.pi * s)

    def stretch(self, dx: float, level: float) -> None:
        """Move the end of the bristle, in pieces over which the share that slips is constant."""
        turns = abs(dx) * self.levels.stiffness_n_per_m / level
        end = level / self.levels.stiffness_n_per_m
        if turns > SATURATED:
            self.z = math.copysign(end, dx)
            return
        count = math.ceil(PIECES_PER_DEFLECTION * turns)
        for _ in range(count):
            slip = self.slips(level, dx)
            self.z += dx / count - slip * turns / count * self.z
            self.z = min(max(self.z, -end), end)


@dataclass
class MaxwellSlip:
    """Eight springs in parallel that each slide at a share of the level (Iwan, 1966)."""

    levels: Levels
    force_n: np.ndarray = field(default_factory=lambda: np.zeros(8))

    def move(self, dx: float, h: float, warmth: float = 1.0) -> float:
        """Move the part."""
        one, v = self.levels, dx / h
        shares = np.linspace(0.3, 1.7, len(self.force_n)) / len(self.force_n)
        limits = warmth * one.at(v) * shares
        before = self.force_n
        loaded = before + one.stiffness_n_per_m / len(before) * dx
        self.force_n = np.clip(loaded, -limits, limits)
        sticking = float(np.mean(np.abs(loaded) < limits))
        damper = one.damping_n_s_per_m * sticking * v
        return float(self.force_n.sum()) + damper + one.viscous_n_s_per_m * v


@dataclass
class TwoRegions:
    """A spring and a damper up to the stiction force, then the Coulomb level until a turn."""

    levels: Levels
    force_n: float = 0.0
    sliding: float = 0.0

    def move(self, dx: float, h: float, warmth: float = 1.0) -> float:
        """Move the part."""
        one, v = self.levels, dx / h
        coulomb = warmth * one.coulomb_n
        if self.sliding * dx < 0.0:
            self.sliding = 0.0
        if not self.sliding:
            self.force_n += one.stiffness_n_per_m * dx
            if abs(self.force_n) > coulomb * one.stiction_ratio:
                self.sliding = math.copysign(1.0, dx)
        if self.sliding:
            self.force_n = self.sliding * coulomb
        damper = 0.0 if self.sliding else one.damping_n_s_per_m * v
        return self.force_n + damper + one.viscous_n_s_per_m * v


LAWS = {
    "lugre": Lugre,
    "elasto_plastic": ElastoPlastic,
    "maxwell_slip": MaxwellSlip,
    "two_regions": TwoRegions,
}


if __name__ == "__main__":
    joint = Levels(
        coulomb_n=10.0,
        viscous_n_s_per_m=0.0,
        stiction_ratio=1.5,
        stribeck_velocity_m_per_s=0.01,
        stiffness_n_per_m=1e6,
        damping_n_s_per_m=0.0,
    )
    for name, law in LAWS.items():
        moved = law(joint)
        largest_n = max(moved.move(1e-7, 1e-3) for _ in range(1000))
        print(f"{name}: breaks loose at {largest_n:.3g} N of 15 N, pulled at 0.1 mm/s")
