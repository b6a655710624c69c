"""A position that is late against the force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm, t

from breakaway.errors import LogError
from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.faults.rig import RIG_PARAMETERS
from breakaway.measure.identification.identifiability import Prepared, prepare
from breakaway.measure.identification.laws import Law, LawName
from breakaway.measure.identification.output_error import THINNED_ROWS, minimize
from breakaway.measure.identification.record import RunSettings, Span, measured_rows
from breakaway.measure.identification.turns import to_and_fro
from breakaway.measure.identification.uncertainty import covariance
from breakaway.measure.identification.verdicts import Excitation, Verdict
from breakaway.measure.logs.log import Array, Log

LAWS: tuple[LawName, ...] = ("lugre", "elasto_plastic")
"""Laws that a delay is sought under; each stands for others that come back as it does."""

FEWEST_TURNS = 5
SHARE_OF_ROW = 0.5
"""Least delay that is named, in rows: less is within how a row is stamped."""

CHANCE = 0.05
"""One-sided chance that noise makes a delay of a sound log exceed its error so far."""

AS_GOOD = 1.5
"""A law whose squared error is at most so many times the best one's has to show the delay too."""

BETTER = 10.0
"""Deviance by which delay or damping has to explain a log better than the other: odds 150 to 1."""

ALL_ALONG = 0.05
"""One-sided chance that blocks of a log, one for each turn, prefer either so much where both err
alike (Vuong, 1989): what is better at a few turns only is an error of the law."""

EVALUATIONS = 60
ONE_CLOCK = "record position and force by one clock, and filter them alike"


@dataclass(frozen=True)
class Late:
    """The best fit of a law with a late position; ``laws`` explain the log as well as it does.

    ``decided`` says whether the log tells the delay from a damper of the bristle.
    """

    law: Law
    values: Mapping[str, float]
    delay_s: float
    error_s: float
    squares: Array
    """Squared residual of each row."""
    rows: float
    laws: tuple[LawName, ...] = ()
    decided: bool = False

    @property
    def sum(self) -> float:
        """Sum of the squares."""
        return float(self.squares.sum())

    @property
    def fault(self) -> Fault:
        """The delay as a fault."""
        return Fault(
            "delay",
            "delay_s",
            self.delay_s,
            f"delay: the position is late by about {1e3 * self.delay_s:.2g} ms against the force; "
            f"{ONE_CLOCK}",
        )

    @property
    def remark(self) -> str:
        """What follows for the damping where the delay is not decided."""
        return (
            f"a position that is late by {1e3 * self.delay_s:.2g} ms looks the same; hold delay_s "
            "at 0 where one clock stamps position and force"
        )


def find_delay(
    log: Log, law: Law, settings: RunSettings, shown: Excitation, values: Mapping[str, float]
) -> Late | None:
    """Fit the delay under two laws, in place of the damping, and see whether it is needed.

    To first order in the delay τ the elastic force of a late position is that of a bristle with the
    damper c = k_e τ, so either is sought with the other at 0. What comes after the first order, and
    inertia and viscous friction, which the damper does not act on, may tell them apart: a delay is
    decided where it explains the log better by `BETTER`, and none is where the damper does.

    Parameters
    ----------
    log : Log
        The log, without spikes.
    law : Law
        The law that was fitted, for its options.
    settings : RunSettings
        How it was run.
    shown : Excitation
        What the log excites: a part that never slides tells no delay from what a joint loses.
    values : mapping of str to float
        What was found, near which the fits start.

    """
    imposed = replace(settings, motion="imposed", controller=None, steps=4)
    blocks = to_and_fro(*measured_rows(log, imposed).columns[:2])
    if not shown.broke_away or blocks < FEWEST_TURNS:
        return None
    try:
        fits = [_late(log, replace(law, name=name), imposed, values) for name in LAWS]
    except LogError:
        return None
    best = min(fits, key=lambda one: one.sum)
    shows = [one.delay_s for one in fits if one.sum <= AS_GOOD * best.sum]
    least = SHARE_OF_ROW / log.sample_rate_hz
    certain = best.delay_s > float(norm.isf(CHANCE)) * best.error_s
    if not certain or min(shows) < least:
        return None
    damped = _damped(log, best, imposed, values)
    if _explains_better(damped, best, blocks):
        return None
    good = tuple(one.law.name for one in fits if one.sum <= AS_GOOD * best.sum)
    return replace(best, laws=good, decided=_explains_better(best, damped, blocks))


