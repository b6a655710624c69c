"""Stability of a PID loop around a joint, stuck and sliding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.design.pole_placement import PidGains, check_positive
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import (
    has_bristles,
    steepest_change_velocity,
    stribeck_slope,
)
from breakaway.model.scenario.joint import AnyJoint


@dataclass(frozen=True)
class LoopStability:
    """A verdict on one linear loop, with its reason."""

    stable: bool
    """Whether all closed-loop poles lie in the left half plane."""
    poles_per_s: tuple[complex, ...]
    """Closed-loop poles, in 1/s."""
    reason: str
    """The Routh-Hurwitz condition, in numbers."""


@dataclass(frozen=True)
class Stability:
    """Verdicts for both regimes, and on self-excited oscillation."""

    stuck: LoopStability | None
    """Around the bristle's spring and damper; None for a law without stiffness."""
    sliding: LoopStability
    """Around a mass on which friction is constant."""
    stribeck: str
    """What the falling friction curve does to the sliding loop at low speed."""


def stability(gains: PidGains, joint: AnyJoint, mass_kg: float) -> Stability:
    """Judge a continuous PID loop around a joint by Routh and Hurwitz.

    The loop ``m x'' + (c + kd) x' + (k_e + kp) x + ki integral(x) = 0`` (stuck; sliding without c
    and k_e) has the characteristic polynomial ``s**3 + a2 s**2 + a1 s + a0``. It is stable if and
    only if all coefficients are positive and ``a2 a1 > a0``.

    Parameters
    ----------
    gains : PidGains
        The gains that run.
    joint : AnyJoint
        The joint.
    mass_kg : float
        m, above 0.

    Notes
    -----
    Sliding is Newton's law ``m x'' = F - R`` with constant friction. The paper's (13) is another
    plant: it multiplies the force by m2, and its verdict on the same gains may differ.

    Not modeled: sampling and hold, delay, the transition between the regimes. The verdict for
    sliding ignores the Stribeck slope, which `Stability.stribeck` compares with kd.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> vibrating = bk.design.PidGains(kp=828.2e3, ki=823940e3, kd=662.5)  # Table II
    >>> verdict = bk.design.stability(vibrating, joint, mass_kg=1.0)
    >>> verdict.stuck.stable, verdict.sliding.stable
    (True, False)

    """
    check_arguments(stability, locals(), ScenarioError)
    check_positive(mass_kg=mass_kg)
    stuck = None
    if has_bristles(joint):
        k_e, c = joint.stiffness_n_per_m, joint.damping_n_s_per_m
        stuck = _routh_hurwitz(c + gains.kd, k_e + gains.kp, gains.ki, mass_kg)
    return Stability(
        stuck=stuck,
        sliding=_routh_hurwitz(gains.kd, gains.kp, gains.ki, mass_kg),
        stribeck=_stribeck_verdict(gains, joint, mass_kg),
    )


def _routh_hurwitz(damping: float, stiffness: float, ki: float, mass_kg: float) -> LoopStability:
    a2, a1, a0 = damping / mass_kg, stiffness / mass_kg, ki / mass_kg
    if not np.all(np.isfinite([a2, a1, a0])):
        raise ScenarioError(
            f"gains: kp = {stiffness:g}, kd = {damping:g}, ki = {ki:g} over mass_kg = {mass_kg:g} "
            "are too large to compute; give gains closer to those of a real loop"
        )
    poles = tuple(complex(p) for p in np.roots([1.0, a2, a1, a0]))
    negative = [
        f"{name} = {value:.4g}"
        for name, value in (("damping", damping), ("stiffness", stiffness), ("ki", ki))
        if value <= 0.0
    ]
    if negative:
        return LoopStability(False, poles, f"not all coefficients are positive: {negative[0]}")
    stable = a2 * a1 > a0
    sign = ">" if stable else "<="
    reason = f"damping x stiffness / m = {a2 * a1 * mass_kg:.4g} {sign} ki = {ki:.4g}"
    return LoopStability(stable, poles, reason)


def _stribeck_verdict(gains: PidGains, joint: AnyJoint, mass_kg: float) -> str:
    """Routh's condition with the steepest fall of the friction curve, viscous friction included."""
    at = steepest_change_velocity(joint)
    if at is None:
        return "this law has no falling friction curve"
    slope = -stribeck_slope(joint, at)
    kd = gains.kd
    where = f"steepest fall {slope:.4g} N s/m at {at:.3g} m/s"
    if slope > kd:
        return f"{where} exceeds kd = {kd:.4g}: expect self-excited oscillation at low speed"
    damps = f"{where}, kd = {kd:.4g} damps it"
    if slope <= 0.0 or gains.kp <= 0.0 or gains.ki <= 0.0:
        return damps
    needed = gains.ki * mass_kg / gains.kp
    if kd - slope > needed:
        return damps
    return (
        f"{where} and the integral's {needed:.4g} N s/m exceed kd = {kd:.4g}: expect "
        "self-excited oscillation at low speed"
    )
