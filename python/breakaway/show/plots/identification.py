"""The figures of an identification: what was measured, what the law says, how well it is known.

Each function draws one figure. Where a log gives nothing to draw, it raises `LogError` with the
reason, so that a report can say it in place of the figure.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from scipy import ndimage, signal
from scipy.stats import chi2, norm

from breakaway.drawing.style import COLORS, WIDTH_IN, house_figure, house_style, scaled
from breakaway.errors import LogError
from breakaway.measure.identification.comparison import ComparedLaw
from breakaway.measure.identification.laws import Law
from breakaway.measure.identification.prediction import Prediction
from breakaway.measure.identification.record import Span
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.uncertainty import LEVEL, Profile
from breakaway.model.units import unit_of, words_of

Array = NDArray[np.float64]
Places = NDArray[np.intp]

BINS = 1500
"""Stretches of time of which a long trace keeps the lowest and the highest value."""

ZOOM = 0.05
"""Share of the record that is shown enlarged."""

LABELED = 8
"""Up to so many repeats are labeled."""

CORNER = 6
"""Most parameters in the matrix of a posterior."""


def law_words(law: Law) -> str:
    """Return a law in words, with names of people capitalized.

    Parameters
    ----------
    law : Law
        A law with its options.

    Examples
    --------
    >>> law_words(Law("coulomb", asymmetric=True))
    'Coulomb, each direction'

    """
    return _proper(law.label)


def _proper(words: str) -> str:
    return words.replace("coulomb", "Coulomb").replace("stribeck", "Stribeck")


def plot_fit(prediction: Prediction, spans: Sequence[Span] = ()) -> Figure:
    """Draw measured and simulated channel, the residual, and the most telling stretch enlarged.

    Long traces are drawn by their extremes, so that no peak is lost. The stretch is a twentieth of
    the record, where the force changes most, or where the speed does if position is compared.

    Parameters
    ----------
    prediction : Prediction
        The fit of an identification, or held-out rows.
    spans : sequence of (start_s, end_s)
        Repeats, which are marked where there are several.

    Returns
    -------
    matplotlib.figure.Figure

    """
    name, unit = _channel_words(prediction)
    measured, simulated = _channel(prediction)
    everything = np.ones(len(measured), dtype=bool)
    near = _telling(prediction)
    with house_style():
        figure = house_figure(height=6.4)
        whole, residual, zoom = figure.subplots(3, 1, height_ratios=[1.8, 1.0, 1.4])
        whole.sharex(residual)
        whole.tick_params(labelbottom=False)
        factor, shown = scaled(measured, unit)
        for axes, rows in ((whole, everything), (zoom, near)):
            for values, style in ((measured, _MEASURED), (simulated, _SIMULATED)):
                t_s, drawn = _trace(prediction, values, rows)
                axes.plot(t_s, drawn * factor, **style)
            axes.set_ylabel(f"{name} ({shown})")
        per, small = scaled(prediction.error, unit)
        t_s, drawn = _trace(prediction, prediction.error, everything)
        residual.axhline(0.0, color=COLORS["axis"], linewidth=0.7)
        residual.plot(t_s, drawn * per, color=COLORS["alternative"], linewidth=0.8)
        residual.set_ylabel(f"residual ({small})")
        residual.set_xlabel("time (s)")
        above = 1.1 if len(spans) > 1 else 1.0  # leaves a line for the names of the repeats
        whole.legend(loc="lower right", bbox_to_anchor=(1.0, above), ncols=2, borderaxespad=0.1)
        start, end = float(prediction.t_s[near][0]), float(prediction.t_s[near][-1])
        for axes in (whole, residual):
            axes.axvspan(start, end, color=COLORS["fifth"], alpha=0.25, linewidth=0.0)
        _mark_spans([whole, residual], prediction, spans)
        zoom.set_xlim(start, end)
        zoom.set_xlabel("time (s), the shaded stretch enlarged")
        whole.set_xlim(float(prediction.t_s[0]), float(prediction.t_s[-1]))
        figure.align_ylabels()
    return figure


_MEASURED: Mapping[str, Any] = {"color": "#A0A0A0", "linewidth": 3.0, "label": "measured"}
_SIMULATED: Mapping[str, Any] = {"color": COLORS["ours"], "linewidth": 1.0, "label": "simulated"}


def plot_residual(found: Identification) -> Figure:
    """Draw how residuals spread, and how they correlate over time.

    Left their histogram with the normal distribution of the same root mean square; right their
    autocorrelation, with the band in which 95 % of the values of white noise lie, and the
    window over which the standard errors allow for correlation.

    Parameters
    ----------
    found : Identification
        A finished fit.

    """
    error, step = found.fit.error, float(np.median(np.diff(found.fit.t_s)))
    window = found.internals.covariance.window
    factor, unit = scaled(error, _channel_words(found.fit)[1])
    correlation = _autocorrelation(found.fit, max(2 * window, 40))
    with house_style():
        figure = house_figure(height=2.7)
        spread, memory = figure.subplots(1, 2, width_ratios=[1.0, 1.35])
        _draw_spread(spread, error * factor, unit)
        per_s, time_unit = scaled([len(correlation) * step], "s")
        lag = np.arange(len(correlation)) * step * per_s
        band = float(norm.ppf(0.5 + 0.5 * LEVEL)) / math.sqrt(len(error))
        memory.axhspan(-band, band, color=COLORS["third"], alpha=0.35, linewidth=0.0)
        memory.axhline(0.0, color=COLORS["axis"], linewidth=0.7)
        memory.plot(lag, correlation, color=COLORS["ours"], label="residual")
        memory.fill_between([], [], color=COLORS["third"], alpha=0.35, label="white: 95 %")
        if window > 0:
            at = window * step * per_s
            memory.axvline(at, color=COLORS["axis"], linestyle=(0, (4, 2)), linewidth=1.0)
            memory.lines[-1].set_label("window of the errors")
        memory.set_xlim(0.0, lag[-1])
        memory.set_ylim(min(-0.25, 1.1 * float(correlation.min())), 1.02)
        memory.set_xlabel(f"lag ({time_unit})")
        memory.set_ylabel("autocorrelation")
        memory.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, columnspacing=1.0, fontsize=7.5
        )
    return figure


def _draw_spread(axes: Axes, error: Array, unit: str) -> None:
    rms = float(np.sqrt(np.mean(error**2)))
    edge = max(4.0 * rms, 1e-300)
    beyond = int(np.count_nonzero(np.abs(error) > edge))
    weights = np.full(len(error), 60.0 / (len(error) * 2.0 * edge))
    axes.hist(error, 60, range=(-edge, edge), weights=weights, color=COLORS["ours"], alpha=0.55)
    axes.patches[0].set_label("residual")
    at = np.linspace(-edge, edge, 201)
    axes.plot(at, norm.pdf(at, 0.0, max(rms, 1e-300)), color=COLORS["text"], label="normal")
    beyond_text = f"; {beyond} of {len(error)} beyond" if beyond else ""
    axes.set_xlabel(f"residual ({unit}){beyond_text}")
    axes.set_ylabel(f"density (1/{unit})" if unit else "density")
    axes.set_xlim(-edge, edge)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, columnspacing=1.0)


def plot_posterior(
    found: Identification, samples: Mapping[str, Array], names: Sequence[str] = ()
) -> Figure:
    """Draw draws of the parameters: each by itself, and each against each.

    Contours hold 50 % and 95 % of the draws; lines mark the estimate.

    Parameters
    ----------
    found : Identification
        The fit.
    samples : mapping of str to array
        ``found.posterior().samples``, or ``found.draws(n)``.
    names : sequence of str, optional
        Which parameters; by default the six that correlate most with another, in their order.

    Raises
    ------
    LogError
        Fewer than two parameters vary among the draws, or a name is not among them.

    """
    for name in names:
        if name not in samples:
            raise LogError(f"names: {name!r} was not drawn; it must be one of {', '.join(samples)}")
    chosen = list(names) or _most_correlated(samples)
    if len(chosen) < 2:
        raise LogError("fewer than two parameters are known well enough for draws to be compared")
    count = len(chosen)
    columns = [_drawn(found, samples, name) for name in chosen]
    with house_style():
        figure = house_figure(height=WIDTH_IN * min(1.0, 0.22 + 0.14 * count))
        panels = figure.subplots(count, count, sharex="col", squeeze=False)
        for i, row in enumerate(columns):
            for j, column in enumerate(columns):
                axes = panels[i, j]
                if j > i:
                    axes.remove()
                    continue
                _corner_cell(axes, column, None if i == j else row)
                if i < count - 1:
                    axes.tick_params(labelbottom=False)
                if 0 < j < i:
                    axes.tick_params(labelleft=False)
            panels[-1, i].set_xlabel(row.label, fontsize=7.5)
            if i > 0:
                panels[i, 0].set_ylabel(row.label, fontsize=7.5)
        figure.align_labels()
    return figure


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Draws of one parameter as they are shown."""

    label: str
    values: Array
    estimate: float

    @property
    def ends(self) -> tuple[float, float]:
        low, high = (float(q) for q in np.quantile(self.values, [0.002, 0.998]))
        margin = 0.05 * (high - low)
        return low - margin, high + margin


