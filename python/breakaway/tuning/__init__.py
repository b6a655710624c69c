"""Tuning: numbers of a method chosen on training parts, and scored on unseen ones."""

from __future__ import annotations

from breakaway.tuning.evaluation import Evaluation
from breakaway.tuning.files import load_tuning
from breakaway.tuning.problem import PartRange, ScoreBound, TunedNumber, Tuning
from breakaway.tuning.result import TuningResult, open_tuning
from breakaway.tuning.running import TuningProgress, tune
from breakaway.tuning.scores import Score

__all__ = [
    "Evaluation",
    "PartRange",
    "Score",
    "ScoreBound",
    "TunedNumber",
    "Tuning",
    "TuningProgress",
    "TuningResult",
    "load_tuning",
    "open_tuning",
    "tune",
]
