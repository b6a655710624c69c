"""What a file of each kind starts as: values that run at once, to be edited."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from breakaway.model.scenario import Method, Scenario
    from breakaway.model.scenario.model import Model


class StartKind(StrEnum):
    """Kinds of files that ``breakaway init`` writes."""

    SCENARIO = "scenario"
    POPULATION = "population"
    METHOD = "method"
    RIG = "rig"
    LIMITS = "limits"
    SWEEP = "sweep"
    ROBUSTNESS = "robustness"
    SENSITIVITY = "sensitivity"
    COMPARE = "compare"
    AGREEMENT = "agreement"
    TUNING = "tuning"


PRESET = {
    StartKind.POPULATION: "seized_parts",
    StartKind.METHOD: "steady_feed",
    StartKind.RIG: "screw_jack",
    StartKind.TUNING: "steady_feed",
}
"""Preset that a kind starts from."""
PRESET_OF_OTHERS = "paper_as_computed"
"""That of scenarios and studies."""

USE = {
    StartKind.SCENARIO: "breakaway run {file}",
    StartKind.POPULATION: "breakaway compare {file} --runs 100 --out result",
    StartKind.METHOD: "breakaway compare --method {file} --runs 100 --out result",
    StartKind.RIG: "breakaway advise seized_parts --rig {file} --budget-s 30 --out result",
    StartKind.LIMITS: "breakaway advise seized_parts --limits {file} --budget-s 30 --out result",
    StartKind.TUNING: "breakaway tune {file} --out result",
}
"""Command that takes a file of a kind."""
USE_OF_STUDIES = "breakaway study {file} --out result"
"""That of studies."""


@dataclass(frozen=True)
class Start:
    """A file to start from."""

    model: Model
    """Its values."""
    what: str
    """What it is, in a sentence."""
    named: Mapping[str, str] = field(default_factory=dict)
    """Keys that name a preset or a file."""


def start(kind: StartKind, preset: str, name: str) -> Start:
    """Give what a file of a kind starts as.

    Parameters
    ----------
    kind : StartKind
        The kind.
    preset : str
        Name of a preset, or path of a file: the scenario, population or method that the file is a
        copy of; for a study its scenario, for a tuning its method.
    name : str
        The name that the file gets.

    Raises
    ------
    ScenarioError, StudyError
        There is no such preset or file, or its values do not fit.

    Examples
    --------
    >>> start(StartKind.SWEEP, "paper_as_computed", "mine").model.sweep.grid
    {'disturbance.var': [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]}

    """
    from breakaway.model.scenario import load_method, load_population, load_rig, load_scenario

    label = {"name": name, "description": f"Made from {preset}"}
    if kind is StartKind.SCENARIO:
        return Start(load_scenario(preset).with_(**label), "A scenario of breakaway.")
    if kind is StartKind.POPULATION:
        return Start(_labeled(load_population(preset), label), "A population of parts.")
    if kind is StartKind.METHOD:
        return Start(_labeled(load_method(preset), label), "A method of extraction.")
    if kind is StartKind.RIG:
        return Start(_labeled(load_rig(preset), label), "A rig that frees parts.")
    if kind is StartKind.LIMITS:
        return Start(_limits(name), "What a part and its host may suffer.")
    if kind is StartKind.TUNING:
        return _tuning(preset, label, load_method(preset))
    return _study(kind, preset, label, load_scenario(preset))


def _limits(name: str) -> Model:
    """Give limits of a neck of 10 mm x 10 mm, to be replaced by those of the part."""
    from breakaway.model.scenario import HarmLimits, StressLimit

    neck = StressLimit(place="neck", section_m2=1e-4, material="inconel_718", share=0.3)
    return HarmLimits(name=name, stresses=[neck], jump_max_m=5e-4, release_velocity_max_m_per_s=0.3)


def _labeled(model: Model, label: Mapping[str, str]) -> Model:
    values = {name: getattr(model, name) for name in type(model).model_fields}
    return type(model).parse({**values, **label})


def _study(kind: StartKind, preset: str, label: Mapping[str, str], scenario: Scenario) -> Start:
    from breakaway.ask.studies.files import parse_study

    late = scenario.timing.one_sample_delay
    runs = {StartKind.SENSITIVITY: 64, StartKind.AGREEMENT: 16}.get(kind, 100)
    asked: dict[StartKind, dict[str, Any]] = {
        StartKind.SWEEP: {
            "sweep": {"grid": {"disturbance.var": [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]}},
            "vary": _tenth_more_or_less(scenario),
        },
        StartKind.ROBUSTNESS: {
            "robustness": {
                "over": "disturbance.var",
                "low": 0.05,
                "high": 0.95,
                "resolution": 0.05,
                "failure_probability_max": 0.05,
            }
        },
        StartKind.SENSITIVITY: {"vary": _tenth_more_or_less(scenario)},
        StartKind.COMPARE: {
            "changes": {"disturbance.var": 0.1},
            "compare": {
                "controllers": [
                    {"name": "as it is"},
                    {
                        "name": "without delay" if late else "one sample late",
                        "changes": {"timing.one_sample_delay": not late},
                    },
                ]
            },
        },
        StartKind.AGREEMENT: {
            "changes": {"disturbance.var": 0.1},
            "agreement": {
                "variants": [
                    {"name": "as it is"},
                    {"name": "heavy", "changes": {"part.mass_kg": 2.0 * scenario.part.mass_kg}},
                ]
            },
        },
    }
    common = {"kind": kind.value, "scenario": preset, "runs": runs}
    model = parse_study({**label, **common, **asked[kind]})
    question = " ".join((type(model).__doc__ or "").split("\n\n")[0].split())
    return Start(model, f"A study of the kind {kind.value}. {question}", {"scenario": preset})


def _tenth_more_or_less(scenario: Scenario) -> dict[str, Any]:
    fields = {
        "joint.stiction_n": scenario.joint.stiction_n,
        "part.mass_kg": scenario.part.mass_kg,
    }
    return {
        path: {"distribution": "uniform", "low": _round(0.9 * at), "high": _round(1.1 * at)}
        for path, at in fields.items()
    }


def _tuning(preset: str, label: Mapping[str, str], method: Method) -> Start:
    from breakaway.ask.tuning import Tuning

    population = PRESET[StartKind.POPULATION]
    model = Tuning.parse(
        {
            **label,
            "population": population,
            "method": preset,
            "objectives": ["strict_share", "median_time_to_release_s"],
            "constraints": {"released_share": {"at_least": 0.9}},
            "tune": _half_to_double(method),
            "training_runs": 16,
            "test_runs": {"first": 1_000_000, "runs": 200},
        }
    )
    return Start(model, "A tuning of a method.", {"population": population, "method": preset})


def _half_to_double(method: Method) -> dict[str, Any]:
    """Give ranges for the first numbers of a method's controller that are positive."""
    from breakaway.ask.tuning.numbers import number_of
    from breakaway.model.scenario.model import numbers_of

    found: dict[str, Any] = {}
    for path in numbers_of(method.controller, "controller."):
        value = number_of(method, path)
        if value and value > 0.0 and path not in method.knows and len(found) < MOST_TUNED:
            found[path] = {"low": _round(0.5 * value), "high": _round(2.0 * value), "log": True}
    return found


MOST_TUNED = 3
"""Numbers that a new tuning tunes."""


def _round(value: float) -> float:
    return float(f"{value:.3g}")
