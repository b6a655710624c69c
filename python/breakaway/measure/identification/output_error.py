"""Output error: the parameters whose simulation comes closest to what was measured."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from scipy.optimize import least_squares

from breakaway._core import RigRecord
from breakaway.base.threads import usable_processors
from breakaway.measure.identification.lag import Lag
from breakaway.measure.identification.laws import Layout
from breakaway.measure.logs.log import Array

Loss = Literal["linear", "soft_l1", "huber", "cauchy"]
LOSSES: tuple[Loss, ...] = ("linear", "soft_l1", "huber", "cauchy")
"""Losses of `scipy.optimize.least_squares` that can be chosen; all but the first are robust."""

HOPELESS = 1e6
"""Residual, in units of the scale, that stands for a simulation that is not finite."""

THINNED_ROWS = 3000
"""Rows whose residuals decide between several starts."""

SCREENED_PER_START = 8
"""Random sets of parameters that are tried, in lanes, for each start that is followed up."""

Progress = Callable[[int, int], None]
"""Called with how many starts are done, and of how many."""


class Stopped(Exception):  # noqa: N818 - it is a request, no failure
    """Raised inside a fit that was asked to stop."""


@dataclass
class Problem:
    """One record, one layout of parameters, and the channel whose error is made small.

    Residuals are divided by ``scale``, so that they are near 1 where the model is as good as the
    measurement, and times ``counted``, 0 for rows that are left out.
    """

    record: RigRecord
    layout: Layout
    channel: str
    measured: Array
    scale: float
    lag: Lag
    every: int = 1
    counted: Array | float = 1.0
    stop: threading.Event = field(default_factory=threading.Event)

    @property
    def _is_position(self) -> bool:
        return self.channel == "position_m"

    def thinned(self, every: int) -> Problem:
        """Return the problem with the residuals of every ``every``-th row only."""
        return replace(self, every=every)

    def predicted(self, internal: Array) -> Array:
        """Simulate the channel."""
        numbers = self.layout.numbers(internal).tolist()
        position, force = self.record.simulate(numbers)
        found = np.frombuffer(position if self._is_position else force)
        return self.lag.shifted(found, self.layout.delay_s(internal))

    def residual(self, internal: Array) -> Array:
        """Return (simulated - measured) / scale."""
        if self.stop.is_set():
            raise Stopped
        return self._residual(self.predicted(internal)[:: self.every])

    def _residual(self, predicted: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):
            return _finite((predicted - self.measured[:: self.every]) / self.scale * self._counted)

    @property
    def _counted(self) -> Array | float:
        return self.counted[:: self.every] if isinstance(self.counted, np.ndarray) else 1.0

    def residual_and_slopes(self, internal: Array) -> tuple[Array, Array]:
        """Return the residual and its derivatives with respect to the internal parameters."""
        if self.stop.is_set():
            raise Stopped
        layout = self.layout
        late = layout.delay_place is not None or layout.held_delay_s != 0.0
        every = 1 if late else self.every
        numbers = layout.numbers(internal).tolist()
        out = self.record.differentiate(numbers, list(layout.variable), self._is_position, every)
        value, slopes = (np.frombuffer(one) for one in out)
        by_row = np.zeros((len(value), len(layout.free)))
        slopes = slopes.reshape(len(value), -1)
        by_row[:, : slopes.shape[1]] = slopes
        if late:
            value, by_row = self._shifted(value, by_row, internal)
        with np.errstate(over="ignore", invalid="ignore"):
            by_row *= layout.slope(internal) / self.scale
            by_row *= np.reshape(self._counted, (-1, 1))
            return self._residual(value), np.nan_to_num(by_row, posinf=0.0, neginf=0.0)

    def _shifted(self, value: Array, by_row: Array, internal: Array) -> tuple[Array, Array]:
        """Shift values and slopes by the delay of the position, and add its own slope."""
        delay_s, place = self.layout.delay_s(internal), self.layout.delay_place
        moved = self.lag.shifted(by_row, delay_s)
        if place is not None:
            moved = moved.copy()
            moved[:, place] = self.lag.slope(value, delay_s)
        return self.lag.shifted(value, delay_s)[:: self.every], moved[:: self.every]

    def sums_of_squares(self, internal: Array, threads: int = 0) -> Array:
        """Return the sum of squared residuals of many sets of parameters (k, n), in lanes."""
        if self.layout.held_delay_s or self.layout.delay_place is not None:
            residuals = (self.residual(one) for one in internal)
            return np.array([float(residual @ residual) for residual in residuals])
        numbers = np.ascontiguousarray(self.layout.numbers(internal).reshape(-1))
        pairs = np.frombuffer(self.record.misfits(numbers, threads or usable_processors()))
        sums = pairs.reshape(-1, 2)[:, 0 if self._is_position else 1] / self.scale**2
        worst = len(self.measured) * HOPELESS**2
        return np.minimum(np.nan_to_num(sums, nan=worst, posinf=worst), worst)


@dataclass(frozen=True, eq=False)
class Minimum:
    """What one start came to: the internal parameters, their cost, and whether it was done."""

    internal: Array
    cost: float
    evaluations: int
    converged: bool


def minimize(
    problem: Problem, start: Array, bounds: tuple[Array, Array], loss: Loss, most: int
) -> Minimum:
    """Follow one start down, by a trust-region method with exact derivatives.

    A stop gives the best point so far, not converged.
    """
    low, high = bounds
    inside = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
    best = [Minimum(inside, np.inf, 0, converged=False)]

    def value(internal: Array) -> Array:
        residual = problem.residual(internal)
        cost = 0.5 * float(residual @ residual)
        if cost < best[0].cost:
            best[0] = Minimum(internal.copy(), cost, 0, converged=False)
        return residual

    def slope(internal: Array) -> Array:
        return problem.residual_and_slopes(internal)[1]

    try:
        found = least_squares(
            value, inside, jac=slope, bounds=bounds, x_scale="jac", loss=loss, max_nfev=most,
            ftol=1e-9, xtol=1e-9,
        )  # fmt: skip
    except Stopped:
        return best[0]
    return Minimum(found.x, float(found.cost), int(found.nfev), converged=found.status > 0)


def screened_starts(
    problem: Problem,
    guess: Array,
    spread: Array,
    bounds: tuple[Array, Array],
    starts: int,
    seed: int,
) -> Array:
    """Return starts (k, n): the guess, then the best of many drawn around it.

    ``spread`` is the half width of the draws in the internal parameters. Draws are keyed by the
    seed alone, so the same call gives the same starts.
    """
    if starts == 1:
        return guess[None, :]
    rng = np.random.default_rng(seed)
    drawn = guess + spread * rng.uniform(-1.0, 1.0, (SCREENED_PER_START * starts, len(guess)))
    drawn = np.clip(drawn, *bounds)
    order = np.argsort(problem.sums_of_squares(drawn), kind="stable")
    return np.vstack([guess, drawn[order[: starts - 1]]])


AGREEMENT = 1e-4
"""Costs that differ by less than this share are those of one minimum."""


def minimize_all(
    problem: Problem,
    starts: Array,
    bounds: tuple[Array, Array],
    loss: Loss,
    most: int,
    progress: Progress | None,
) -> tuple[Minimum, int, bool]:
    """Follow all starts, on threads; return the best, how many came to it, and whether all ended.

    Where there are several, they are followed with the residuals of some thousand rows, evenly
    thinned (all rows are simulated), and the best goes on from there with all residuals. Ctrl-C
    stops them; what they had come to is kept.
    """
    every = 1 if len(starts) == 1 else max(1, len(problem.measured) // THINNED_ROWS)
    done, complete = _follow(problem.thinned(every), starts, bounds, loss, most, progress)
    best = min(done, key=lambda one: one.cost)
    agreeing = sum(one.cost <= best.cost * (1.0 + AGREEMENT) for one in done)
    if every > 1 and complete:
        polished, complete = _follow(problem, best.internal[None, :], bounds, loss, most, None)
        best = polished[0]
    return best, agreeing, complete


def _follow(
    problem: Problem,
    starts: Array,
    bounds: tuple[Array, Array],
    loss: Loss,
    most: int,
    progress: Progress | None,
) -> tuple[list[Minimum], bool]:
    complete = True
    with ThreadPoolExecutor(min(usable_processors(), len(starts))) as pool:
        runs = [pool.submit(minimize, problem, start, bounds, loss, most) for start in starts]
        try:
            for finished, _ in enumerate(as_completed(runs), start=1):
                if progress is not None:
                    progress(finished, len(starts))
        except KeyboardInterrupt:
            problem.stop.set()
            complete = False
        done = [run.result() for run in runs]
    problem.stop.clear()
    return done, complete


def _finite(residual: Array) -> Array:
    bounded: Array = np.clip(
        np.nan_to_num(residual, nan=HOPELESS, posinf=HOPELESS, neginf=-HOPELESS),
        -HOPELESS,
        HOPELESS,
    )
    return bounded
