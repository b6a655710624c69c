"""Friction laws that can be identified: which numbers of a rig they free, and which they fix."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from breakaway._core import RIG_NUMBERS
from breakaway.errors import LogError
from breakaway.measure.logs.log import Array
from breakaway.model.scenario.laws import LAW_WORDS

LawName = Literal["coulomb", "stribeck", "lugre", "elasto_plastic"]
LAWS: tuple[LawName, ...] = ("coulomb", "stribeck", "lugre", "elasto_plastic")
"""Coulomb and viscous friction; with a Stribeck term; with a bristle; with an elastic range."""

LABELS: Mapping[LawName, str] = {
    "coulomb": "Coulomb",
    "stribeck": "Stribeck",
    "lugre": LAW_WORDS["lugre"],
    "elasto_plastic": LAW_WORDS["elasto_plastic"],
}

SHARED = RIG_NUMBERS[:-1]
"""Numbers of the core that all repeats share; the last, the offset, may differ between them."""


@dataclass(frozen=True)
class Parameter:
    """One number that is identified.

    ``numbers`` are the numbers of the core that it sets; one parameter may set several, as where
    friction is equal in both directions. A positive parameter is fitted as its logarithm; one that
    may be 0 (``low`` is 0) as it is, or it would be stuck there.
    """

    name: str
    numbers: tuple[str, ...]
    positive: bool
    low: float
    high: float

    @property
    def may_vanish(self) -> bool:
        """Whether it is at least 0, and may be 0."""
        return self.low == 0.0

    def internal(self, value: float) -> float:
        """Return the number that the optimizer sees."""
        return float(np.log(value)) if self.positive else value

    def external(self, internal: Array) -> Array:
        """Return values from what the optimizer sees."""
        return np.exp(internal) if self.positive else internal


@dataclass(frozen=True)
class Law:
    """A law, with its options."""

    name: LawName
    asymmetric: bool = False
    position_dependent: bool = False

    @property
    def elasto_plastic(self) -> bool:
        """Whether its bristle has an elastic range."""
        return self.name == "elasto_plastic"

    @property
    def has_bristle(self) -> bool:
        """Whether its bristle's stiffness is a parameter, or only a stiff stand-in for rest."""
        return self.name in ("lugre", "elasto_plastic")

    @property
    def label(self) -> str:
        """The law in words, for tables and figures."""
        words = [LABELS[self.name]]
        words += ["each direction"] * self.asymmetric + ["position"] * self.position_dependent
        return ", ".join(words)

    def parameters(self, offsets: int) -> tuple[Parameter, ...]:
        """Return what can be fitted, with ``offsets`` offsets, one for all or one per repeat.

        Where friction has levels of its own in each direction, they hold a constant offset: the
        first repeat's offset is then 0, and the others count from it.
        """
        wide = (1e-9, 1e9)
        out = [Parameter("mass_kg", ("mass_kg",), True, *wide)]
        out += self._sides("coulomb", "n", positive=True)
        out += self._sides("viscous", "n_s_per_m", positive=False)
        if self.name != "coulomb":
            out.append(Parameter("stiction_ratio", ("stiction_ratio",), True, 0.1, 20.0))
            speed = "stribeck_velocity_m_per_s"
            out.append(Parameter(speed, (speed,), True, *wide))
        if self.has_bristle:
            out.append(Parameter("stiffness_n_per_m", ("stiffness_n_per_m",), True, *wide))
            out.append(Parameter("damping_n_s_per_m", ("damping_n_s_per_m",), False, 0.0, 1e9))
        if self.elasto_plastic:
            out.append(Parameter("elastic_share", ("elastic_share",), True, 0.02, 0.98))
        if self.position_dependent:
            for name in ("coulomb_slope_n_per_m", "spring_n_per_m"):
                out.append(Parameter(name, (name,), False, -1e9, 1e9))
        return (*out, *self._offsets(offsets))

    def _sides(self, quantity: str, unit: str, *, positive: bool) -> list[Parameter]:
        low = 1e-9 if positive else 0.0
        sides = tuple(f"{quantity}_{side}_{unit}" for side in ("positive", "negative"))
        if self.asymmetric:
            return [Parameter(side, (side,), positive, low, 1e9) for side in sides]
        return [Parameter(f"{quantity}_{unit}", sides, positive, low, 1e9)]

    def _offsets(self, offsets: int) -> list[Parameter]:
        if offsets == 1:
            places = [("offset_n", 0)]
        else:
            places = [(f"offset_{repeat + 1}_n", repeat) for repeat in range(offsets)]
        held = places[1:] if self.asymmetric else places
        return [Parameter(name, (f"offset {place}",), False, -1e9, 1e9) for name, place in held]


