"""The parts that an advice is for: a population, or what a joint file leaves open."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from breakaway.base.reading import read_toml
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.distribution import Uniform
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.files import load_population, preset_names
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.population import QUANTITIES, PartPopulation
from breakaway.run.parts_overlay import lay_over_parts

ASSUMED = "seized_parts"
"""The population whose ranges stand for what a joint file does not tell."""
LONGEST_GUIDE_M = 10.0
"""A longer guide is a slip of the unit."""
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
        There is no such file, or it is neither a population nor a joint file; or a joint file tells
        no level of friction.

    """
    if isinstance(source, PartPopulation):
        return _of_population(source, source.name)
    if isinstance(source, JointFile):
        return _of_joint(source, source.provenance.log)
    if source in preset_names("populations"):
        return _of_population(load_population(source), str(source))
    name = Path(source).name
    try:
        is_joint = "provenance" in read_toml(Path(source))
    except OSError:
        is_joint = False  # whoever reads it as a population says what is wrong
    except ValueError:
        raise ScenarioError(
            f"{name}: is not TOML; give a joint or population file: breakaway events LOG "
            "--out joint.toml makes one of a log"
        ) from None
    if is_joint:
        return _of_joint(JointFile.load(source), name)
    return _of_population(load_population(source), name)


def with_guide(parts: Parts, engagement_length_m: float) -> Parts:
    """Give the parts with a guide of known length, as a drawing tells it.

    Raises
    ------
    ScenarioError
        The length is not that of a guide.

    """
    name = "engagement_length_m"
    if not 0.0 < engagement_length_m <= LONGEST_GUIDE_M:
        raise ScenarioError(
            f"{name}: {engagement_length_m!r} is not > 0 and <= {LONGEST_GUIDE_M:g}; give the "
            "length of the guide in m"
        )
    known = Uniform(low=engagement_length_m, high=engagement_length_m)
    population = parts.population.model_copy(
        update={"parts": parts.population.parts.model_copy(update={name: known})}
    )
    return replace(
        parts,
        population=population,
        told=tuple(one for one in QUANTITIES if one in parts.told or one == name),
        assumed=tuple(one for one in parts.assumed if one != name),
    )


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


def _of_population(population: PartPopulation, name: str) -> Parts:
    """Give the parts of a population; where it does not say, nothing counts as measured."""
    assumed = tuple(population.assumed) or QUANTITIES
    told = tuple(one for one in QUANTITIES if one not in assumed)
    return Parts(name, population, told, assumed, (population.description,))


def _of_joint(file: JointFile, name: str) -> Parts:
    """Give the joints that a file leaves open, with the assumed ranges of all that it has not."""
    assumed = load_population(ASSUMED)
    population = lay_over_parts(assumed, file, name)
    if population.parts.stiction_n == assumed.parts.stiction_n:
        raise ScenarioError(
            f"{name}: the joint file tells neither stiction nor Coulomb friction, so nothing can "
            "be advised; identify the joint from a log that shows either"
        )
    told = tuple(
        one
        for one in QUANTITIES
        if getattr(population.parts, one) != getattr(assumed.parts, one)
        and one not in population.assumed
    )
    untold = tuple(one for one in QUANTITIES if one not in told)
    return Parts(name, population, told, untold, _provenance(file))


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
        *(f"{name} is a bound from below: {why}" for name, why in file.at_least.items()),
        *made.notes,
    )
