"""The friction curve of a law: its level, its slope, and where it falls."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway import _core
from breakaway.base.arguments import check_arguments
from breakaway.base.equality import ByValue
from breakaway.errors import ScenarioError
from breakaway.model.friction.asked import (
    check_joint,
    check_residual,
    columns,
    seated,
)
from breakaway.model.scenario.core_joint import core_joint
from breakaway.model.scenario.joint import AnyJoint

Array = NDArray[np.float64]

SPEEDS = np.geomspace(1e-12, 1e6, 1801)
"""Speeds at which a curve is looked at, in m/s: slower and faster than any part slides."""


@dataclass(frozen=True, eq=False)
class SteadyFriction(ByValue):
    """Friction of a part that slides steadily, and how it follows a small change of the speed.

    With g' the slope of the level::

        R  = g sgn(v) + sigma v
        dR = y + lead / rate dy/dt + sigma dv,  dy/dt = rate (g' sgn(v) dv - y)
    """

    level_n: Array
    """g, the size of the friction force without its viscous part, in N."""
    viscous_n_s_per_m: Array
    """sigma, in N s/m."""
    damping_n_s_per_m: Array
    """Damping of the bristles at this speed, in N s/m; 0 for a rigid law."""
    rate_per_s: Array
    """How fast friction follows, in 1/s: k_e abs(v) / g of a bristle, C / g of elements; infinite
    where it follows at once."""
    lead: Array
    """Share of a change of the level that shows at once: c rate / k_e of a bristle, 0 of elements,
    1 where all of it does."""


def steady_friction(
    joint: AnyJoint, velocity_m_per_s: ArrayLike, *, position_m: ArrayLike = 0.0
) -> SteadyFriction:
    """Give the friction of a part that slides steadily.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law.
    velocity_m_per_s : array_like
        v, in m/s, of any sign.
    position_m : array_like, optional
        x, in m, 0 to l_f. Beyond the seat, ``joint.residual_n`` must be given.

    Returns
    -------
    SteadyFriction
        Arrays of the shape that velocity and position are broadcast to.

    Raises
    ------
    ScenarioError
        Not a joint, a velocity that is not finite, a position outside the guide, or a missing
        residual force.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> steady_friction(joint, [0.0, 10.0]).level_n
    array([450., 360.])

    """
    return SteadyFriction(*columns(_core.steady_friction, joint, position_m, velocity_m_per_s))


def steady_force(
    joint: AnyJoint, velocity_m_per_s: ArrayLike, *, position_m: ArrayLike = 0.0
) -> Array:
    """Give the steady friction force ``R = g(v, x) sgn(v) + sigma v``, in N, equation (4).

    Parameters and errors are those of `steady_friction`. At rest it is zero, which is one of the
    forces that a stuck joint may hold.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> steady_force(joint, [-10.0, 0.0, 10.0])
    array([-360.,    0.,  360.])

    """
    return columns(_core.friction_curve, joint, position_m, velocity_m_per_s)[0]


def stribeck_slope(joint: AnyJoint, velocity_m_per_s: float, *, position_m: float = 0.0) -> float:
    """Slope of the steady friction curve, in N s/m: negative where friction falls with speed.

    Of any law, by exact differentiation of its own equations. For one with the levels of (3), (5)
    and (6)::

        d R_ss / dv = -2 (F_s(x) - F_c(x)) |v| / v_s**2 exp(-(v / v_s)**2) + sigma_2
        F_s(x) - F_c(x) = (F_s0 - F_c0) (1 - x / l_f)

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law. One whose friction does not change with speed has the slope 0.
    velocity_m_per_s : float
        v, in m/s; for -v the slope is the same, but for ``joint.backward_ratio``.
    position_m : float, optional
        x, in m, 0 to l_f.

    Returns
    -------
    float

    Raises
    ------
    ScenarioError
        Not a joint, a velocity that is not finite, or a position outside the guide.

    Notes
    -----
    Not modeled: the bristle's lag, for which see `breakaway.design.sliding_plant`. The residual
    friction shifts both levels alike; where it is left open, it is taken as zero.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> round(bk.design.stribeck_slope(joint, 0.09 / 2**0.5), 1)
    -857.8

    """
    check_joint(joint)
    check_arguments(stribeck_slope, locals(), ScenarioError)
    return float(_curve(seated(joint), velocity_m_per_s, position_m)[1])


def steepest_change_velocity(joint: AnyJoint) -> float | None:
    """Velocity at which the level changes most steeply, v_s / sqrt(2) for (3), in m/s.

    Looked for among `SPEEDS`, then found exactly: there the second derivative is zero.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law.

    Returns
    -------
    float or None
        None where the level does not change with speed.

    Raises
    ------
    ScenarioError
        Not a joint.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> abs(steepest_change_velocity(joint) * 2**0.5 / 0.09 - 1.0) < 1e-14
    True

    """
    from scipy.optimize import brentq

    slope = np.abs(_curve(joint, SPEEDS)[1] - steady_friction(joint, SPEEDS).viscous_n_s_per_m)
    best = int(np.argmax(slope))
    if slope[best] == 0.0:
        return None
    low, high = SPEEDS[max(best - 1, 0)], SPEEDS[min(best + 1, SPEEDS.size - 1)]

    def curvature(velocity: float) -> float:
        return float(_curve(joint, velocity)[2])

    if curvature(low) * curvature(high) >= 0.0:
        return float(SPEEDS[best])
    return float(brentq(curvature, low, high, xtol=1e-300, rtol=4 * np.finfo(np.float64).eps))


def steepest_fall_velocity(joint: AnyJoint) -> float | None:
    """Velocity at which friction falls most steeply, v_s / sqrt(2) for (3), in m/s.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law.

    Returns
    -------
    float or None
        None for a law whose friction does not fall with speed.

    Raises
    ------
    ScenarioError
        Not a joint.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> round(bk.design.steepest_fall_velocity(joint), 4)
    0.0636

    """
    velocity = steepest_change_velocity(joint)
    if velocity is None or stribeck_slope(joint, velocity) >= 0.0:
        return None
    return velocity


def breakaway_force(joint: AnyJoint, position_m: ArrayLike) -> Array:
    """Force that breaks the joint loose forward, F_s(x) in N: equation (5).

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law, with its ``residual_n``.
    position_m : array_like
        x, in m. Before the seat the joint is fully engaged.

    Returns
    -------
    numpy.ndarray

    Raises
    ------
    ScenarioError
        Not a joint, or a missing residual force.

    Notes
    -----
    Not checked: positions beyond the guide, where nothing holds the part anymore.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.resolve(bk.load_scenario("paper_as_computed")).joint
    >>> breakaway_force(joint, [0.0, 0.1])
    array([450.  ,   9.81])

    """
    check_joint(joint)
    check_residual(joint)
    x = np.asarray(position_m, dtype=np.float64)
    return np.frombuffer(_core.breakaway_force(core_joint(joint), x.ravel())).reshape(x.shape)


def has_bristles(joint: AnyJoint) -> bool:
    """Whether the joint gives way elastically while it is stuck.

    Examples
    --------
    >>> import breakaway as bk
    >>> has_bristles(bk.load_scenario("paper_as_computed").joint)
    True

    """
    check_joint(joint)
    return joint.stiffness_n_per_m < inf


def has_elements(joint: AnyJoint) -> bool:
    """Whether the joint has several elements, each of which sticks or slips.

    Examples
    --------
    >>> import breakaway as bk
    >>> has_elements(bk.load_scenario("paper_as_computed").joint)
    False

    """
    check_joint(joint)
    return _core.law_form(core_joint(seated(joint))) == "elements"


def _curve(joint: AnyJoint, velocity: ArrayLike, position: ArrayLike = 0.0) -> list[Array]:
    """Force, slope and curvature of the steady friction force."""
    return columns(_core.friction_curve, joint, position, velocity)
