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
from breakaway.scenario.distribution import (
    Distribution,
    LogNormal,
    LogUniform,
    Normal,
    Samples,
    Uniform,
)
from breakaway.scenario.disturbance import (
    BandLimitedDisturbance,
    GaussianDisturbance,
    UniformDisturbance,
)
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
    "BandLimitedDisturbance",
    "Distribution",
    "FmPulses",
    "FmVibration",
    "Gains",
    "GaussianDisturbance",
    "IdealActuator",
    "Limits",
    "LogNormal",
    "LogUniform",
    "Lugre",
    "MinimumJerk",
    "Normal",
    "Part",
    "Pid",
    "PidSettings",
    "PolePlacement",
    "PushOnlyActuator",
    "RampReference",
    "Samples",
    "Scenario",
    "SeizedJoint",
    "StepReference",
    "Timing",
    "Trace",
    "TrapezoidalVelocity",
    "TwoRegion",
    "TwoStep",
    "Uniform",
    "UniformDisturbance",
    "gain_sets",
    "load_scenario",
    "parse_scenario",
    "preset_names",
    "save_scenario",
    "scenario_schema",
    "scenario_toml",
]
