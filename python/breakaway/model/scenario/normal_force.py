"""The force across a joint: what its friction levels are proportional to, and what shakes it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from breakaway.model.scenario.magnitudes import (
    DurationOrZero,
    Force,
    ForceOrZero,
    Frequency,
    LengthOrZero,
    Stiffness,
)
from breakaway.model.scenario.model import Model

POINTS_MAX = 8
"""The most points of a course: as many as the core has room for."""
STEPS_PER_CYCLE = 20
"""Fewest integration steps in a cycle of vibration."""

Points = Annotated[tuple[float, ...], Field(strict=False, max_length=POINTS_MAX)]
"""Numbers of a course; TOML has lists, which a strict tuple would refuse."""
Factors = Annotated[
    tuple[Annotated[float, Field(gt=0.0, le=1e3)], ...],
    Field(strict=False, max_length=POINTS_MAX),
]
Times = Annotated[tuple[DurationOrZero, ...], Field(strict=False, max_length=POINTS_MAX)]
Forces = Annotated[tuple[ForceOrZero, ...], Field(strict=False, max_length=POINTS_MAX)]


class NormalVibration(Model):
    """Vibration normal to the joint: N + k a sin(2 pi (f t + phase)), k the contact's stiffness."""

    amplitude_m: LengthOrZero
    """How far the bodies approach and part, from their mean, in m."""
    stiffness_n_per_m: Stiffness
    """Stiffness of the contact normal to the joint, in N/m."""
    frequency_hz: Frequency
    """Frequency, in Hz; a cycle takes 20 integration steps or more."""
    phase_turns: float = 0.0
    """Phase at the start, in turns."""


class TransverseVibration(Model):
    """Vibration in the joint's plane, across the motion: y = a sin(2 pi (f t + phase)).

    Friction opposes the velocity as a vector, so less of it is left along the motion. For laws with
    a bristle in the plane: lugre and elasto_plastic.
    """

    amplitude_m: LengthOrZero
    """How far the part is moved across, from its mean, in m."""
    frequency_hz: Frequency
    """Frequency, in Hz; a cycle takes 20 integration steps or more."""
    phase_turns: float = 0.0
    """Phase at the start, in turns."""


def _check_course(
    name: str, at: Sequence[float], values_name: str, values: Sequence[float]
) -> None:
    """Refuse places that do not rise, or of which there are not as many as values."""
    if not at:
        raise ValueError(f"{name}: [] has no number; give one for each point")
    if len(at) != len(values):
        raise ValueError(
            f"{values_name}: {list(values)!r} has not as many numbers as {name} = {list(at)!r}; "
            "give one for each point"
        )
    if any(later <= earlier for earlier, later in pairwise(at)):
        raise ValueError(
            f"{name}: {list(at)!r} does not rise; give each point after the one before"
        )


def core_course(
    over: Literal["time", "travel"], at: Sequence[float], values: Sequence[float]
) -> dict[str, Any]:
    """Give a course under the names of the core, which has room for a fixed number of points."""
    rest = POINTS_MAX - len(at)
    return {
        "over": over,
        "points": len(at),
        "at": [*at, *[at[-1]] * rest],
        "values": [*values, *[values[-1]] * rest],
    }


