"""Whether a friction law holds about turns, and what its error does to what is told of sliding."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from breakaway.measure.identification.faults.rig import rig_parameters
from breakaway.measure.identification.guess import internal_guess, stand_in
from breakaway.measure.identification.identifiability import Prepared
from breakaway.measure.identification.laws import Law, LawName, Layout
from breakaway.measure.identification.output_error import (
    THINNED_ROWS,
    Loss,
    Problem,
    minimize,
)
from breakaway.measure.identification.record import RunSettings, core_record
from breakaway.measure.identification.turns import Turns, find_turns, passages
from breakaway.measure.identification.uncertainty import Covariance, covariance
from breakaway.measure.identification.verdicts import NO_PEAK, Estimate
from breakaway.measure.logs.log import Array

Chosen = NDArray[np.bool_]
"""Which rows are meant."""

RIVALS: dict[LawName, LawName] = {"lugre": "elasto_plastic", "elasto_plastic": "lugre"}
"""The other law with a bristle."""

BRISTLE = ("stiffness_n_per_m", "damping_n_s_per_m", "elastic_share")
"""What acts about turns only, where the laws differ."""

PREFERRED = 10.0
"""Deviance by which a law must explain a log better than its rival: odds of 150 to 1."""

ABOUT_TURNS = 5.0
"""Rows are about a turn within this many deflections of it."""

ROWS_ABOUT_TURNS = 3
"""Rows after a turn that are about it at least."""

EDGES = (0.1, 0.3, 0.6, 1.0, 1.6, 3.0)
"""Ways since a turn, in deflections, between which residuals are averaged."""

FEWEST_TURNS = 4
"""Fewest turns whose residuals can be compared."""

CHANCE = 0.001
"""Chance that residuals of a law that holds look as if they came back at each turn."""

MATERIAL = 0.02
"""Least mean error about turns that counts, as a share of the Coulomb level."""

FEWEST_SLOW_ROWS = 10
"""Fewest rows away from turns that are slower than v_s, so that sliding shows a peak."""

EVALUATIONS = 60


@dataclass(frozen=True, eq=False)
class Doubt:
    """Why a law may not hold, and the covariance of the internal parameters that allows for it.

    ``shows_peak`` is whether the part slides slowly enough, twice and away from turns.
    """

    because: str
    known: Covariance
    shows_peak: bool

    def judged(self, estimates: Sequence[Estimate]) -> list[Estimate]:
        """Take back what acts about turns, and a peak that sliding does not show twice."""
        ratio = next((one for one in estimates if one.name == "stiction_ratio"), None)
        no_peak = not self.shows_peak or (ratio is not None and ratio.low < NO_PEAK)
        peak = ("stiction_ratio", "stribeck_velocity_m_per_s") if no_peak else ()
        return [
            replace(one, identifiable=False, remark=f"the law is in doubt: {self.because}")
            if one.name in (*BRISTLE, *peak)
            else one
            for one in estimates
        ]


def doubt(
    asked: Prepared,
    law: Law,
    settings: RunSettings,
    loss: Loss,
    best: Array,
    known: Covariance,
) -> Doubt | None:
    """Compare a law with its rival, and its residuals about turns with each other.

    Nothing is compared for laws without a bristle, and for motion that is not imposed. Where the
    law is in doubt, sliding is fitted again without the rows about turns; the covariance grows by

    ::

        d dᵀ + C_s + r rᵀ    d: by how much the parameters move,  C_s: their covariance then
                             r: how far those of the rival are away

    which is how far the law's error pulls them (Hausman, Econometrica 46(6), 1978).
    """
    if settings.motion != "imposed" or law.name not in RIVALS:
        return None
    residual = asked.problem.residual(best)
    x, v = asked.rows.columns[:2, asked.places]
    turns = find_turns(x, v)
    deflection = _deflection_m(asked.problem.layout.values(best), asked)
    because, rival = _preferred(asked, law, settings, loss, best, known.weight)
    least = MATERIAL * asked.sizes.coulomb_n / asked.problem.scale
    because = because or _comes_back(turns, residual, deflection, least)
    if not because:
        return None
    about = turns.since_m < ABOUT_TURNS * deflection
    about |= turns.rows_since < ROWS_ABOUT_TURNS
    slow = np.abs(v) < asked.problem.layout.values(best).get("stribeck_velocity_m_per_s", 0.0)
    shows_peak = turns.count > 1 and int(np.sum(slow & ~about)) >= FEWEST_SLOW_ROWS
    wide = _widened(asked, loss, best, known, ~about)
    return Doubt(because, _up_to(wide, rival - best), shows_peak)


def events(asked: Prepared, settings: RunSettings, best: Array) -> dict[int, int]:
    """Return in how many events of an imposed motion a parameter shows, by its place.

    What acts about turns shows in each turn, the Stribeck term there too, and in each passage below
    twice its speed.
    """
    if settings.motion != "imposed":
        return {}
    x, v = asked.rows.columns[:2, asked.places]
    turns = find_turns(x, v).count
    names = [one.name for one in asked.problem.layout.free]
    out = {names.index(name): turns for name in BRISTLE if name in names}
    if "stribeck_velocity_m_per_s" in names:
        slow = 2.0 * asked.problem.layout.values(best)["stribeck_velocity_m_per_s"]
        peak = ("stribeck_velocity_m_per_s", "stiction_ratio")
        shown = max(passages(v, slow), turns)
        out |= {names.index(name): shown for name in peak if name in names}
    return out


def with_hidden_mass(known: Covariance, asked: Prepared, slopes: Array) -> Covariance:
    """Return the covariance that allows for a mass which was held at 0 because it hardly shows.

    The largest that would not show counts as two standard errors; it moves the parameters by

    ::

        d = -(Jᵀ J)⁻¹ Jᵀ m a
    """
    held = asked.neutral.get("mass_kg") == 0.0 and "mass_kg" not in asked.held
    told = np.isfinite(np.diag(known.matrix))
    if not held or not told.any():
        return known
    inertia_n = asked.sizes.hidden_mass_kg * asked.rows.columns[2, asked.places]
    moved = np.zeros(len(told))
    moved[told] = np.linalg.lstsq(slopes[:, told], inertia_n / asked.problem.scale, rcond=None)[0]
    return replace(known, matrix=known.matrix + 0.25 * np.outer(moved, moved))


def _deflection_m(values: dict[str, float], asked: Prepared) -> float:
    """Return the deflection at which the fitted joint slides."""
    held = {name: value for name, value in asked.held.items() if name in BRISTLE}
    numbers = {**held, **values}
    level = next((one for name, one in numbers.items() if name.startswith("coulomb")), 0.0)
    peak = min(max(numbers.get("stiction_ratio", 1.0), 1.0), 3.0)
    stiffness = numbers.get("stiffness_n_per_m", 0.0)
    return peak * (level or asked.sizes.coulomb_n) / stiffness if stiffness > 0.0 else 0.0


def _preferred(
    asked: Prepared, law: Law, settings: RunSettings, loss: Loss, best: Array, weight: float
) -> tuple[str, Array]:
    """Say why the rival is not worse, empty where it is; and give the rival's parameters."""
    rival = replace(law, name=RIVALS[law.name])
    problem, starts, bounds = _rival(asked, rival, settings, best)
    every = max(1, len(problem.measured) // THINNED_ROWS)
    ends = [minimize(problem.thinned(every), one, bounds, loss, EVALUATIONS) for one in starts]
    end = min(ends, key=lambda one: one.cost).internal
    power = _power(problem, end)
    gain = weight * len(problem.measured) * float(np.log(power / _power(asked.problem, best)))
    values = {one.name: end[i] for i, one in enumerate(problem.layout.free)}
    free = asked.problem.layout.free
    found = np.array([values.get(one.name, best[i]) for i, one in enumerate(free)])
    if gain > PREFERRED:
        return "", found
    how = "better" if gain < -PREFERRED else "as well"
    return f"law {rival.name!r} explains the log {how}", found


def _power(problem: Problem, internal: Array) -> float:
    residual = problem.residual(internal)
    return max(float(residual @ residual), 1e-300)


def _rival(
    asked: Prepared, law: Law, settings: RunSettings, best: Array
) -> tuple[Problem, Sequence[Array], tuple[Array, Array]]:
    """Return the problem of the rival law, and starts near what was found."""
    parameters = (*law.parameters(len(asked.spans)), *rig_parameters(settings.motion))
    names = {one.name for one in parameters}
    held = {name: value for name, value in asked.neutral.items() if name in names}
    numbers = {**stand_in(law, settings, asked.sizes), **held}
    layout = Layout.of(parameters, numbers, asked.owners)
    record = core_record(asked.rows, asked.segments, law, settings)
    problem = replace(asked.problem, record=record, layout=layout)
    found = asked.problem.layout.values(best)
    starts = []
    for share, softer in ((0.2, 1.0), (0.7, 0.7)):
        near = {**found, "elastic_share": share}
        if "stiffness_n_per_m" in found:
            near["stiffness_n_per_m"] = softer * found["stiffness_n_per_m"]
        start, _, bounds = internal_guess(layout, asked.sizes, settings, near)
        starts.append(start)
    return problem, starts, bounds


def _comes_back(turns: Turns, residual: Array, deflection_m: float, least: float) -> str:
    """Say that residuals are alike at all turns, where they are; empty where they are not.

    Each bin of the way since a turn is a t-test of the mean over turns, folded by the direction.
    """
    if deflection_m <= 0.0 or turns.count <= FEWEST_TURNS:
        return ""
    folded = turns.direction * residual
    place = np.digitize(turns.since_m / deflection_m, EDGES)
    for number in range(len(EDGES)):
        here = place == number
        counts = np.bincount(turns.stretch[here], minlength=turns.count)
        sums = np.bincount(turns.stretch[here], folded[here], minlength=turns.count)
        means = (sums / np.maximum(counts, 1))[1:][counts[1:] > 0]
        if len(means) < FEWEST_TURNS:
            continue
        error = float(np.std(means, ddof=1)) / np.sqrt(len(means))
        limit = float(student.isf(0.5 * CHANCE / len(EDGES), len(means) - 1))
        if abs(float(np.mean(means))) > max(limit * error, least):
            return "the errors of the law about turns come back at every turn"
    return ""


def _up_to(known: Covariance, moved: Array) -> Covariance:
    """Return the covariance that reaches to other parameters."""
    told = np.isfinite(np.diag(known.matrix))
    moved = np.where(told, moved, 0.0)
    return replace(known, matrix=known.matrix + np.outer(moved, moved))


def _widened(
    asked: Prepared, loss: Loss, best: Array, known: Covariance, sliding: Chosen
) -> Covariance:
    """Return the covariance that allows for how far the rows about turns pull the parameters."""
    free = asked.problem.layout.free
    places = np.array([i for i, one in enumerate(free) if one.name not in BRISTLE])
    matrix = known.matrix.copy()
    if np.sum(sliding) < 20 * len(places):
        matrix[places, places] = np.inf
        return replace(known, matrix=matrix)
    problem = replace(asked.problem, counted=sliding.astype(float))
    held = tuple(one.name not in BRISTLE for one in free)
    low, high = (np.where(held, end, best) for end in asked.bounds)
    tight = 1e-9 * (asked.bounds[1] - asked.bounds[0])
    found = minimize(problem, best, (low - tight, high + tight), loss, EVALUATIONS).internal
    residual, slopes = problem.residual_and_slopes(found)
    kept = sliding[:: problem.every]
    own = covariance(residual[kept], slopes[kept][:, places]).matrix
    moved = (found - best)[places]
    matrix[np.ix_(places, places)] += np.outer(moved, moved) + own
    return replace(known, matrix=matrix)
