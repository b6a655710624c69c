"""The figures of breakaway events: the start in one log, and the ratios of many."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.errors import LogError
from breakaway.measure.identification.events import LOADING, BreakawayEvent, BreakawayReport
from breakaway.measure.logs.log import Log

Array = NDArray[np.float64]

BEFORE = 1.2
AFTER = 9.0
"""How much is shown before the loading starts and after the peak, in times of the loading."""

DOTS = 400
"""Up to so many samples are drawn as dots too."""


def plot_breakaway(log: Log, report: BreakawayReport, event: int = 0) -> Figure:
    """Draw force and position about one start from rest, and how it was read.

    The force is as measured. A lower bound is a hollow peak with an arrow toward where the true
    one may lie; lines break at gaps, which are shaded. Without an event the log's first
    tenth is drawn, with the reason.

    Parameters
    ----------
    log : Log
        The log that the report is of.
    report : BreakawayReport
        What `find_breakaway_events` found in it.
    event : int
        Which event, counted from 0.

    Raises
    ------
    LogError
        There is no such event, though there are others.

    Examples
    --------
    >>> from breakaway.measure.identification.events import find_breakaway_events
    >>> t_s = np.arange(400) / 100.0
    >>> load = np.where(t_s <= 1.0, 90.0 * t_s, 40.0)
    >>> log = Log(t_s=t_s, position_m=0.01 * np.maximum(t_s - 1.0, 0.0), force_n=load)
    >>> figure = plot_breakaway(log, find_breakaway_events(log))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['force (N)', 'position (mm)']

    """
    if report.events and not 0 <= event < len(report.events):
        raise LogError(f"{report.name}: event is {event}; it must be 0 to {len(report.events) - 1}")
    found = report.events[event] if report.events else None
    low, high = _span(log, found)
    shown = (log.t_s >= low) & (log.t_s <= high)
    t_s, force, position = _broken(log, report, shown)
    with house_style():
        figure = house_figure(height=4.6)
        upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [1.7, 1.0]})
        per_s, time_unit = scaled([high - low], "s")
        per_n, force_unit = scaled(force, "N")
        per_m, way_unit = scaled(position - np.nanmin(position), "m")
        dots = "." if np.count_nonzero(shown) <= DOTS else ""
        for axes, values in ((upper, force * per_n), (lower, position * per_m)):
            axes.plot(t_s * per_s, values, color=COLORS["ours"], marker=dots, markersize=4)
        _shade_gaps([upper, lower], report, (low, high), per_s)
        upper.set_ylabel(f"force ({force_unit})")
        lower.set_ylabel(f"position ({way_unit})")
        lower.set_xlabel(f"time ({time_unit})")
        lower.set_xlim(low * per_s, high * per_s)
        if found is not None:
            _draw_reading(upper, log, report, found, per_s, per_n)
            _draw_way(lower, found, per_s)
        figure.align_ylabels()
        _title(figure, f"{report.name}: {_headline(report, found)}")
    return figure


def plot_breakaway_ratios(reports: Sequence[BreakawayReport]) -> Figure:
    """Draw breakaway over sliding of every event, by log; lower bounds as arrows.

    Parameters
    ----------
    reports : sequence of BreakawayReport
        One for each log, drawn from the top; one without a ratio keeps its row, with the reason.

    Raises
    ------
    LogError
        There is no report.

    """
    if not reports:
        raise LogError("no reports to plot; give at least one")
    with house_style():
        figure = house_figure(height=1.2 + 0.3 * len(reports))
        axes = figure.subplots()
        for row, report in enumerate(reports):
            _draw_ratios(axes, row, report)
        axes.axvline(1.0, color=COLORS["axis"], linewidth=0.8)
        axes.set_yticks(range(len(reports)), [text.label(report.name) for report in reports])
        axes.set_ylim(len(reports) - 0.4, -0.6)
        axes.set_xlim(left=0.9)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("breakaway over sliding friction")
        seen = sum(not e.is_lower_bound for r in reports for e in r.events)
        bounds = sum(e.is_lower_bound for r in reports for e in r.events)
        _title(
            figure, f"Breakaway over sliding: {seen} seen (dots), {bounds} lower bounds (arrows)"
        )
    return figure


def _span(log: Log, event: BreakawayEvent | None) -> tuple[float, float]:
    start, end = float(log.t_s[0]), float(log.t_s[-1])
    if event is None:
        return start, start + 0.1 * (end - start)
    begin = start if event.load_start_s is None else event.load_start_s
    step = float(np.median(np.diff(log.t_s)))
    loading = max(event.time_s - begin, 5.0 * step)
    return max(start, begin - BEFORE * loading), min(end, event.time_s + AFTER * loading)


def _broken(
    log: Log, report: BreakawayReport, shown: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Return what is shown, with NaN in every gap so that no line is drawn across it."""
    columns = [log.t_s[shown], log.force_n[shown], log.position_m[shown]]
    befores = [before for before, _ in report.gaps_s]
    places = np.flatnonzero(np.isin(columns[0], befores)) + 1
    t_s, force, position = (np.insert(column, places, np.nan) for column in columns)
    return t_s, force, position


