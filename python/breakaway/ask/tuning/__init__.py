"""Tuning: numbers of a method chosen on training parts, and scored on unseen ones."""

from __future__ import annotations

from breakaway.ask.tuning.evaluation import Evaluation
from breakaway.ask.tuning.files import load_tuning
from breakaway.ask.tuning.problem import PartRange, ScoreBound, TunedNumber, Tuning
from breakaway.ask.tuning.result import TuningResult, open_tuning
from breakaway.ask.tuning.running import TuningProgress, tune
from breakaway.ask.tuning.scores import Score

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
