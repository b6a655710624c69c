"""A joint whose motion is imposed, as on a friction test rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway import _core
from breakaway.base.equality import ByValue
from breakaway.errors import ScenarioError
from breakaway.model.scenario.joint import SeizedJoint


@dataclass(frozen=True, eq=False)
class ImposedMotion(ByValue):
    """What a joint did while it was moved; one value for each velocity."""

    position_m: NDArray[np.float64]
    """x at the middle of each period, m."""
    bristle_m: NDArray[np.float64]
    """z after each period, m."""
    joint_force_n: NDArray[np.float64]
    """R at the middle of each period, N."""


def impose_motion(
    joint: SeizedJoint,
    velocity_m_per_s: ArrayLike,
    *,
    period_s: float,
    start_m: float = 0.0,
) -> ImposedMotion:
    """Move a relaxed joint with given velocities, each held for a period.

    The bristle equation alone, without mass or controller: Stribeck curves, presliding loops,
    frictional lag. Midpoint rule, second order in the period.

    Parameters
    ----------
    joint : Lugre or TwoRegion
        Its ``residual_n`` must be given: there is no part to take a weight from.
    velocity_m_per_s : array_like
        Velocities, one-dimensional and finite.
    period_s : float
        How long each is held, above 0.
    start_m : float, optional
        Position at the start.

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
    velocity = np.asarray(velocity_m_per_s, dtype=np.float64)
    if velocity.ndim != 1 or not np.all(np.isfinite(velocity)):
        raise ScenarioError("velocity_m_per_s: is not a one-dimensional array of finite numbers")
    if not 0.0 < period_s < float("inf"):
        raise ScenarioError(f"period_s: {period_s!r} is not > 0 and finite; give a time in s")
    if not -float("inf") < start_m < float("inf"):
        raise ScenarioError(f"start_m: {start_m!r} is not finite; give a position in m")
    if joint.residual_n is None:
        raise ScenarioError("joint.residual_n: is missing; give a number > 0, such as the weight")
    columns = _core.impose(joint.model_dump(), start_m, period_s, velocity.tolist())
    return ImposedMotion(*(np.frombuffer(column) for column in columns))