NEUTRAL: Mapping[str, float] = {
    "mass_kg": 0.0,
    "spring_n_per_m": 0.0,
    "viscous_positive_n_s_per_m": 0.0,
    "viscous_negative_n_s_per_m": 0.0,
    "stiction_ratio": 1.0,
    "stribeck_velocity_m_per_s": 1.0,
    "damping_n_s_per_m": 0.0,
    "coulomb_slope_n_per_m": 0.0,
    "elastic_share": 0.0,
    "drift_n_per_s": 0.0,
    "warming_per_s": 0.0,
    "backlash_m": 0.0,
}
"""Values of numbers that a law leaves out."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Where parameters go among the numbers of the core, for a record of several segments.

    ``variable`` says of each number which free parameter it is, if any. ``held_delay_s`` is the
    delay of the position where it is not free: it is no number of the core.
    """

    free: tuple[Parameter, ...]
    base: Array
    variable: tuple[int | None, ...]
    held_delay_s: float

    @classmethod
    def of(
        cls,
        parameters: tuple[Parameter, ...],
        fixed: Mapping[str, float],
        offset_of_segment: tuple[int, ...],
    ) -> Layout:
        """Lay out ``parameters``; those in ``fixed``, by name, keep still."""
        names = [*SHARED, *(f"offset {offset}" for offset in offset_of_segment)]
        base = np.zeros(len(names))
        variable: list[int | None] = [None] * len(names)
        for place, name in enumerate(names):
            base[place] = fixed.get(name, NEUTRAL.get(name, 0.0))
        free = tuple(one for one in parameters if one.name not in fixed)
        for parameter in parameters:
            for place, name in enumerate(names):
                if name in parameter.numbers:
                    if parameter.name in fixed:
                        base[place] = fixed[parameter.name]
                    else:
                        variable[place] = free.index(parameter)
        return cls(free, base, tuple(variable), fixed.get("delay_s", 0.0))

    @property
    def delay_place(self) -> int | None:
        """Which free parameter the delay of the position is, if it is one."""
        return next((i for i, one in enumerate(self.free) if one.name == "delay_s"), None)

    def delay_s(self, internal: Array) -> float:
        """Return the delay of the position in s."""
        place = self.delay_place
        return self.held_delay_s if place is None else float(internal[place])

    def numbers(self, internal: Array) -> Array:
        """Return the core's numbers for one set of parameters (n,), or for many (k, n)."""
        values = np.empty_like(internal)
        for i, parameter in enumerate(self.free):
            values[..., i] = parameter.external(internal[..., i])
        out = np.broadcast_to(self.base, (*internal.shape[:-1], len(self.base))).copy()
        for place, variable in enumerate(self.variable):
            if variable is not None:
                out[..., place] = values[..., variable]
        return out

    def values(self, internal: Array) -> dict[str, float]:
        """Return the free parameters by name."""
        return {
            parameter.name: float(parameter.external(internal[i]))
            for i, parameter in enumerate(self.free)
        }

    def slope(self, internal: Array) -> Array:
        """Return d value / d internal of each free parameter."""
        out = np.ones(len(self.free))
        for i, parameter in enumerate(self.free):
            if parameter.positive:
                out[i] = np.exp(internal[i])
        return out


def check_law(law: str, asymmetric: bool, position_dependent: bool) -> Law:
    """Return the law of this name.

    Raises
    ------
    LogError
        There is no such law.

    """
    for name in LAWS:
        if name == law:
            return Law(name, asymmetric, position_dependent)
    raise LogError(f"law: {law!r} is not one of {', '.join(LAWS)}")
