"""Friction under a speed that oscillates about a mean: its force, harmonic by harmonic."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from numpy.typing import NDArray

from breakaway.base.arguments import check_arguments
from breakaway.design.pole_placement import check_positive
from breakaway.design.stribeck import FrictionLaw, StribeckLaw, TwoWay, bristle_damping, bristles
from breakaway.errors import ScenarioError

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

POINTS = 128
"""Points of a period at which friction is evaluated."""


def describing_function(
    force: Callable[[Array], Array], amplitude: float, *, bias: float = 0.0, points: int = 4096
) -> tuple[float, complex]:
    """Mean and describing function of a force without memory under ``bias + A cos(theta)``.

    By numeric quadrature over one period (dual-input describing function; Gelb and Vander Velde,
    Multiple-Input Describing Functions, 1968)::

        mean = 1/(2 pi) integral f(b + A cos theta) d theta
        N    = 1/(pi A) integral f(b + A cos theta) exp(-j theta) d theta

    Parameters
    ----------
    force : callable
        f, of an array of inputs.
    amplitude : float
        A, above 0, in the unit of the input.
    bias : float, optional
        b, in the unit of the input.
    points : int, optional
        Points of the midpoint rule, at least 8. A jump of f costs an error of the order of its
        size over the number of points.

    Returns
    -------
    mean : float
        In the unit of the force.
    gain : complex
        N, force over input.

    Raises
    ------
    ScenarioError
        An amplitude or a number of points out of range.

    Examples
    --------
    >>> import numpy as np
    >>> mean, gain = describing_function(np.sign, 2.0)  # a relay: 4 / (pi A)
    >>> round(gain.real * np.pi * 2.0 / 4.0, 6), round(abs(mean), 9)
    (1.0, 0.0)

    """
    check_arguments(describing_function, locals(), ScenarioError)
    check_positive(amplitude=amplitude)
    if points < 8:
        raise ScenarioError(f"points: {points!r} is not >= 8; give a whole number >= 8")
    theta = midpoints(points)
    values = np.asarray(force(bias + amplitude * np.cos(theta)), dtype=np.float64)
    return float(np.mean(values)), complex(harmonic(values, 1) / amplitude)


def midpoints(points: int) -> Array:
    """Middles of equal parts of a period, in rad.

    Examples
    --------
    >>> midpoints(2)
    array([1.57079633, 4.71238898])

    """
    return np.asarray((np.arange(points) + 0.5) * (2.0 * pi / points), dtype=np.float64)


def harmonic(values: Array, order: int) -> ComplexArray:
    """Complex amplitude of a harmonic of what is given at `midpoints`, along the last axis.

    Examples
    --------
    >>> bool(abs(harmonic(3.0 * np.cos(2.0 * midpoints(16)), 2) - 3.0) < 1e-12)
    True

    """
    turn = np.exp(-1j * order * midpoints(values.shape[-1]))
    amplitude: ComplexArray = np.asarray(2.0 * np.mean(values * turn, axis=-1))
    return amplitude


def friction_over_period(
    joint: FrictionLaw,
    velocity_m_per_s: Array,
    w: Array,
    *,
    residual_n: float,
    position_m: Array,
) -> Array:
    """Friction force in N over a period of a speed that repeats, at the same points.

    Without bristles ``R = g(v) sgn v + sigma_2 v``. With bristles the steady periodic solution of
    equation (2): over a point's share of the period its coefficients are held, so that the
    deflection follows ``z <- z E + q`` exactly, and what repeats is the fixed point of the whole
    period's map, which is linear in z.

    Parameters
    ----------
    joint : AnyJoint
        A law of friction; bristles are LuGre's.
    velocity_m_per_s : numpy.ndarray
        v at `midpoints`, along the last axis.
    w : numpy.ndarray
        Frequencies in rad/s, of the other axes.
    residual_n : float
        Friction left at the end of the guide, in N.
    position_m : numpy.ndarray
        x, of the other axes: it stands still over a period.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> steady = friction_over_period(
    ...     joint, np.full(64, 0.5), np.array(1e3), residual_n=9.81, position_m=np.array(0.0))
    >>> bool(np.allclose(steady, 360.0))
    True

    """
    v = velocity_m_per_s
    share = (1.0 - position_m / joint.engagement_length_m)[..., None]
    level = residual_n + (joint.coulomb_n - residual_n) * share
    viscous = 0.0
    if isinstance(joint, StribeckLaw):
        viscous = joint.viscous_n_s_per_m
        drop = (joint.stiction_n - joint.coulomb_n) * share
        level = level + drop * np.exp(-np.square(v / joint.stribeck_velocity_m_per_s))
    if isinstance(joint, TwoWay) and joint.backward_ratio is not None:
        level = level * np.where(v < 0.0, joint.backward_ratio, 1.0)
    elastic = bristles(joint)
    if elastic is None:
        return np.asarray(level * np.sign(v) + viscous * v, dtype=np.float64)
    k_e, c = elastic.stiffness_n_per_m, bristle_damping(elastic, v)
    rate = k_e * np.abs(v) / level
    z, rate_of_z = _bristle(v, rate, 2.0 * pi / v.shape[-1] / w)
    force: Array = k_e * z + c * rate_of_z + viscous * v
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
