"""How friction varies in a study of agreement: one word for each way, and the scenario under it."""

from __future__ import annotations

from typing import Literal

from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.disturbance import FieldDisturbance, UniformDisturbance
from breakaway.model.scenario.scenario import Scenario

AskedDisturbance = Literal["joint_force", "friction_level", "field", "part", "none"]
"""The paper's random factor on the joint force or on the friction level; friction that varies along
the way, or from part to part; or undisturbed."""
REDRAWN = ("joint_force", "friction_level")
"""Those that are drawn anew in time."""
OWN = "variant's own"
"""What stands for the disturbance where variants differ in it."""
USUAL_HOLD_S = 1e-3
"""Time between redraws of the random factor where the scenario says none."""
LEFT_OUT: dict[str, tuple[str, ...]] = {
    "part": ("disturbance.hold_s", "disturbance.bandwidth_hz"),
    "none": tuple(f"disturbance.{name}" for name in UniformDisturbance.model_fields),
}
"""Disturbance -> numbers of a scenario that mean nothing there, although it has them."""


def own_disturbance(scenario: Scenario) -> str:
    """Name the disturbance that a scenario has."""
    disturbance = scenario.disturbance
    return "field" if disturbance.kind == "field" else disturbance.acts_on


def with_disturbance(scenario: Scenario, asked: str, correlation_length_m: float) -> Scenario:
    """Give a scenario whose friction varies as asked, with the size that it has.

    Raises
    ------
    StudyError
        The scenario cannot have it; the message says why.

    Examples
    --------
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed").with_({"disturbance.var": 0.3})
    >>> with_disturbance(scenario, "field", 1e-3).disturbance
    FieldDisturbance(kind='field', law='bounded', var=0.3, correlation_length_m=0.001)
    >>> with_disturbance(scenario, "part", 1e-3).disturbance.hold_s
    0.5

    """
    try:
        if asked == "field":
            return _along_the_way(scenario, correlation_length_m)
        if asked == "part":
            return _redrawn(scenario, "friction_level", scenario.timing.duration_s)
        if asked == "none":
            return scenario.with_(disturbance=UniformDisturbance())
        return scenario if asked == OWN else _redrawn(scenario, asked, None)
    except ScenarioError as error:
        raise StudyError(f"agreement.disturbances: ({asked}) {error}") from None


def _along_the_way(scenario: Scenario, correlation_length_m: float) -> Scenario:
    own = scenario.disturbance
    if own.kind == "field":
        return scenario
    field = FieldDisturbance(var=own.var, correlation_length_m=correlation_length_m)
    return scenario.with_(disturbance=field)


def _redrawn(scenario: Scenario, acts_on: str, hold_s: float | None) -> Scenario:
    """Give the random factor, as it is or with another hold time; in place of a field."""
    own = scenario.disturbance
    changes: dict[str, object] = {"acts_on": acts_on} | (
        {} if hold_s is None else {"hold_s": hold_s}
    )
    if own.kind != "field":
        return scenario.with_({f"disturbance.{name}": value for name, value in changes.items()})
    values = {"kind": "paper_random_factor", "law": "uniform", "var": own.var}
    return scenario.with_(disturbance=values | {"hold_s": USUAL_HOLD_S} | changes)
