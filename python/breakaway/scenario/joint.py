"""The seized joint."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.scenario.model import Model, NotNegative, Positive


class SeizedJoint(Model):
    """What every friction law has: levels, bristle and length of engagement."""

    stiction_n: Positive
    """F_s0, the force that breaks the joint loose at the seat, in N."""
    coulomb_n: Positive
    """F_c0, the friction force while sliding at the seat, in N."""
    stiffness_n_per_m: Positive
    """k_e, stiffness of the bristles, in N/m."""
    damping_n_s_per_m: NotNegative
    """c, damping of the bristles, in N s/m."""
    engagement_length_m: Positive
    """l_f, travel after which the part is out of its guide, in m."""
    residual_n: Positive | None = None
    """Friction left at the end of the guide, in N. Left out: the weight m g, as in the paper."""


class Lugre(SeizedJoint):
    """LuGre friction with contact loss, equations (1) to (8) of the paper.

    ``dz/dt = v - k_e |v| / g(v, x) z``, ``R = k_e z + c dz/dt + viscous v`` with
    ``g = F_c(x) + (F_s(x) - F_c(x)) exp(-(v/v_s)**2)`` and levels that fall linearly with ``x``.

    Examples
    --------
    >>> Lugre(
    ...     stiction_n=450, coulomb_n=360, stiffness_n_per_m=3.6e7, damping_n_s_per_m=9000,
    ...     stribeck_velocity_m_per_s=0.09, engagement_length_m=0.1,
    ... ).law
    'lugre'

    """

    law: Literal["lugre"] = "lugre"
    """The friction law."""
    viscous_n_s_per_m: NotNegative = 0.0
    """Viscous friction sigma_2, in N s/m."""
    stribeck_velocity_m_per_s: Positive
    """v_s, the velocity over which friction falls from stiction to Coulomb, in m/s."""


class TwoRegion(SeizedJoint):
    """The law that the paper designs its controller with, equation (9).

    Bristle spring and damper until the elastic force passes F_s(x), then F_c(x) until the slip
    stops.
    """

    law: Literal["two_region"] = "two_region"
    """The friction law."""

    @model_validator(mode="after")
    def _breaks_loose(self) -> Self:
        if self.coulomb_n > self.stiction_n:
            raise ValueError(
                f"coulomb_n: {self.coulomb_n!r} is not <= stiction_n = {self.stiction_n!r}; "
                "this law can not slide at a force that does not break it loose"
            )
        return self


Joint = Annotated[Lugre | TwoRegion, Field(discriminator="law")]


class Part(Model):
    """The part that is extracted."""

    mass_kg: Positive
    """m, in kg."""
