"""The figures of a tuning: from the rows of its tables alone."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.model.units import unit_of, words_of

Row = Mapping[str, Any]
Array = NDArray[np.float64]

COLUMNS = 3
"""Panels of slices side by side."""
NOT_MET = "constraint not met"
DECADES = 60.0
"""Largest span of a logarithmic axis that is marked at 1, 2 and 5."""
RANKED_MIN = 5
"""Fewest evaluations whose rank correlation is told."""


def plot_pareto(
    title: str,
    evaluations: Sequence[Row],
    front: Sequence[Row],
    less_is_better: Mapping[str, bool],
    start: Mapping[str, float],
) -> Figure:
    """Draw the front of the first objective and each other one, on training and unseen parts.

    Parameters
    ----------
    title : str
        Name of the tuning.
    evaluations : sequence of mapping
        One row for each evaluation.
    front : sequence of mapping
        One row for each evaluation that no other beats, best in the first objective first.
    less_is_better : mapping
        For each objective, by name, whether less of it is better.
    start : mapping
        Objectives of the method as it was, by name.

    """
    first, *others = less_is_better
    with house_style():
        figure = house_figure(height=0.9 + 3.3 * len(others))
        panels = np.atleast_1d(figure.subplots(len(others), 1))
        for axes, other in zip(panels, others, strict=True):
            # No point between two of the front was reached: steps, not slopes, join them.
            steps = "steps-post" if less_is_better[other] else "steps-pre"
            line = steps if len(others) == 1 else None
            _front(axes, evaluations, front, (other, first), start, line)
            axes.set_xlabel(f"{axes.get_xlabel()}; {_better(less_is_better[other])}")
            axes.set_ylabel(f"{axes.get_ylabel()}; {_better(less_is_better[first])}")
        panels[0].legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=6,
            borderaxespad=0.1,
            columnspacing=1.0,
            handletextpad=0.3,
        )
        _title(
            figure,
            f"{title}: the front, {len(front)} of {len(evaluations)} evaluations",
        )
    return figure


def _front(
    axes: Axes,
    evaluations: Sequence[Row],
    front: Sequence[Row],
    names: tuple[str, str],
    start: Mapping[str, float],
    steps: str | None,
) -> None:
    """Draw evaluations, front and start; steps join a front that is a line."""
    factors = [_factor(evaluations, name) for name in names]

    def places(rows: Sequence[Row], suffix: str = "") -> list[Array]:
        return [
            _column(rows, f"{name}{suffix}") * factor
            for name, (factor, _) in zip(names, factors, strict=True)
        ]

    for state, marker, label in (("feasible", "o", "evaluation"), ("infeasible", "x", NOT_MET)):
        rows = [row for row in evaluations if row["state"] == state]
        if rows:
            axes.plot(*places(rows), marker, markersize=3.5, color=COLORS["reference"], label=label)
    _points(axes, front, places(front, "_training"), places(front, "_unseen"), steps)
    before = [start[name] * factor for name, (factor, _) in zip(names, factors, strict=True)]
    if np.isfinite(before).all():
        axes.plot(*before, "D", markersize=6, color=COLORS["third"], label="start")
    axes.set_xlabel(_label(names[0], factors[0][1]))
    axes.set_ylabel(_label(names[1], factors[1][1]))


def _points(
    axes: Axes,
    front: Sequence[Row],
    trained: Sequence[Array],
    unseen: Sequence[Array],
    steps: str | None,
) -> None:
    """Draw each point of a front where training put it, and where unseen parts do."""
    pale, dark = COLORS["alternative"], COLORS["ours"]
    for i in range(len(front)):
        ends = ([a[i], b[i]] for a, b in zip(trained, unseen, strict=True))
        axes.plot(*ends, color=pale, linewidth=0.8, alpha=0.6)
    axes.plot(*unseen, "o", markersize=4, mfc="white", color=pale, label="on unseen parts")
    order = np.argsort(trained[0])
    line: dict[str, Any] = {"drawstyle": steps} if steps else {"linestyle": "none"}
    line |= {"marker": "o", "markersize": 4.5, "color": dark, "label": "front"}
    axes.plot(*(place[order] for place in trained), **line)
    for row, x, y in zip(front, *trained, strict=True):
        if row["recommended"]:
            axes.plot(x, y, "o", ms=11, mfc="none", color=COLORS["text"], label="recommended")


def _better(less: bool) -> str:
    return "less is better" if less else "more is better"


def plot_history(
    title: str, evaluations: Sequence[Row], less_is_better: Mapping[str, bool]
) -> Figure:
    """Draw every objective in the order of evaluation, and the best that meets the constraints.

    Parameters
    ----------
    title : str
        Name of the tuning.
    evaluations : sequence of mapping
        One row for each evaluation.
    less_is_better : mapping
        For each objective, by name, whether less of it is better.

    """
    with house_style():
        figure = house_figure(height=0.9 + 1.9 * len(less_is_better))
        panels = np.atleast_1d(figure.subplots(len(less_is_better), 1, sharex=True))
        for axes, (name, less) in zip(panels, less_is_better.items(), strict=True):
            _history(axes, evaluations, name, less)
        panels[-1].set_xlabel("evaluation")
        panels[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
        panels[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.1)
        figure.align_ylabels()
        _title(figure, f"{title}: objectives on the training parts, in the order of evaluation")
    return figure


def _history(axes: Axes, evaluations: Sequence[Row], name: str, less: bool) -> None:
    factor, unit = _factor(evaluations, name)
    number, value = _column(evaluations, "evaluation"), _column(evaluations, name) * factor
    state = np.array([row["state"] for row in evaluations])
    feasible = (state == "feasible") & np.isfinite(value)
    for chosen, marker, label in (
        (feasible, "o", "constraints met"),
        ((state == "infeasible") & np.isfinite(value), "x", NOT_MET),
    ):
        if chosen.any():
            axes.plot(
                number[chosen],
                value[chosen],
                marker,
                markersize=3.5,
                color=COLORS["axis"],
                label=label,
            )
    if feasible.any():
        found = np.where(feasible, value if less else -value, np.inf)
        best = np.minimum.accumulate(found) * (1.0 if less else -1.0)
        axes.step(
            number,
            np.where(np.isfinite(best), best, np.nan),
            where="post",
            color=COLORS["ours"],
            label="best so far",
        )
    none = number[~np.isfinite(value)]
    if len(none):
        axes.plot(
            none,
            np.full(len(none), 0.02),
            "|",
            markersize=7,
            color=COLORS["alarm"],
            transform=axes.get_xaxis_transform(),
            label="refused, or too few freed",
        )
    axes.set_ylabel(_label(name, unit))


def plot_slices(
    title: str,
    evaluations: Sequence[Row],
    objective: str,
    spans: Mapping[str, tuple[float, float, bool]],
) -> Figure:
    """Draw an objective over each tuned number, with the rank correlation of both.

    Later evaluations are darker: where they gather, the search saw promise. A rank correlation near
    0 means little effect, or one that is not monotonic.

    Parameters
    ----------
    title : str
        Name of the tuning.
    evaluations : sequence of mapping
        One row for each evaluation.
    objective : str
        Name of the objective.
    spans : mapping
        For each tuned number, by dotted path: smallest and largest value, and whether its
        logarithm was searched.

    """
    rows = ceil(len(spans) / COLUMNS)
    columns = min(COLUMNS, len(spans))
    shown = [row for row in evaluations if row[objective] is not None]
    factor, unit = _factor(shown, objective)
    with house_style():
        figure = house_figure(height=0.9 + 1.75 * rows)
        panels = np.atleast_1d(figure.subplots(rows, columns, sharey=True, squeeze=False)).ravel()
        for axes, (path, span) in zip(panels, spans.items(), strict=False):
            _slice(axes, shown, path, _column(shown, objective) * factor, span)
        for axes in panels[len(spans) :]:
            axes.set_axis_off()
        for axes in panels[::columns]:
            axes.set_ylabel(unit if unit else "share")
        _title(
            figure,
            f"{title}: {_label(objective, unit)} over each tuned number, ρ: rank correlation; "
            "later evaluations are darker, ×: misses a constraint, ring: recommended",
        )
    return figure


def _slice(
    axes: Axes, rows: Sequence[Row], path: str, value: Array, span: tuple[float, float, bool]
) -> None:
    low, high, log = span
    factor, unit = _scale(path, [low, high])
    place = _column(rows, path) * factor
    state = np.array([row["state"] for row in rows])
    order = _column(rows, "evaluation")
    for name, marker in (("infeasible", "x"), ("feasible", "o")):
        chosen = state == name
        axes.scatter(
            place[chosen],
            value[chosen],
            c=order[chosen],
            cmap="Blues",
            marker=marker,
            s=13,
            vmin=-0.5 * max(order, default=1.0),
            vmax=max(order, default=1.0),
            linewidths=0.9,
        )
    for row, x, y in zip(rows, place, value, strict=True):
        if row["recommended"]:
            axes.plot(x, y, "o", markersize=9, mfc="none", color=COLORS["text"])
    if log:
        axes.set_xscale("log")
        subs = (1.0,) if high / low > DECADES else (1.0, 2.0, 5.0)
        axes.xaxis.set_major_locator(LogLocator(subs=subs))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlim(factor * low / (high / low) ** 0.04, factor * high * (high / low) ** 0.04)
    else:
        axes.set_xlim(
            *(factor * (end + 0.04 * side * (high - low)) for end, side in ((low, -1), (high, 1)))
        )
    words = words_of(path.rpartition(".")[2])
    axes.set_xlabel(f"{words} ({unit})" if unit else words)
    axes.set_title(_correlation(place, value), fontsize=8, loc="right", pad=2)


def _correlation(place: Array, value: Array) -> str:
    """Give Spearman's rank correlation in words."""
    if len(place) < RANKED_MIN or np.ptp(place) == 0.0 or np.ptp(value) == 0.0:
        return ""
    from scipy.stats import spearmanr

    return f"ρ = {float(spearmanr(place, value).statistic):+.2f}".replace("-", "−")


def _column(rows: Sequence[Row], key: str) -> Array:
    return np.array([np.nan if row[key] is None else row[key] for row in rows], dtype=np.float64)


def _factor(rows: Sequence[Row], name: str) -> tuple[float, str]:
    return _scale(name, _column(rows, name))


def _scale(name: str, values: Any) -> tuple[float, str]:  # noqa: ANN401 - array-like
    """Give the factor and unit in which the values of a name are easy to read."""
    return scaled(values, unit_of(name).symbol)


def _label(name: str, unit: str) -> str:
    return f"{words_of(name)} ({unit})" if unit else words_of(name)


def _title(figure: Figure, words: str) -> None:
    lines = "\n".join(textwrap.wrap(text.figure(words), 100))
    figure.suptitle(lines, x=0.01, ha="left", fontsize=9.5)
