"""What is asked of a law: a joint, and places and speeds that are numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway.errors import ScenarioError
from breakaway.model.scenario.core_joint import core_joint
from breakaway.model.scenario.joint import AnyJoint

Array = NDArray[np.float64]


def check_joint(joint: object) -> None:
    """Refuse what is no joint, such as the name of a preset.

    Examples
    --------
    >>> check_joint("paper_as_computed")
    Traceback (most recent call last):
    breakaway.errors.ScenarioError: joint: 'paper_as_computed' is not a joint; ...

    """
    if not isinstance(joint, AnyJoint):
        raise ScenarioError(
            f"joint: {joint!r} is not a joint; give a joint of any law, or that of a scenario: "
            "load_scenario(...).joint"
        )


def check_residual(joint: AnyJoint) -> None:
    """Refuse a joint whose residual friction is left open."""
    if joint.residual_n is None:
        raise ScenarioError("joint.residual_n: is missing; give a number > 0, such as the weight")


def check_places(joint: AnyJoint, position_m: Array) -> None:
    """Refuse positions outside of the guide."""
    length_m = joint.engagement_length_m
    outside = position_m[~((position_m >= 0.0) & (position_m <= length_m))]
    if outside.size:
        raise ScenarioError(
            f"position_m: {float(outside[0])!r} is not within the guide, 0 to "
            f"joint.engagement_length_m = {length_m!r}; give a position in m"
        )


def check_velocities(velocity_m_per_s: Array) -> None:
    """Refuse velocities that are not finite."""
    wrong = velocity_m_per_s[~np.isfinite(velocity_m_per_s)]
    if wrong.size:
        raise ScenarioError(
            f"velocity_m_per_s: {float(wrong[0])!r} is not finite; give a speed in m/s"
        )


def seated(joint: AnyJoint) -> AnyJoint:
    """Give the joint with some residual friction: at the seat it plays no part."""
    return joint if joint.residual_n is not None else joint.model_copy(update={"residual_n": 0.0})


def columns(
    answer: Callable[[Mapping[str, Any], Array, Array], list[bytes]],
    joint: AnyJoint,
    position_m: ArrayLike,
    velocity_m_per_s: ArrayLike,
) -> list[Array]:
    """Ask the core at positions and velocities, which are broadcast; one array for each quantity.

    Raises
    ------
    ScenarioError
        Not a joint, a velocity that is not finite, a position outside the guide, or one beyond the
        seat while ``residual_n`` is left open.

    """
    check_joint(joint)
    x, v = np.broadcast_arrays(
        np.asarray(position_m, dtype=np.float64), np.asarray(velocity_m_per_s, dtype=np.float64)
    )
    check_places(joint, x)
    check_velocities(v)
    if np.any(x > 0.0):
        check_residual(joint)
    found = answer(core_joint(seated(joint)), x.ravel(), v.ravel())
    return [np.frombuffer(one).reshape(x.shape) for one in found]
