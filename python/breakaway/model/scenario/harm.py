"""What a part, and what stays behind, may suffer: forces as stresses, travel as scratches."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.errors import ScenarioError
from breakaway.model.scenario.magnitudes import Length, Speed
from breakaway.model.scenario.model import Model, Name, Positive, Text


class Material(Model):
    """Strengths of a material, as a standard or a data sheet gives them.

    Examples
    --------
    >>> material("inconel_718").yield_pa > 1e9
    True

    """

    description: Text
    """What it is, and in which condition."""
    yield_pa: Positive
    """Least yield strength, in Pa."""
    fatigue_pa: Positive | None = None
    """Stress amplitude or largest stress that is borne for good, in Pa. Left out: not known."""
    basis: Text = ""
    """What the fatigue figure is of."""
    temperature_degc: float = 20.0
    """At which temperature."""
    source: Text
    """Where the figures are from."""


@cache
def materials() -> dict[str, Material]:
    """Give the materials that are known by name."""
    text = (files("breakaway.model.presets.tables") / "materials.toml").read_text(encoding="utf-8")
    return {name: Material.parse(values) for name, values in tomllib.loads(text).items()}


def material(name: str) -> Material:
    """Give a material by its name.

    Raises
    ------
    ScenarioError
        There is none of this name.

    """
    found = materials().get(name)
    if found is None:
        raise ScenarioError(
            f"material: {name!r} is not one of {', '.join(materials())}; give one, or the stress "
            "that is allowed (allowed_pa)"
        )
    return found


class StressLimit(Model):
    """A place that the pulling force stresses, and what it bears.

    The stress is F / section_m2, F / bearing_area_m2 or F times stress_per_newton_pa (from a finite
    element model of yours); it is allowed up to share times the strength.
    """

    place: Name
    """Which place, such as "neck of the root"."""
    of: Literal["part", "host"] = "part"
    """Whether it is of the part, or of the disk or shaft that stays."""
    section_m2: Positive | None = None
    """Area in tension or compression, in m^2."""
    bearing_area_m2: Positive | None = None
    """Area that the force presses on, in m^2."""
    stress_per_newton_pa: Positive | None = None
    """Largest stress at the place for each newton, in Pa."""
    material: Name | None = None
    """A material by name."""
    strength: Literal["yield", "fatigue"] = "yield"
    """Which of its strengths counts."""
    allowed_pa: Positive | None = None
    """The stress that is allowed, in Pa, in place of a material."""
    share: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    """Share of the strength that is allowed."""

    @model_validator(mode="after")
    def _is_stated_once(self) -> Self:
        ways = ("section_m2", "bearing_area_m2", "stress_per_newton_pa")
        if sum(getattr(self, way) is not None for way in ways) != 1:
            raise ValueError(f"{self.place}: give exactly one of {', '.join(ways)}")
        if (self.material is None) == (self.allowed_pa is None):
            raise ValueError(f"{self.place}: give either material or allowed_pa")
        if self.material is not None:
            try:
                found = material(self.material)
            except ScenarioError as error:
                raise ValueError(f"{self.place}: {error}") from None
            if self.strength == "fatigue" and found.fatigue_pa is None:
                raise ValueError(
                    f"{self.place}: no fatigue strength of {self.material!r} is known; give "
                    "allowed_pa"
                )
        return self

    @property
    def strength_pa(self) -> float:
        """The stress that is allowed, in Pa."""
        if self.allowed_pa is not None:
            return self.share * self.allowed_pa
        found = material(self.material or "")
        value = found.yield_pa if self.strength == "yield" else found.fatigue_pa
        return self.share * (value or 0.0)

    @property
    def pascals_per_newton(self) -> float:
        """Stress for each newton, in Pa."""
        area = self.section_m2 or self.bearing_area_m2
        return 1.0 / area if area is not None else self.stress_per_newton_pa or 0.0

    @property
    def force_max_n(self) -> float:
        """The force at which the stress is the allowed one, in N."""
        return self.strength_pa / self.pascals_per_newton


class HarmLimits(Model):
    """What a part and its host may suffer as the part is freed.

    Examples
    --------
    >>> neck = StressLimit(place="neck", section_m2=1e-4, allowed_pa=2e8, share=0.5)
    >>> HarmLimits(stresses=[neck]).force_max_n
    10000.0

    """

    name: Name = "limits"
    """What they are of."""
    stresses: list[StressLimit] = Field(default_factory=list)
    """Places that the force stresses; the weakest counts."""
    jump_max_m: Length | None = None
    """Largest uncontrolled travel in one slip, in m: it scratches part and slot. Left out: any."""
    release_velocity_max_m_per_s: Speed | None = None
    """Largest velocity at release, in m/s: the part is thrown. Left out: any."""

    @model_validator(mode="after")
    def _limits_something(self) -> Self:
        if not self.stresses and self.jump_max_m is None and not self.release_velocity_max_m_per_s:
            raise ValueError(
                "stresses: nothing is limited; give a [[stresses]], jump_max_m or "
                "release_velocity_max_m_per_s"
            )
        return self

    @property
    def weakest(self) -> StressLimit | None:
        """The place that bears the least force; None where no place is stated."""
        return min(self.stresses, key=lambda one: one.force_max_n, default=None)

    @property
    def force_max_n(self) -> float:
        """The force that every place bears, in N; infinite where no place is stated."""
        return min((one.force_max_n for one in self.stresses), default=float("inf"))
