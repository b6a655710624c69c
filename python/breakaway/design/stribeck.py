"""The friction curve of a sliding joint: its slope, and which laws have one."""

from __future__ import annotations

from math import exp, inf, sqrt
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway.errors import ScenarioError


class FrictionLaw(Protocol):
    """What every law of a joint has."""

    @property
    def law(self) -> str:
        """Its name."""

    @property
    def stiction_n(self) -> float:
        """F_s0, in N."""

    @property
    def coulomb_n(self) -> float:
        """F_c0, in N."""

    @property
    def engagement_length_m(self) -> float:
        """l_f, in m."""

    @property
    def residual_n(self) -> float | None:
        """Friction left at the end of the guide, in N."""


@runtime_checkable
class StribeckLaw(FrictionLaw, Protocol):
    """What a law has whose friction changes with speed, whatever its name."""

    @property
    def stribeck_velocity_m_per_s(self) -> float:
        """v_s, in m/s."""

    @property
    def viscous_n_s_per_m(self) -> float:
        """sigma_2, in N s/m."""


@runtime_checkable
class BristleLaw(FrictionLaw, Protocol):
    """What a law has that gives way elastically while it is stuck."""

    @property
    def stiffness_n_per_m(self) -> float:
        """k_e, in N/m; infinite where nothing gives."""

    @property
    def damping_n_s_per_m(self) -> float:
        """c, in N s/m."""


@runtime_checkable
class SlipElements(Protocol):
    """What a law of Maxwell-slip elements has."""

    @property
    def attraction_n_per_s(self) -> float:
        """C, in N/s: a slipping element follows its level with the time constant g / C."""


@runtime_checkable
class FadingDamping(Protocol):
    """What a law has whose bristles may lose their damping with speed."""

    @property
    def damping_velocity_m_per_s(self) -> float | None:
        """v_d, in m/s: ``c exp(-(v / v_d)**2)``; None for constant damping."""


@runtime_checkable
class TwoWay(Protocol):
    """What a law has whose friction may differ with the direction."""

    @property
    def backward_ratio(self) -> float | None:
        """What friction is multiplied by for backward motion; None for 1."""


def bristles(joint: FrictionLaw) -> BristleLaw | None:
    """Give the joint as a law with bristles, or None for a rigid one.

    Examples
    --------
    >>> import breakaway as bk
    >>> bristles(bk.load_scenario("paper_as_computed").joint).stiffness_n_per_m
    36000000.0

    """
    return joint if isinstance(joint, BristleLaw) and joint.stiffness_n_per_m < inf else None


def bristle_damping(joint: BristleLaw, velocity_m_per_s: ArrayLike) -> NDArray[np.float64]:
    """Damping of the bristles at a speed, in N s/m: ``c``, or ``c exp(-(v / v_d)**2)``.

    Examples
    --------
    >>> import breakaway as bk
    >>> float(bristle_damping(bk.load_scenario("paper_as_computed").joint, 0.1))
    9000.0

    """
    v = np.asarray(velocity_m_per_s, dtype=np.float64)
    damping = np.full(v.shape, joint.damping_n_s_per_m)
    if isinstance(joint, FadingDamping) and joint.damping_velocity_m_per_s is not None:
        with np.errstate(under="ignore"):
            damping = damping * np.exp(-np.square(v / joint.damping_velocity_m_per_s))
    return damping


