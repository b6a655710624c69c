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

from breakaway.batch.batch import UNITS
from breakaway.errors import LogError
from breakaway.identification.comparison import ComparedLaw
from breakaway.identification.laws import SHARED, Law
from breakaway.identification.prediction import Prediction
from breakaway.identification.record import Rows, RunSettings, Span, core_record, measured_rows
from breakaway.identification.result import Identification
from breakaway.identification.uncertainty import LEVEL, Profile
from breakaway.identification.verdicts import SPEED_RATIO, excitation
from breakaway.logs.log import Log
from breakaway.plots.style import COLORS, WIDTH_IN, house_figure, house_style, scaled

Array = NDArray[np.float64]
Places = NDArray[np.intp]

BINS = 1500
"""Stretches of time of which a long trace keeps the lowest and the highest value."""

POINTS = 50_000
"""Most measured points in a cloud; of more, every so many-th is drawn."""

DRAWS = 200
"""Draws of the parameters that a band is made of."""

ZOOM = 0.05
"""Share of the record that is shown enlarged."""

LABELED = 8
"""Up to so many repeats are labeled."""

CORNER = 6
"""Most parameters in the matrix of a posterior."""

TURNS = 8
"""Most reversals whose hysteresis is drawn, in one panel."""

TURN = 0.05
"""A reversal counts if the part then goes back by this share of its travel."""

REACH = 5.0
"""Travel shown about a reversal, in times of the deflection from one level to the other."""


@dataclass(frozen=True, eq=False)
class FrictionPath:
    """Friction force along a path: what is left of the force without inertia and rig.

    ::

        R = F - m a - F_0 - k_r (x - x_0)
    """

    position_m: Array
    velocity_m_per_s: Array
    friction_n: Array
    segment: NDArray[np.int64]


def words_and_unit(name: str) -> tuple[str, str]:
    """Split the name of a parameter into words and unit.

    Parameters
    ----------
    name : str
        Such as ``stiffness_n_per_m``.

    Examples
    --------
    >>> words_and_unit("coulomb_positive_n"), words_and_unit("stiction_ratio")
    (('Coulomb positive', 'N'), ('stiction ratio', ''))

    """
    end = next((end for end in UNITS if name.endswith(end)), "")
    return _proper(name.removesuffix(end).replace("_", " ")), UNITS.get(end, "")


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


def easy_unit(values: object, unit: str) -> tuple[float, str]:
    """Give the factor and the unit in which values of a parameter are easy to read.

    Parameters
    ----------
    values : array_like
        What is shown, in ``unit``.
    unit : str
        As `words_and_unit` gives it; units of mass and those without a unit get no prefix.

    Examples
    --------
    >>> easy_unit([1.28e6], "N/m"), easy_unit([0.0147], "m/s"), easy_unit([95.0], "kg")
    ((1e-06, 'MN/m'), (1000.0, 'mm/s'), (1.0, 'kg'))

    """
    if not unit.startswith(("N", "m")):
        return 1.0, unit
    return scaled(np.asarray(values, dtype=np.float64), unit)


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


def plot_friction_velocity(found: Identification) -> Figure:
    """Draw measured friction against velocity, with the identified steady curve and its band.

    Points are the measured force less inertia, offset and spring: every so many-th row, as the
    legend says, without those within one period of the low-pass of the log's ends, where it
    rings. The curve is the steady friction at the origin of position; the band holds 95 % of the
    curves of draws from the parameters' normal distribution. A second panel shows slow motion
    where the Stribeck velocity is small against the speeds.

    Parameters
    ----------
    found : Identification
        A finished fit.

    Raises
    ------
    LogError
        The log has nearly one speed: there is no curve to see.

    """
    _check_speeds(found)
    path = measured_friction(found)
    quiet = _quiet_rows(found)
    top = 1.04 * float(np.abs(path.velocity_m_per_s).max())
    slow = _slow_end(found, top)
    with house_style():
        figure = house_figure(height=3.5)
        ends = [top] if slow is None else [top, slow]
        panels = np.atleast_1d(figure.subplots(1, len(ends), width_ratios=[1.5, 1.0][: len(ends)]))
        for axes, end in zip(panels, ends, strict=True):
            _draw_friction(axes, found, path, quiet, end)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=3, markerscale=3.0)
    return figure


