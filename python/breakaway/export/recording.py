"""A recorded step, with everything that is known of its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from breakaway import _core
from breakaway.errors import ScenarioError
from breakaway.export.interface import Real, Variable, What, flow, parameter, state
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import core_job


@dataclass(frozen=True)
class Body:
    """A function body in C, and which structures and helpers it uses."""

    text: str
    uses: frozenset[str]


@dataclass(frozen=True)
class Routine:
    """A stretch of a step."""

    name: str
    times: int
    body: Body


@dataclass(frozen=True)
class Recording:
    """The step of a controller, a plant or a loop in C, in pieces."""

    what: What
    real: Real
    scenario: Scenario
    """The resolved scenario."""
    parameters: list[Variable]
    inputs: list[Variable]
    outputs: list[Variable]
    states: list[Variable]
    derived: list[tuple[str, str]]
    """Name and formula of what follows from parameters alone."""
    signals: list[str]
    derive: Body
    routines: list[Routine]
    helpers: dict[str, str]
    """Bodies and constants of helper functions."""
    draw_functions: list[tuple[str, list[str], str]]
    """Name, arguments and body of what random draws compute with numbers."""

    @property
    def uses(self) -> frozenset[str]:
        """Everything that any routine uses."""
        return self.derive.uses.union(*(routine.body.uses for routine in self.routines))


def record(resolved: Scenario, what: What, real: Real) -> Recording:
    """Record a part of a resolved scenario."""
    if real == "float" and what != "controller" and resolved.disturbance.kind == "field":
        raise ScenarioError(
            "disturbance.kind: 'field' is a hash of whole numbers that float cannot hold; export "
            "with real = double, or the controller alone"
        )
    found = _core.export_code(core_job(resolved, 0), what, real)
    parameters = [parameter(resolved, *one) for one in found["parameters"]]
    _check_defaults(parameters, real)
    return Recording(
        what=what,
        real=real,
        scenario=resolved,
        parameters=parameters,
        inputs=_inputs(what, found["inputs"]),
        outputs=flow(what, "output", found["outputs"]),
        states=[state(*one) for one in found["states"]],
        derived=found["derived"],
        signals=found["signals"],
        derive=_body(found["derive"]),
        routines=[Routine(name, times, _body(body)) for name, times, body in found["routines"]],
        helpers={name: found[name] for name in ("exp2_fraction", "exp2_power", "round")},
        draw_functions=found["draw_functions"],
    )


def _inputs(what: What, names: list[str]) -> list[Variable]:
    """Describe the inputs; a controller that senses nothing still gets the position."""
    if what == "controller" and not names:
        names = ["position_m"]
    return flow(what, "input", names)


def _body(found: dict[str, Any]) -> Body:
    return Body(found["text"], frozenset(name for name, used in found.items() if used is True))


def _check_defaults(parameters: list[Variable], real: Real) -> None:
    """Refuse a number that the real type cannot hold within its range."""
    from numpy import float32

    if real == "double":
        return
    for one in parameters:
        held = float(float32(one.value))
        if not one.range.holds(held):
            raise ScenarioError(
                f"{one.path}: {one.value!r} is {held!r} as float, outside its range; export with "
                "real = double"
            )
