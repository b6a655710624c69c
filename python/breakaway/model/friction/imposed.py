"""A joint whose motion is imposed, as on a friction test rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway import _core
from breakaway.base.arguments import check_arguments, column_of
from breakaway.base.equality import ByValue
from breakaway.errors import ScenarioError
from breakaway.model.friction.asked import check_joint, check_residual, check_velocities
from breakaway.model.scenario.core_joint import core_joint
from breakaway.model.scenario.joint import AnyJoint


@dataclass(frozen=True, eq=False)
class ImposedMotion(ByValue):
    """What a joint did while it was moved; one value for each velocity."""

    position_m: NDArray[np.float64]
    """x at the middle of each period, m."""
    bristle_m: NDArray[np.float64]
    """z after each period, m; the mean of the elements, weighted with their stiffness; 0 for a
    rigid law."""
    joint_force_n: NDArray[np.float64]
    """R at the middle of each period, N."""


def impose_motion(
    joint: AnyJoint,
    velocity_m_per_s: ArrayLike,
    *,
    period_s: float,
    start_m: float = 0.0,
) -> ImposedMotion:
    """Move a relaxed joint with given velocities, each held for a period.

    The friction law alone, without mass or controller: Stribeck curves, presliding loops,
    frictional lag. Midpoint rule, second order in the period. A rigid joint that stands still
    holds the force that it had while it moved, at most its level; before it has moved, none.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law. Its ``residual_n`` must be given: there is no part whose weight could
        stand in.
    velocity_m_per_s : array_like
        Velocities in m/s, one-dimensional and finite.
    period_s : float
        How long each is held, in s, above 0.
    start_m : float, optional
        Position at the start, in m. Beyond the guide the force is zero.

    Returns
    -------
    ImposedMotion
        Arrays as long as the velocities.

    Raises
    ------
    ScenarioError
        As above.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.resolve(bk.load_scenario("paper_as_computed")).joint
    >>> motion = impose_motion(joint, np.full(1000, 1e-3), period_s=1e-4)
    >>> f"{motion.joint_force_n.max():.0f}"  # just below the stiction force of 450 N
    '449'

    """
    check_joint(joint)
    check_arguments(impose_motion, locals(), ScenarioError)
    velocity = column_of("velocity_m_per_s", velocity_m_per_s, ScenarioError)
    check_velocities(velocity)
    if not 0.0 < period_s < float("inf"):
        raise ScenarioError(f"period_s: {period_s!r} is not > 0 and finite; give a time in s")
    if not -float("inf") < start_m < float("inf"):
        raise ScenarioError(f"start_m: {start_m!r} is not finite; give a position in m")
    check_residual(joint)
    columns = _core.impose(core_joint(joint), start_m, period_s, velocity)
    return ImposedMotion(*(np.frombuffer(column) for column in columns))
