"""PID gains from a joint by pole placement (section 4.1 of the paper, misprints corrected)."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import has_bristles
from breakaway.model.scenario.joint import AnyJoint

GRAVITY_M_PER_S2 = 9.81
"""Standard gravity, as rounded by the paper's own gains."""


@dataclass(frozen=True)
class PidGains:
    """Gains of ``F = kp e + ki integral(e) + kd de/dt``."""

    kp: float
    """Proportional gain, in N/m."""
    ki: float
    """Integral gain, in N/(m s)."""
    kd: float
    """Derivative gain, in N s/m."""

    def __post_init__(self) -> None:
        check_arguments(PidGains.__init__, vars(self), ScenarioError)


@dataclass(frozen=True)
class GainSet:
    """The gains for a stuck joint, for a sliding one, and their weighted sum."""

    static: PidGains
    """For the stuck joint: equation (10) with the poles of (11)."""
    dynamic: PidGains
    """For the sliding joint: equation (13) with the poles of (11)."""
    total: PidGains
    """``static_share * static + (1 - static_share) * dynamic``: the gains that run."""
    natural_frequency_rad_per_s: float
    """omega, from the settling time."""


def residual_n(joint: AnyJoint, mass_kg: float) -> float:
    """Friction left at the end of the guide, in N: the joint's own, or the weight m g."""
    return mass_kg * GRAVITY_M_PER_S2 if joint.residual_n is None else joint.residual_n


def coulomb_fall_n_per_m(joint: AnyJoint, mass_kg: float) -> float:
    """How fast Coulomb friction falls along the guide, m2 in N/m: equation (12)."""
    return (joint.coulomb_n - residual_n(joint, mass_kg)) / joint.engagement_length_m


def with_residual(joint: AnyJoint, mass_kg: float) -> AnyJoint:
    """Give the joint with its residual force as a number."""
    return joint.model_copy(update={"residual_n": residual_n(joint, mass_kg)})


def pole_placement(
    joint: AnyJoint,
    *,
    mass_kg: float,
    settling_time_s: float,
    damping_ratio: float,
    pole_per_s: float,
    static_share: float = 0.1,
) -> GainSet:
    """Place the closed-loop poles at ``(s + a)(s**2 + 2 eps w s + w**2)``, equation (11).

    With w = 4 / (eps t_s), the 2 % settling time::

        static   kp = (w**2 + 2 a eps w) m - k_e     kd = (2 eps w + a) m - c    ki = a w**2 m
        dynamic  m2 = (F_c0 - m g) / l_f                                                    (12)
                 kp = (w**2 + 2 a eps w) m / m2 - 1  kd = (2 eps w + a) m / m2   ki = a w**2 m / m2
        total    0.1 static + 0.9 dynamic

    Misprints corrected: the paper prints w**2 twice in the static kp, and ``- eps`` in place of
    ``- c`` in the static kd; (11) lacks an s.

    The dynamic kp is the printed one, with the wrong sign of (13): R = F_c0 - m2 x puts -m2 x on
    the left, which asks for + 1. That is 2 of 12,600 to 19,200 in the paper, and Table II does not
    tell the two apart.

    Parameters
    ----------
    joint : AnyJoint
        Its stiffness k_e, damping c, Coulomb force F_c0, length l_f and residual force are used.
    mass_kg : float
        m, above 0.
    settling_time_s : float
        t_s, above 0.
    damping_ratio : float
        eps, above 0.
    pole_per_s : float
        a, above 0.
    static_share : float, optional
        Share of the static gains in the total, 0 to 1.

    Returns
    -------
    GainSet

    Raises
    ------
    ScenarioError
        A parameter is out of range, F_c0 does not exceed the residual force, or the law has no
        stiffness.

    Notes
    -----
    Not checked: that the *total* gains are stable in either regime. They place the poles of
    neither; see `breakaway.design.stability`.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.pole_placement(
    ...     joint, mass_kg=1.0, settling_time_s=5e-4, damping_ratio=1.0, pole_per_s=200.0)
    >>> round(gains.total.kp / 1000, 1)  # Table II prints 3137.3
    3137.3

    """
    check_arguments(pole_placement, locals(), ScenarioError)
    check_positive(
        mass_kg=mass_kg,
        settling_time_s=settling_time_s,
        damping_ratio=damping_ratio,
        pole_per_s=pole_per_s,
    )
    if not 0.0 <= static_share <= 1.0:
        raise ScenarioError(f"static_share: {static_share!r} is not within 0 to 1")
    if not has_bristles(joint):
        raise ScenarioError(
            f"joint.law: {joint.law!r} has no stiffness to place poles by; give gains as numbers"
        )
    end_n = residual_n(joint, mass_kg)
    if joint.coulomb_n <= end_n:
        raise ScenarioError(
            f"joint.coulomb_n: {joint.coulomb_n!r} is not > the residual force {end_n:.6g} N, so "
            "friction does not fall along the guide and equation (12) has no dynamic gains; give "
            "the gains as numbers"
        )
    a, m = pole_per_s, mass_kg
    slowness = damping_ratio * settling_time_s
    m2 = coulomb_fall_n_per_m(joint, mass_kg)
    if slowness == 0.0 or m2 == 0.0:
        raise ScenarioError(_NO_NUMBERS)
    w = 4.0 / slowness
    second_order = 2.0 * damping_ratio * w
    k_wanted, c_wanted, ki = (w * w + a * second_order) * m, (second_order + a) * m, a * w * w * m
    static = PidGains(
        kp=k_wanted - joint.stiffness_n_per_m, ki=ki, kd=c_wanted - joint.damping_n_s_per_m
    )
    dynamic = PidGains(kp=k_wanted / m2 - 1.0, ki=ki / m2, kd=c_wanted / m2)
    total = _weighted(static_share, static, dynamic)
    if not all(isfinite(gain) for gain in (total.kp, total.ki, total.kd)):
        raise ScenarioError(_NO_NUMBERS)
    return GainSet(static, dynamic, total, w)


_NO_NUMBERS = (
    "controller.gains: the designed gains are too large to compute; give a settling_time_s, "
    "damping_ratio and pole_per_s closer to 1"
)


def _weighted(share: float, static: PidGains, dynamic: PidGains) -> PidGains:
    rest = 1.0 - share
    return PidGains(
        kp=share * static.kp + rest * dynamic.kp,
        ki=share * static.ki + rest * dynamic.ki,
        kd=share * static.kd + rest * dynamic.kd,
    )


def check_positive(**values: float) -> None:
    """Refuse what is not above zero and finite, by its name."""
    for name, value in values.items():
        if not 0.0 < value < float("inf"):
            raise ScenarioError(f"{name}: {value!r} is not > 0 and finite; give a number > 0")