def _drawn(found: Identification, samples: Mapping[str, Array], name: str) -> _Drawn:
    factor, shown = scaled([np.median(np.abs(samples[name]))], unit_of(name).symbol)
    brackets = f" ({shown})" if shown else ""
    label = "\n".join(textwrap.wrap(words_of(name), 12)) + brackets.replace(" ", "\n", 1)
    return _Drawn(label, samples[name] * factor, found.values[name] * factor)


def _corner_cell(axes: Axes, column: _Drawn, row: _Drawn | None) -> None:
    """Draw a histogram on the diagonal, contours below it."""
    axes.grid(visible=False)
    axes.tick_params(labelsize=6.5, length=2)
    axes.tick_params(axis="x", labelrotation=30)
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.axvline(column.estimate, color=COLORS["alternative"], linewidth=0.9)
    axes.set_xlim(column.ends)
    if row is None:
        axes.hist(column.values, 30, range=column.ends, color=COLORS["ours"], alpha=0.55)
        axes.set_yticks([])
        axes.spines["left"].set_visible(False)
        return
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.axhline(row.estimate, color=COLORS["alternative"], linewidth=0.9)
    counts, xs, ys = np.histogram2d(column.values, row.values, 40, [column.ends, row.ends])
    density = ndimage.gaussian_filter(counts, 2.0).T
    levels = _enclosing(density, (0.95, 0.5))
    middle_x, middle_y = 0.5 * (xs[1:] + xs[:-1]), 0.5 * (ys[1:] + ys[:-1])
    axes.contourf(middle_x, middle_y, density, [*levels, density.max() * 1.01], colors=_SHADES)
    axes.set_ylim(row.ends)


