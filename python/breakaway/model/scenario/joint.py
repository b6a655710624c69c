"""The seized joint."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from breakaway.model.scenario.magnitudes import (
    Damping,
    Force,
    ForceRate,
    Length,
    Mass,
    Speed,
    Stiffness,
)
from breakaway.model.scenario.model import Model, Positive
from breakaway.model.scenario.normal_force import Drift, NormalForce

ELEMENTS_MAX = 10
"""The most elements of a Maxwell-slip joint: as many as the core has room for."""

Shares = Annotated[tuple[Positive, ...], Field(strict=False)]
"""Shares of elements; TOML has lists, which a strict tuple would refuse."""


class _Levels(Model):
    """The friction levels at the seat."""

    stiction_n: Force
    """F_s0, the force that breaks the joint loose at the seat, in N."""
    coulomb_n: Force
    """F_c0, the friction force while sliding at the seat, in N."""


class _Bristle(Model):
    """What a stuck joint yields by."""

    one_bristle: ClassVar[bool] = True
    """Whether the joint yields by one bristle, which is all that Runge-Kutta steps."""
    stiffness_n_per_m: Stiffness
    """k_e, stiffness of the bristles, in N/m."""
    damping_n_s_per_m: Damping
    """c, damping of the bristles, in N s/m."""


class _Varying(Model):
    """How friction varies with the time, the way and the normal force: the same for all laws."""

    in_plane: ClassVar[bool] = False
    """Whether the law says what vibration across the motion does."""
    drift: Drift | None = None
    """A factor on all friction levels that changes during a pull. Left out: 1."""
    normal_force: NormalForce | None = None
    """The force across the joint, which all friction levels are proportional to. Left out: it is
    constant, and the levels are what they are."""


class _Guide(Model):
    """How the levels change along the guide and with the direction."""

    engagement_length_m: Length
    """l_f, travel after which the part is out of its guide, in m."""
    residual_n: Force | None = None
    """Friction left at the end of the guide, in N. Left out: the weight m g, as in the paper."""
    backward_ratio: Annotated[float, Field(gt=0.0, le=1e3)] | None = None
    """Factor on all friction levels for backward motion. Left out: 1."""


# Fields come in the reverse order of the bases.
class SeizedJoint(_Varying, _Guide, _Bristle, _Levels):
    """What every friction law with a bristle has: levels, bristle and length of engagement."""


class StribeckJoint(SeizedJoint):
    """What the laws have whose friction falls with speed: LuGre and its relatives."""

    viscous_n_s_per_m: Damping = 0.0
    """Viscous friction sigma_2, in N s/m."""
    stribeck_velocity_m_per_s: Speed
    """v_s, the velocity over which friction falls from stiction to Coulomb, in m/s."""
    damping_velocity_m_per_s: Speed | None = None
    """v_d, in m/s: damping of the bristles falls with speed as exp(-(v/v_d)**2). Left out: it is
    constant, and at speeds beyond 4 g / c a bristle may push the part."""


class Lugre(StribeckJoint):
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

    in_plane: ClassVar[bool] = True
    law: Literal["lugre"] = "lugre"
    """The friction law."""


class ElastoPlastic(StribeckJoint):
    """LuGre whose bristle is elastic at first, so that weak vibration moves nothing permanently.

    ``dz/dt = v - alpha(z, v) k_e |v| / g(v, x) z``: alpha is 0 while the bristle is unloaded or
    carries less than ``elastic_share`` of g, and rises smoothly to 1 at g (Dupont, Hayward,
    Armstrong and Altpeter, IEEE TAC 47(5), 2002). Between ``elastic_share`` of breakaway and
    breakaway it drifts under vibration too, if less than LuGre.

    Examples
    --------
    >>> ElastoPlastic(
    ...     stiction_n=450, coulomb_n=360, stiffness_n_per_m=3.6e7, damping_n_s_per_m=9000,
    ...     stribeck_velocity_m_per_s=0.09, elastic_share=0.9, engagement_length_m=0.1,
    ... ).law
    'elasto_plastic'

    """

    in_plane: ClassVar[bool] = True
    law: Literal["elasto_plastic"] = "elasto_plastic"
    """The friction law."""
    elastic_share: Annotated[float, Field(ge=0.0, lt=1.0)]
    """Share of the friction level up to which the bristle is elastic."""


class Gms(StribeckJoint):
    """Generalized Maxwell-slip: springs side by side that let go one after another.

    An element sticks, ``dz_i/dt = v``, until it carries its share of g(v, x); then it slips and
    its force follows ``d(k_i z_i)/dt = C (share_i sgn v - k_i z_i / g)`` until the motion turns
    (Al-Bender, Lampaert and Swevers, IEEE TAC 50(11), 2005; but an element never loads faster than
    the part moves). Below breakaway it does not drift. By default all elements are equally stiff
    and their yield deflections rise linearly, to ``2 n / (n + 1)`` times F_s/k_e.

    Examples
    --------
    >>> Gms(
    ...     stiction_n=450, coulomb_n=360, stiffness_n_per_m=3.6e7, damping_n_s_per_m=9000,
    ...     stribeck_velocity_m_per_s=0.09, attraction_n_per_s=1e6, engagement_length_m=0.1,
    ... ).elements
    6

    """

    one_bristle: ClassVar[bool] = False
    law: Literal["gms"] = "gms"
    """The friction law."""
    elements: Annotated[int, Field(ge=4, le=ELEMENTS_MAX)] = 6
    """Number of elements."""
    attraction_n_per_s: ForceRate
    """C, in N/s: the force of a slipping element follows its level with the time constant g / C."""
    stiffness_shares: Shares | None = None
    """Share of each element in stiffness and damping; they add up to 1. Left out: equal."""
    level_shares: Shares | None = None
    """Share of each element in the friction level; they add up to 1. Left out: 1, 2, ... n in
    proportion."""

    @model_validator(mode="after")
    def _shares_add_up(self) -> Self:
        for name in ("stiffness_shares", "level_shares"):
            shares = getattr(self, name)
            if shares is None:
                continue
            if len(shares) != self.elements or abs(sum(shares) - 1.0) > 1e-9:
                raise ValueError(
                    f"{name}: {list(shares)!r} is not {self.elements!r} shares (elements) that add "
                    f"up to 1; give {self.elements!r} numbers > 0 with the sum 1, or leave it out"
                )
        return self

    def all_shares(self) -> tuple[list[float], list[float]]:
        """Give the shares of all elements in stiffness and level, with 0 for those not there.

        Examples
        --------
        >>> joint = Gms(
        ...     stiction_n=450, coulomb_n=360, stiffness_n_per_m=3.6e7, damping_n_s_per_m=9000,
        ...     stribeck_velocity_m_per_s=0.09, attraction_n_per_s=1e6, engagement_length_m=0.1,
        ...     elements=4,
        ... )
        >>> joint.all_shares()[1]
        [0.1, 0.2, 0.3, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]

        """
        n = self.elements
        stiffness = self.stiffness_shares or [1.0 / n] * n
        level = self.level_shares or [2.0 * (i + 1) / (n * (n + 1.0)) for i in range(n)]
        rest = [0.0] * (ELEMENTS_MAX - n)
        return [*stiffness, *rest], [*level, *rest]


class TwoRegion(SeizedJoint):
    """The law that the paper designs its controller with, equation (9).

    Bristle spring and damper until the elastic force passes F_s(x), then F_c(x) until the slip
    stops.
    """

    law: Literal["two_region"] = "two_region"
    """The friction law."""

    @model_validator(mode="after")
    def _breaks_loose(self) -> Self:
        _check_breaks_loose(self)
        return self


class CoulombStiction(_Varying, _Guide, _Levels):
    """Rigid friction: stuck up to F_s(x), else g(v, x) against the motion, without any bristle.

    Nothing gives before breakaway, nothing drifts, and breakaway does not depend on how fast the
    force rises. Not for a controller that is designed for the stiffness of a stuck joint.

    Examples
    --------
    >>> joint = CoulombStiction(
    ...     stiction_n=450, coulomb_n=360, stribeck_velocity_m_per_s=0.09, engagement_length_m=0.1
    ... )
    >>> joint.stiffness_n_per_m, joint.damping_n_s_per_m
    (inf, 0.0)

    """

    one_bristle: ClassVar[bool] = False
    law: Literal["coulomb_stiction"] = "coulomb_stiction"
    """The friction law."""
    viscous_n_s_per_m: Damping = 0.0
    """Viscous friction sigma_2, in N s/m."""
    stribeck_velocity_m_per_s: Speed
    """v_s, the velocity over which friction falls from stiction to Coulomb, in m/s."""

    @model_validator(mode="after")
    def _breaks_loose(self) -> Self:
        _check_breaks_loose(self)
        return self

    @property
    def stiffness_n_per_m(self) -> float:
        """Infinite: nothing gives while the joint is stuck."""
        return float("inf")

    @property
    def damping_n_s_per_m(self) -> float:
        """Zero: there is no bristle to damp."""
        return 0.0


def _check_breaks_loose(joint: TwoRegion | CoulombStiction) -> None:
    """Refuse a joint that could not slide at the force that breaks it loose."""
    if joint.coulomb_n > joint.stiction_n:
        raise ValueError(
            f"coulomb_n: {joint.coulomb_n!r} is not <= stiction_n = {joint.stiction_n!r}; "
            "this law cannot slide at a force that does not break it loose"
        )


AnyJoint = Lugre | ElastoPlastic | Gms | TwoRegion | CoulombStiction
"""A joint of any law."""


class Part(Model):
    """The part that is extracted."""

    mass_kg: Mass
    """m, in kg."""
