"""What exported code takes and gives: names, units, meanings and ranges."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf
from typing import Any, Literal

from pydantic import BaseModel

from breakaway.model.scenario.model import properties
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.units import unit_of

What = Literal["controller", "plant", "loop"]
"""What of a scenario is exported."""
Real = Literal["float", "double"]
"""The real type of the code."""


@dataclass(frozen=True)
class Range:
    """The numbers that a parameter may be."""

    minimum: float | None = None
    maximum: float | None = None
    above: bool = False
    """Whether the minimum itself is not allowed."""
    below: bool = False
    """Whether the maximum itself is not allowed."""
    infinite: bool = False
    """Whether it may be infinite: a limit that is left out."""

    @property
    def told(self) -> str:
        """The range in words."""
        if self.minimum is None and self.maximum is None:
            told = "any"
        else:
            low = "" if self.minimum is None else f"{'>' if self.above else '>='} {self.minimum:g}"
            high = "" if self.maximum is None else f"{'<' if self.below else '<='} {self.maximum:g}"
            told = ", ".join(part for part in (low, high) if part)
        return f"{told}, or infinite for none" if self.infinite else told

    def holds(self, value: float) -> bool:
        """Whether a number is allowed."""
        low = -inf if self.minimum is None else self.minimum
        high = inf if self.maximum is None else self.maximum
        above = value > low if self.above else value >= low
        below = value < high if self.below else value <= high
        return above and below and (self.infinite or not isinf(value))


@dataclass(frozen=True)
class Variable:
    """A parameter, an input, an output or a state of exported code."""

    name: str
    """Its name in C."""
    path: str
    """Where it is in the scenario, or in the state of the core."""
    unit: str
    """Its SI unit, ``1`` where it has none."""
    description: str
    """What it is."""
    value: float = 0.0
    """Its default, or what it is after a reset."""
    literal: str = "0.0"
    """That number in C."""
    range: Range = Range()
    """What it may be."""


FLOW: dict[str, dict[str, str]] = {
    "controller.input": {
        "position_m": "Measured position of the part: 0 on its seat, growing as it comes out.",
        "velocity_m_per_s": "Measured velocity of the part.",
        "force_n": "Measured force on the part.",
    },
    "controller.output": {
        "force_n": "Force to push the part with.",
        "feed_m_per_s": "Speed of the feed.",
        "stack_share": "Share of the piezo stack's full voltage, 0 to 1.",
        "stop_reason": "Why the watch has stopped the controller: 1 not a number, 2 the position "
        "jumps, 3 it is frozen, 4 the clock stands still; 0 while it has not.",
        "reference_m": "Where the part should be at this sample.",
    },
    "plant.input": {
        "force_n": "Commanded force.",
        "feed_m_per_s": "Commanded speed of the feed.",
        "stack_share": "Commanded share of the piezo stack's full voltage, 0 to 1.",
    },
    "plant.output": {
        "measured_position_m": "Position as its sensor shows it at the next sample.",
        "measured_velocity_m_per_s": "Velocity at the next sample; its sensor is ideal.",
        "measured_force_n": "Force as its sensor shows it at the next sample.",
        "position_m": "Position at the end of the period.",
        "velocity_m_per_s": "Velocity at the end of the period.",
        "bristle_m": "Deflection of the bristles at the end of the period.",
        "applied_force_n": "Force on the part, the mean of the period.",
        "joint_force_n": "Force of the joint, the mean of the period.",
    },
    "loop.output": {
        "reference_m": "Where the part should be at the sample that begins the period.",
        "command_force_n": "Commanded force of the period.",
        "command_feed_m_per_s": "Commanded speed of the feed in the period.",
        "command_stack_share": "Commanded share of the stack's full voltage in the period.",
        "stop_reason": "Why the watch has stopped the controller; 0 while it has not.",
        "position_m": "Position at the end of the period.",
        "velocity_m_per_s": "Velocity at the end of the period.",
        "bristle_m": "Deflection of the bristles at the end of the period.",
        "applied_force_n": "Force on the part, the mean of the period.",
        "joint_force_n": "Force of the joint, the mean of the period.",
    },
}
"""Inputs and outputs of what is exported -> their meaning."""

LIMITS = {"m": 1e3, "m/s": 1e4, "N": 1e9, "1": 1.0}
"""Unit of an input -> largest magnitude that is not taken for a fault."""


def flow(what: What, direction: str, names: list[str]) -> list[Variable]:
    """Describe inputs or outputs."""
    told = FLOW.get(f"{what}.{direction}", {})
    variables = []
    for name in names:
        unit = unit_of(name).symbol
        limit = LIMITS[unit]
        bounds = Range(-limit, limit) if direction == "input" else Range()
        variables.append(Variable(name, name, unit, told[name], range=bounds))
    return variables


_KEY = Range(-(2.0**25), 2.0**25)
CORE_ONLY: dict[str, tuple[str, str, Range]] = {
    "variation.field.keys.first": (
        "1",
        "What makes the field the run's own: a whole number.",
        _KEY,
    ),
    "variation.field.keys.second": ("1", "What makes the field the run's own: another.", _KEY),
    "variation.field.keys.offset": ("1", "Where in its cell the field begins.", Range(0.0, 1.0)),
    "variation.drift.at": ("1", "Place of a point of the drift, in s or m.", Range()),
    "variation.drift.values": ("1", "Factor on the friction levels there.", Range(0.0, above=True)),
    "variation.normal_force.constant_n": ("N", "Normal force beside its course.", Range()),
    "variation.normal_force.course_gain": ("1", "What the course is multiplied by.", Range()),
    "variation.normal_force.course.at": (
        "1",
        "Place of a point of the course, in s or m.",
        Range(),
    ),
    "variation.normal_force.course.values": ("1", "The course there.", Range()),
}
"""Numbers that only the core has -> unit, meaning and range."""
_TABLES = (
    ("variation.field.", "disturbance."),
    ("variation.normal_force.", "joint.normal_force."),
)
"""Tables of the core -> where the scenario has them."""


def parameter(scenario: Scenario, path: str, name: str, value: float, literal: str) -> Variable:
    """Describe a number of a resolved scenario, by its path among the core's numbers."""
    plain = ".".join(part for part in path.split(".") if not part.isdigit())
    if plain in CORE_ONLY:
        unit, description, bounds = CORE_ONLY[plain]
        return Variable(name, path, unit, description, value, literal, bounds)
    path = _in_scenario(path)
    owner: BaseModel = scenario
    *parents, last = [part for part in path.split(".") if not part.isdigit()]
    for parent in parents:
        owner = getattr(owner, parent)
    described = type(owner).model_fields[last].description or ""
    description = " ".join(described.split())
    bounds = _range(properties(type(owner))[last], optional=isinf(value))
    return Variable(name, path, unit_of(path).symbol, description, value, literal, bounds)


def state(path: str, name: str, value: float, literal: str) -> Variable:
    """Describe a state by its path in the state of the core."""
    block, _, last = path.partition(".")
    described = f"State of the {block}: {last}."
    return Variable(name, path, unit_of(path).symbol, described, value, literal)


def _in_scenario(path: str) -> str:
    """The path of a core's number in the scenario: there, the numbers of a sensor have units."""
    if path.startswith("sensors."):
        _, which, name = path.split(".")
        if name in ("noise_rms", "quantum"):
            return f"{path}{'_m' if which == 'position' else '_n'}"
    for core, ours in _TABLES:
        if path.startswith(core):
            return f"{ours}{path.removeprefix(core)}"
    return path


def _range(schema: dict[str, Any], *, optional: bool) -> Range:
    """Read the range of a field from its JSON schema."""
    options = [one for one in schema.get("anyOf", [schema]) if one.get("type") != "null"]
    one = options[0].get("items", options[0])
    above, below = "exclusiveMinimum" in one, "exclusiveMaximum" in one
    return Range(
        one.get("exclusiveMinimum", one.get("minimum")),
        one.get("exclusiveMaximum", one.get("maximum")),
        above=above,
        below=below,
        infinite=optional,
    )
