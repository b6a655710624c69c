"""Where the part should be, from the seat (0) to a distance."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.model.scenario.magnitudes import (
    Acceleration,
    Duration,
    DurationOrZero,
    Length,
    Speed,
)
from breakaway.model.scenario.model import Model


class ReferenceMotion(Model):
    """What every reference has."""

    distance_m: Length
    """Distance to go, in m. Usually the engagement length of the joint."""
    start_s: DurationOrZero = 0.0
    """Start of the motion, in s."""


class StepReference(ReferenceMotion):
    """A jump to the distance."""

    kind: Literal["step"] = "step"
    """The kind of reference."""


class RampReference(ReferenceMotion):
    """Constant speed."""

    kind: Literal["ramp"] = "ramp"
    """The kind of reference."""
    duration_s: Duration
    """Duration of the motion, in s."""


class MinimumJerk(ReferenceMotion):
    """``r = d (10 tau**3 - 15 tau**4 + 6 tau**5)`` with ``tau = (t - start) / duration``."""

    kind: Literal["minimum_jerk"] = "minimum_jerk"
    """The kind of reference."""
    duration_s: Duration
    """Duration of the motion, in s."""


class TrapezoidalVelocity(ReferenceMotion):
    """Accelerate, cruise, decelerate."""

    kind: Literal["trapezoidal_velocity"] = "trapezoidal_velocity"
    """The kind of reference."""
    velocity_m_per_s: Speed
    """Cruising velocity, in m/s."""
    acceleration_m_per_s2: Acceleration
    """Acceleration and deceleration, in m/s^2."""

    @model_validator(mode="after")
    def _reaches_its_velocity(self) -> Self:
        v, a, d = self.velocity_m_per_s, self.acceleration_m_per_s2, self.distance_m
        if v * v > a * d:
            raise ValueError(
                f"velocity_m_per_s: {v!r} is not reached within distance_m = {d!r} at "
                f"acceleration_m_per_s2 = {a!r}; give a velocity <= {(a * d) ** 0.5:.6g}"
            )
        return self


Reference = Annotated[
    StepReference | RampReference | MinimumJerk | TrapezoidalVelocity,
    Field(discriminator="kind"),
]
