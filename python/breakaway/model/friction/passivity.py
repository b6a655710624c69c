"""Where the damping of bristles is safe: bounds within which friction never pushes a part."""

from __future__ import annotations

from math import inf

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.model.friction.asked import check_joint, seated
from breakaway.model.friction.curve import SPEEDS, SteadyFriction, has_elements, steady_friction
from breakaway.model.scenario.joint import AnyJoint


def passive_speed(joint: AnyJoint) -> float | None:
    """Speed up to which a bristle of constant damping cannot push the part, in m/s.

    ``v = 4 g (c + sigma_2) / c**2`` with g the smallest level at the seat; without viscous friction
    ``4 g / c``. Sufficient, not necessary: beyond it only a bristle that is stretched by more than
    g / k_e can push (``docs/derivations/friction_laws.md``).

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law.

    Returns
    -------
    float or None
        None where there is no such bound: for laws without a bristle that slides or with elements,
        and where damping falls with speed.

    Raises
    ------
    ScenarioError
        Not a joint.

    Notes
    -----
    Not modeled: the way along the guide, where the levels and with them this speed are lower; how
    fast damping has to fall with speed.

    Examples
    --------
    >>> import breakaway as bk
    >>> passive_speed(bk.load_scenario("paper_as_computed").joint)
    0.16

    """
    check_arguments(passive_speed, locals(), ScenarioError)
    check_joint(joint)
    sliding = _slow_and_fast(joint)
    c = _constant_damping_n_s_per_m(sliding)
    if c == 0.0 or has_elements(joint):
        return None
    sigma = float(sliding.viscous_n_s_per_m[-1])
    return 4.0 * float(sliding.level_n.min()) * (c + sigma) / c**2


def passive_attraction_n_per_s(joint: AnyJoint) -> float | None:
    """Attraction C up to which slipping elements of constant damping cannot push the part, in N/s.

    ``C = k_e g / c`` with g the smallest level at the seat, at any speed.

    Parameters
    ----------
    joint : AnyJoint
        A joint of any law.

    Returns
    -------
    float or None
        None where there is no such bound: for laws without elements, and where damping falls with
        speed.

    Raises
    ------
    ScenarioError
        Not a joint.

    Notes
    -----
    Not modeled: the way along the guide, where the levels and with them this bound are lower.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint.model_dump(exclude={"law"})
    >>> passive_attraction_n_per_s(bk.Gms(**joint, attraction_n_per_s=4.5e5))
    1440000.0

    """
    check_arguments(passive_attraction_n_per_s, locals(), ScenarioError)
    check_joint(joint)
    sliding = _slow_and_fast(joint)
    c = _constant_damping_n_s_per_m(sliding)
    if c == 0.0 or not has_elements(joint):
        return None
    return joint.stiffness_n_per_m * float(sliding.level_n.min()) / c


def _slow_and_fast(joint: AnyJoint) -> SteadyFriction:
    """Friction at the seat at rest and far beyond any change with speed, in both directions.

    The smallest level at any speed is one of these.
    """
    return steady_friction(seated(joint), [-SPEEDS[-1], 0.0, SPEEDS[-1]])


def _constant_damping_n_s_per_m(sliding: SteadyFriction) -> float:
    """Give the damping of bristles that slide; 0 where it falls with speed or there are none."""
    _, at_rest, fast = sliding.damping_n_s_per_m
    bristles_slide = sliding.rate_per_s[-1] < inf
    return float(fast) if bristles_slide and fast == at_rest else 0.0