_SHADES = ("#B5D3E8", COLORS["ours"])


def _enclosing(density: Array, shares: Sequence[float]) -> list[float]:
    """Return the levels above which the given shares of the whole lie, rising."""
    ordered = np.sort(density.ravel())[::-1]
    summed = np.cumsum(ordered) / ordered.sum()
    return [float(ordered[int(np.searchsorted(summed, share))]) for share in shares]


def _most_correlated(samples: Mapping[str, Array]) -> list[str]:
    varied = [name for name, values in samples.items() if np.ptp(values) > 0.0]
    if len(varied) <= CORNER:
        return varied
    related = np.abs(np.corrcoef([samples[name] for name in varied]))
    np.fill_diagonal(related, 0.0)
    best = np.argsort(-related.max(axis=0), kind="stable")[:CORNER]
    return [varied[place] for place in sorted(int(place) for place in best)]


def plot_profiles(found: Identification, profiles: Sequence[Profile]) -> Figure:
    """Draw profile likelihoods, with the level of the 95 % interval and the interval itself.

    Parameters
    ----------
    found : Identification
        The fit.
    profiles : sequence of Profile
        From ``found.profile(name)``.

    Raises
    ------
    LogError
        There is no profile.

    """
    if not profiles:
        raise LogError("no profiles to plot; give at least one, from found.profile(name)")
    columns = min(3, len(profiles))
    rows = -(-len(profiles) // columns)
    with house_style():
        figure = house_figure(height=0.4 + 2.0 * rows)
        panels = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for axes, one in zip(panels.flat, profiles, strict=False):
            _draw_profile(axes, one, found.values[one.name])
        for axes in panels.flat[len(profiles) :]:
            axes.set_visible(False)
        for axes in panels[:, 0]:
            axes.set_ylabel("deviance")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=4)
    return figure