def with_delay(
    log: Log,
    law: Law,
    settings: RunSettings,
    repeats: Sequence[Span],
    asked: Prepared,
    late: Late,
    free: Sequence[str],
    best: Array,
) -> Prepared:
    """Return the problem with the delay free and the damping, which looks like it, held at 0.

    Under a law that explains the log less well a free delay would mend the law: there it is held.
    """
    damping = "damping_n_s_per_m"
    near = {**asked.problem.layout.values(best), "delay_s": late.delay_s}
    names = {one.name for one in asked.problem.layout.free}
    held, why = {}, []
    if damping in names:
        held[damping] = 0.0
        why.append(Verdict(damping, False, "held at 0: a late position looks like it", ONE_CLOCK))
    if law.has_bristle and law.name not in late.laws:
        held["delay_s"] = late.delay_s
        because = f"held at {late.delay_s:.3g}, as law {late.law.name!r} tells, which holds better"
        why.append(Verdict("delay_s", False, because, ONE_CLOCK))
    given = {*free, "delay_s", *(["mass_kg"] if "mass_kg" in names else [])} - held.keys()
    fixed = {**asked.held, **held}
    new = prepare(log, law, settings, repeats, fixed, sorted(given), near)
    return replace(new, held=asked.held, held_back=(*new.held_back, *why))


def _late(log: Log, law: Law, settings: RunSettings, near: Mapping[str, float]) -> Late:
    held = {"damping_n_s_per_m": 0.0}
    delay_s = near.get("damping_n_s_per_m", 0.0) / near.get("stiffness_n_per_m", np.inf)
    start = {**near, "delay_s": min(delay_s, 0.01)}
    return _fitted(log, law, settings, start, held, ("delay_s",))


def _damped(log: Log, late: Late, settings: RunSettings, values: Mapping[str, float]) -> Late:
    """Fit a damper in the delay's place."""
    damping = late.delay_s * late.values["stiffness_n_per_m"]
    start = {**late.values, "damping_n_s_per_m": damping, **values}
    return _fitted(log, late.law, settings, start, {}, ("damping_n_s_per_m",))


def _explains_better(one: Late, other: Late, blocks: int) -> bool:
    """Whether a fit explains a log better than another, as a whole and all along."""
    deviance = min(one.rows, other.rows) * float(np.log(other.sum / one.sum))
    gains = [float(part.sum()) for part in np.array_split(other.squares - one.squares, blocks)]
    error = float(np.std(gains, ddof=1)) / np.sqrt(blocks)
    return deviance > BETTER and np.mean(gains) > float(t.isf(ALL_ALONG, blocks - 1)) * error


def _fitted(
    log: Log,
    law: Law,
    settings: RunSettings,
    start: Mapping[str, float],
    held: Mapping[str, float],
    free: tuple[str, ...],
) -> Late:
    """Fit a law from a start, its mass free, the rig's other parameters as the start has them."""
    rig = [one.name for one in RIG_PARAMETERS if one.name in start and one.name not in free]
    names = ("mass_kg", *free, *(name for name in rig if name != "delay_s"))
    asked = prepare(log, law, settings, (), held, names, start)
    every = max(1, len(asked.problem.measured) // THINNED_ROWS)
    problem = asked.problem.thinned(every)
    found = minimize(problem, asked.guess, asked.bounds, "linear", EVALUATIONS)
    residual, slopes = problem.residual_and_slopes(found.internal)
    known = covariance(residual, slopes)
    values = problem.layout.values(found.internal)
    place = problem.layout.delay_place
    error = 0.0 if place is None else float(np.sqrt(known.matrix[place, place]))
    rows = known.weight * len(residual)
    return Late(law, values, values.get("delay_s", 0.0), error, residual**2, rows)
