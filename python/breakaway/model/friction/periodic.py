"""Friction over a period of a speed that repeats."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import has_elements, steady_friction
from breakaway.model.scenario.joint import AnyJoint

Array = NDArray[np.float64]


def friction_over_period(
    joint: AnyJoint, velocity_m_per_s: Array, w: Array, *, position_m: Array
) -> Array:
    """Friction force in N over a period of a speed that repeats, at the same points.

    Of a law that follows at once ``R = g(v) sgn v + sigma v``. With a bristle the steady periodic
    solution of ``dz/dt = v - rate(v) z``, equation (2) for LuGre: over a point's share of the
    period its coefficients are held, so that the deflection follows ``z <- z E + q`` exactly, and
    what repeats is the fixed point of the whole period's map, which is linear in z.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law without elements. A bristle yields as it does where it has settled.
    velocity_m_per_s : numpy.ndarray
        v at the middles of equal shares of the period, along the last axis, in m/s.
    w : numpy.ndarray
        Frequencies in rad/s, above 0, of the other axes.
    position_m : numpy.ndarray
        x, in m, of the other axes: it stands still over a period. Where it is not the seat,
        ``joint.residual_n`` must be given.

    Returns
    -------
    numpy.ndarray

    Raises
    ------
    ScenarioError
        A law of several elements, or what `steady_friction` refuses.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> steady = friction_over_period(
    ...     joint, np.full(64, 0.5), np.array(1e3), position_m=np.array(0.0))
    >>> bool(np.allclose(steady, 360.0))
    True

    """
    if has_elements(joint):
        raise ScenarioError(
            f"joint.law: {joint.law!r} has several elements, for which the force over a period "
            "cannot be computed; use impose_motion instead"
        )
    v = velocity_m_per_s
    friction = steady_friction(joint, v, position_m=np.asarray(position_m)[..., None])
    viscous = friction.viscous_n_s_per_m * v
    if np.all(friction.rate_per_s == np.inf):
        return np.asarray(friction.level_n * np.sign(v) + viscous, dtype=np.float64)
    z, rate_of_z = _bristle(v, friction.rate_per_s, 2.0 * pi / v.shape[-1] / w)
    force: Array = joint.stiffness_n_per_m * z + friction.damping_n_s_per_m * rate_of_z + viscous
    return force


def _bristle(v: Array, rate: Array, step_s: Array) -> tuple[Array, Array]:
    """Give z and dz/dt of ``dz/dt = v - rate z``, means over each step of the periodic solution."""
    turns = rate * step_s[..., None]
    kept = np.exp(-turns)
    small = turns < 1e-8
    safe = np.where(small, 1.0, turns)
    share = np.where(small, 1.0, -np.expm1(-safe) / safe)  # (1 - e^-turns) / turns
    gained = v * step_s[..., None] * share
    product, total = np.ones(step_s.shape), np.zeros(step_s.shape)
    for k in range(v.shape[-1]):
        product, total = product * kept[..., k], total * kept[..., k] + gained[..., k]
    at = total / np.maximum(1.0 - product, np.finfo(np.float64).tiny)
    starts = np.empty(v.shape)
    for k in range(v.shape[-1]):
        starts[..., k] = at
        at = at * kept[..., k] + gained[..., k]
    # the mean of dz/dt over a step is the step's rise; the mean of z follows from the equation
    rise = (np.roll(starts, -1, axis=-1) - starts) / step_s[..., None]
    z = np.where(small, starts, (v - rise) / np.where(small, 1.0, rate))
    return z, rise
