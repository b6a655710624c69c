"""How well parameters are known: standard errors, profiles and a posterior."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2, norm
from scipy.stats import t as student

from breakaway.base.one_line import OneLine, counted
from breakaway.errors import LogError
from breakaway.measure.identification.output_error import Problem
from breakaway.measure.logs.log import Array

LEVEL = 0.95
"""Confidence of all intervals."""

HALF_WIDTH = float(norm.ppf(0.5 + 0.5 * LEVEL))
"""Half an interval, in standard errors."""

LONGEST_WINDOW = 0.1
"""Longest window of correlated residuals, as a share of the record."""

NOT_IDENTIFIABLE = 0.5
"""Standard error of a positive parameter's logarithm from which it counts as not identifiable."""

NOT_TOLD_FROM_0 = 0.25
"""Standard error, as a share of its value, from which a parameter that may be 0 counts so too."""


FEWEST_EVENTS = 3
"""Fewer events than this count as so many."""

LEAST_SLOPE = 1e-150
"""A parameter whose slopes are so small that their squares vanish is not told."""

SINGULAR = 1e-7
"""Singular value, relative to the largest, below which parameters cannot be told apart."""

BURNED = 500
"""Steps of the posterior's walkers that are left out, while they forget where they began."""

THINNED = 10
"""Steps of the walkers per draw that is kept."""


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of the internal parameters, and what it was made from.

    ``window`` is the number of rows over which residuals correlate; ``weight`` the share of the
    rows' information that is left after that correlation, 1 for independent residuals.
    """

    matrix: Array
    window: int
    weight: float
    condition_number: float


def correlation_window(residual: Array) -> int:
    """Return the number of rows over which residuals correlate, by Andrews' rule.

    ::

        L = 1.1447 (4 ρ² / (1 - ρ²)² n)^(1/3)         ρ: correlation of successive residuals

    for the Bartlett kernel and residuals like those of a first-order process; at most a tenth of
    the record. Source: D. W. K. Andrews, Econometrica 59(3), 1991.
    """
    power = float(residual @ residual)
    if power == 0.0:
        return 0
    rho = min(abs(float(residual[1:] @ residual[:-1]) / power), 0.9999)
    alpha = 4.0 * rho**2 / (1.0 - rho**2) ** 2
    window = 1.1447 * (alpha * len(residual)) ** (1.0 / 3.0)
    return int(min(window, LONGEST_WINDOW * len(residual)))


def covariance(residual: Array, slopes: Array) -> Covariance:
    """Return the covariance of least-squares estimates whose residuals may correlate.

    ::

        C = H⁻¹ S H⁻¹,    H = Jᵀ J
        S = Σ_{|l| ≤ L} (1 - |l| / (L + 1)) Σ_t J_t r_t r_{t+l} J_{t+l}ᵀ

    with J the slopes (n, p) and r the residual: the estimate of Newey and West (Econometrica
    55(3), 1987), which holds for unequal and correlated residuals. The Bartlett weights are
    those of sums over overlapping windows of L + 1 rows, which is how S is computed.

    Parameters that the record does not tell, for their slope is zero or that of others, get an
    infinite variance.
    """
    rows, count = slopes.shape
    with np.errstate(over="ignore", under="ignore"):
        size = np.linalg.norm(slopes, axis=0)
    told = (size > LEAST_SLOPE) & np.isfinite(size)
    matrix = np.zeros((count, count))
    matrix[~told, ~told] = np.inf
    window = correlation_window(residual)
    if not told.any():
        return Covariance(matrix, window, 1.0, np.inf)
    scaled = slopes[:, told] / size[told]
    _, singular, right = np.linalg.svd(scaled, full_matrices=False)
    condition = float(singular[0] / max(singular[-1], 1e-300))
    kept = singular > SINGULAR * singular[0]
    inverse = (right[kept].T / singular[kept] ** 2) @ right[kept]
    lost = np.flatnonzero(told)[np.any(np.abs(right[~kept]) > 0.1, axis=0)]
    score = scaled * residual[:, None]
    ahead, behind = np.zeros((window + 1, score.shape[1])), np.zeros((window, score.shape[1]))
    running = np.cumsum(np.vstack([ahead, score, behind]), axis=0)
    sums = running[window + 1 :] - running[: -window - 1]
    freedom = rows / max(rows - count, 1)
    influence = inverse @ sums.T * np.sqrt(freedom / (window + 1))
    sandwich = influence @ influence.T
    variance = freedom * float(residual @ residual) / rows
    inflation = float(np.sum((sums @ inverse) * sums))
    inflation *= freedom / (window + 1) / max(variance, 1e-300)
    weight = min(1.0, len(singular) / max(inflation, 1e-300))
    places = np.flatnonzero(told)
    matrix[np.ix_(places, places)] = sandwich / np.outer(size[told], size[told])
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    return Covariance(matrix, window, weight, condition)


def few_events(known: Covariance, events: Mapping[int, int]) -> Covariance:
    """Return a covariance that allows for parameters which show in a few events only.

    ::

        C_ij <- f_i f_j C_ij        f² = G / (G - 1) (t / z)²

    G is the number of events, at least 3, t and z the quantiles of 97.5 % of Student's
    distribution with G - 1 degrees of freedom and of the normal distribution (Cameron, Gelbach and
    Miller, Review of Economics and Statistics 90(3), 2008).

    ``events`` maps the place of a parameter to its number of events.
    """
    factor = np.ones(len(known.matrix))
    for place, count in events.items():
        count = max(count, FEWEST_EVENTS)
        factor[place] = student.ppf(0.5 + 0.5 * LEVEL, count - 1) / HALF_WIDTH
        factor[place] *= np.sqrt(count / (count - 1.0))
    return replace(known, matrix=known.matrix * np.outer(factor, factor))


def interval(problem: Problem, internal: Array, place: int, error: float) -> tuple[float, float]:
    """Return the interval of a parameter, from the standard error of the internal one."""
    half = HALF_WIDTH * error
    parameter = problem.layout.free[place]
    with np.errstate(over="ignore"):
        ends = parameter.external(np.array([internal[place] - half, internal[place] + half]))
    return float(ends[0]), float(ends[1])


@dataclass(frozen=True, eq=False)
class Profile:
    """Profile likelihood of one parameter: the smallest misfit at each of its values.

    ``deviance`` is the weighted rise of the sum of squares over the variance; the interval holds
    where it is below the quantile of χ² with one degree of freedom. An end is infinite, or 0,
    where the record sets none within the values tried.
    """

    name: str
    values: Array
    deviance: Array
    low: float
    high: float


def profile(
    problem: Problem,
    internal: Array,
    bounds: tuple[Array, Array],
    place: int,
    error: float,
    weight: float,
    points: int = 8,
) -> Profile:
    """Compute a profile likelihood, by fitting all other parameters at each value of one.

    ``weight`` tempers the likelihood for correlated residuals, see `Covariance`.
    """
    best = problem.residual(internal)
    variance = float(best @ best) / max(len(best) - len(internal), 1)
    low, high = bounds
    parameter = problem.layout.free[place]
    reach = min(max(4.0 * error, 1e-6), 6.0) if parameter.positive else 4.0 * error
    if not np.isfinite(reach):
        reach = 6.0 if parameter.positive else 0.5 * (high[place] - low[place])
    others = np.array([i for i in range(len(internal)) if i != place])
    found: dict[float, float] = {internal[place]: 0.0}
    for side in (-1.0, 1.0):
        at = internal.copy()
        for step in np.linspace(0.0, reach, points + 1)[1:]:
            target = internal[place] + side * step
            if not low[place] < target < high[place]:
                break
            at[place] = target
            rise = _refit(problem, at, others, (low, high)) - float(best @ best)
            found[target] = weight * max(rise, 0.0) / variance
            if found[target] > 2.0 * _limit():
                break
    order = sorted(found)
    values = parameter.external(np.array(order))
    deviance = np.array([found[one] for one in order])
    ends = _crossings(
        values, deviance, 0.0 if parameter.positive or parameter.may_vanish else -np.inf
    )
    return Profile(parameter.name, values, deviance, *ends)


def _limit() -> float:
    return float(chi2.ppf(LEVEL, 1))


def _refit(problem: Problem, at: Array, others: Array, bounds: tuple[Array, Array]) -> float:
    """Fit all others with one held; move ``at`` there and return the sum of squares."""
    if len(others) == 0:
        residual = problem.residual(at)
        return float(residual @ residual)

    def whole(part: Array) -> Array:
        full = at.copy()
        full[others] = part
        return full

    low, high = bounds[0][others], bounds[1][others]

    def value(part: Array) -> Array:
        return problem.residual(whole(part))

    def slope(part: Array) -> Array:
        return problem.residual_and_slopes(whole(part))[1][:, others]

    found = least_squares(
        value,
        np.clip(at[others], low + 1e-9 * (high - low), high - 1e-9 * (high - low)),
        jac=slope,
        bounds=(low, high),
        x_scale="jac",
        max_nfev=20,
        ftol=1e-7,
    )
    at[others] = found.x
    return 2.0 * float(found.cost)


def _crossings(values: Array, deviance: Array, open_low: float) -> tuple[float, float]:
    limit = _limit()
    inside = np.flatnonzero(deviance <= limit)
    first, last = int(inside[0]), int(inside[-1])
    low, high = open_low, np.inf
    if first > 0:
        low = float(np.interp(limit, deviance[[first, first - 1]], values[[first, first - 1]]))
    if last < len(values) - 1:
        high = float(np.interp(limit, deviance[[last, last + 1]], values[[last, last + 1]]))
    return low, high


@dataclass(frozen=True, eq=False)
class Posterior(OneLine):
    """Draws of the parameters, given the log.

    ``samples`` maps a parameter to its draws, the same row of all being one draw. The chain's
    autocorrelation time and the share of accepted proposals tell how good it is.
    """

    samples: dict[str, Array]
    autocorrelation_steps: float
    acceptance: float
    walkers: int
    steps: int
    weight: float

    def __repr__(self) -> str:
        draws = counted(len(next(iter(self.samples.values()))), "draw")
        return f"<posterior: {draws} of {', '.join(self.samples)}>"


def posterior(
    problem: Problem,
    internal: Array,
    spread: Array,
    bounds: tuple[Array, Array],
    weight: float,
    samples: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> Posterior:
    """Draw from the posterior by affine-invariant walkers, all of a step in one batch of lanes.

    ::

        log p = -w/2 Σ r² / s² + const within the bounds         s² = Σ r̂² / (n - p)

    flat in the internal parameters (the logarithms of positive ones). w tempers the likelihood for
    correlated residuals, by the adjustment of magnitude of Ribatet, Cooley and Davison (Statistica
    Sinica 22, 2012): without it n correlated rows count as n.

    Raises
    ------
    LogError
        emcee is not installed.

    """
    try:
        import emcee
    except ImportError:
        raise LogError(
            "a posterior needs emcee; install it with: pip install 'breakaway[posterior]'"
        ) from None
    best = problem.residual(internal)
    variance = float(best @ best) / max(len(best) - len(internal), 1)
    low, high = bounds

    def log_probability(at: Array) -> Array:
        outside = np.any((at < low) | (at > high), axis=1)
        sums = problem.sums_of_squares(np.clip(at, low, high))
        chance: Array = -0.5 * weight * sums / variance
        chance[outside] = -np.inf
        return chance

    count = len(internal)
    walkers = max(64, 2 * (count + 1) // 2 * 2)
    rng = np.random.default_rng(seed)
    around = internal + spread * rng.standard_normal((walkers, count))
    around = np.clip(around, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    sampler = emcee.EnsembleSampler(walkers, count, log_probability, vectorize=True)
    sampler.random_state = np.random.RandomState(seed % 2**32).get_state()
    kept = THINNED * -(-samples // walkers)
    total = BURNED + kept
    for step, _ in enumerate(sampler.sample(around, iterations=total), start=1):
        if progress is not None:
            progress(step, total)
    chain = sampler.get_chain(discard=BURNED, thin=THINNED, flat=True)[:samples]
    time = float(np.max(sampler.get_autocorr_time(discard=BURNED, quiet=True, tol=0)))
    drawn = {
        parameter.name: parameter.external(chain[:, i])
        for i, parameter in enumerate(problem.layout.free)
    }
    return Posterior(
        drawn, time, float(np.mean(sampler.acceptance_fraction)), walkers, kept, weight
    )
