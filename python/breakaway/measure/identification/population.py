"""How breakaway differs from part to part: distributions fitted to the events of many logs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, ndtri

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.errors import LogError
from breakaway.measure.identification.censored import (
    FEWEST_VALUES,
    FittedDistribution,
    Kind,
    fit_distribution,
)
from breakaway.measure.identification.events import (
    BreakawayEvent,
    BreakawayReport,
    find_breakaway_events,
)
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.distribution import LogNormal, Normal, Samples

QUANTITIES = (
    "breakaway_force_n",
    "sliding_force_n",
    "breakaway_over_sliding",
    "presliding_displacement_m",
)
"""What is fitted, where at least `FEWEST_VALUES` parts show it."""

FIELDS = {"breakaway_force_n": "joint.stiction_n", "sliding_force_n": "joint.coulomb_n"}
"""Quantity -> the field of a scenario that it is."""


SCALED: dict[Kind, tuple[str, ...]] = {"log_normal": ("median",), "normal": ("mean", "std")}
"""Parameters that are as wrong as the gain of the load cell."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Population(OneLine):
    """How much the force that frees a part differs from part to part.

    Attributes
    ----------
    fits : dict
        Quantity -> its distribution over the parts.
    parts : tuple of str
        Names of the parts that gave an event, in their order.
    table : dict
        Quantity -> value of each part, NaN where it has none.
    bounds : dict
        Quantity -> whether the value of each part is a lower bound.
    events, repeats : int
        Number of events, and of parts with more than one.
    refused : tuple of str
        Why starts, or logs without any start, gave nothing.
    correlation : float or None
        Of breakaway and sliding force (of their logarithms where the fit is log-normal) over
        the parts that show both; None for fewer than three.
    notes : tuple of str
        What to beware of.

    """

    fits: dict[str, FittedDistribution]
    parts: tuple[str, ...]
    table: dict[str, Array]
    bounds: dict[str, npt.NDArray[np.bool_]]
    events: int
    repeats: int
    refused: tuple[str, ...]
    correlation: float | None
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        seen = f"{counted(len(self.parts), 'part')}, {counted(self.events, 'event')}"
        return f"<population: {seen}, fits of {', '.join(self.fits)}>"

    def distributions(self) -> dict[str, LogNormal | Normal]:
        """Return the distributions by field of a scenario, for ``vary`` of a study.

        Each number is drawn on its own; `correlated` keeps their correlation.
        """
        return {
            FIELDS[name]: self.fits[name].distribution() for name in FIELDS if name in self.fits
        }

    def correlated(self, count: int = 1000, *, seed: int = 0) -> dict[str, Samples]:
        """Return a table of parts whose breakaway and sliding forces belong together.

        Standard normal numbers with the estimated correlation go through the quantiles of the
        fitted distributions (a Gaussian copula); a part whose sliding force would exceed its
        breakaway force is drawn again.

        Parameters
        ----------
        count : int
            Rows of the table, 1 to 1 000 000.
        seed : int
            Seed of the draws, >= 0.

        Raises
        ------
        LogError
            The correlation is not known, ``count`` is out of range, or nearly no part would
            have a breakaway force above its sliding force.

        """
        check_arguments(Population.correlated, locals(), LogError)
        if not 1 <= count <= 1_000_000:
            raise LogError(f"count is {count}; it must be 1 to 1000000")
        if self.correlation is None:
            raise LogError(
                "fewer than 3 parts show both breakaway and sliding force, so their correlation is "
                "not known: record more parts, or use the two fits alone"
                " (Population.distributions())"
            )
        rng = np.random.Generator(np.random.Philox(seed))
        hold, slide = (self.fits[name].distribution() for name in FIELDS)
        kept: list[Array] = []
        while sum(len(rows) for rows in kept) < count:
            first, other = rng.standard_normal((2, max(count, 100)))
            second = self.correlation * first + math.sqrt(1.0 - self.correlation**2) * other
            rows = np.column_stack([hold.quantile(ndtr(first)), slide.quantile(ndtr(second))])
            rows = rows[rows[:, 0] >= rows[:, 1]]
            if len(rows) < 0.05 * len(first):
                raise LogError(
                    f"only {len(rows)} of {len(first)} drawn parts have a breakaway force above "
                    "their sliding force; at least 5 % must: check the two fits, or use "
                    "distributions()"
                )
            kept.append(rows)
        table = np.concatenate(kept)[:count]
        return {
            field: Samples(values=tuple(column.tolist()), rows="shared")
            for field, column in zip(FIELDS.values(), table.T, strict=True)
        }


