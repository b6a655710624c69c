"""A population file from many pulls: fitted distributions, and stated ranges for the rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import counted
from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.identification.censored import FEWEST_VALUES, fit_distribution
from breakaway.measure.identification.joint_file import JointFile
from breakaway.measure.identification.population import FIELDS, Population
from breakaway.measure.identification.pulled_joint import RANGES_NOTE, USUAL
from breakaway.model.scenario.correlation import Correlation
from breakaway.model.scenario.distribution import Distribution, LogNormal, LogUniform, Samples
from breakaway.model.scenario.files import load_population
from breakaway.model.scenario.population import QUANTITIES, PartDistributions, PartPopulation

STRIBECK = "joint.stribeck_velocity_m_per_s"
LISTED = 20
"""Most parts that a description names."""
CLOSEST = 1.0 - 1e-6
"""Largest correlation that a population can have, but for rounding."""

Fitted = tuple[dict[str, Distribution], list[Correlation]]


def parts_of_pulls(
    found: Population,
    joints: Sequence[JointFile] = (),
    *,
    name: str = "parts",
    mass_kg: float | None = None,
) -> PartPopulation:
    """Make a population of parts of what was fitted to many pulls.

    Breakaway force and its ratio to the sliding force have the fitted distributions and their
    correlation. With log-normal fits the ratio is log-normal::

        μ_r = μ_s - μ_c,  σ_r² = σ_s² + σ_c² - 2 ρ σ_s σ_c
        corr(ln F_s, ln r) = (σ_s - ρ σ_c) / σ_r

    with μ, σ of the logarithms of F_s and F_c and their correlation ρ; a ratio is at least 1. With
    normal fits both are rows of `Population.correlated`. The presliding travel F_s/k_e is fitted
    where three joints tell their stiffness; bounds of it end its range. All else has the ranges of
    the preset ``seized_parts``, and ``assumed`` says so.

    Parameters
    ----------
    found : Population
        From `fit_population`.
    joints : sequence of JointFile, optional
        From `joint_from_pull`, for the stiffness of single parts.
    name : str
        Name of the population.
    mass_kg : float, optional
        Mass of all parts from a scale, > 0 and at most 1e6. Left out: assumed.

    Returns
    -------
    PartPopulation

    Raises
    ------
    LogError
        The mass is out of range.
    ScenarioError
        The name is no name.

    Notes
    -----
    Not checked: how well few parts tell a distribution; ``description`` has the fits' intervals.

    Examples
    --------
    >>> from breakaway.measure.identification import fit_population
    >>> parts = parts_of_pulls(fit_population([300.0, 420.0, 510.0]), mass_kg=1.5)
    >>> parts.parts.stiction_n.median, parts.parts.mass_kg.values
    (400.54..., (1.5,))
    >>> "stiction_ratio" in parts.assumed, "mass_kg" in parts.assumed
    (True, False)

    """
    check_arguments(parts_of_pulls, locals(), LogError)
    if mass_kg is not None and not 0.0 < mass_kg <= 1e6:
        raise LogError(f"mass_kg: {mass_kg!r} is not > 0 and <= 1e6; give the parts' mass in kg")
    usual = load_population(USUAL)
    fitted, correlations = _forces(found)
    presliding, why_range = _presliding(joints, usual.parts.presliding_m)
    if not why_range:
        fitted["presliding_m"] = presliding
    if mass_kg is not None:
        fitted["mass_kg"] = Samples(values=(mass_kg,))
    assumed = {one: f"range of {USUAL}, assumed" for one in QUANTITIES if one not in fitted}
    if why_range:
        assumed["presliding_m"] = why_range
    parts: dict[str, Distribution] = {one: getattr(usual.parts, one) for one in QUANTITIES}
    parts |= {"presliding_m": presliding} | fitted
    speeds = [file.assumed[STRIBECK] for file in joints if STRIBECK in file.assumed]
    if speeds:
        low, high = min(one.low for one in speeds), max(one.high for one in speeds)
        parts["stribeck_velocity_m_per_s"] = LogUniform(low=low, high=high)
        assumed["stribeck_velocity_m_per_s"] = "assumed: all ranges that single logs leave open"
    shared = usual.model_dump(exclude={"name", "description", "parts", "correlations", "assumed"})
    return PartPopulation(
        **shared,
        name=name,
        description=_description(found),
        parts=PartDistributions(**parts),
        correlations=correlations,
        assumed=assumed,
    )


def _forces(found: Population) -> Fitted:
    """Give breakaway force and ratio as they were fitted, and how they go together."""
    hold = found.fits["breakaway_force_n"]
    law = hold.distribution()
    if found.correlation is None:
        return {"stiction_n": law}, []
    if not isinstance(law, LogNormal):
        rows = found.correlated()
        both = [np.asarray(rows[field].values) for field in FIELDS.values()]
        ratio = Samples(values=tuple((both[0] / both[1]).tolist()), rows="shared")
        return {"stiction_n": rows["joint.stiction_n"], "stiction_ratio": ratio}, []
    slide = found.fits["sliding_force_n"].parameters
    wide, other, rho = law.sigma, slide["sigma"], found.correlation
    sigma = math.sqrt(max(wide**2 + other**2 - 2.0 * rho * wide * other, 0.0))
    ratio_law = LogNormal(median=law.median / slide["median"], sigma=sigma, low=1.0)
    fitted: dict[str, Distribution] = {"stiction_n": law, "stiction_ratio": ratio_law}
    if sigma < 1e-6 * wide:  # all parts have one ratio
        return fitted, []
    together = (wide - rho * other) / sigma
    normal = math.copysign(min(abs(together), CLOSEST), together)
    return fitted, [Correlation(of=("stiction_n", "stiction_ratio"), normal=normal)]


def _presliding(joints: Sequence[JointFile], usual: Distribution) -> tuple[Distribution, str]:
    """Give how F_s/k_e differs, and why it is only a range; nothing where it was fitted."""
    told, bounds = [], []
    for file in joints:
        stiction, stiffness = file.joint.stiction_n, file.joint.stiffness_n_per_m
        if stiction is None or stiffness is None:
            continue
        if file.at_least.keys() & {"joint.stiffness_n_per_m", "joint.stiction_n"}:
            bounds.append(stiction / file.interval["stiffness_n_per_m"][0])
        else:
            told.append(stiction / stiffness)
    if len(told) >= FEWEST_VALUES and len(set(told)) > 1:
        return fit_distribution(told, [False] * len(told)).distribution(), ""
    low, high = (float(end) for end in usual.quantile(np.array([0.0, 1.0])))
    most = max([*told, *bounds], default=high)
    least = min([low, *told, *bounds])
    seen = f"; {counted(len(told), 'log')} told it, fewer than {FEWEST_VALUES}" if told else ""
    ends = f"; no part slid further before it broke loose than {most:.3g} m" if bounds else ""
    why = f"from the smallest of {USUAL}, {low:.3g} m, assumed{seen}{ends}"
    return LogUniform(low=least, high=most), why


def _description(found: Population) -> str:
    """Say from which logs what was fitted, and how surely."""
    lines = [f"Fitted to {counted(len(found.parts), 'part')}, "
             f"{counted(found.events, 'start')} from rest."]  # fmt: skip
    for quantity in FIELDS:
        if quantity in found.fits:
            fit = found.fits[quantity]
            for parameter, value in fit.parameters.items():
                low, high = fit.interval[parameter]
                lines.append(
                    f"{quantity}: {parameter} {value:.4g}, {100 * fit.confidence:g} % interval "
                    f"{low:.4g} to {high:.4g}."
                )
            if fit.censored:
                lines.append(f"{quantity}: {counted(fit.censored, 'part')} held at least the load.")
    lines += [f"{note}." for note in (*found.notes, RANGES_NOTE)]
    more = len(found.parts) - LISTED
    named = [brief(part) for part in found.parts[:LISTED]]
    return "\n".join([*lines, ", ".join(named) + (f" and {more} more" if more > 0 else "")])
