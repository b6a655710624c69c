"""The sampled loops of a gain set: stuck, sliding, and sliding where friction falls fastest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from breakaway.base.arguments import check_arguments
from breakaway.design.loop import SampledPid, open_loop, sliding_plant, stuck_plant
from breakaway.design.margins import Margins, margins
from breakaway.design.pole_placement import PidGains
from breakaway.design.stability import LoopStability
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import has_bristles, steepest_fall_velocity, stribeck_slope
from breakaway.model.scenario.controller import PidSettings
from breakaway.model.scenario.joint import AnyJoint
from breakaway.model.scenario.run import Timing

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class SampledLoop:
    """One sampled loop and its margins."""

    regime: str
    """What the joint does: ``stuck``, ``sliding`` or ``sliding, falling friction``."""
    velocity_m_per_s: float | None
    """Speed at which friction has its slope, in m/s; None where it has none."""
    slope_n_s_per_m: float
    """Slope of the friction curve, in N s/m; the stuck loop has none."""
    open_loop: control.StateSpace
    """L, opened at the force."""
    margins: Margins
    """Its margins."""

    @property
    def counts(self) -> bool:
        """Whether a gain set must be stable here to be safe.

        Falling friction is not counted: it ends in an oscillation of limited size, which
        `breakaway.design.limit_cycles` predicts.
        """
        return self.velocity_m_per_s is None


def sampled_pid(gains: PidGains, settings: PidSettings, timing: Timing) -> SampledPid:
    """Give a scenario's PID as it runs.

    Parameters
    ----------
    gains : PidGains
        The gains that run.
    settings : PidSettings
        Where its velocity comes from, and its filter.
    timing : Timing
        Control period and delay.

    Returns
    -------
    SampledPid

    Notes
    -----
    Left out: limits of the actuator and what the PID does at them.

    Examples
    --------
    >>> import breakaway as bk
    >>> scenario = bk.resolve(bk.load_scenario("paper_as_computed"))
    >>> pid = sampled_pid(PidGains(1.0, 1.0, 1.0), scenario.controller, scenario.timing)
    >>> pid.period_s, pid.delay_samples
    (1e-05, 0)

    """
    check_arguments(sampled_pid, locals(), ScenarioError)
    return SampledPid(
        gains,
        period_s=timing.control_period_s,
        delay_samples=int(timing.one_sample_delay),
        velocity_from=settings.velocity_from,
        derivative_filter_s=settings.derivative_filter_s,
    )


def sampled_loops(
    pid: SampledPid,
    joint: AnyJoint,
    mass_kg: float,
    *,
    velocity_m_per_s: float | None = None,
) -> tuple[SampledLoop, ...]:
    """Give the loops of a PID around a joint: stuck, sliding, and sliding at a speed.

    Parameters
    ----------
    pid : SampledPid
        The controller.
    joint : AnyJoint
        The joint. A law without stiffness has no stuck loop.
    mass_kg : float
        m, above 0.
    velocity_m_per_s : float, optional
        Speed at which the slope of the friction curve is taken, in m/s, above 0. Left out: where
        friction falls most steeply, and no such loop where it does not fall.

    Returns
    -------
    tuple of SampledLoop

    Raises
    ------
    ScenarioError
        A parameter is out of range.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)  # Table II
    >>> for loop in bk.design.sampled_loops(bk.design.SampledPid(gains, 1e-5), joint, 1.0):
    ...     print(loop.regime, loop.margins.stable)
    stuck True
    sliding True
    sliding, falling friction False

    """
    check_arguments(sampled_loops, locals(), ScenarioError)
    loops = []
    if has_bristles(joint):
        loops.append(_loop("stuck", pid, stuck_plant(joint, mass_kg)))
    loops.append(_loop("sliding", pid, sliding_plant(joint, mass_kg)))
    given = velocity_m_per_s is not None
    velocity = velocity_m_per_s if given else steepest_fall_velocity(joint)
    if velocity is not None:
        plant = sliding_plant(joint, mass_kg, velocity)
        slope = stribeck_slope(joint, velocity)
        kind = "falling" if slope < 0.0 else "rising"
        loops.append(_loop(f"sliding, {kind} friction", pid, plant, velocity, slope))
    return tuple(loops)


def _loop(
    regime: str,
    pid: SampledPid,
    plant: control.StateSpace,
    velocity: float | None = None,
    slope: float = 0.0,
) -> SampledLoop:
    loop = open_loop(pid, plant)
    return SampledLoop(regime, velocity, slope, loop, margins(loop))


def disagreement(regime: str, continuous: LoopStability | None, sampled: Margins) -> str | None:
    """Say where the sampled loop is not what the continuous one promises, or None.

    Parameters
    ----------
    regime : str
        What the joint does.
    continuous : LoopStability or None
        The verdict of Routh and Hurwitz.
    sampled : Margins
        The margins of the sampled loop.

    Returns
    -------
    str or None

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=1e6, ki=1e8, kd=2500.0)
    >>> loop = bk.design.sampled_loops(SampledPid(gains, period_s=1e-3), joint, 1.0)[1]
    >>> print(disagreement("sliding", bk.design.stability(gains, joint, 1.0).sliding, loop.margins))
    sliding: stable without sampling and delay, UNSTABLE as it runs; a pole at |z| = 1.63

    """
    if continuous is None or continuous.stable == sampled.stable:
        return None
    largest = max(abs(pole) for pole in sampled.poles)
    if sampled.stable:
        return (
            f"{regime}: unstable without sampling and delay, stable as it runs; largest |z| = "
            f"{largest:.6g}"
        )
    return (
        f"{regime}: stable without sampling and delay, UNSTABLE as it runs; a pole at |z| = "
        f"{largest:.3g}"
    )