def _draw_profile(axes: Axes, one: Profile, estimate: float) -> None:
    words = words_of(one.name)
    factor, shown = scaled([estimate], unit_of(one.name).symbol)
    limit = float(chi2.ppf(LEVEL, 1))
    low, high = (float(np.clip(end, one.values[0], one.values[-1])) for end in (one.low, one.high))
    axes.axvspan(low * factor, high * factor, color=COLORS["ours"], alpha=0.15, linewidth=0.0)
    axes.patches[-1].set_label("95 % interval")
    axes.axhline(limit, color=COLORS["alarm"], linestyle=(0, (4, 2)), linewidth=1.0)
    axes.lines[-1].set_label("95 % quantile of χ²")
    axes.axvline(estimate * factor, color=COLORS["alternative"], linewidth=1.0, label="estimate")
    axes.plot(one.values * factor, one.deviance, marker="o", markersize=3, label="profile")
    axes.set_ylim(0.0, 2.2 * limit)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel(f"{words} ({shown})" if shown else words)


def plot_laws(compared: Sequence[ComparedLaw]) -> Figure:
    """Draw held-out error and AIC of laws that were compared; those that do not pay are gray.

    The AIC counts from the smallest; it counts the fewest effective rows of all fits.

    Parameters
    ----------
    compared : sequence of ComparedLaw
        As `breakaway.measure.identification.compare_laws` gives them.

    Raises
    ------
    LogError
        There are fewer than two.

    """
    if len(compared) < 2:
        raise LogError("fewer than two laws to compare; give more to `compare_laws`")
    rows = min(one.fit.effective_rows for one in compared)
    aic = np.array([one.fit.aic_for(rows) for one in compared])
    unit = _channel_words(compared[0].fit.fit)[1]
    factor, shown = scaled([one.held_out_error for one in compared], unit)
    place = np.arange(len(compared))
    values = (
        (np.array([one.held_out_error for one in compared]) * factor, f"held-out error ({shown})"),
        (aic - aic.min(), "AIC less the smallest"),
    )
    with house_style():
        figure = house_figure(height=1.1 + 0.34 * len(compared))
        panels = figure.subplots(1, 2, sharey=True)
        for axes, (numbers, label) in zip(panels, values, strict=True):
            for pays, color, said in ((True, "ours", "pays"), (False, "reference", "does not pay")):
                some = np.array([one.pays is pays for one in compared])
                if some.any():
                    axes.hlines(place[some], 0.0, numbers[some], color=COLORS[color], linewidth=1.2)
                    axes.plot(numbers[some], place[some], "o", color=COLORS[color], label=said)
            axes.set_xlabel(label)
            axes.set_xlim(-0.03 * max(numbers.max(), 1e-300), 1.08 * max(numbers.max(), 1e-300))
            axes.grid(visible=False, axis="y")
        panels[0].set_yticks(place, [law_words(one.fit.law) for one in compared])
        panels[0].set_ylim(len(compared) - 0.5, -0.5)
        for tick, one in zip(panels[0].get_yticklabels(), compared, strict=True):
            tick.set_color(COLORS["text"] if one.pays else COLORS["axis"])
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=2)
    return figure


def plot_drift(found: Identification) -> Figure:
    """Draw the offset of each repeat with its 95 % interval.

    Parameters
    ----------
    found : Identification
        A fit of several repeats.

    Raises
    ------
    LogError
        There is only one repeat.

    """
    if len(found.spans) < 2:
        raise LogError(
            f"{found.log.name}: one repeat was fitted, so the offset cannot show a drift; give "
            "`repeats`"
        )
    with house_style():
        figure = house_figure(height=2.5)
        axes = figure.subplots()
        axes.axhline(0.0, color=COLORS["axis"], linewidth=0.7)
        known = {one.name: one for one in found.estimates}
        for repeat in range(1, len(found.spans) + 1):
            name = f"offset_{repeat}_n"
            if name in known:
                one = known[name]
                ends = [[max(one.value - one.low, 0.0)], [max(one.high - one.value, 0.0)]]
                style: dict[str, Any] = {"color": COLORS["ours"], "capsize": 4}
                axes.errorbar([repeat], [one.value], yerr=ends, marker="o", **style)
                continue
            held = found.fixed.get(name, 0.0)
            axes.plot([repeat], [held], "o", color=COLORS["axis"], markerfacecolor="white")
            text = "held" if name in found.fixed else "0 by definition"
            axes.annotate(
                text, (repeat, held), (8, 5), textcoords="offset points", fontsize=8,
                color=COLORS["axis"],
            )  # fmt: skip
        axes.set_xticks(range(1, len(found.spans) + 1))
        axes.set_xlim(0.5, len(found.spans) + 0.5)
        axes.set_xlabel("repeat")
        axes.set_ylabel("offset (N)")
    return figure


