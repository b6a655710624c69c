"""How long an integration step may be: what the time scales of a part and its rig ask for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from breakaway.model.scenario.actuator import FeedAxis, ForceActuator, Piezo
from breakaway.model.scenario.joint import StribeckJoint, TwoRegion
from breakaway.model.scenario.normal_force import STEPS_PER_CYCLE

if TYPE_CHECKING:
    from breakaway.model.scenario.scenario import Scenario

Array = NDArray[np.float64]

OF_OSCILLATION = 0.3
"""Longest step over 1 / omega, omega^2 = k_e / m + k_c (1 / m + 1 / m_face), of a part between its
bristles and its contact with tool or tip."""
OF_FORCED = 0.15
"""The same where a force drives the part, without a contact: when it breaks loose decides how far
it gets, and so counts more."""
OF_JUMPING = 0.05
"""The same for laws whose friction drops at once: a step errs by its own length when it does."""
OF_PERIOD = 0.25
"""For these laws too, longest step over the control period: controllers decide by what they see."""
OF_TOOL = 0.15
"""Longest step over sqrt(mass / stiffness) of the tool, whose impacts make the peaks."""
OF_TIP = 0.3
"""The same of the tip of a stack."""
OF_DAMPING = 0.6
"""Longest step over mass / damping of the part."""
OF_FALL = 1.0
"""Longest step over m v_s / (F_s - F_c), in which friction falls as the part breaks loose."""
LEAST = 1.0 / 16.0
"""However fast friction falls or damping acts, steps need not be shorter than this share of what
oscillations ask for: what is faster is over at once, and the part moves on at its own pace."""
OF_SLIP = 0.005
"""Longest step over sqrt(2 m l_f / F_s), about the time in which a part with rigid friction that
slips is through its guide."""
OF_LAG = 0.5
"""Longest step over the time constant of a force actuator."""
OF_RK4 = 15.0
"""How many times as many steps rk4 takes: it is explicit, and the oracle."""
GRADES = np.unique([grade * 2**n for n in range(31) for grade in (1, 3)])
"""Numbers of steps that are taken: few, so that parts of a population share them."""


class _Numbers:
    """Numbers of a scenario by path: those of one part, or columns of many."""

    def __init__(self, scenario: Scenario, columns: Mapping[str, Array]) -> None:
        self._scenario, self._columns = scenario, columns

    def __call__(self, path: str) -> Array:
        if path in self._columns:
            return np.asarray(self._columns[path], dtype=np.float64)
        value: object = self._scenario
        for name in path.split("."):
            value = getattr(value, name)
        return np.asarray(value, dtype=np.float64)


def longest_step_s(scenario: Scenario, columns: Mapping[str, Array] | None = None) -> Array:
    """Return the longest step with which metrics are accurate, in s; one for each row of columns.

    The shortest of what the part's oscillation, the tool's and the stack's, damping, the fall of
    friction and vibration of the normal force ask for. tests/accuracy measures what that gives.

    Examples
    --------
    >>> import breakaway as bk
    >>> f"{float(longest_step_s(bk.load_scenario('paper_as_computed'))):.3g}"
    '2.5e-05'

    """
    numbers = _Numbers(scenario, columns or {})
    longest_s = np.asarray(np.inf)
    with np.errstate(all="ignore"):  # numbers at the ends of their ranges
        for _, needed_s in _needed_s(scenario, numbers):
            longest_s = np.minimum(longest_s, needed_s)
    return longest_s


def asking_for_most_steps(scenario: Scenario) -> str:
    """Return the paths of the numbers that ask for the shortest step."""
    with np.errstate(all="ignore"):
        needed = {paths: float(s) for paths, s in _needed_s(scenario, _Numbers(scenario, {}))}
    return min(needed, key=lambda paths: needed[paths])


def steps_per_period(
    scenario: Scenario, columns: Mapping[str, Array] | None = None
) -> NDArray[np.int64]:
    """Return the integration steps in a control period that "auto" stands for.

    As many as `longest_step_s` asks for, rounded up to 1, 2, 3, 4, 6, 8, 12, ...

    Examples
    --------
    >>> import breakaway as bk
    >>> int(steps_per_period(bk.load_scenario("paper_as_computed")))
    1

    """
    with np.errstate(all="ignore"):
        ratio = scenario.timing.control_period_s / longest_step_s(scenario, columns)
        if scenario.timing.integrator == "rk4":
            ratio = ratio * OF_RK4
        needed = np.fmin(np.ceil(ratio * (1.0 - 1e-9)), GRADES[-1])
    return np.asarray(GRADES[np.searchsorted(GRADES, needed)])


Needed = Iterator[tuple[str, Array]]
"""Paths of numbers, and the step in s that they ask for."""


def _needed_s(scenario: Scenario, number: _Numbers) -> Needed:
    joint, actuator = scenario.joint, scenario.actuator
    yield from _of_part_s(scenario, number)
    if isinstance(actuator, FeedAxis):
        yield from _of_faces_s(actuator, number)
    if isinstance(actuator, ForceActuator):
        path = "actuator.bandwidth_hz"
        yield path, OF_LAG / (2.0 * np.pi * number(path))
    normal = joint.normal_force
    for name in ("vibration", "transverse"):
        if normal is not None and getattr(normal, name) is not None:
            path = f"joint.normal_force.{name}.frequency_hz"
            yield path, 1.0 / (STEPS_PER_CYCLE * number(path))


def _of_part_s(scenario: Scenario, number: _Numbers) -> Needed:
    joint, mass = scenario.joint, number("part.mass_kg")
    square, rate = _contact_rates(scenario.actuator, mass, number)
    if rigid := not np.isfinite(joint.stiffness_n_per_m):
        length_m, stiction_n = number("joint.engagement_length_m"), number("joint.stiction_n")
        slip_s = OF_SLIP * np.sqrt(2.0 * mass * length_m / stiction_n)
        yield "part.mass_kg, joint.engagement_length_m, joint.stiction_n", slip_s
    else:
        square = square + number("joint.stiffness_n_per_m") / mass
        rate = rate + number("joint.damping_n_s_per_m") / mass
    jumps = rigid or isinstance(joint, TwoRegion)
    if jumps:
        yield "timing.control_period_s", OF_PERIOD * number("timing.control_period_s")
    touching = isinstance(scenario.actuator, FeedAxis)
    share = OF_JUMPING if jumps else OF_OSCILLATION if touching else OF_FORCED
    oscillation_s = share / np.sqrt(square)
    contact = f", actuator.contact, {_face_path(scenario.actuator)}" if touching else ""
    yield f"part.mass_kg, joint.stiffness_n_per_m{contact}", oscillation_s
    damping_s = np.maximum(OF_DAMPING / rate, LEAST * oscillation_s)
    yield f"part.mass_kg, joint.damping_n_s_per_m{contact}", damping_s
    if isinstance(joint, StribeckJoint):
        fall_n = np.maximum(number("joint.stiction_n") - number("joint.coulomb_n"), 1e-300)
        fall_s = OF_FALL * mass * number("joint.stribeck_velocity_m_per_s") / fall_n
        yield (
            "part.mass_kg, joint.stribeck_velocity_m_per_s, joint.stiction_n, joint.coulomb_n",
            np.maximum(fall_s, LEAST * oscillation_s),
        )


def _contact_rates(actuator: object, mass: Array, number: _Numbers) -> tuple[Array, Array]:
    """Give omega^2 and c / m of the contact of part and face."""
    if not isinstance(actuator, FeedAxis):
        return np.asarray(0.0), np.asarray(0.0)
    per_mass = 1.0 / mass + 1.0 / number(_face_path(actuator))
    contact = "actuator.contact."
    return (
        per_mass * number(f"{contact}stiffness_n_per_m"),
        per_mass * number(f"{contact}damping_n_s_per_m"),
    )


def _face_path(actuator: object) -> str:
    """Give the path of the mass that touches the part: the tip of a stack, or the tool."""
    stack = isinstance(actuator, FeedAxis) and isinstance(actuator.tip, Piezo)
    return "actuator.tip.tip_mass_kg" if stack else "actuator.tool_mass_kg"


def _of_faces_s(axis: FeedAxis, number: _Numbers) -> Needed:
    """Tool between axis and contact or stack; tip between stack and contact."""
    contact = "actuator.contact.stiffness_n_per_m"
    before = contact
    if isinstance(axis.tip, Piezo):
        before = "actuator.tip.stiffness_n_per_m"
        mass = "actuator.tip.tip_mass_kg"
        tip_s = OF_TIP * np.sqrt(number(mass) / (number(before) + number(contact)))
        yield f"{mass}, {before}, {contact}", tip_s
    mass, spring = "actuator.tool_mass_kg", "actuator.stiffness_n_per_m"
    tool_s = OF_TOOL * np.sqrt(number(mass) / (number(spring) + number(before)))
    yield f"{mass}, {spring}, {before}", tool_s
