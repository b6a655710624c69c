"""Figures that no joint has: a sign that a log states its numbers in the wrong unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.verdicts import Estimate


@dataclass(frozen=True)
class Usual:
    """What a figure of a joint is in, from least to most, and the unit that is often mistaken."""

    name: str
    unit: str
    least: float
    most: float
    mistake: str


USUAL = (
    Usual("friction level", "N", 1e-3, 1e7, "force"),
    Usual("stiffness", "N/m", 1e2, 1e11, "force"),
    Usual("deflection before sliding", "m", 1e-8, 1e-3, "position"),
    Usual("mass", "kg", 1e-3, 1e5, "force"),
    Usual("fast speed", "m/s", 1e-7, 20.0, "position"),
)
"""From an asperity contact of some nanometers and a millinewton, over the LuGre paper's 1 N at 1e5
N/m (Canudas de Wit et al., 1995), EMPS and the tribometer, to shrink fits of a meganewton at some
1e10 N/m: factors of ten beyond what was found published."""

MISTAKES = {"force": "is the force in kN, lbf or V?", "position": "is the position in mm or um?"}


def figures(estimates: Mapping[str, Estimate], fast_speed_m_per_s: float) -> dict[str, float]:
    """Return the figures of `USUAL` that a fit tells."""
    told = {name: one.value for name, one in estimates.items() if one.identifiable}
    levels = [value for name, value in told.items() if name.startswith("coulomb") and value > 0.0]
    out = {"fast speed": fast_speed_m_per_s}
    if levels:
        out["friction level"] = max(levels)
    for name, parameter in (("stiffness", "stiffness_n_per_m"), ("mass", "mass_kg")):
        if parameter in told:
            out[name] = told[parameter]
    if levels and "stiffness" in out:
        out["deflection before sliding"] = max(levels) / out["stiffness"]
    return out


def find_units(estimates: Mapping[str, Estimate], fast_speed_m_per_s: float) -> tuple[Fault, ...]:
    """Compare what a fit tells with what joints have.

    Not found: a wrong unit whose figures a joint could have. Kilonewtons that are called newtons
    make a joint of 3 kN one of 3 N, which exists.
    """
    found = figures(estimates, fast_speed_m_per_s)
    return tuple(
        Fault("units", "", found[one.name], _words(one, found[one.name]))
        for one in USUAL
        if one.name in found and not one.least <= found[one.name] <= one.most
    )


def plausibility(estimates: Mapping[str, Estimate], fast_speed_m_per_s: float) -> str:
    """Put the figures of a fit beside what joints have, in one line."""
    found = figures(estimates, fast_speed_m_per_s)
    shown = [
        f"{one.name} {found[one.name]:.3g} {one.unit} ({one.least:.0e} to {one.most:.0e})"
        for one in USUAL
        if one.name in found
    ]
    return f"plausible for a joint, in brackets: {', '.join(shown)}"


def _words(usual: Usual, value: float) -> str:
    return (
        f"units: a {usual.name} of {value:.3g} {usual.unit} is out of what joints have, "
        f"{usual.least:.0e} to {usual.most:.0e} {usual.unit}; {MISTAKES[usual.mistake]} state the "
        "unit in the mapping"
    )