def _channel(prediction: Prediction) -> tuple[Array, Array]:
    if prediction.channel == "position_m":
        return prediction.measured_position_m, prediction.position_m
    return prediction.measured_force_n, prediction.force_n


def _channel_words(prediction: Prediction) -> tuple[str, str]:
    return ("position", "m") if prediction.channel == "position_m" else ("force", "N")


def _telling(prediction: Prediction) -> NDArray[np.bool_]:
    """Return the rows about the largest change: of the force, or of the speed."""
    t_s = prediction.t_s
    is_force = prediction.channel == "force_n"
    watched = prediction.measured_force_n if is_force else prediction.measured_velocity_m_per_s
    rows = max(len(t_s) // round(4 / ZOOM), 1)
    change = np.abs(watched[rows:] - watched[:-rows])
    # A change from one segment to the next is none of the part.
    change[prediction.segment[rows:] != prediction.segment[:-rows]] = 0.0
    middle = int(np.argmax(change)) + rows // 2
    half = max(round(0.5 * ZOOM * len(t_s)), 5)
    first = min(max(middle - half, 0), max(len(t_s) - 2 * half, 0))
    near = prediction.segment == prediction.segment[middle]
    near[:first] = near[first + 2 * half :] = False
    return np.asarray(near, dtype=bool)


def _trace(prediction: Prediction, values: Array, chosen: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return what is drawn of a channel: its extremes, with a gap between segments."""
    segments = range(int(prediction.segment[-1]) + 1)
    bins = max(BINS // len(segments), 50)
    t_s: list[npt.ArrayLike] = []
    drawn: list[npt.ArrayLike] = []
    for segment in segments:
        rows = np.flatnonzero(chosen & (prediction.segment == segment))
        kept = rows[_extremes(values[rows], bins)]
        t_s += [prediction.t_s[kept], [np.nan]]
        drawn += [values[kept], [np.nan]]
    return np.hstack(t_s)[:-1], np.hstack(drawn)[:-1]


def _extremes(values: Array, bins: int) -> Places:
    """Return the places of the lowest and the highest value of each stretch, in their order."""
    if len(values) <= 2 * bins:
        return np.arange(len(values))
    parts = np.array_split(np.arange(len(values)), bins)
    places = [part[[np.argmin(values[part]), np.argmax(values[part])]] for part in parts]
    return np.unique(np.concatenate([[0], *places, [len(values) - 1]]))


def _mark_spans(panels: Sequence[Axes], prediction: Prediction, spans: Sequence[Span]) -> None:
    if len(spans) < 2:
        return
    for number, (start_s, end_s) in enumerate(spans, 1):
        for axes in panels:
            axes.axvline(start_s, color=COLORS["axis"], linewidth=0.9, linestyle=":")
        if len(spans) <= LABELED:
            middle = 0.5 * (start_s + min(end_s, float(prediction.t_s[-1])))
            panels[0].annotate(
                f"repeat {number}",
                (middle, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 2),
                textcoords="offset points",
                ha="center",
                fontsize=8,
                color=COLORS["axis"],
            )


def _autocorrelation(prediction: Prediction, most: int) -> Array:
    """Return the autocorrelation of the residual within segments, up to a lag of ``most`` rows."""
    error = prediction.error
    lengths = np.bincount(prediction.segment)
    lags = min(most, int(lengths.max()) - 1)
    total = np.zeros(lags + 1)
    for segment in range(len(lengths)):
        own = error[prediction.segment == segment]
        sums = signal.correlate(own, own, method="fft")[len(own) - 1 :][: lags + 1]
        total[: len(sums)] += sums
    return total / max(float(total[0]), 1e-300)
