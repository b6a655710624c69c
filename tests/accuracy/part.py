"""The part of a case and the joint that holds it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, sqrt
from typing import Any

from tests.accuracy.draws import Draws
from tests.accuracy.kinds import Kind


@dataclass(frozen=True)
class Part:
    """What is drawn of a part."""

    mass_kg: float
    stiffness_n_per_m: float
    stiction_n: float
    coulomb_n: float
    damping_ratio: float
    stribeck_velocity_m_per_s: float
    rigid: bool
    guide_m: float = 0.0

    @property
    def held_n_per_m(self) -> float:
        return inf if self.rigid else self.stiffness_n_per_m

    @property
    def presliding_m(self) -> float:
        return self.stiction_n / self.held_n_per_m

    @property
    def fastest_s(self) -> float:
        """What resolves the bristle, in s; a rigid joint has none."""
        return 1.0 if self.rigid else 0.3 * sqrt(self.mass_kg / self.stiffness_n_per_m)

    def with_guide(self, duration_s: float, draws: Draws) -> Part:
        """A guide that a part which breaks loose halfway can leave in time."""
        spare_n = 1.3 * self.stiction_n - self.coulomb_n
        reach_m = 0.5 * spare_n / self.mass_kg * (0.4 * duration_s) ** 2
        wanted_m = reach_m * draws.log_uniform(0.02, 0.7)
        shortest_m = max(20 * self.presliding_m, 2e-5)
        return replace(self, guide_m=max(shortest_m, min(wanted_m, 0.3)))


def draw_part(kind: Kind, draws: Draws) -> Part:
    stiffness = draws.log_uniform(1e3, 1e9)
    stiction = draws.log_uniform(max(1.0, 2e-7 * stiffness), min(3e4, 1e-2 * stiffness))
    return Part(
        mass_kg=draws.log_uniform(1e-3, 1e3),
        stiffness_n_per_m=stiffness,
        stiction_n=stiction,
        coulomb_n=stiction / draws.log_uniform(1.05, 3.0),
        damping_ratio=draws.log_uniform(0.05, 1.5),
        stribeck_velocity_m_per_s=draws.log_uniform(1e-4, 0.1),
        rigid=kind.law == "coulomb_stiction",
    )


def joint_table(kind: Kind, part: Part, draws: Draws) -> dict[str, Any]:
    """The joint as a scenario has it."""
    table: dict[str, Any] = {
        "law": kind.law,
        "stiction_n": part.stiction_n,
        "coulomb_n": part.coulomb_n,
        "engagement_length_m": part.guide_m,
        "residual_n": part.coulomb_n * draws.uniform(0.05, 1.0),
    }
    if draws.chance(0.2):
        table["backward_ratio"] = draws.log_uniform(0.5, 2.0)
    if not part.rigid:
        table |= _bristle(part)
    if kind.law != "two_region":
        table |= _stribeck(part, draws)
    if kind.law == "elasto_plastic":
        table["elastic_share"] = draws.uniform(0.1, 0.95)
    if kind.law == "gms":
        table["elements"] = draws.one_of((4, 6, 10))
        table["attraction_n_per_s"] = part.stiction_n / draws.log_uniform(1e-4, 1e-2)
    return table


def _bristle(part: Part) -> dict[str, Any]:
    critical = 2.0 * sqrt(part.stiffness_n_per_m * part.mass_kg)
    return {
        "stiffness_n_per_m": part.stiffness_n_per_m,
        "damping_n_s_per_m": part.damping_ratio * critical,
    }


def _stribeck(part: Part, draws: Draws) -> dict[str, Any]:
    table = {"stribeck_velocity_m_per_s": part.stribeck_velocity_m_per_s}
    if draws.chance(0.3):
        table["viscous_n_s_per_m"] = part.coulomb_n * draws.log_uniform(0.01, 1.0)
    if not part.rigid and draws.chance(0.5):
        falls = part.stribeck_velocity_m_per_s * draws.log_uniform(1.0, 30.0)
        table["damping_velocity_m_per_s"] = falls
    return table
