"""Trials: a method of extraction on parts of a population that it does not know."""

from __future__ import annotations

from breakaway.run.trials.case import Case
from breakaway.run.trials.parts import draw_parts, part_columns, scenario_of
from breakaway.run.trials.trial import TRIAL_METRICS, Trial, run_trial

__all__ = [
    "TRIAL_METRICS",
    "Case",
    "Trial",
    "draw_parts",
    "part_columns",
    "run_trial",
    "scenario_of",
]
