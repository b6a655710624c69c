"""The loop's equations, written once for every peer that is programmed in Python.

What the operations are decides what the numbers are: floats, arrays, or expressions. A compiler
that wants to see each function is given as `compiled`.

    g = F_c(x) + (F_s(x) − F_c(x)) exp(−(v/v_s)²)
    dz/dt = v − k_e |v| z / g,   R = k_e z + c dz/dt,   m dv/dt = F − n R,   dx/dt = v

with R = 0 and z = 0 past the end of the guide.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np

from .loop import Numbers

Number = Any
"""A float, an array, or an expression."""
Function = Callable[..., Any]
Rule = Literal["rk2", "rk4", "ours"]


class Operations(NamedTuple):
    """What arithmetic does not have."""

    exp: Function
    absolute: Function
    minimum: Function
    maximum: Function
    below: Function
    """1 where the first is less than the second, else 0."""


FLOATS = Operations(math.exp, abs, min, max, operator.lt)
ARRAYS = Operations(np.exp, np.abs, np.minimum, np.maximum, np.less)


def as_it_is(function: Function) -> Function:
    """For who compiles nothing."""
    return function


def rates_of(p: Numbers, ops: Operations, compiled: Function = as_it_is) -> Function:
    """(dx/dt, dv/dt, dz/dt) of (x, v, z) under a force and a factor on the joint force."""
    level = compiled(level_of(p, ops))
    absolute, below = ops.absolute, ops.below
    m, k_e, c, length = p.mass_kg, p.stiffness_n_per_m, p.damping_n_s_per_m, p.engagement_length_m

    def rates(x: Number, v: Number, z: Number, force: Number, factor: Number) -> tuple[Number, ...]:
        z_rate = v - k_e * absolute(v) / level(x, v) * z
        joint_force = factor * below(x, length) * (k_e * z + c * z_rate)
        return v, (force - joint_force) / m, z_rate

    return compiled(rates)


def level_of(p: Numbers, ops: Operations) -> Function:
    """g in N at a position and a velocity."""
    exp, minimum, maximum = ops.exp, ops.minimum, ops.maximum
    length, v_s = p.engagement_length_m, p.stribeck_velocity_m_per_s
    coulomb, coulomb_slope = p.coulomb_n, (p.residual_n - p.coulomb_n) / length
    peak = p.stiction_n - p.coulomb_n

    def level(x: Number, v: Number) -> Number:
        # F_s − F_c falls to zero along the guide, since both end at the residual force.
        seated = minimum(maximum(x, 0.0), length)
        ratio = v / v_s
        engaged_peak = peak - peak / length * seated
        return coulomb + coulomb_slope * seated + engaged_peak * exp(-ratio * ratio)

    return level


def rk2_of(p: Numbers, ops: Operations, compiled: Function = as_it_is) -> Function:
    """One step of the explicit midpoint rule over a control period."""
    rates, below = rates_of(p, ops, compiled), ops.below
    h, length = p.period_s, p.engagement_length_m
    half = 0.5 * h

    def step(
        x: Number, v: Number, z: Number, joint: Number, force: Number, factor: Number
    ) -> tuple[Number, ...]:
        x1, v1, z1 = rates(x, v, z, force, factor)
        x2, v2, z2 = rates(x + half * x1, v + half * v1, z + half * z1, force, factor)
        after = x + h * x2
        return after, v + h * v2, (z + h * z2) * below(after, length), joint

    return compiled(step)


def rk4_of(p: Numbers, ops: Operations, compiled: Function = as_it_is) -> Function:
    """One step of the classical Runge-Kutta rule of order four over a control period."""
    rates, below = rates_of(p, ops, compiled), ops.below
    h, length = p.period_s, p.engagement_length_m
    half, sixth = 0.5 * h, h / 6.0

    def step(
        x: Number, v: Number, z: Number, joint: Number, force: Number, factor: Number
    ) -> tuple[Number, ...]:
        x1, v1, z1 = rates(x, v, z, force, factor)
        x2, v2, z2 = rates(x + half * x1, v + half * v1, z + half * z1, force, factor)
        x3, v3, z3 = rates(x + half * x2, v + half * v2, z + half * z2, force, factor)
        x4, v4, z4 = rates(x + h * x3, v + h * v3, z + h * z3, force, factor)
        after = x + sixth * (x1 + 2.0 * (x2 + x3) + x4)
        bristle = z + sixth * (z1 + 2.0 * (z2 + z3) + z4)
        return after, v + sixth * (v1 + 2.0 * (v2 + v3) + v4), bristle * below(after, length), joint

    return compiled(step)


def ours_of(p: Numbers, ops: Operations, compiled: Function = as_it_is) -> Function:
    """Our linearly implicit midpoint step: g at a predicted velocity, then the midpoint rule.

    With k = h/2, q = k n/m, w = v + k F/m, A = k_e |v_predicted|, and the joint force of the middle
    of the step before for the prediction:

        v_m [g (1 + q (c + k k_e)) + k A] = (g + k A) w − q (k_e g − c A) z
        z_m [ same ] = g ((1 + q c) z + k w)
    """
    level = compiled(level_of(p, ops))
    absolute, below = ops.absolute, ops.below
    m, k_e, c, length = p.mass_kg, p.stiffness_n_per_m, p.damping_n_s_per_m, p.engagement_length_m
    h, k = p.period_s, 0.5 * p.period_s

    def step(
        x: Number, v: Number, z: Number, joint: Number, force: Number, factor: Number
    ) -> tuple[Number, ...]:
        middle = x + k * v
        q = k / m * factor * below(middle, length)
        w = v + k / m * force
        predicted = w - q * joint
        g, a = level(middle, predicted), k_e * absolute(predicted)
        share = 1.0 / (g * (1.0 + q * (c + k * k_e)) + k * a)
        v_m = ((g + k * a) * w - q * (k_e * g - c * a) * z) * share
        z_m = g * ((1.0 + q * c) * z + k * w) * share
        after = x + h * v_m
        bristle = (2.0 * z_m - z) * below(after, length)
        return after, 2.0 * v_m - v, bristle, k_e * z_m + c / k * (z_m - z)

    return compiled(step)


STEPS: dict[Rule, Function] = {"rk2": rk2_of, "rk4": rk4_of, "ours": ours_of}
RULES: dict[Rule, str] = {
    "rk2": "explicit midpoint, 1 step",
    "rk4": "Runge-Kutta 4, 1 step",
    "ours": "linearly implicit midpoint, 1 step",
}
"""What integrates, in a control period."""


def period_of(
    rule: Rule, p: Numbers, ops: Operations, compiled: Function = as_it_is
) -> Callable[..., tuple[Number, ...]]:
    """One control period: (x, v, z, joint force, I, IAE) after it, from those before it."""
    step, control = STEPS[rule](p, ops, compiled), compiled(control_of(p))
    absolute, period_s = ops.absolute, p.period_s

    def period(
        x: Number,
        v: Number,
        z: Number,
        joint: Number,
        integral: Number,
        iae: Number,
        reference: Number,
        reference_rate: Number,
        factor: Number,
    ) -> tuple[Number, ...]:
        error = reference - x
        integral, force = control(error, reference_rate - v, integral)
        x, v, z, joint = step(x, v, z, joint, force, factor)
        return x, v, z, joint, integral, iae + period_s * absolute(error)

    return compiled(period)


def control_of(p: Numbers) -> Function:
    """The sampled PID: (I, F) from the error, its rate, and I before."""
    kp, ki_period, kd = p.kp_n_per_m, p.ki_n_per_m_s * p.period_s, p.kd_n_s_per_m

    def control(error: Number, error_rate: Number, integral: Number) -> tuple[Number, Number]:
        after = integral + ki_period * error
        return after, kp * error + after + kd * error_rate

    return control