def fit_population(
    logs: Iterable[float | Log | BreakawayReport | BreakawayEvent],
    *,
    distribution: Kind = "log_normal",
    parts: Sequence[str] | None = None,
    confidence: float = 0.95,
    passed_share: float = 0.5,
) -> Population:
    """Fit the distributions of breakaway over many parts, lower bounds counted as such.

    Each log is a part, unless ``parts`` says which logs belong to one. So is each breakaway force
    that is known without a log, and each event. Of a part with several
    events the median counts; it is a lower bound where one of the events at or below the median
    is, because a larger value in its place may raise the median. `fit_distribution` says how lower
    bounds enter.

    Parameters
    ----------
    logs : iterable of Log, BreakawayReport, BreakawayEvent or float
        Logs are searched with the defaults of `find_breakaway_events`; reports keep the settings
        they were made with. A number is a known breakaway force in N, finite and > 0, and no bound.
    distribution : str
        ``log_normal`` or ``normal``.
    parts : sequence of str, optional
        Name of the part of each log, one for each.
    confidence : float
        Confidence of the intervals, > 0 and < 1. Those of forces allow for the gain of the load
        cell, the largest uncertainty that a report's rig states, as one for all parts.
    passed_share : float
        As in `find_breakaway_events`, for logs.

    Returns
    -------
    Population
        ``fits`` always has ``breakaway_force_n``; other quantities only where they can be
        fitted, and ``notes`` say why one is not.

    Raises
    ------
    LogError
        Fewer than three parts gave an event, all but one are lower bounds, or their values are
        all equal; or a setting is out of its range.

    Notes
    -----
    Not checked: that the parts were drawn at random from those that the study is about; that
    they were treated alike (a part freed before, at another loading rate, or after another
    time at rest breaks loose at another force); that the reason for a lower bound has nothing
    to do with the strength of the part, given the bound. A rig that gives up at its largest force
    is no problem, a log that was stopped because the part looked strong is.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(400) / 100.0
    >>> x = 0.01 * np.maximum(t_s - 1.0, 0.0)
    >>> slip = 0.4 + 0.5 * np.exp(-(t_s - 1.0) / 0.02)
    >>> load = np.where(t_s <= 1.0, 0.9 * t_s, slip)
    >>> logs = [Log(t_s=t_s, position_m=x, force_n=f * load) for f in (80.0, 100.0, 130.0)]
    >>> population = fit_population(logs)
    >>> population.distributions()["joint.stiction_n"].model_dump(exclude_none=True)
    {'distribution': 'log_normal', 'median': 91.184..., 'sigma': 0.198...}

    """
    check_arguments(fit_population, locals(), LogError)
    sources = [_source(place, log, passed_share) for place, log in enumerate(logs)]
    names = _part_names(sources, parts)
    grouped: dict[str, list[_Source]] = {}
    for name, source in zip(names, sources, strict=True):
        if source.starts:
            grouped.setdefault(name, []).append(source)
    table, bounds = _table(list(grouped.values()))
    fits, notes = {}, []
    for quantity in QUANTITIES:
        here = np.isfinite(table[quantity])
        try:
            fits[quantity] = fit_distribution(
                table[quantity][here], bounds[quantity][here], kind=distribution,
                confidence=confidence,
            )  # fmt: skip
        except LogError as error:
            if quantity == "breakaway_force_n":
                refusals = "".join(f"; {why}" for why in _refused(sources)[:3])
                raise LogError(f"{quantity}: {error}{refusals}") from None
            notes.append(f"{quantity} is not fitted: {error}")
    gain = 0.01 * max((one.gain_percent for one in sources), default=0.0)
    fits = {name: _with_gain(name, fit, gain) for name, fit in fits.items()}
    notes += [note for name, fit in fits.items() for note in _cautions(name, fit)]
    events = [sum(len(one.starts) for one in part) for part in grouped.values()]
    return Population(
        fits=fits,
        parts=tuple(grouped),
        table=table,
        bounds=bounds,
        events=sum(events),
        repeats=sum(count > 1 for count in events),
        refused=tuple(_refused(sources)),
        correlation=_correlation(fits, table, distribution),
        notes=tuple(notes),
    )


def _with_gain(name: str, fit: FittedDistribution, gain: float) -> FittedDistribution:
    """Return a fit of forces whose intervals allow for a gain that all of them share.

    ::

        half width² = that of the fit² + (z gain value)²
    """
    if name not in FIELDS or gain == 0.0:
        return fit
    z = float(ndtri(0.5 + 0.5 * fit.confidence))
    errors, ends = dict(fit.standard_error), dict(fit.interval)
    for parameter in SCALED[fit.kind]:
        value, (low, high) = fit.parameters[parameter], fit.interval[parameter]
        own = gain * abs(value)
        errors[parameter] = math.hypot(errors[parameter], own)
        ends[parameter] = (
            value - math.hypot(value - low, z * own),
            value + math.hypot(high - value, z * own),
        )
    return replace(fit, standard_error=errors, interval=ends)


