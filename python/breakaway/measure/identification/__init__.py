"""Identification: from a measured log to the parameters of a part and its joint."""

from __future__ import annotations

from breakaway.measure.identification.blank import Blank, BlankFigure, rig_from_blank
from breakaway.measure.identification.cascade import Cascade
from breakaway.measure.identification.censored import FittedDistribution, fit_distribution
from breakaway.measure.identification.comparison import ComparedLaw, compare_laws
from breakaway.measure.identification.events import (
    BreakawayEvent,
    BreakawayReport,
    Spike,
    find_breakaway_events,
)
from breakaway.measure.identification.fitted_parts import parts_of_pulls
from breakaway.measure.identification.identifiability import Identifiability, identifiability
from breakaway.measure.identification.identify import identify
from breakaway.measure.identification.inertia_friction import (
    NOT_IDENTIFIED,
    AsymmetricFit,
    InertiaFrictionFit,
    SymmetricFit,
    identify_inertia_friction,
)
from breakaway.measure.identification.joint_file import JointFile
from breakaway.measure.identification.laws import LAWS
from breakaway.measure.identification.population import Population, fit_population
from breakaway.measure.identification.prediction import Prediction
from breakaway.measure.identification.pulled_joint import joint_from_pull
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.sliding import Reversal, SlidingLevel
from breakaway.measure.identification.uncertainty import Posterior, Profile
from breakaway.measure.identification.verdicts import Estimate, Excitation, Verdict

__all__ = [
    "LAWS",
    "NOT_IDENTIFIED",
    "AsymmetricFit",
    "Blank",
    "BlankFigure",
    "BreakawayEvent",
    "BreakawayReport",
    "Cascade",
    "ComparedLaw",
    "Estimate",
    "Excitation",
    "FittedDistribution",
    "Identifiability",
    "Identification",
    "InertiaFrictionFit",
    "JointFile",
    "Population",
    "Posterior",
    "Prediction",
    "Profile",
    "Reversal",
    "RigFile",
    "SlidingLevel",
    "Spike",
    "SymmetricFit",
    "Verdict",
    "compare_laws",
    "find_breakaway_events",
    "fit_distribution",
    "fit_population",
    "identifiability",
    "identify",
    "identify_inertia_friction",
    "joint_from_pull",
    "parts_of_pulls",
    "rig_from_blank",
]
