"""Identification: from a measured log to the parameters of a part and its joint."""

from __future__ import annotations

from breakaway.identification.inertia_friction import (
    NOT_IDENTIFIED,
    AsymmetricFit,
    InertiaFrictionFit,
    SymmetricFit,
    identify_inertia_friction,
)
from breakaway.identification.joint_file import JointFile

__all__ = [
    "NOT_IDENTIFIED",
    "AsymmetricFit",
    "InertiaFrictionFit",
    "JointFile",
    "SymmetricFit",
    "identify_inertia_friction",
]