@dataclass(frozen=True)
class _Source:
    """What one log, report, event or number tells: its starts, by quantity."""

    name: str
    starts: tuple[Mapping[str, float | None], ...]
    bounds: tuple[bool, ...]
    refused: tuple[str, ...] = ()
    gain_percent: float = 0.0


def _source(
    place: int, given: float | Log | BreakawayReport | BreakawayEvent, passed_share: float
) -> _Source:
    if isinstance(given, Log):
        given = find_breakaway_events(given, passed_share=passed_share)
    if isinstance(given, BreakawayReport):
        events, name = given.events, given.name
        refused = given.refused or (() if events else ("has no start from rest",))
        gain = given.rig.force_calibration_percent if given.rig else 0.0
    elif isinstance(given, BreakawayEvent):
        events, name, refused, gain = (given,), f"event at {given.time_s:.6g} s", (), 0.0
    else:
        return _known(place, float(given))
    starts = tuple({name: getattr(event, name) for name in QUANTITIES} for event in events)
    return _Source(name, starts, tuple(e.is_lower_bound for e in events), refused, gain)


def _known(place: int, force_n: float) -> _Source:
    if not (math.isfinite(force_n) and force_n > 0.0):
        raise LogError(
            f"logs[{place}]: {force_n:g} is no breakaway force; it must be finite and > 0 N"
        )
    return _Source(f"{force_n:g} N", ({"breakaway_force_n": force_n},), (False,))


def _part_names(sources: list[_Source], parts: Sequence[str] | None) -> list[str]:
    if parts is None:
        # Logs may share a name, but are parts of their own.
        return [f"{place + 1} {one.name}" for place, one in enumerate(sources)]
    if len(parts) != len(sources):
        raise LogError(f"{len(parts)} names of parts for {len(sources)} logs; give one for each")
    return list(parts)


def _table(
    groups: list[list[_Source]],
) -> tuple[dict[str, Array], dict[str, npt.NDArray[np.bool_]]]:
    """Return value and lower bound of each part for every quantity."""
    table, bounds = {}, {}
    for quantity in QUANTITIES:
        rows = []
        for part in groups:
            known = [
                (start.get(quantity), bound)
                for one in part
                for start, bound in zip(one.starts, one.bounds, strict=True)
            ]
            rows.append(_median([(v, b) for v, b in known if v is not None], quantity))
        table[quantity] = np.array([row[0] for row in rows], dtype=np.float64)
        bounds[quantity] = np.array([row[1] for row in rows], dtype=bool)
    return table, bounds


def _median(known: list[tuple[float, bool]], quantity: str) -> tuple[float, bool]:
    """Return the median of a part's values, and whether it is a lower bound."""
    if not known:
        return math.nan, False
    values = np.sort([value for value, _ in known])
    upper = values[len(values) // 2]
    # What slides is seen in full, whatever a gap hid of the peak.
    bound = quantity != "sliding_force_n" and any(b and v <= upper for v, b in known)
    return float(np.median(values)), bound


def _refused(sources: list[_Source]) -> list[str]:
    return [f"{one.name}: {reason}" for one in sources for reason in one.refused]


def _correlation(
    fits: dict[str, FittedDistribution], table: dict[str, Array], kind: Kind
) -> float | None:
    if any(name not in fits for name in FIELDS):
        return None
    both = np.stack([table[name] for name in FIELDS])
    both = both[:, np.isfinite(both).all(axis=0)]
    if both.shape[1] < FEWEST_VALUES:
        return None
    return float(np.corrcoef(np.log(both) if kind == "log_normal" else both)[0, 1])


def _cautions(name: str, fit: FittedDistribution) -> list[str]:
    notes = []
    if fit.distance > fit.distance_limit and not fit.censored:
        notes.append(
            f"{name}: the {fit.kind} distribution misses the recorded one by {fit.distance:.2g}, "
            f"more than {fit.distance_limit:.2g}, which chance alone exceeds in 5 % of cases: the "
            "parts may be of more than one kind"
        )
    best = min(fit.aic, key=lambda kind: fit.aic[kind])
    if best != fit.kind and fit.aic[fit.kind] - fit.aic[best] > 2.0:
        notes.append(
            f"{name}: the {best} distribution describes the values better (AIC "
            f"{fit.aic[best]:.1f} against {fit.aic[fit.kind]:.1f})"
        )
    if fit.censored > fit.seen:
        notes.append(
            f"{name}: {fit.censored} of {len(fit.values)} values are lower bounds; how far the "
            "distribution reaches upward is mostly its assumed shape"
        )
    return notes