class DriftOverTime(Model):
    """A factor on the friction levels that changes slowly during a pull: heat, dirt, a lubricant.

    Straight lines between points; before the first and after the last it stays.

    Examples
    --------
    >>> DriftOverTime(time_s=[0.0, 10.0], factor=[1.0, 0.8]).factor
    (1.0, 0.8)

    """

    kind: Literal["over_time"] = "over_time"
    """What the factor follows."""
    time_s: Times
    """Times of its points since the start, rising, in s."""
    factor: Factors
    """The factor at each point."""

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        _check_course("time_s", self.time_s, "factor", self.factor)
        return self

    def core(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return core_course("time", self.time_s, self.factor)


class DriftOverTravel(Model):
    """A factor on the friction levels that changes with the way: wear, a bore that widens.

    Straight lines between points; before the first and after the last it stays.

    Examples
    --------
    >>> DriftOverTravel(travel_m=[0.0, 0.1], factor=[1.0, 0.8]).kind
    'over_travel'

    """

    kind: Literal["over_travel"] = "over_travel"
    """What the factor follows."""
    travel_m: Points
    """Places of its points, the part's travel from its seat, rising, in m."""
    factor: Factors
    """The factor at each point."""

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        _check_course("travel_m", self.travel_m, "factor", self.factor)
        return self

    def core(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return core_course("travel", self.travel_m, self.factor)


Drift = Annotated[DriftOverTime | DriftOverTravel, Field(discriminator="kind")]
"""A drift, whatever it follows."""


class _NormalForce(Model):
    """What every source of a normal force has."""

    nominal_n: Force | None = None
    """Normal force at which the joint's levels hold, in N: a level over it is a coefficient of
    friction. Left out: the force at the start, without vibration."""
    vibration: NormalVibration | None = None
    """Vibration normal to the joint. Left out: none."""
    transverse: TransverseVibration | None = None
    """Vibration in the joint's plane, across the motion. Left out: none."""


class ConstantNormalForce(_NormalForce):
    """A normal force that stays: a preload.

    Examples
    --------
    >>> ConstantNormalForce(force_n=2000.0).start_n()
    2000.0

    """

    kind: Literal["constant"] = "constant"
    """Where the force comes from."""
    force_n: Force
    """N, in N."""

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return {"constant_n": self.force_n, "course_gain": 0.0, "course": None}

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return self.force_n


class NormalForceOverTime(_NormalForce):
    """A normal force that follows the time, along straight lines between points.

    Examples
    --------
    >>> NormalForceOverTime(time_s=[0.0, 2.0], force_n=[2000.0, 500.0]).start_n()
    2000.0

    """

    kind: Literal["over_time"] = "over_time"
    """Where the force comes from."""
    time_s: Times
    """Times of its points since the start, rising, in s."""
    force_n: Forces
    """N at each point, in N."""

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        _check_course("time_s", self.time_s, "force_n", self.force_n)
        return self

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        course = core_course("time", self.time_s, self.force_n)
        return {"constant_n": 0.0, "course_gain": 1.0, "course": course}

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return _along(self.time_s, self.force_n)


class NormalForceOverTravel(_NormalForce):
    """A normal force that follows the way, along straight lines between points.

    Examples
    --------
    >>> NormalForceOverTravel(travel_m=[0.0, 0.1], force_n=[2000.0, 500.0]).start_n()
    2000.0

    """

    kind: Literal["over_travel"] = "over_travel"
    """Where the force comes from."""
    travel_m: Points
    """Places of its points, the part's travel from its seat, rising, in m."""
    force_n: Forces
    """N at each point, in N."""

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        _check_course("travel_m", self.travel_m, "force_n", self.force_n)
        return self

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        course = core_course("travel", self.travel_m, self.force_n)
        return {"constant_n": 0.0, "course_gain": 1.0, "course": course}

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return _along(self.travel_m, self.force_n)


class SpringNormalForce(_NormalForce):
    """Springs that clamp the part and relax as it moves: ``N = preload - stiffness slope x``.

    Examples
    --------
    >>> SpringNormalForce(preload_n=900.0, stiffness_n_per_m=1e5, slope=0.02).kind
    'springs'

    """

    kind: Literal["springs"] = "springs"
    """Where the force comes from."""
    preload_n: Force
    """N at the seat, in N."""
    stiffness_n_per_m: Stiffness
    """Stiffness of the springs, in N/m."""
    slope: float
    """How far the springs relax for each meter of travel, such as the slope of a taper; below 0
    they tighten."""

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return {
            "constant_n": self.preload_n,
            "course_gain": -self.stiffness_n_per_m * self.slope,
            "course": core_course("travel", [0.0, 1e3], [0.0, 1e3]),
        }

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return self.preload_n


class InterferenceNormalForce(_NormalForce):
    """A press fit: ``N = pressure area``.

    The levels fall along the guide as the engaged area does, by equations (5) and (6); that is not
    said here again.

    Examples
    --------
    >>> InterferenceNormalForce(pressure_pa=2e6, area_m2=1e-3).start_n()
    2000.0

    """

    kind: Literal["interference"] = "interference"
    """Where the force comes from."""
    pressure_pa: Annotated[float, Field(gt=0.0, le=1e12)]
    """Pressure in the fit, in Pa."""
    area_m2: Annotated[float, Field(gt=0.0, le=1e6)]
    """Area of the whole fit, in m^2."""

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return {"constant_n": self.pressure_pa * self.area_m2, "course_gain": 0.0, "course": None}

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return self.pressure_pa * self.area_m2


class TemperatureNormalForce(_NormalForce):
    """A fit that is heated or cooled: ``N = preload + expansion dT(t)``.

    Examples
    --------
    >>> TemperatureNormalForce(
    ...     preload_n=2000.0, expansion_n_per_k=-10.0, time_s=[0.0, 5.0], change_k=[0.0, 60.0]
    ... ).start_n()
    2000.0

    """

    kind: Literal["temperature"] = "temperature"
    """Where the force comes from."""
    preload_n: Force
    """N where the temperature has not changed, in N."""
    expansion_n_per_k: float
    """Change of N with the temperature, in N/K; below 0 where heat loosens the fit."""
    time_s: Times
    """Times of the points since the start, rising, in s."""
    change_k: Points
    """Change of temperature at each point, in K; straight lines between them."""

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        _check_course("time_s", self.time_s, "change_k", self.change_k)
        return self

    def core_source(self) -> dict[str, Any]:
        """Give it under the names of the core."""
        return {
            "constant_n": self.preload_n,
            "course_gain": self.expansion_n_per_k,
            "course": core_course("time", self.time_s, self.change_k),
        }

    def start_n(self) -> float:
        """Give the force at the start, in N."""
        return self.preload_n + self.expansion_n_per_k * _along(self.time_s, self.change_k)


def _along(at: Sequence[float], values: Sequence[float]) -> float:
    """Give a course at the start."""
    return float(np.interp(0.0, at, values))


NormalForce = Annotated[
    ConstantNormalForce
    | NormalForceOverTime
    | NormalForceOverTravel
    | SpringNormalForce
    | InterferenceNormalForce
    | TemperatureNormalForce,
    Field(discriminator="kind"),
]
"""A normal force, wherever it comes from."""
