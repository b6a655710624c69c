"""Scenarios: what is extracted, from what, by what, and how it is run."""

from __future__ import annotations

from breakaway.scenario.actuator import IdealActuator, PushOnlyActuator
from breakaway.scenario.controller import (
    FmPulses,
    FmVibration,
    Gains,
    Pid,
    PidSettings,
    PolePlacement,
    TwoStep,
    gain_sets,
)
from breakaway.scenario.disturbance import UniformDisturbance
from breakaway.scenario.files import (
    load_scenario,
    parse_scenario,
    preset_names,
    save_scenario,
    scenario_schema,
    scenario_toml,
)
from breakaway.scenario.joint import Lugre, Part, SeizedJoint, TwoRegion
from breakaway.scenario.reference import (
    MinimumJerk,
    RampReference,
    StepReference,
    TrapezoidalVelocity,
)
from breakaway.scenario.run import Limits, Timing, Trace
from breakaway.scenario.scenario import Scenario

__all__ = [
    "FmPulses",
    "FmVibration",
    "Gains",
    "IdealActuator",
    "Limits",
    "Lugre",
    "MinimumJerk",
    "Part",
    "Pid",
    "PidSettings",
    "PolePlacement",
    "PushOnlyActuator",
    "RampReference",
    "Scenario",
    "SeizedJoint",
    "StepReference",
    "Timing",
    "Trace",
    "TrapezoidalVelocity",
    "TwoRegion",
    "TwoStep",
    "UniformDisturbance",
    "gain_sets",
    "load_scenario",
    "parse_scenario",
    "preset_names",
    "save_scenario",
    "scenario_schema",
    "scenario_toml",
]
