"""The figures of studies: from the rows of their tables alone."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.model.scenario.laws import LAW_WORDS
from breakaway.model.units import unit_of, words_of

Row = Mapping[str, Any]
Array = NDArray[np.float64]

SERIES = ("ours", "alternative", "third", "fourth", "fifth")
"""Colors of series, in their order."""
OUTCOME_COLORS = {
    "released": COLORS["third"],
    "not_released": COLORS["reference"],
    "limit_exceeded": COLORS["fifth"],
    "diverged": COLORS["alternative"],
}
"""Outcome -> its color."""
METRICS_MAX = 3
"""Most metrics that one figure shows."""
CONCLUSIONS_MAX = 6
"""Most conclusions that one figure shows."""
DIRECTIONS = {
    "lower": (COLORS["ours"], "o", "lower"),
    "higher": (COLORS["alternative"], "o", "higher"),
    "same": (COLORS["axis"], "s", "the same"),
    "undecided": (COLORS["reference"], "D", "not shown"),
}
"""Which way a difference goes -> its color, its marker, its words."""


def plot_sweep(
    title: str, rows: Sequence[Row], paths: Sequence[str], metrics: Sequence[str]
) -> Figure:
    """Draw metrics and the share of released parts over what is swept.

    The path with most values is the axis; each combination of the others is a series, of which the
    first five are drawn. A metric is drawn as its median, with its 5 to 95 % range pale
    behind it; a share with the interval of its probability.

    Parameters
    ----------
    title : str
        Name of the study.
    rows : sequence of mapping
        One for each point.
    paths : sequence of str
        What is swept.
    metrics : sequence of str
        Which metrics are drawn, the first three at most.

    """
    axis, series = _axis_and_series(rows, paths)
    names = [name for name in metrics if _any_number(rows, f"{name}_median")][:METRICS_MAX]
    with house_style():
        figure = house_figure(height=1.2 + 1.75 * (len(names) + 1))
        panels = np.atleast_1d(figure.subplots(len(names) + 1, 1, sharex=True))
        for color, (label, chosen) in zip(SERIES, series.items(), strict=False):
            for axes, name in zip(panels, names, strict=False):
                _band(axes, chosen, axis, name, COLORS[color], label)
            _band(panels[-1], chosen, axis, "released", COLORS[color], label)
        for axes, name in zip(panels, names, strict=False):
            axes.set_ylabel(_label(name, _factor(rows, [f"{name}_p05", f"{name}_p95"], name)[1]))
        panels[-1].set_ylabel("share released")
        panels[-1].set_ylim(-0.04, 1.04)
        _set_swept_axis(panels[-1], rows, axis)
        if len(series) > 1:
            panels[0].legend(
                loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.1
            )
        more = f", {len(SERIES)} of {len(series)} series" if len(series) > len(SERIES) else ""
        _title(figure, f"{title}: median and 5 to 95 % of the runs that did not diverge{more}")
        figure.align_ylabels()
    return figure


def plot_robustness(
    title: str,
    trail: Sequence[Row],
    over: str,
    result: str,
    limit: float,
    span: tuple[float, float],
) -> Figure:
    """Draw the failure probability of every level that was tried, with its upper bound.

    Parameters
    ----------
    title : str
        Name of the study.
    trail : sequence of mapping
        One row for each level, in the order in which they were tried.
    over : str
        What the level is of.
    result : str
        The answer, as a sentence.
    limit : float
        The failure probability that was asked for.
    span : tuple of float
        Lowest and highest level that might have been tried.

    """
    ordered = sorted(trail, key=lambda row: float(row[over]))
    level = np.array([row[over] for row in ordered], dtype=float)
    bound = np.array([row["upper_bound"] for row in ordered], dtype=float)
    seen = np.array([row["failure_probability"] for row in ordered], dtype=float)
    survived = np.array([row["survived"] for row in ordered], dtype=bool)
    floor = 0.3 * min(limit, bound.min(), 0.5 / max(row["runs"] for row in ordered))
    with house_style():
        figure = house_figure(height=4.0)
        axes = figure.subplots()
        axes.axhline(limit, color=COLORS["alarm"], linewidth=1.0, linestyle=(0, (4, 2)))
        axes.annotate(
            f"asked for: {limit:g}",
            (1.0, limit),
            xycoords=("axes fraction", "data"),
            xytext=(-2, 3),
            textcoords="offset points",
            ha="right",
            fontsize=8,
            color=COLORS["alarm"],
        )
        for chosen, color, label in (
            (survived, "ours", "survived"),
            (~survived, "alternative", "not shown to be survived"),
        ):
            if chosen.any():
                _bounds(axes, level[chosen], seen[chosen], bound[chosen], COLORS[color], label)
        for place, row in enumerate(trail, 1):
            _number_step(axes, row[over], row["upper_bound"], place)
        axes.set_yscale("log")
        axes.set_ylim(floor, 3.0 * bound.max())
        margin = 0.04 * (span[1] - span[0])
        axes.set_xlim(span[0] - margin, span[1] + margin)
        axes.set_xlabel(f"{over}{_in_brackets(over)}; numbers tell the order of trial")
        axes.set_ylabel("failure probability")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1)
        _title(figure, f"{title}: {result}")
    return figure


def _bounds(axes: Axes, level: Array, seen: Array, bound: Array, color: str, label: str) -> None:
    """Draw upper bounds as bars that reach down to what was seen, or off the axis at no failure."""
    axes.vlines(level, np.maximum(seen, 1e-12), bound, color=color, linewidth=1.4)
    axes.plot(level, bound, linestyle="none", marker="_", markersize=10, color=color)
    some = seen > 0.0
    axes.plot(level[some], seen[some], linestyle="none", marker="o", markersize=4, color=color)
    axes.plot([], [], marker="o", markersize=4, color=color, label=label)


def _number_step(axes: Axes, level: float, bound: float, step: int) -> None:
    axes.annotate(
        str(step),
        (level, bound),
        xytext=(0, 4),
        textcoords="offset points",
        ha="center",
        fontsize=7,
        color=COLORS["axis"],
    )


def plot_sensitivity(title: str, rows: Sequence[Row]) -> Figure:
    """Draw first and total order indices of each input, a panel for each metric.

    Parameters
    ----------
    title : str
        Name of the study.
    rows : sequence of mapping
        One for each metric and input; the first three metrics are drawn.

    """
    metrics = list(dict.fromkeys(str(row["metric"]) for row in rows))[:METRICS_MAX]
    inputs = list(dict.fromkeys(str(row["input"]) for row in rows))
    place = np.arange(len(inputs))[::-1].astype(float)
    with house_style():
        figure = house_figure(height=1.3 + 0.48 * max(2, len(inputs)))
        panels = np.atleast_1d(figure.subplots(1, len(metrics), sharey=True, sharex=True))
        for axes, metric in zip(panels, metrics, strict=True):
            chosen = {str(row["input"]): row for row in rows if row["metric"] == metric}
            for shift, key, color, label in (
                (0.19, "first_order", "ours", "first order"),
                (-0.19, "total_order", "fifth", "total order"),
            ):
                axes.barh(
                    place + shift,
                    [chosen[name][key] for name in inputs],
                    height=0.34,
                    xerr=[chosen[name][f"{key}_error"] for name in inputs],
                    color=COLORS[color],
                    ecolor=COLORS["text"],
                    error_kw={"linewidth": 0.9, "capsize": 2},
                    label=label,
                )
            axes.set_title(words_of(metric), fontsize=9)
            axes.axvline(0.0, color=COLORS["axis"], linewidth=0.7)
            axes.grid(visible=False, axis="y")
        panels[0].set_yticks(place, inputs)
        figure.supxlabel("share of the variance", fontsize=9)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper right", ncols=2)
        _title(figure, f"{title}: Sobol indices")
    return figure


def plot_compare(title: str, outcomes: Sequence[Row], differences: Sequence[Row]) -> Figure:
    """Draw how runs ended under each controller, and paired differences from the first.

    Parameters
    ----------
    title : str
        Name of the study.
    outcomes : sequence of mapping
        One row for each controller, the first being what the others are compared with.
    differences : sequence of mapping
        One row for each other controller and metric; the first three metrics are drawn.

    """
    named = dict.fromkeys(str(row["metric"]) for row in differences if row["pairs"])
    metrics = list(named)[:METRICS_MAX]
    count = len(outcomes)
    with house_style():
        heights = [count + 0.5, *([count - 0.5] * len(metrics))]
        figure = house_figure(height=0.9 + 0.36 * sum(heights) + 0.55 * len(heights))
        panels = np.atleast_1d(
            figure.subplots(len(heights), 1, gridspec_kw={"height_ratios": heights})
        )
        _outcome_bars(panels[0], outcomes)
        for axes, metric in zip(panels[1:], metrics, strict=True):
            rows = [row for row in differences if row["metric"] == metric]
            _difference_bars(axes, rows, metric, str(outcomes[0]["controller"]))
        for axes in panels[1:2]:
            axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.1)
        _title(figure, f"{title}: the same parts and draws")
    return figure


def _outcome_bars(axes: Axes, outcomes: Sequence[Row]) -> None:
    place = np.arange(len(outcomes))[::-1]
    left = np.zeros(len(outcomes))
    for name, color in OUTCOME_COLORS.items():
        share = np.array([row[f"{name}_share"] for row in outcomes])
        if share.any():
            axes.barh(
                place, share, left=left, height=0.6, color=color, label=name.replace("_", " ")
            )
        left += share
    axes.set_yticks(place, [text.label(str(row["controller"])) for row in outcomes])
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel(f"share of {outcomes[0]['runs']} runs")
    axes.grid(visible=False, axis="y")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.1)


def _difference_bars(axes: Axes, rows: Sequence[Row], metric: str, first: str) -> None:
    factor, unit = _factor(rows, ["difference_p05", "difference_p95"], metric)
    place = np.arange(len(rows))[::-1]
    keys = ("difference", "difference_low", "difference_high", "difference_p05", "difference_p95")
    middle, low, high, p05, p95 = (_column(rows, key) * factor for key in keys)
    axes.hlines(place, p05, p95, color=COLORS["reference"], linewidth=6.0, label="5 to 95 %")
    axes.hlines(
        place, low, high, color=COLORS["ours"], linewidth=2.0, label="interval of the median"
    )
    axes.plot(
        middle, place, "o", markersize=5, color=COLORS["ours"], label="median of the differences"
    )
    axes.axvline(0.0, color=COLORS["text"], linewidth=0.8)
    for y, row in zip(place, rows, strict=True):
        if not row["pairs"]:
            axes.annotate("no pairs", (0.02, y), xycoords=axes.get_yaxis_transform(), va="center")
    axes.set_yticks(place, [text.label(str(row["controller"])) for row in rows])
    axes.set_ylim(-0.7, len(rows) - 0.3)
    axes.set_xlabel(
        f"{words_of(metric)} less that of {text.label(first)}{f' ({unit})' if unit else ''}"
    )
    axes.grid(visible=False, axis="y")


def plot_agreement(title: str, conclusions: Sequence[Row], laws: Sequence[Row]) -> Figure:
    """Draw what each law says of each conclusion, a panel for each conclusion.

    The verdict is in red where only one law says so, and where laws contradict each other.

    Parameters
    ----------
    title : str
        Name of the study.
    conclusions : sequence of mapping
        One row for each conclusion; the first six are drawn.
    laws : sequence of mapping
        One row for each conclusion, law and disturbance, in the same order.

    """
    count = len(laws) // len(conclusions)
    shown = conclusions[:CONCLUSIONS_MAX]
    with house_style():
        figure = house_figure(height=0.75 + len(shown) * (0.85 + 0.21 * count))
        panels = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
        for place, (axes, conclusion) in enumerate(zip(panels, shown, strict=True)):
            _law_bars(axes, conclusion, laws[place * count : (place + 1) * count])
        _direction_legend(figure, laws[: len(shown) * count])
        more = f", {len(shown)} of {len(conclusions)}" if len(conclusions) > len(shown) else ""
        _title(figure, f"{title}: what each law says{more}")
    return figure


def _law_bars(axes: Axes, conclusion: Row, rows: Sequence[Row]) -> None:
    """Draw the difference that each law shows, with its interval."""
    quantity = str(conclusion["quantity"])
    relative = all(row["relative"] is not None for row in rows)
    name = "relative" if relative else "difference"
    keys = (f"{name}_low", name, f"{name}_high")
    factor, unit = _factor(rows, keys, quantity)
    if relative or quantity == "released":
        factor, unit = 100.0, "%"
    place = np.arange(len(rows))[::-1].astype(float)
    low, middle, high = (_column(rows, key) * factor for key in keys)
    for k, row in enumerate(rows):
        color, marker, _ = DIRECTIONS[str(row["direction"])]
        axes.hlines(place[k], low[k], high[k], color=color, linewidth=2.0)
        axes.plot(middle[k], place[k], marker, markersize=5, color=color)
        if not row["pairs"]:
            where = axes.get_yaxis_transform()
            axes.annotate("no pairs", (0.02, place[k]), xycoords=where, va="center")
    axes.axvline(0.0, color=COLORS["text"], linewidth=0.8)
    if not np.abs(np.nan_to_num([low, middle, high])).any():
        axes.set_xlim(-1.0, 1.0)
    several = len({row["disturbance"] for row in rows}) > 1
    axes.set_yticks(place, [_law_label(row, several=several) for row in rows])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.grid(visible=False, axis="y")
    of = "share released" if quantity == "released" else words_of(quantity)
    first, other = (text.label(str(conclusion[key])) for key in ("first", "other"))
    axes.set_xlabel(f"{of}: {other} less {first}{f' ({unit})' if unit else ''}")
    verdict = str(conclusion["verdict"])
    flagged = verdict.startswith(("only", "contradicted"))
    color = COLORS["alarm"] if flagged else COLORS["text"]
    words = " ".join(LAW_WORDS.get(word, word) for word in verdict.split()).replace("_", " ")
    axes.set_title(words, fontsize=9, color=color)


def _direction_legend(figure: Figure, rows: Sequence[Row]) -> None:
    seen = {str(row["direction"]) for row in rows}
    handles = [
        Line2D([], [], color=color, marker=marker, markersize=5, label=label)
        for name, (color, marker, label) in DIRECTIONS.items()
        if name in seen
    ]
    figure.legend(handles=handles, loc="upper right", ncols=4)


def _law_label(row: Row, *, several: bool) -> str:
    law = LAW_WORDS[str(row["law"])]
    return f"{law}, {str(row['disturbance']).replace('_', ' ')}" if several else law


def _axis_and_series(rows: Sequence[Row], paths: Sequence[str]) -> tuple[str, dict[str, list[Row]]]:
    """Give the path with most values, numbers first, and the rows of each other combination."""

    def rank(path: str) -> tuple[bool, int]:
        return _is_number(rows[0][path]), len({row[path] for row in rows})

    axis = max(paths, key=rank)
    others = [path for path in paths if path != axis]
    series: dict[str, list[Row]] = {}
    for row in rows:
        label = ", ".join(f"{path} = {_short(row[path])}" for path in others)
        series.setdefault(label, []).append(row)
    return axis, series


def _band(axes: Axes, rows: Sequence[Row], axis: str, name: str, color: str, label: str) -> None:
    """Draw a metric's median within its range, or an outcome's share within its interval."""
    if f"{name}_share" in rows[0]:
        keys, factor = (f"{name}_low", f"{name}_share", f"{name}_high"), 1.0
    else:
        keys = (f"{name}_p05", f"{name}_median", f"{name}_p95")
        factor = _factor(rows, [keys[0], keys[2]], name)[0]
    x = _places(rows, axis)
    low, middle, high = (_column(rows, key) * factor for key in keys)
    if _is_number(rows[0][axis]):
        axes.fill_between(x, low, high, color=color, alpha=0.18, linewidth=0.0)
        axes.plot(x, middle, color=color, marker="o", markersize=3, label=label)
        return
    errors = [np.maximum(middle - low, 0.0), np.maximum(high - middle, 0.0)]
    axes.errorbar(
        x, middle, yerr=errors, color=color, linestyle="none", marker="o", capsize=3, label=label
    )


def _set_swept_axis(axes: Axes, rows: Sequence[Row], axis: str) -> None:
    axes.set_xlabel(f"{axis}{_in_brackets(axis)}")
    if not _is_number(rows[0][axis]):
        names = list(dict.fromkeys(_short(row[axis]) for row in rows))
        axes.set_xticks(range(len(names)), names)
        axes.margins(x=0.15)
        return
    values = np.unique(_column(rows, axis))
    ratios = values[1:] / values[:-1] if values[0] > 0.0 else np.array([])
    # Values that lie evenly in their logarithm are meant to be seen so.
    if len(ratios) > 1 and np.ptp(np.log(ratios)) < 0.1 * np.log(ratios).mean():
        axes.set_xscale("log")


def _places(rows: Sequence[Row], axis: str) -> Array:
    if _is_number(rows[0][axis]):
        return _column(rows, axis)
    names = list(dict.fromkeys(row[axis] for row in rows))
    return np.array([names.index(row[axis]) for row in rows], dtype=float)


def _column(rows: Sequence[Row], key: str) -> Array:
    values = [np.nan if row[key] is None else row[key] for row in rows]
    return np.array(values, dtype=np.float64)


def _any_number(rows: Sequence[Row], key: str) -> bool:
    return any(row.get(key) is not None for row in rows)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _short(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else text.label(str(value))


def _factor(rows: Sequence[Row], keys: Sequence[str], name: str) -> tuple[float, str]:
    """Give the factor and unit in which some columns of a metric are easy to read."""
    return scaled(np.concatenate([_column(rows, key) for key in keys]), unit_of(name).symbol)


def _label(name: str, unit: str) -> str:
    return f"{words_of(name)} ({unit})" if unit else words_of(name)


def _in_brackets(path: str) -> str:
    unit = unit_of(path).shown
    return f" ({unit})" if unit else ""


def _title(figure: Figure, words: str) -> None:
    lines = "\n".join(textwrap.wrap(text.figure(words), 100))
    figure.suptitle(lines, x=0.01, ha="left", fontsize=9.5)
