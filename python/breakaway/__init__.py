"""Free seized parts: identify a joint, design a controller, simulate the extraction.

>>> import breakaway as bk
>>> run = bk.simulate(bk.load_scenario("paper_as_computed"))
>>> str(run.outcome)
'released'
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from breakaway._core import __version__
from breakaway.errors import BreakawayError, LogError, OutputError, ScenarioError, StudyError

if TYPE_CHECKING:
    from breakaway import design
    from breakaway.batch import Batch, draw_columns, grid_columns, simulate_many
    from breakaway.identification import (
        BreakawayEvent,
        BreakawayReport,
        Cascade,
        ComparedLaw,
        Estimate,
        Identifiability,
        Identification,
        JointFile,
        Population,
        Posterior,
        Prediction,
        compare_laws,
        find_breakaway_events,
        fit_population,
        identifiability,
        identify,
        identify_inertia_friction,
    )
    from breakaway.imposed import ImposedMotion, impose_motion
    from breakaway.logs import Channel, Finding, Log, derive_motion, noise_floor, read_log
    from breakaway.resolution import resolve
    from breakaway.run import Outcome, Run, RunMetrics
    from breakaway.scenario import (
        BandLimitedDisturbance,
        FmPulses,
        FmVibration,
        Gains,
        GaussianDisturbance,
        IdealActuator,
        Limits,
        LogNormal,
        LogUniform,
        Lugre,
        MinimumJerk,
        Normal,
        Part,
        Pid,
        PidSettings,
        PolePlacement,
        PushOnlyActuator,
        RampReference,
        Samples,
        Scenario,
        StepReference,
        Timing,
        Trace,
        TrapezoidalVelocity,
        TwoRegion,
        TwoStep,
        Uniform,
        UniformDisturbance,
        load_scenario,
        preset_names,
        save_scenario,
        scenario_schema,
    )
    from breakaway.simulation import simulate
    from breakaway.studies import (
        ComparedController,
        CompareStudy,
        CompareTable,
        RobustnessStudy,
        RobustnessTable,
        SensitivityStudy,
        SensitivityTable,
        StudyProgress,
        StudyResult,
        SweepStudy,
        SweepTable,
        load_study,
        open_study,
        run_study,
    )

# Where each public name lives; loaded on first use, so that `import breakaway` stays quick.
_HOMES = {
    "breakaway.batch": ("Batch", "draw_columns", "grid_columns", "simulate_many"),
    "breakaway.identification": (
        "BreakawayEvent",
        "BreakawayReport",
        "Cascade",
        "ComparedLaw",
        "Estimate",
        "Identifiability",
        "Identification",
        "JointFile",
        "Population",
        "Posterior",
        "Prediction",
        "compare_laws",
        "find_breakaway_events",
        "fit_population",
        "identifiability",
        "identify",
        "identify_inertia_friction",
    ),
    "breakaway.imposed": ("ImposedMotion", "impose_motion"),
    "breakaway.logs": ("Channel", "Finding", "Log", "derive_motion", "noise_floor", "read_log"),
    "breakaway.resolution": ("resolve",),
    "breakaway.run": ("Outcome", "Run", "RunMetrics"),
    "breakaway.scenario": (
        "BandLimitedDisturbance",
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
        "StepReference",
        "Timing",
        "Trace",
        "TrapezoidalVelocity",
        "TwoRegion",
        "TwoStep",
        "Uniform",
        "UniformDisturbance",
        "load_scenario",
        "preset_names",
        "save_scenario",
        "scenario_schema",
    ),
    "breakaway.simulation": ("simulate",),
    "breakaway.studies": (
        "ComparedController",
        "CompareStudy",
        "CompareTable",
        "RobustnessStudy",
        "RobustnessTable",
        "SensitivityStudy",
        "SensitivityTable",
        "StudyProgress",
        "StudyResult",
        "SweepStudy",
        "SweepTable",
        "load_study",
        "open_study",
        "run_study",
    ),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "BandLimitedDisturbance",
    "Batch",
    "BreakawayError",
    "BreakawayEvent",
    "BreakawayReport",
    "Cascade",
    "Channel",
    "CompareStudy",
    "CompareTable",
    "ComparedController",
    "ComparedLaw",
    "Estimate",
    "Finding",
    "FmPulses",
    "FmVibration",
    "Gains",
    "GaussianDisturbance",
    "IdealActuator",
    "Identifiability",
    "Identification",
    "ImposedMotion",
    "JointFile",
    "Limits",
    "Log",
    "LogError",
    "LogNormal",
    "LogUniform",
    "Lugre",
    "MinimumJerk",
    "Normal",
    "Outcome",
    "OutputError",
    "Part",
    "Pid",
    "PidSettings",
    "PolePlacement",
    "Population",
    "Posterior",
    "Prediction",
    "PushOnlyActuator",
    "RampReference",
    "RobustnessStudy",
    "RobustnessTable",
    "Run",
    "RunMetrics",
    "Samples",
    "Scenario",
    "ScenarioError",
    "SensitivityStudy",
    "SensitivityTable",
    "StepReference",
    "StudyError",
    "StudyProgress",
    "StudyResult",
    "SweepStudy",
    "SweepTable",
    "Timing",
    "Trace",
    "TrapezoidalVelocity",
    "TwoRegion",
    "TwoStep",
    "Uniform",
    "UniformDisturbance",
    "__version__",
    "compare_laws",
    "derive_motion",
    "design",
    "draw_columns",
    "find_breakaway_events",
    "fit_population",
    "grid_columns",
    "identifiability",
    "identify",
    "identify_inertia_friction",
    "impose_motion",
    "load_scenario",
    "load_study",
    "noise_floor",
    "open_study",
    "preset_names",
    "read_log",
    "resolve",
    "run_study",
    "save_scenario",
    "scenario_schema",
    "simulate",
    "simulate_many",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever the name stands for
    if name == "design":
        return importlib.import_module("breakaway.design")
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module 'breakaway' has no attribute {name!r}")
    value = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