def stribeck_slope(
    joint: FrictionLaw, velocity_m_per_s: float, *, position_m: float = 0.0
) -> float:
    """Slope of the steady friction curve, in N s/m: negative where friction falls with speed.

    Of equation (4) with (3), both levels falling along the guide as in (5) and (6)::

        d R_ss / dv = -2 (F_s(x) - F_c(x)) |v| / v_s**2 exp(-(v / v_s)**2) + sigma_2
        F_s(x) - F_c(x) = (F_s0 - F_c0) (1 - x / l_f)

    Parameters
    ----------
    joint : AnyJoint
        A law of friction. One without Stribeck velocity has no curve: its slope is 0.
    velocity_m_per_s : float
        v, in m/s; the slope is the same for -v.
    position_m : float, optional
        x, in m, 0 to l_f.

    Returns
    -------
    float

    Raises
    ------
    ScenarioError
        A velocity that is not finite, or a position outside of the guide.

    Notes
    -----
    Not modeled: the bristle's lag, for which see `breakaway.design.sliding_plant`.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> round(bk.design.stribeck_slope(joint, 0.09 / 2**0.5), 1)
    -857.8

    """
    _check_place(joint, velocity_m_per_s, position_m)
    if not isinstance(joint, StribeckLaw):
        return 0.0
    v_s = joint.stribeck_velocity_m_per_s
    drop = (joint.stiction_n - joint.coulomb_n) * (1.0 - position_m / joint.engagement_length_m)
    relative = abs(velocity_m_per_s) / v_s
    if relative > 30.0:  # exp(-900) is no number; the curve is flat
        return joint.viscous_n_s_per_m
    return -2.0 * drop * relative / v_s * exp(-relative * relative) + joint.viscous_n_s_per_m


def steepest_fall_velocity(joint: FrictionLaw) -> float | None:
    """Velocity at which friction falls most steeply, v_s / sqrt(2), in m/s.

    Parameters
    ----------
    joint : AnyJoint
        A law of friction.

    Returns
    -------
    float or None
        None for a law whose friction does not fall with speed.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> round(bk.design.steepest_fall_velocity(joint), 4)
    0.0636

    """
    if not isinstance(joint, StribeckLaw):
        return None
    velocity = joint.stribeck_velocity_m_per_s / sqrt(2.0)
    return velocity if stribeck_slope(joint, velocity) < 0.0 else None


def friction_level(
    joint: FrictionLaw, velocity_m_per_s: ArrayLike, *, residual_n: float, position_m: float = 0.0
) -> NDArray[np.float64]:
    """Size of the friction force at a steady speed, without its viscous part, in N.

    ``g = F_c(x) + (F_s(x) - F_c(x)) exp(-(v / v_s)**2)``, equations (3), (5), (6); F_c(x) for a
    law without Stribeck curve.

    Parameters
    ----------
    joint : AnyJoint
        A law of friction.
    velocity_m_per_s : array_like
        v, in m/s, of any sign.
    residual_n : float
        Friction left at the end of the guide, in N.
    position_m : float, optional
        x, in m, 0 to l_f.

    Returns
    -------
    numpy.ndarray

    Raises
    ------
    ScenarioError
        A position outside of the guide.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> friction_level(joint, [0.0, 10.0], residual_n=9.81)
    array([450., 360.])

    """
    _check_place(joint, 0.0, position_m)
    share = 1.0 - position_m / joint.engagement_length_m
    v = np.asarray(velocity_m_per_s, dtype=np.float64)
    coulomb = residual_n + (joint.coulomb_n - residual_n) * share
    if not isinstance(joint, StribeckLaw):
        return np.full(v.shape, coulomb)
    drop = (joint.stiction_n - joint.coulomb_n) * share
    with np.errstate(under="ignore"):
        level: NDArray[np.float64] = coulomb + drop * np.exp(
            -np.square(v / joint.stribeck_velocity_m_per_s)
        )
    return level


def _check_place(joint: FrictionLaw, velocity_m_per_s: float, position_m: float) -> None:
    if not abs(velocity_m_per_s) < inf:
        raise ScenarioError(
            f"velocity_m_per_s: {velocity_m_per_s!r} is not finite; give a speed in m/s"
        )
    length_m = joint.engagement_length_m
    if not 0.0 <= position_m <= length_m:
        raise ScenarioError(
            f"position_m: {position_m!r} is not within the guide, 0 to "
            f"joint.engagement_length_m = {length_m!r}; give a position in m"
        )