def _shade_gaps(
    panels: Sequence[Axes], report: BreakawayReport, span: tuple[float, float], per_s: float
) -> None:
    for before, after in report.gaps_s:
        if after < span[0] or before > span[1]:
            continue
        for axes in panels:
            axes.axvspan(before * per_s, after * per_s, color="#EFEFEF", linewidth=0.0)
        if after - before > 0.1 * (span[1] - span[0]):
            panels[0].annotate(
                f"gap of {after - before:.3g} s",
                (0.5 * (before + after) * per_s, 0.95),
                xycoords=("data", "axes fraction"),
                ha="center",
                va="top",
                fontsize=8,
                color=COLORS["axis"],
            )


def _draw_reading(
    axes: Axes,
    log: Log,
    report: BreakawayReport,
    event: BreakawayEvent,
    per_s: float,
    per_n: float,
) -> None:
    sign = event.direction
    peak = sign * event.raw_breakaway_force_n
    _draw_loading(axes, log, event, per_s, per_n)
    if event.raw_sliding_force_n is not None:
        level = sign * event.raw_sliding_force_n * per_n
        axes.axhline(level, color=COLORS["third"], linestyle=(0, (5, 2)), label="sliding level")
    if report.offset_n:
        axes.axhline(
            report.offset_n * per_n,
            color=COLORS["axis"],
            linestyle=":",
            label="offset of the force",
        )
    face = "white" if event.is_lower_bound else COLORS["alternative"]
    label = "largest recorded load" if event.is_lower_bound else "breakaway"
    axes.plot(
        [event.time_s * per_s], [peak * per_n], "o", markersize=7, markerfacecolor=face,
        markeredgecolor=COLORS["alternative"], label=label, zorder=4,
    )  # fmt: skip
    low, high = axes.get_ylim()
    room = 0.16 * (high - low)
    axes.set_ylim((low, high + room) if sign > 0 else (low - room, high))
    if event.is_lower_bound:
        axes.annotate(
            "",
            (event.time_s * per_s, peak * per_n + sign * 1.25 * room),
            (event.time_s * per_s, peak * per_n),
            arrowprops={"arrowstyle": "-|>", "color": COLORS["alternative"], "shrinkA": 4},
            annotation_clip=False,
        )
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.1)


def _draw_loading(axes: Axes, log: Log, event: BreakawayEvent, per_s: float, per_n: float) -> None:
    """Draw the fitted loading line from the start of the load to the peak."""
    if event.loading_rate_n_per_s is None or event.load_start_s is None:
        return
    inside = (log.t_s >= event.load_start_s) & (log.t_s <= event.time_s)
    t_s, load = log.t_s[inside], event.direction * log.force_n[inside]
    low, high = (load[0] + share * (load[-1] - load[0]) for share in LOADING)
    chosen = (load >= low) & (load <= high)
    middle, level = t_s[chosen].mean(), load[chosen].mean()
    ends_n = np.array([load[0], load[-1]])
    ends_s = middle + (ends_n - level) / event.loading_rate_n_per_s
    axes.plot(
        ends_s * per_s,
        event.direction * ends_n * per_n,
        color=COLORS["fifth"],
        linewidth=2.4,
        label="loading",
        zorder=3,
    )


def _draw_way(axes: Axes, event: BreakawayEvent, per_s: float) -> None:
    """Mark the start of loading and the peak on the position."""
    axes.axvline(event.time_s * per_s, color=COLORS["alternative"], linewidth=1.0, linestyle=":")
    if event.load_start_s is not None:
        axes.axvline(
            event.load_start_s * per_s, color=COLORS["fifth"], linewidth=1.2, linestyle=":"
        )


def _draw_ratios(axes: Axes, row: int, report: BreakawayReport) -> None:
    known = [event for event in report.events if event.breakaway_over_sliding is not None]
    for event in known:
        ratio = float(event.breakaway_over_sliding or np.nan)
        face = "white" if event.is_lower_bound else COLORS["ours"]
        axes.plot([ratio], [row], "o", markersize=5, color=COLORS["ours"], markerfacecolor=face)
        if event.is_lower_bound:
            axes.annotate(
                "",
                (ratio, row),
                (22, 0),
                textcoords="offset points",
                arrowprops={"arrowstyle": "<|-", "color": COLORS["ours"], "shrinkB": 3},
            )
    if not known:
        why = report.refused[0] if report.refused else "no steady sliding after a start from rest"
        axes.annotate(
            textwrap.shorten(why.split(";")[0], 95),
            (0.05, row),
            xycoords=axes.get_yaxis_transform(),
            va="center",
            fontsize=7.5,
            color=COLORS["axis"],
        )


def _headline(report: BreakawayReport, event: BreakawayEvent | None) -> str:
    if event is None:
        return report.refused[0] if report.refused else "no start from rest"
    bound = "at least " if event.is_lower_bound else ""
    ratio = event.breakaway_over_sliding
    over = "" if ratio is None else f", {ratio:.2f} times sliding"
    less = " less the offset" if report.offset_n else ""
    why = f"; {event.reason}" if event.reason else ""
    return f"breakaway {bound}{event.breakaway_force_n:.4g} N{less}{over}{why}"


def _title(figure: Figure, words: str) -> None:
    lines = "\n".join(textwrap.wrap(text.figure(words), 100))
    figure.suptitle(lines, x=0.01, ha="left", fontsize=9.5)
