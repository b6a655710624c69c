"""The parts that an advice is for: a population, or what a joint file leaves open."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from breakaway.base.reading import read_toml
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.distribution import Samples
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.files import load_population, preset_names
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.population import QUANTITIES, PartPopulation

Array = NDArray[np.float64]

ASSUMED = "seized_parts"
"""The population whose ranges stand for what a joint file does not tell."""
USUAL_LAWS: tuple[Law, ...] = ("lugre", "elasto_plastic", "gms")
"""Laws that are asked; a log of one pull excludes none of them."""


@dataclass(frozen=True)
class Parts:
    """Whom the advice is for."""

    name: str
    """Name of the file or the preset."""
    population: PartPopulation
    """The parts."""
    told: tuple[str, ...]
    """Quantities that were measured."""
    assumed: tuple[str, ...]
    """Quantities whose ranges are assumed."""
    provenance: tuple[str, ...]
    """Where what is known comes from, in sentences."""
    laws: tuple[Law, ...] = USUAL_LAWS
    """Friction laws that are asked."""


def parts_of(source: str | Path | PartPopulation | JointFile) -> Parts:
    """Find out whom the advice is for.

    Raises
    ------
    ScenarioError
        There is no such file, or it is neither a population nor a joint file.

    """
    if isinstance(source, PartPopulation):
        return Parts(source.name, source, (), QUANTITIES, (source.description,))
    if isinstance(source, JointFile):
        return _of_joint(source, source.provenance.log)
    if source in preset_names("populations"):
        population = load_population(source)
        return Parts(str(source), population, (), QUANTITIES, (population.description,))
    try:
        is_joint = "provenance" in read_toml(Path(source))
    except (OSError, ValueError):
        is_joint = False  # whoever reads it as a population says what is wrong
    if is_joint:
        return _of_joint(JointFile.load(source), Path(source).name)
    population = load_population(source)
    return Parts(Path(source).name, population, QUANTITIES, (), (population.description,))


def at_rig(population: PartPopulation, rig: ExtractionRig) -> PartPopulation:
    """Give the parts before the clock and the sensors of a rig."""
    return population.model_copy(
        update={
            "control_period_s": rig.control_period_s,
            "one_sample_delay": rig.one_sample_delay,
            "sensors": rig.sensors,
            "watch": None,
        }
    )


def _of_joint(file: JointFile, name: str) -> Parts:
    """Give parts with the numbers that a joint file tells, and the assumed ranges of all others."""
    assumed = load_population(ASSUMED)
    table = _told(file, assumed)
    ranges = {key: Samples(values=tuple(v.tolist()), rows="shared") for key, v in table.items()}
    population = assumed.model_copy(
        update={
            "name": "this joint",
            "description": f"Joints that {file.provenance.log} allows",
            "parts": assumed.parts.model_copy(update=ranges),
        }
    )
    return Parts(
        name,
        population,
        tuple(table),
        tuple(name for name in QUANTITIES if name not in table),
        _provenance(file),
    )


def _provenance(file: JointFile) -> tuple[str, ...]:
    """Say which log tells what, and how surely."""
    made = file.provenance
    digest = f", SHA-256 {made.log_sha256}" if made.log_sha256 else ""
    intervals = "; ".join(
        f"{name} {low:.4g} to {high:.4g}" for name, (low, high) in file.interval.items()
    )
    return (
        f"log {made.log}{digest}, {made.samples} samples, by {made.method}",
        *([f"95 % intervals: {intervals}"] if intervals else []),
        *made.notes,
    )


def _told(file: JointFile, assumed: PartPopulation) -> dict[str, Array]:
    """Give the quantities of a part that draws of a joint file tell, row by row.

    F_s = ratio F_c where the log does not show a peak, with the assumed range of the ratio.
    """
    draws = {path: np.asarray(values) for path, values in _draws(file).items()}
    if "joint.coulomb_n" not in draws and "joint.stiction_n" not in draws:
        raise ScenarioError(
            f"{file.provenance.log}: the joint file tells neither stiction nor Coulomb friction, "
            "so nothing can be advised; identify the joint from a log that shows either"
        )
    count = len(next(iter(draws.values())))
    ratio = assumed.parts.stiction_ratio.quantile(_spread(count))
    if "joint.coulomb_n" not in draws:
        return {"stiction_n": draws["joint.stiction_n"]} | _others(draws, draws["joint.stiction_n"])
    coulomb = draws["joint.coulomb_n"]
    stiction = draws.get("joint.stiction_n", ratio * coulomb)
    rows = {"stiction_n": stiction, "stiction_ratio": stiction / coulomb}
    return rows | _others(draws, stiction)


def _draws(file: JointFile) -> Mapping[str, list[float]]:
    if file.draws is None:
        raise ScenarioError(
            f"{file.provenance.log}: the joint file has no draws, so its spread is not known; "
            "identify the joint again"
        )
    return file.draws.values


def _others(draws: Mapping[str, Array], stiction_n: Array) -> dict[str, Array]:
    found = {}
    if "joint.stiffness_n_per_m" in draws:
        found["presliding_m"] = stiction_n / draws["joint.stiffness_n_per_m"]
    for path, name in (
        ("joint.stribeck_velocity_m_per_s", "stribeck_velocity_m_per_s"),
        ("part.mass_kg", "mass_kg"),
    ):
        if path in draws:
            found[name] = draws[path]
    return found


def _spread(count: int) -> Array:
    """Give shares that fill 0 to 1 evenly, in an order that follows no other column."""
    return (np.random.default_rng(0).permutation(count) + 0.5) / count
