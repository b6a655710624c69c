"""Identification: from a measured log to the parameters of a part and its joint."""

from __future__ import annotations

from breakaway.identification.cascade import Cascade
from breakaway.identification.comparison import ComparedLaw, compare_laws
from breakaway.identification.identify import Estimate, Identification, identify
from breakaway.identification.inertia_friction import (
    NOT_IDENTIFIED,
    AsymmetricFit,
    InertiaFrictionFit,
    SymmetricFit,
    identify_inertia_friction,
)
from breakaway.identification.joint_file import JointFile
from breakaway.identification.laws import LAWS
from breakaway.identification.prediction import Prediction
from breakaway.identification.uncertainty import Posterior, Profile
from breakaway.identification.verdicts import Excitation, Verdict

__all__ = [
    "LAWS",
    "NOT_IDENTIFIED",
    "AsymmetricFit",
    "Cascade",
    "ComparedLaw",
    "Estimate",
    "Excitation",
    "Identification",
    "InertiaFrictionFit",
    "JointFile",
    "Posterior",
    "Prediction",
    "Profile",
    "SymmetricFit",
    "Verdict",
    "compare_laws",
    "identify",
    "identify_inertia_friction",
]
