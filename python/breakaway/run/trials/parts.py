"""Parts of a population as scenarios: which numbers they set, and the scenario they share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from breakaway.base.arguments import check_arguments
from breakaway.base.text import shown
from breakaway.errors import StudyError
from breakaway.model.scenario.correlation import correlation_matrix, lower_factor
from breakaway.model.scenario.distribution import Distribution, Uniform
from breakaway.model.scenario.laws import LAWS, Law, numbers_of_parts, shared_numbers
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import LEVEL_DRAW, QUANTITIES, PartPopulation
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.scenario.variation import VARIATION_WORDS, VariationKind
from breakaway.run.batch import draw_columns
from breakaway.run.resolution import with_gains

Array = NDArray[np.float64]


def draw_parts(population: PartPopulation, runs: int | range, *, seed: int) -> dict[str, Array]:
    """Draw the quantities of some parts. A part is a function of the seed and its number.

    Beside the quantities of the population there is ``level_draw``, by which friction varies from
    part to part. A quantity that is correlated with earlier ones follows them; all others are what
    they would be without any correlation, to the bit.

    Parameters
    ----------
    population : PartPopulation
        How parts differ.
    runs : int or range
        How many, starting at number 0; or the numbers of the parts.
    seed : int
        Seed of the draws, 0 to 2^63 - 1.

    Raises
    ------
    ScenarioError
        It is not a population.
    StudyError
        ``runs`` or ``seed`` are out of range, or the parts cannot fit into the free memory.

    Examples
    --------
    >>> import breakaway as bk
    >>> parts = bk.draw_parts(bk.load_population("seized_parts"), 3, seed=0)
    >>> bool((parts["stiction_ratio"] >= 1.1).all())
    True

    """
    check_arguments(draw_parts, locals(), StudyError)
    vary: dict[str, Distribution] = {name: getattr(population.parts, name) for name in QUANTITIES}
    drawn = draw_columns({**vary, LEVEL_DRAW: Uniform(low=-1.0, high=1.0)}, runs, seed=seed)
    return drawn | _following(population, vary, runs, seed)


def _following(
    population: PartPopulation, vary: dict[str, Distribution], runs: int | range, seed: int
) -> dict[str, Array]:
    """Draw the quantities that follow earlier ones, by a Gaussian copula of the same draws."""
    if not population.correlations:
        return {}
    shares = draw_columns(dict.fromkeys(vary, Uniform(low=0.0, high=1.0)), runs, seed=seed)
    scores = [ndtri(share) for share in shares.values()]
    lower = lower_factor(correlation_matrix(QUANTITIES, population.correlations))
    found = {}
    for weights, (name, distribution) in zip(lower, vary.items(), strict=True):
        places = np.flatnonzero(weights)
        if len(places) > 1:
            found[name] = distribution.quantile(ndtr(sum(weights[k] * scores[k] for k in places)))
    return found


def part_columns(
    population: PartPopulation,
    method: Method,
    law: Law,
    variation: VariationKind,
    parts: dict[str, Array],
) -> dict[str, Array]:
    """Give the numbers of a scenario that parts set, by dotted path."""
    joint = numbers_of_parts(law, population.laws, parts)
    if variation == "part":
        factor = 1.0 + parts["var"] * parts[LEVEL_DRAW]
        joint |= {name: factor * joint[name] for name in ("stiction_n", "coulomb_n")}
    columns = {
        **{f"joint.{name}": values for name, values in joint.items()},
        "part.mass_kg": parts["mass_kg"],
        **{f"disturbance.{name}": parts[name] for name in _OF_DISTURBANCE.get(variation, ())},
        "limits.diverged_error_m": 10.0 * parts["engagement_length_m"],
        "limits.diverged_force_n": 1e3 * parts["stiction_n"],
        "limits.breakaway_travel_m": 2.0 * parts["presliding_m"],
    }
    return columns | method.told(parts["engagement_length_m"])


_OF_DISTURBANCE: dict[VariationKind, tuple[str, ...]] = {
    "field": ("var", "correlation_length_m"),
    "paper_random_factor": ("var", "hold_s"),
}
"""Kind of variation -> numbers of the disturbance that are quantities of a part."""


def _disturbance(population: PartPopulation, variation: VariationKind) -> dict[str, str]:
    """Give what all parts have of a disturbance; empty where there is none."""
    if variation == "field":
        return {"kind": "field", "law": "bounded"}
    if variation == "paper_random_factor":
        return {"kind": variation, "law": "uniform", "acts_on": population.disturbance_acts_on}
    return {}


def scenario_of(
    population: PartPopulation,
    method: Method,
    law: Law,
    variation: VariationKind,
    *,
    seed: int,
) -> Scenario:
    """Give the scenario that the parts of a population share: a method before the nominal part.

    Gains by pole placement are designed for that part, and stay.
    """
    if law not in LAWS:
        raise StudyError(f"law: {shown(law)} is not one of {', '.join(LAWS)}")
    nominal = {name: np.array([value]) for name, value in population.nominal.items()}
    reference = method.reference or {
        "kind": "ramp",
        "distance_m": population.nominal["engagement_length_m"],
        "duration_s": population.duration_s,
    }
    values = {
        "name": method.name,
        "description": f"On {population.name}, {law}, {VARIATION_WORDS[variation]}",
        "seed": seed,
        "joint": {"law": law, **shared_numbers(law, population.laws)},
        "part": {},
        "reference": reference if isinstance(reference, dict) else reference.model_dump(),
        "disturbance": _disturbance(population, variation),
        "actuator": method.actuator.model_dump(),
        "sensors": population.sensors.model_dump(),
        "watch": None if population.watch is None else population.watch.model_dump(),
        "controller": method.controller.model_dump(),
        "timing": {
            "duration_s": population.duration_s,
            "control_period_s": population.control_period_s,
            "one_sample_delay": population.one_sample_delay,
        },
        "limits": {"after_release_s": 0.0, "release_tolerance_m": 0.0},
        "trace": {"every_samples": 1},
    }
    for path, column in part_columns(population, method, law, variation, nominal).items():
        _put(values, path, float(column[0]))
    scenario = Scenario.parse(values)
    return scenario.model_copy(update={"controller": with_gains(scenario)})


def _put(values: dict[str, object], path: str, value: float) -> None:
    *parents, last = path.split(".")
    for name in parents:
        inner = values.get(name)
        if not isinstance(inner, dict):
            raise StudyError(f"knows: {shown(path)} is not a number of the method")
        values = inner
    values[last] = value
