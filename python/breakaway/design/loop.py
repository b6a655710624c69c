"""The sampled loop of a PID around a joint, stuck or sliding, as python-control systems."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Literal

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.base.text import shown
from breakaway.design.pole_placement import PidGains, check_positive
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import has_bristles, steady_friction, stribeck_slope
from breakaway.model.scenario.joint import AnyJoint

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class SampledPid:
    """A PID as it runs: sampled, held, perhaps delayed.

    ``F = kp e + I + kd d`` at every sample, ``I <- I + ki e T_s`` before use,
    ``d <- (1 - s) d + s d_raw`` with ``s = T_s / (tau_f + T_s)``.

    Examples
    --------
    >>> SampledPid(PidGains(kp=3.1e6, ki=1.3e9, kd=724.0), period_s=1e-5).delay_samples
    0

    """

    gains: PidGains
    """Its gains."""
    period_s: float
    """T_s, in s, above 0."""
    delay_samples: int = 0
    """Whole periods that pass between a sample and its force; 1 with `one_sample_delay`."""
    velocity_from: Literal["sensor", "position_difference"] = "sensor"
    """Where the derivative comes from."""
    derivative_filter_s: float = 0.0
    """tau_f, in s, of the first-order filter on the derivative; 0 for none."""

    def __post_init__(self) -> None:
        check_arguments(SampledPid.__init__, vars(self), ScenarioError)
        check_positive(period_s=self.period_s)
        gains = self.gains
        for name, value in (("kp", gains.kp), ("ki", gains.ki), ("kd", gains.kd)):
            if not abs(value) < inf:
                raise ScenarioError(f"gains.{name}: {value!r} is not finite; give a number")
        if self.delay_samples not in range(1001):
            raise ScenarioError(
                f"delay_samples: {self.delay_samples!r} is not a whole number within 0 to 1000"
            )
        if self.velocity_from not in ("sensor", "position_difference"):
            raise ScenarioError(
                f"velocity_from: {self.velocity_from!r} is not one of 'sensor', "
                "'position_difference'"
            )
        if not 0.0 <= self.derivative_filter_s < inf:
            raise ScenarioError(
                f"derivative_filter_s: {self.derivative_filter_s!r} is not >= 0 and finite; give "
                "a time in s, or 0 for no filter"
            )


def stuck_plant(joint: AnyJoint, mass_kg: float) -> control.StateSpace:
    """Give the part on its bristles, from force to position and velocity.

    ``m x'' + (c + sigma_2) x' + k_e x = F``: equation (1) at rest, where the bristle moves with
    the part.

    Parameters
    ----------
    joint : AnyJoint
        Its stiffness, damping and viscous friction are used.
    mass_kg : float
        m, above 0.

    Returns
    -------
    control.StateSpace
        In continuous time: input F (N), outputs x (m) and v (m/s).

    Raises
    ------
    ScenarioError
        The law has no bristles, or a mass out of range.

    Notes
    -----
    Not modeled: the joint gives way at F_s.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> bk.design.stuck_plant(joint, 1.0).poles().real.round()
    array([-4500., -4500.])

    """
    check_arguments(stuck_plant, locals(), ScenarioError)
    check_positive(mass_kg=mass_kg)
    if not has_bristles(joint):
        raise ScenarioError(
            f"joint.law: {joint.law!r} has no stiffness while it is stuck, so there is no stuck "
            "loop; look at the sliding one"
        )
    at_rest = steady_friction(joint, 0.0)
    damping = float(at_rest.damping_n_s_per_m + at_rest.viscous_n_s_per_m)
    return _plant([[0.0, 1.0], [-joint.stiffness_n_per_m / mass_kg, -damping / mass_kg]], mass_kg)


def sliding_plant(
    joint: AnyJoint, mass_kg: float, velocity_m_per_s: float | None = None
) -> control.StateSpace:
    """Give the sliding part, from force to position and velocity, around a steady speed.

    Friction of constant size drops out: ``m x'' = F``. At a speed v its slope stays, behind the
    lag of the bristles where the law has them; linearized from equations (1) to (3)::

        m dv/dt = F - R,  R(s) / v(s) = g'(v) (1 + s c / k_e) / (1 + s g / (k_e v)) + sigma_2

    Parameters
    ----------
    joint : AnyJoint
        The joint, at its seat.
    mass_kg : float
        m, above 0.
    velocity_m_per_s : float, optional
        The steady speed, above 0. Left out: friction is constant.

    Returns
    -------
    control.StateSpace
        In continuous time: input F (N), outputs x (m) and v (m/s).

    Raises
    ------
    ScenarioError
        A mass or a speed out of range.

    Notes
    -----
    Not modeled: the contact loss along the guide, which acts as the small negative stiffness
    (F_c0 - F_end) / l_f. Maxwell-slip elements follow with the time constant g / C, without lead.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> bool(bk.design.sliding_plant(joint, 1.0, 0.06).poles().real.max() > 0)  # falling friction
    True

    """
    check_arguments(sliding_plant, locals(), ScenarioError)
    check_positive(mass_kg=mass_kg)
    m = mass_kg
    if velocity_m_per_s is None:
        return _plant([[0.0, 1.0], [0.0, 0.0]], m)
    check_positive(velocity_m_per_s=velocity_m_per_s)
    friction = steady_friction(joint, velocity_m_per_s)
    viscous, rate, lead = (
        float(one) for one in (friction.viscous_n_s_per_m, friction.rate_per_s, friction.lead)
    )
    slope = stribeck_slope(joint, velocity_m_per_s) - viscous
    if rate == inf:
        return _plant([[0.0, 1.0], [0.0, -(slope + viscous) / m]], m)
    # y is the bristle's change times k_e: y' = rate (g' v - y), R = y + c/k_e y' + sigma_2 v
    return _plant(
        [
            [0.0, 1.0, 0.0],
            [0.0, -(lead * slope + viscous) / m, -(1.0 - lead) / m],
            [0.0, rate * slope, -rate],
        ],
        m,
    )


def open_loop(pid: SampledPid, plant: control.StateSpace) -> control.StateSpace:
    """Open the sampled loop at the force, and give what comes back with its sign turned.

    The plant is discretized exactly for a held force (zero-order hold). The controller measures
    position and velocity, so there is no single output at which to open the loop: it is opened at
    the plant's input, the force. ``1 + L(z) = 0`` at the closed loop's poles.

    Parameters
    ----------
    pid : SampledPid
        The controller.
    plant : control.StateSpace
        From `stuck_plant` or `sliding_plant`: continuous, input F, outputs x and v.

    Returns
    -------
    control.StateSpace
        L, of one input and one output, with period ``pid.period_s``; ``control.ss2tf`` gives it
        as a transfer function.

    Notes
    -----
    Not modeled: limits of the actuator, anti-windup, quantization.

    Examples
    --------
    >>> import breakaway as bk
    >>> pid = bk.design.SampledPid(bk.design.PidGains(kp=0.0, ki=0.0, kd=2.0), period_s=0.1)
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> L = bk.design.open_loop(pid, bk.design.sliding_plant(joint, 1.0))
    >>> bool(abs(L(-1.0) + 0.1) < 1e-12)  # kd T_s / m / (z - 1)
    True

    """
    check_arguments(open_loop, locals(), ScenarioError)
    import control

    check_system("plant", plant, "stuck_plant and sliding_plant give one")
    sampled = control.c2d(plant, pid.period_s, method="zoh")
    loop = control.series(sampled, _controller(pid))
    return control.series(loop, _delay(pid)) if pid.delay_samples else loop


def check_system(name: str, value: object, remedy: str) -> None:
    """Refuse what is no linear system of python-control."""
    import control

    if not isinstance(value, control.StateSpace | control.TransferFunction):
        raise ScenarioError(f"{name}: {shown(value)} is not a control.StateSpace; {remedy}")


def _plant(dynamics: list[list[float]], mass_kg: float) -> control.StateSpace:
    """States x, v and perhaps a friction force; the force enters at v; x and v are measured."""
    import control

    states = len(dynamics)
    force = [[0.0], [1.0 / mass_kg], *[[0.0]] * (states - 2)]
    return control.ss(
        dynamics, force, np.eye(2, states), 0.0, inputs=["F"], outputs=["x", "v"], name="plant"
    )


def _controller(pid: SampledPid) -> control.StateSpace:
    """Give the PID from (x, v) to -F, reference at rest; only the states that it has.

    States: the integral I, the filtered derivative d, the last position.
    """
    import control

    gains, period_s = pid.gains, pid.period_s
    share = period_s / (pid.derivative_filter_s + period_s)
    differenced = pid.velocity_from == "position_difference"
    # d_raw as a row over (I, d, last x) and over (x, v)
    raw_states = np.array([0.0, 0.0, -1.0 / period_s if differenced else 0.0])
    raw_inputs = np.array([1.0 / period_s, 0.0] if differenced else [0.0, 1.0])
    kept = np.array([0.0, 1.0 - share, 0.0])
    a = np.array([[1.0, 0.0, 0.0], kept + share * raw_states, [0.0, 0.0, 0.0]])
    b = np.array([[gains.ki * period_s, 0.0], share * raw_inputs, [1.0, 0.0]])
    c = np.array([[1.0, 0.0, 0.0]]) + gains.kd * a[1]
    d = np.array([[gains.kp + gains.ki * period_s, 0.0]]) + gains.kd * b[1]
    has = [gains.ki != 0.0, pid.derivative_filter_s > 0.0, differenced]
    return control.ss(
        a[np.ix_(has, has)], b[has], c[:, has], d, period_s, inputs=["x", "v"], outputs=["-F"]
    )


def _delay(pid: SampledPid) -> control.StateSpace:
    import control

    n = pid.delay_samples
    first, last = np.eye(n)[:, :1], np.eye(n)[-1:]
    return control.ss(np.eye(n, k=-1), first, last, 0.0, pid.period_s)
