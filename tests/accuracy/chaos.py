"""Cases that depend on a start that nobody knows: which they are, and how they are compared.

A case is *chaotic* if stiction that differs by 1e-9 moves a converged run by more than 1 %, at two
numbers of steps. Such runs have no values that steps could converge to, but distributions over
starts, and these must be the same at the default steps as at finer ones.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from tests.accuracy.figures import COUNTS, Figures, errors_of, figures_of, worst_of
from tests.accuracy.steps import at_steps

import breakaway as bk

MOVED = 1e-9
"""By how much the start is moved, as a share of the friction levels."""
APART = 1e-2
"""Error between two runs that were moved by so little, above which a case is chaotic."""
STARTS = 20
"""Runs of a distribution."""
FINER = 10
"""Steps of the other distribution over those of the default."""
LIKE = 0.05
"""Difference of quartiles, relative to the median, that is none."""
APART_SHARE = 0.65
"""Difference of cumulative shares that 20 runs of each show by chance in 4 of 10,000 metrics."""


def moved_starts(scenario: bk.Scenario, numbers: Iterable[int]) -> Iterable[bk.Scenario]:
    """The scenario with friction levels that differ by next to nothing."""
    joint = scenario.joint
    for number in numbers:
        factor = 1.0 + MOVED * number
        levels = {"stiction_n": joint.stiction_n * factor, "coulomb_n": joint.coulomb_n * factor}
        yield scenario.model_copy(update={"joint": joint.model_copy(update=levels)})


def is_chaotic(scenario: bk.Scenario, steps: int, floors: Figures) -> bool:
    """Whether a start that is moved moves the reference, at its steps and at half of them."""
    return all(_parts(scenario, count, floors) for count in (max(1, steps // 2), steps))


def _parts(scenario: bk.Scenario, steps: int, floors: Figures) -> bool:
    found = [
        figures_of(bk.simulate(at_steps(moved, steps)))
        for moved in moved_starts(scenario, (0, 1, -1))
    ]
    return any(worst_of(errors_of(other, found[0], floors)) > APART for other in found[1:])


def unlike(
    scenario: bk.Scenario, steps: int, reference_steps: int, floors: Figures
) -> dict[str, float]:
    """Metrics whose distributions over starts differ, each with the largest gap of its shares."""
    coarse = _distribution(scenario, steps)
    fine = _distribution(scenario, min(FINER * steps, reference_steps))
    differs = {}
    for name in coarse:
        gap = _gap(coarse[name], fine[name], max(floors.get(name, 0.0), 1.0 * (name in COUNTS)))
        if gap > 0.0:
            differs[name] = gap
    return differs


def _distribution(scenario: bk.Scenario, steps: int) -> dict[str, np.ndarray]:
    runs = [
        figures_of(bk.simulate(at_steps(moved, steps)))
        for moved in moved_starts(scenario, range(STARTS))
    ]
    return {name: np.array([run[name] for run in runs]) for name in runs[0]}


def _gap(coarse: np.ndarray, fine: np.ndarray, floor: float) -> float:
    """Largest difference of cumulative shares; zero where that may be chance, or is too small."""
    ends = [np.nan_to_num(side, posinf=1e300, neginf=-1e300, nan=1e300) for side in (coarse, fine)]
    quartiles = [np.quantile(side, (0.25, 0.5, 0.75)) for side in ends]
    scale = max(abs(quartiles[1][1]), floor)
    if np.all(np.abs(quartiles[0] - quartiles[1]) <= LIKE * scale):
        return 0.0
    places = np.concatenate(ends)
    below = [np.searchsorted(np.sort(side), places, side="right") / side.size for side in ends]
    gap = float(np.max(np.abs(below[0] - below[1])))
    return gap if gap >= APART_SHARE else 0.0
