"""Studies: many simulations that answer one question, in a folder that outlives a kill."""

from __future__ import annotations

from breakaway.ask.studies.agreement_study import (
    AgreementStudy,
    AgreementTable,
    AgreementVariant,
    SmallestTable,
)
from breakaway.ask.studies.files import load_study
from breakaway.ask.studies.result import StudyResult, open_study
from breakaway.ask.studies.running import run_study
from breakaway.ask.studies.study import (
    ComparedController,
    CompareStudy,
    CompareTable,
    RobustnessStudy,
    RobustnessTable,
    SensitivityStudy,
    SensitivityTable,
    SweepStudy,
    SweepTable,
)

__all__ = [
    "AgreementStudy",
    "AgreementTable",
    "AgreementVariant",
    "CompareStudy",
    "CompareTable",
    "ComparedController",
    "RobustnessStudy",
    "RobustnessTable",
    "SensitivityStudy",
    "SensitivityTable",
    "SmallestTable",
    "StudyResult",
    "SweepStudy",
    "SweepTable",
    "load_study",
    "open_study",
    "run_study",
]
