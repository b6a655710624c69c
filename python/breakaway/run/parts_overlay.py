"""An identified joint laid over a population: parts with what the log leaves open of one joint."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.distribution import Samples
from breakaway.model.scenario.population import PartPopulation

Array = NDArray[np.float64]

TOLD_BY = {
    "stiction_n": "joint.stiction_n",
    "stiction_ratio": "joint.coulomb_n",
    "presliding_m": "joint.stiffness_n_per_m",
    "bristle_damping_ratio": "joint.damping_n_s_per_m",
    "stribeck_velocity_m_per_s": "joint.stribeck_velocity_m_per_s",
    "mass_kg": "part.mass_kg",
}
"""Quantity of a part -> the field of a joint file that tells it, beside those before it."""


def lay_over_parts(population: PartPopulation, joint: JointFile, name: str) -> PartPopulation:
    """Let the parts be the joints that a file draws; what it has no draws of stays.

    Raises
    ------
    ScenarioError
        The file has no draws; it is called by ``name``.

    """
    try:
        drawn = {path: np.asarray(one.values) for path, one in joint.vary().items()}
    except ScenarioError as error:
        raise ScenarioError(f"{name}: {error}") from None
    rows = _quantities(drawn, population)
    told = {one: Samples(values=tuple(v.tolist()), rows="shared") for one, v in rows.items()}
    assumed = {one: why for one, why in population.assumed.items() if one not in told}
    for one in told:
        if TOLD_BY[one] in joint.assumed:
            assumed[one] = joint.assumed[TOLD_BY[one]].why
    own_share = joint.joint.elastic_share
    laws = {} if own_share is None else {"elastic_share": own_share}
    fields = {one: getattr(population, one) for one in type(population).model_fields}
    return PartPopulation(
        **fields
        | {
            "description": f"{population.description}\nJoints that {joint.provenance.log} leaves "
            f"open ({joint.provenance.method}) as far as that tells".lstrip(),
            "parts": population.parts.model_copy(update=told),
            "correlations": [c for c in population.correlations if not told.keys() & set(c.of)],
            "assumed": assumed,
            "laws": population.laws.model_copy(update=laws),
        }
    )


def _quantities(drawn: Mapping[str, Array], population: PartPopulation) -> dict[str, Array]:
    """Give the quantities of parts, row by row.

    ::

        ratio = F_s / F_c,  presliding = F_s / k,  ζ = c / (2 sqrt(k m))

    Where only F_c is told, F_s has the population's own ratio to it, spread over the rows.
    """
    rows: dict[str, Array] = {}
    for name in ("stribeck_velocity_m_per_s", "mass_kg"):
        if TOLD_BY[name] in drawn:
            rows[name] = drawn[TOLD_BY[name]]
    coulomb, stiction = drawn.get("joint.coulomb_n"), drawn.get("joint.stiction_n")
    if stiction is None and coulomb is not None:
        stiction = coulomb * population.parts.stiction_ratio.quantile(_spread(len(coulomb)))
    if stiction is None:
        return rows
    rows["stiction_n"] = stiction
    if coulomb is not None:
        rows["stiction_ratio"] = stiction / coulomb
    k, c = drawn.get("joint.stiffness_n_per_m"), drawn.get("joint.damping_n_s_per_m")
    if k is not None:
        rows["presliding_m"] = stiction / k
        if c is not None and "mass_kg" in rows:
            rows["bristle_damping_ratio"] = c / (2.0 * np.sqrt(k * rows["mass_kg"]))
    return rows


def _spread(count: int) -> Array:
    """Give shares that fill 0 to 1 evenly, in an order that follows no other column."""
    return (np.random.default_rng(0).permutation(count) + 0.5) / count