def _draw_friction(
    axes: Axes, found: Identification, path: FrictionPath, quiet: Places, end: float
) -> None:
    every = -(-len(quiet) // POINTS)
    rows = quiet[::every]
    rows = rows[np.abs(path.velocity_m_per_s[rows]) <= end]
    half = np.linspace(0.0, end, 121)[1:]
    speeds = np.concatenate([-half[::-1], half])
    curve, low, high = _steady_band(found, speeds)
    per_v, v_unit = scaled([end], "m/s")
    per_n, n_unit = scaled([*path.friction_n[rows], *curve], "N")
    text = "every row" if every == 1 else f"every {_ordinal(every)} row"
    axes.plot(
        path.velocity_m_per_s[rows] * per_v,
        path.friction_n[rows] * per_n,
        linestyle="none",
        marker=".",
        markersize=3,
        markeredgewidth=0.0,
        color="#8A8A8A",
        alpha=0.5,
        label=f"measured, {text}",
        rasterized=True,  # else every point of a long log would be an element of the page
    )
    for side in (speeds < 0.0, speeds > 0.0):
        at = speeds[side] * per_v
        axes.fill_between(
            at,
            low[side] * per_n,
            high[side] * per_n,
            color=COLORS["ours"],
            alpha=0.3,
            linewidth=0.0,
        )
        axes.plot(at, curve[side] * per_n, color=COLORS["ours"])
    axes.lines[-1].set_label("steady curve")
    axes.collections[-1].set_label("95 % band")
    for at_zero in (axes.axhline, axes.axvline):
        at_zero(0.0, color=COLORS["axis"], linewidth=0.7)
    axes.set_xlim(-end * per_v, end * per_v)
    axes.set_xlabel(f"velocity ({v_unit})")
    axes.set_ylabel(f"friction force ({n_unit})")


def plot_hysteresis(found: Identification) -> Figure:
    """Draw friction against position about reversals, measured and simulated.

    A panel for each kind of reversal, position counted from it; where presliding takes most of the
    travel, whole loops in one panel. At most eight reversals are drawn.

    Parameters
    ----------
    found : Identification
        A fit of a law with a bristle.

    Raises
    ------
    LogError
        The law has no bristle, or the part does not reverse within a repeat.

    """
    if not found.law.has_bristle:
        raise LogError(
            f"{found.log.name}: law '{found.law.name}' has no presliding to compare with what was "
            "measured; fit law 'lugre' or 'elasto_plastic'"
        )
    paths = {"measured": measured_friction(found), "simulated": simulated_friction(found)}
    travel = float(np.ptp(paths["measured"].position_m))
    reach = REACH * _deflection(found)
    kinds = [1, -1] if reach < 0.5 * travel else [0]
    drawn = {kind: _loops(paths, kind, reach) for kind in kinds}
    drawn = {kind: loops for kind, loops in drawn.items() if loops["measured"]}
    if not drawn:
        raise LogError(
            f"{found.log.name}: the part does not reverse within a repeat, so no hysteresis shows; "
            "record motion to and fro"
        )
    with house_style():
        figure = house_figure(height=3.5)
        panels = np.atleast_1d(figure.subplots(1, len(drawn), sharey=True))
        for axes, (kind, loops) in zip(panels, drawn.items(), strict=True):
            _draw_loops(axes, loops, kind)
        panels[0].set_ylabel("friction force (N)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=2)
    return figure


def _draw_loops(axes: Axes, loops: Mapping[str, list[tuple[Array, Array]]], kind: int) -> None:
    flat = np.concatenate([x for x, _ in loops["measured"]])
    factor, unit = scaled(flat, "m")
    styles: dict[str, dict[str, Any]] = {
        "measured": {"color": "#8A8A8A", "marker": ".", "markersize": 3, "linewidth": 0.8},
        "simulated": {"color": COLORS["ours"], "linewidth": 1.2},
    }
    for name, style in styles.items():
        for place, (x, friction) in enumerate(loops[name]):
            marker = style if len(x) < 200 else {**style, "marker": ""}
            axes.plot(x * factor, friction, label=name if place == 0 else "", **marker)
    where = {1: "position from the upper turn", -1: "position from the lower turn", 0: "position"}
    axes.axhline(0.0, color=COLORS["axis"], linewidth=0.7)
    axes.set_xlabel(f"{where[kind]} ({unit})")


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
    words, unit = words_and_unit(name)
    factor, shown = easy_unit([np.median(np.abs(samples[name]))], unit)
    brackets = f" ({shown})" if shown else ""
    label = "\n".join(textwrap.wrap(words, 12)) + brackets.replace(" ", "\n", 1)
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
    words, unit = words_and_unit(one.name)
    factor, shown = easy_unit([estimate], unit)
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
        As `breakaway.identification.compare_laws` gives them.

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
        There is but one repeat.

    """
    if len(found.spans) < 2:
        raise LogError(
            f"{found.log.name}: one repeat was fitted, so no drift of the offset shows; give "
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


def measured_friction(found: Identification) -> FrictionPath:
    """Return the friction force along the measured path of the rows that were fitted.

    Parameters
    ----------
    found : Identification
        A finished fit, whose mass, offsets and spring are taken off.

    """
    rows, places = _fitted_rows(found)
    x, v, a, force = rows.columns[:4, places]
    return _path(found, x, v, a, force)


def simulated_friction(found: Identification) -> FrictionPath:
    """Return the friction force along the simulated path.

    Where the motion is simulated, its velocity and acceleration are derived as the measured ones
    are, by the same low-pass.

    Parameters
    ----------
    found : Identification
        A finished fit.

    """
    rows, places = _fitted_rows(found)
    fit = found.fit
    if found.settings.motion == "imposed":
        x, v, a = rows.columns[:3, places]
        return _path(found, x, v, a, fit.force_n)
    settings = RunSettings("imposed", lowpass_hz=rows.lowpass_hz, origin_m=found.settings.origin_m)
    parts = []
    for segment in range(int(fit.segment[-1]) + 1):
        own = fit.segment == segment
        log = Log(t_s=fit.t_s[own], position_m=fit.position_m[own], force_n=fit.force_n[own])
        parts.append(measured_rows(log, settings).columns[:4])
    x, v, a, force = np.concatenate(parts, axis=1)
    return _path(found, x, v, a, force)


def _path(found: Identification, x: Array, v: Array, a: Array, force: Array) -> FrictionPath:
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    mass, spring = (numbers[SHARED.index(name)] for name in ("mass_kg", "spring_n_per_m"))
    offset = numbers[len(SHARED) + found.fit.segment]
    friction = force - mass * a - offset - spring * x
    return FrictionPath(x + found.settings.origin_m, v, friction, found.fit.segment)


def _fitted_rows(found: Identification) -> tuple[Rows, Any]:
    rows = measured_rows(found.log, found.settings)
    return rows, np.searchsorted(rows.log.t_s, found.fit.t_s)


def steady_friction(found: Identification, speeds: Array, numbers: Array) -> Array:
    """Return the friction force of steady sliding, as the core has it.

    A row at rest in its acceleration whose force is huge starts with its bristle at its level: what
    the core says of it is steady sliding.

    Parameters
    ----------
    found : Identification
        The fit, for its law.
    speeds : array of shape (k,)
        Velocities in m/s, none 0.
    numbers : array of shape (n,)
        Numbers of the core, as ``found.internals.problem.layout.numbers`` gives them.

    """
    still, huge = np.zeros_like(speeds), 1e12 * np.sign(speeds)
    period = np.ones_like(speeds)
    columns = [still, speeds, still, huge, still, still, period, speeds, huge]
    rows = Rows(found.log, np.array(columns), even=True, lowpass_hz=None)
    segments = [(row, row + 1) for row in range(len(speeds))]
    record = core_record(rows, segments, found.law, RunSettings("imposed"))
    shared = numbers[: len(SHARED)]
    return np.frombuffer(record.simulate([*shared.tolist(), *still.tolist()])[1])


def _steady_band(found: Identification, speeds: Array) -> tuple[Array, Array, Array]:
    layout = found.internals.problem.layout
    curve = steady_friction(found, speeds, layout.numbers(found.internals.best))
    drawn = found.draws(DRAWS, seed=found.seed)
    internal = np.column_stack(
        [np.log(drawn[one.name]) if one.positive else drawn[one.name] for one in layout.free]
    )
    every = [steady_friction(found, speeds, numbers) for numbers in layout.numbers(internal)]
    low, high = np.quantile(every, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL], axis=0)
    return curve, low, high


def _quiet_rows(found: Identification) -> Places:
    """Return the fitted rows at which the low-pass does not ring at an end of the log."""
    lowpass_hz = _fitted_rows(found)[0].lowpass_hz
    t_s, all_s = found.fit.t_s, found.log.t_s
    period_s = 1.0 / lowpass_hz if lowpass_hz else 0.0
    return np.flatnonzero((t_s >= all_s[0] + period_s) & (t_s <= all_s[-1] - period_s))


def _check_speeds(found: Identification) -> None:
    rows, places = _fitted_rows(found)
    shown = excitation(rows, places)
    if shown.speed_ratio < SPEED_RATIO:
        raise LogError(
            f"{found.log.name}: nearly one speed, {1e3 * shown.slow_speed_m_per_s:.3g} to "
            f"{1e3 * shown.fast_speed_m_per_s:.3g} mm/s, so friction over velocity has no shape to "
            "see; slide at speeds from creeping to fast"
        )


def _slow_end(found: Identification, top: float) -> float | None:
    """Return the speed up to which slow motion is shown apart, if it is worth it."""
    place = SHARED.index("stribeck_velocity_m_per_s")
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    ratio = float(numbers[SHARED.index("stiction_ratio")])
    end = 3.0 * float(numbers[place])
    return end if ratio != 1.0 and 1e-3 * top < end < 0.5 * top else None


def _deflection(found: Identification) -> float:
    """Return how far the bristle goes from the level one way to the level the other way."""
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    levels = sum(numbers[SHARED.index(f"coulomb_{side}_n")] for side in ("positive", "negative"))
    return float(levels / numbers[SHARED.index("stiffness_n_per_m")])


def _loops(
    paths: Mapping[str, FrictionPath], kind: int, reach: float
) -> dict[str, list[tuple[Array, Array]]]:
    return {name: _loops_of(path, kind, reach) for name, path in paths.items()}


def _loops_of(path: FrictionPath, kind: int, reach: float) -> list[tuple[Array, Array]]:
    """Return position and friction about each reversal: upper (1), lower (-1), or all (0)."""
    out: list[tuple[Array, Array]] = []
    for segment in range(int(path.segment[-1]) + 1):
        own = path.segment == segment
        x, friction = path.position_m[own], path.friction_n[own]
        turns = {side: _turns(x, side) for side in (1, -1)}
        if kind == 0:
            if len(turns[1]) + len(turns[-1]):
                out.append((x, friction))
            continue
        others = np.array([0, *turns[-kind], len(x) - 1])
        for turn in turns[kind]:
            before, after = others[others < turn][-1], others[others > turn][0]
            rows = np.arange(before, after + 1)
            rows = rows[np.abs(x[rows] - x[turn]) <= reach]
            out.append((x[rows] - x[turn], friction[rows]))
    return out[:TURNS]


def _turns(x: Array, side: int) -> Places:
    """Return where a path turns: from rising to falling (1) or the other way (-1)."""
    return np.asarray(signal.find_peaks(side * x, prominence=TURN * float(np.ptp(x)))[0])


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


def _ordinal(number: int) -> str:
    ends = {1: "st", 2: "nd", 3: "rd"}
    end = "th" if 10 < number % 100 < 14 else ends.get(number % 10, "th")
    return f"{number}{end}"
