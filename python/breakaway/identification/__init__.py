"""Identification: from a measured log to the parameters of a part and its joint."""

from __future__ import annotations

from breakaway.identification.cascade import Cascade
from breakaway.identification.censored import FittedDistribution, fit_distribution
from breakaway.identification.comparison import ComparedLaw, compare_laws
from breakaway.identification.events import (
    BreakawayEvent,
    BreakawayReport,
    find_breakaway_events,
)
from breakaway.identification.identifiability import Identifiability, identifiability
from breakaway.identification.identify import identify
from breakaway.identification.inertia_friction import (
    NOT_IDENTIFIED,
    AsymmetricFit,
    InertiaFrictionFit,
    SymmetricFit,
    identify_inertia_friction,
)
from breakaway.identification.joint_file import JointFile
from breakaway.identification.laws import LAWS
from breakaway.identification.population import Population, fit_population
from breakaway.identification.prediction import Prediction
from breakaway.identification.result import Identification
from breakaway.identification.sliding import Reversal, SlidingLevel
from breakaway.identification.uncertainty import Posterior, Profile
from breakaway.identification.verdicts import Estimate, Excitation, Verdict

__all__ = [
    "LAWS",
    "NOT_IDENTIFIED",
    "AsymmetricFit",
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
    "SlidingLevel",
    "SymmetricFit",
    "Verdict",
    "compare_laws",
    "find_breakaway_events",
    "fit_distribution",
    "fit_population",
    "identifiability",
    "identify",
    "identify_inertia_friction",
]
