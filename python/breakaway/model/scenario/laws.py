"""Friction laws: how each is called, its usual numbers, and what it takes of a part."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from breakaway.model.scenario.joint import (
    ELEMENTS_MAX,
    AnyJoint,
    CoulombStiction,
    ElastoPlastic,
    Gms,
    Lugre,
    TwoRegion,
)
from breakaway.model.scenario.model import Model, Positive

Numbers = TypeVar("Numbers", float, NDArray[np.float64])
"""The number of one part, or those of many."""
_MODELS: dict[str, type[AnyJoint]] = {
    model.model_fields["law"].default: model for model in get_args(AnyJoint)
}
LAWS = tuple(_MODELS)
"""Friction laws, by the tag of their joint."""
if TYPE_CHECKING:
    Law = str
else:
    Law = Literal[LAWS]


class LawNumbers(Model):
    """What some friction laws need besides the quantities of a part."""

    elastic_share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.7
    """Elasto-plastic: share of the steady deflection that is elastic; assumed. What vibration is
    worth under this law depends on it (docs/agreement.md)."""
    gms_elements: Annotated[int, Field(ge=4, le=ELEMENTS_MAX)] = 4
    """Generalized Maxwell-slip: number of elements."""
    gms_lag_s: Positive = 1e-3
    """Generalized Maxwell-slip: F_s0 over the attraction: how friction lags while sliding, in s."""


@dataclass(frozen=True)
class LawEntry:
    """What is known of a friction law beside its model."""

    words: str
    """Its name for people."""
    shared: Callable[[LawNumbers], dict[str, float]] = lambda _: {}
    """Its own numbers that all parts of a population have in common."""
    of_part: Callable[[LawNumbers, Any], dict[str, Any]] = lambda *_: {}
    """Its own numbers that follow from the stiction force of a part, in N."""


_ENTRIES: Mapping[type[AnyJoint], LawEntry] = {
    Lugre: LawEntry("LuGre"),
    ElastoPlastic: LawEntry(
        "elasto-plastic", shared=lambda usual: {"elastic_share": usual.elastic_share}
    ),
    Gms: LawEntry(
        "generalized Maxwell-slip",
        shared=lambda usual: {"elements": usual.gms_elements},
        of_part=lambda usual, stiction_n: {"attraction_n_per_s": stiction_n / usual.gms_lag_s},
    ),
    TwoRegion: LawEntry("two-region"),
    CoulombStiction: LawEntry("Coulomb with stiction"),
}
LAW_WORDS = {law: _ENTRIES[model].words for law, model in _MODELS.items()}
"""Friction law -> its name in words."""


def stiffness_of(parts: Mapping[str, Numbers]) -> Numbers:
    """Give k_e of a part, or of many, in N/m: it breaks loose after its presliding travel."""
    return parts["stiction_n"] / parts["presliding_m"]


def numbers_of_parts(
    law: Law, usual: LawNumbers, parts: Mapping[str, Numbers]
) -> dict[str, Numbers]:
    """Give what differs from part to part in a joint under a law.

    Parameters
    ----------
    law : str
        The law.
    usual : LawNumbers
        Numbers of laws that have some of their own.
    parts : mapping
        Quantities of a part, or of many, by the names of a population.

    Returns
    -------
    dict
        Numbers of the joint's model by name: of those that any part has, what the law has a place
        for, and what is its own.

    Examples
    --------
    >>> part = {"stiction_n": 450.0, "stiction_ratio": 1.25, "presliding_m": 1.25e-5,
    ...         "bristle_damping_ratio": 0.75, "stribeck_velocity_m_per_s": 0.09,
    ...         "mass_kg": 1.0, "engagement_length_m": 0.1}
    >>> sorted(numbers_of_parts("coulomb_stiction", LawNumbers(), part))
    ['coulomb_n', 'engagement_length_m', 'stiction_n', 'stribeck_velocity_m_per_s']
    >>> numbers_of_parts("gms", LawNumbers(), part)["attraction_n_per_s"]
    450000.0

    """
    stiffness = stiffness_of(parts)
    of_any = {
        "stiction_n": parts["stiction_n"],
        "coulomb_n": parts["stiction_n"] / parts["stiction_ratio"],
        "engagement_length_m": parts["engagement_length_m"],
        "stribeck_velocity_m_per_s": parts["stribeck_velocity_m_per_s"],
        "stiffness_n_per_m": stiffness,
        "damping_n_s_per_m": 2.0
        * parts["bristle_damping_ratio"]
        * np.sqrt(stiffness * parts["mass_kg"]),
    }
    model = _MODELS[law]
    taken = {name: value for name, value in of_any.items() if name in model.model_fields}
    return taken | _ENTRIES[model].of_part(usual, parts["stiction_n"])


def shared_numbers(law: Law, usual: LawNumbers) -> dict[str, float]:
    """Give the numbers of a law's own that all parts have in common.

    Examples
    --------
    >>> shared_numbers("gms", LawNumbers()), shared_numbers("lugre", LawNumbers())
    ({'elements': 4}, {})

    """
    return _ENTRIES[_MODELS[law]].shared(usual)


def joint_under(law: Law, joint: AnyJoint, numbers: Mapping[str, Any]) -> AnyJoint:
    """Give the joint another friction law with the same levels, stiffness, damping and so on.

    Parameters
    ----------
    law : str
        The law.
    joint : Lugre, ElastoPlastic, Gms, TwoRegion or CoulombStiction
        The joint whose numbers are taken where the law has a place for them. A number that the law
        needs and the joint lacks is the usual one.
    numbers : mapping
        Numbers of the law that replace them.

    Raises
    ------
    ScenarioError
        The law needs a number that nothing gives, or a number is not valid.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> joint_under("elasto_plastic", joint, {"elastic_share": 0.9}).stiffness_n_per_m
    36000000.0
    >>> joint_under("gms", joint, {"elements": 2})
    Traceback (most recent call last):
        ...
    breakaway.errors.ScenarioError: elements: 2 is not >= 4; give ...

    """
    return _MODELS[law](**values_under(law, joint, numbers))


def values_under(law: Law, joint: AnyJoint, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Give the values of a joint under another law, as `joint_under` makes them, unchecked."""
    model, usual = _MODELS[law], LawNumbers()
    entry = _ENTRIES[model]
    own = entry.shared(usual) | entry.of_part(usual, joint.stiction_n)
    needed = {name: own[name] for name in own if model.model_fields[name].is_required()}
    known = joint.model_dump(exclude_none=True)
    kept = {name: known[name] for name in model.model_fields if name in known}
    return {**needed, **kept, **numbers, "law": law}


def laws_with(names: Mapping[str, Any] | set[str]) -> list[Law]:
    """Give the laws whose joints have all of these numbers.

    Examples
    --------
    >>> laws_with({"elastic_share", "coulomb_n"})
    ['elasto_plastic']

    """
    return [law for law, model in _MODELS.items() if set(names) <= set(model.model_fields)]
