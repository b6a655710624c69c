"""Which way of running belongs to which kind of study."""

from __future__ import annotations

from breakaway.ask.studies.agreement import AgreementPlan
from breakaway.ask.studies.agreement_study import AgreementStudy
from breakaway.ask.studies.compare import ComparePlan
from breakaway.ask.studies.plan import Plan
from breakaway.ask.studies.robustness import RobustnessPlan
from breakaway.ask.studies.sensitivity import SensitivityPlan
from breakaway.ask.studies.study import (
    CompareStudy,
    RobustnessStudy,
    SensitivityStudy,
    Study,
    SweepStudy,
)
from breakaway.ask.studies.sweep import SweepPlan


def plan_of(study: Study) -> Plan:
    """Give the way in which a study is run.

    Raises
    ------
    StudyError
        The study cannot be run as it is.

    """
    match study:
        case SweepStudy():
            return SweepPlan(study)
        case RobustnessStudy():
            return RobustnessPlan(study)
        case SensitivityStudy():
            return SensitivityPlan(study)
        case CompareStudy():
            return ComparePlan(study)
        case AgreementStudy():
            return AgreementPlan(study)
