"""The figures of a comparison: shares, clouds of parts, and how single parts came out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.model.scenario.laws import LAW_WORDS
from breakaway.model.scenario.population import Gentleness
from breakaway.model.scenario.variation import VARIATION_WORDS
from breakaway.run.trials import Case

Row = Mapping[str, Any]
Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

JUMP_FLOOR_M = 1e-7
"""Jumps below it are drawn on it: a logarithm has no zero."""
_SHARES = (
    ("released", COLORS["reference"], "o", 7.0, "released"),
    ("gentle", COLORS["ours"], "o", 5.0, "gentle"),
    ("strict", COLORS["alternative"], "D", 4.0, "strict"),
)


@dataclass(frozen=True)
class Cloud:
    """What a method did to many parts in a case, a point for each."""

    case: Case
    """Friction law of the joints, and how their friction varies."""
    method: str
    """Name of the method."""
    peak: Array
    """Largest force over the breakaway force of each part."""
    jump_m: Array
    """Largest jump of each part, in m."""
    released: Mask
    """Whether each part came free."""
    gentle: Mask
    """Whether it did so gently."""


@dataclass(frozen=True)
class Course:
    """How one part came out."""

    run_index: int
    """Number of the part."""
    released: bool
    """Whether it came free."""
    stiction_n: float
    """Its breakaway force at the seat, in N."""
    length_m: float
    """Length of its guide, in m."""
    mass_kg: float
    """Its mass, in kg."""
    jump_m: float
    """Its largest jump, in m."""
    peak_force_n: float
    """Largest force on it, in N."""
    peak_over_breakaway: float
    """The same over its breakaway force."""
    end_s: float
    """When its run ended, in s."""
    slip_s: tuple[float, float]
    """When its worst slip began and ended, in s."""
    whole: Mapping[str, Array]
    """Columns ``t_s``, ``position_m``, ``force_n``, ``breakaway_n`` of the whole course; of a feed
    axis also ``feed_m`` and ``tip_m``, and with a stack ``tool_m``, as a trace has them."""
    slip: Mapping[str, Array]
    """The same columns about the worst slip."""


def plot_shares(rows: Sequence[Row]) -> Figure:
    """Draw the shares of released, gentle and strict extractions, a panel for each case.

    Laws stand side by side, variations below each other.

    Parameters
    ----------
    rows : sequence of mapping
        One for each case and method, with shares and their intervals.

    """
    laws, variations, methods = (
        list(dict.fromkeys(str(row[key]) for row in rows)) for key in ("law", "variation", "method")
    )
    place = np.arange(len(methods))[::-1].astype(float)
    with house_style():
        height = 0.15 + 0.42 * max(2, len(methods))
        figure = house_figure(height=1.0 + height * len(variations))
        panels = figure.subplots(
            len(variations), len(laws), sharex=True, sharey=True, squeeze=False
        )
        for row in rows:
            axes = panels[variations.index(row["variation"]), laws.index(row["law"])]
            _draw_shares(axes, row, place[methods.index(row["method"])])
        for axes in panels.flat:
            axes.set_xlim(-2.0, 102.0)
            axes.set_ylim(-0.6, len(methods) - 0.4)
        for axes, law in zip(panels[0], laws, strict=True):
            axes.set_title(LAW_WORDS.get(law, law), fontsize=9)
        for axes, variation in zip(panels[:, 0], variations, strict=True):
            axes.set_yticks(place, [text.label(name) for name in methods], fontsize=9)
            verb, rest = VARIATION_WORDS[variation].split(" ", 1)
            axes.set_ylabel(f"friction {verb}\n{rest}", fontsize=8)
        figure.supxlabel("share of the parts (%)", fontsize=9)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        shown = dict(zip(labels, handles, strict=True))
        figure.legend([*shown.values()], [*shown], loc="outside upper right", ncols=3)
    return figure


def _draw_shares(axes: Axes, row: Row, place: float) -> None:
    """Draw the shares of one method, with their intervals."""
    for (name, color, marker, size, label), shift in zip(_SHARES, (0.22, 0.0, -0.22), strict=True):
        share, low, high = (100.0 * row[f"{name}_{key}"] for key in ("share", "low", "high"))
        axes.hlines(place + shift, low, high, color=color, linewidth=2.0)
        axes.plot(
            share, place + shift, marker, color=color, markersize=size, label=label,
            clip_on=False, zorder=3,
        )  # fmt: skip


def plot_scatter(clouds: Sequence[Cloud], gentle: Gentleness, strict: Gentleness) -> Figure:
    """Draw the largest jump over the peak force of every part, a panel for each method and law.

    Parameters
    ----------
    clouds : sequence of Cloud
        What each method did under each law, with the same variation.
    gentle, strict : Gentleness
        Limits, drawn as boxes.

    """
    laws = list(dict.fromkeys(cloud.case.law for cloud in clouds))
    methods = list(dict.fromkeys(cloud.method for cloud in clouds))
    with house_style():
        figure = house_figure(height=1.1 + 1.5 * len(methods))
        panels = figure.subplots(len(methods), len(laws), sharex=True, sharey=True, squeeze=False)
        limits = _limits(clouds, gentle)
        for cloud in clouds:
            axes = panels[methods.index(cloud.method), laws.index(cloud.case.law)]
            _draw_cloud(axes, cloud)
            _draw_boxes(axes, limits, gentle, strict)
        for axes, law in zip(panels[0], laws, strict=True):
            axes.set_title(LAW_WORDS.get(law, law), fontsize=9)
        for axes, method in zip(panels[:, 0], methods, strict=True):
            axes.set_ylabel(f"{text.label(method)}\njump (mm)", fontsize=8)
        for axes in panels[-1]:
            axes.set_xlabel("peak force / breakaway force", fontsize=8)
        figure.legend(handles=_cloud_legend(), loc="outside upper right", ncols=5)
    return figure


def _limits(clouds: Sequence[Cloud], gentle: Gentleness) -> tuple[tuple[float, float], ...]:
    """Give the ranges of both axes, the gentle box within."""
    peak = np.concatenate([cloud.peak for cloud in clouds])
    jump = np.concatenate([cloud.jump_m for cloud in clouds])
    peak, jump = peak[np.isfinite(peak) & (peak > 0.0)], jump[np.isfinite(jump)]
    x = np.append(peak, gentle.peak_over_breakaway_max)
    y = 1e3 * np.maximum(np.append(jump, gentle.jump_max_m), JUMP_FLOOR_M)
    return ((x.min() / 1.3, x.max() * 1.3), (y.min() / 1.6, y.max() * 1.6))


def _draw_cloud(axes: Axes, cloud: Cloud) -> None:
    jump = 1e3 * np.maximum(cloud.jump_m, JUMP_FLOOR_M)
    alpha = float(np.clip(8.0 / np.sqrt(len(jump)), 0.12, 0.7))
    for chosen, color, marker, size in (
        (cloud.released & ~cloud.gentle, COLORS["alternative"], "o", 2.0),
        (cloud.gentle, COLORS["ours"], "o", 2.0),
        (~cloud.released, COLORS["text"], "x", 3.5),
    ):
        axes.plot(
            cloud.peak[chosen], jump[chosen], linestyle="none", marker=marker, markersize=size,
            markeredgewidth=0.0 if marker == "o" else 0.8, color=color, alpha=alpha,
            rasterized=True,
        )  # fmt: skip
    axes.annotate(
        f"{100.0 * cloud.gentle.mean():.4g} % gentle",
        (0.97, 0.93),
        xycoords="axes fraction",
        ha="right",
        va="top",
        zorder=5,
        fontsize=7.5,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0},
    )


def _draw_boxes(
    axes: Axes,
    limits: tuple[tuple[float, float], ...],
    gentle: Gentleness,
    strict: Gentleness,
) -> None:
    (left, right), (low, high) = limits
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_xscale("log")
    axes.set_yscale("log")
    marks = [mark for mark in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if left <= mark <= right]
    axes.set_xticks(marks, [f"{mark:g}" for mark in marks])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    for box, style in ((gentle, "-"), (strict, (0, (3, 2)))):
        corner = box.peak_over_breakaway_max - left, 1e3 * box.jump_max_m - low
        axes.add_patch(
            Rectangle(
                (left, low),
                *corner,
                fill=False,
                edgecolor=COLORS["event"],
                linewidth=1.1,
                linestyle=style,
                zorder=4,
            )
        )


def _cloud_legend() -> list[Line2D]:
    def points(color: str, marker: str, label: str) -> Line2D:
        return Line2D(
            [], [], linestyle="none", marker=marker, markersize=4, color=color, label=label
        )

    def box(style: Any, label: str) -> Line2D:  # noqa: ANN401 - a style of matplotlib
        return Line2D([], [], color=COLORS["event"], linewidth=1.1, linestyle=style, label=label)

    return [
        points(COLORS["ours"], "o", "gentle"),
        points(COLORS["alternative"], "o", "not gentle"),
        points(COLORS["text"], "x", "left in place"),
        box("-", "gentle limits"),
        box((0, (3, 2)), "strict limits"),
    ]


_TIP: dict[str, Any] = {"color": COLORS["text"], "linewidth": 0.9}


def plot_course(median: Course | None, worst: Course) -> Figure:
    """Draw force and position of the middle and the worst part, and the latter's worst slip.

    Parameters
    ----------
    median : Course or None
        The part in the middle by its jump; None if no part came free.
    worst : Course
        The part with the largest jump.

    """
    with house_style():
        figure = house_figure(height=3.7)
        panels = figure.subplots(2, 3, gridspec_kw={"height_ratios": [1.25, 1.0]})
        _draw_column(panels[:, 0], median, zoom=False, title="middle part")
        _draw_column(panels[:, 1], worst, zoom=False, title="worst part")
        _draw_column(panels[:, 2], worst, zoom=True, title="its worst slip")
        handles = [
            Line2D([], [], color=COLORS["ours"], label="force"),
            Line2D(
                [], [], color=COLORS["text"], linestyle=(0, (4, 2)), linewidth=1.0,
                label="breakaway force there",
            ),
            Line2D([], [], color=COLORS["alternative"], label="position"),
        ]  # fmt: skip
        if "tip_m" in worst.slip:
            handles.append(Line2D([], [], label="tip", **_TIP))
        figure.legend(handles=handles, loc="outside upper right", ncols=len(handles))
        figure.align_ylabels()
    return figure


def _draw_column(panels: Sequence[Axes], course: Course | None, *, zoom: bool, title: str) -> None:
    """Draw force above position, over time; about the slip from its beginning."""
    upper, lower = panels
    if course is None:
        for axes in panels:
            axes.set_axis_off()
        upper.set_title(title, fontsize=9)
        upper.annotate("no part came free", (0.5, 0.5), xycoords="axes fraction", ha="center")
        return
    columns = course.slip if zoom else course.whole
    began, ended = course.slip_s
    since = began if zoom else 0.0
    t = columns["t_s"] - since
    per_s, time_unit = scaled(t, "s")
    origin = _position_at(course, began) if zoom else 0.0
    position = columns["position_m"] - origin
    per_n, force_unit = scaled([*columns["force_n"], *columns["breakaway_n"]], "N")
    per_m, way_unit = scaled(position, "m")
    upper.plot(t * per_s, columns["force_n"] * per_n, color=COLORS["ours"], linewidth=1.0)
    upper.plot(
        t * per_s, columns["breakaway_n"] * per_n, color=COLORS["text"], linestyle=(0, (4, 2)),
        linewidth=1.0,
    )  # fmt: skip
    if zoom and "tip_m" in columns:
        lower.plot(t * per_s, (columns["tip_m"] - origin) * per_m, **_TIP)
    lower.plot(t * per_s, position * per_m, color=COLORS["alternative"], linewidth=1.4)
    for axes in panels:
        axes.axvspan(
            (began - since) * per_s, (ended - since) * per_s, facecolor="#F3D9C9", linewidth=0.8,
            edgecolor="#E3B79B", zorder=0,
        )  # fmt: skip
        axes.set_xlim(t[0] * per_s, t[-1] * per_s)
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(f"force ({force_unit})", fontsize=8)
    lower.set_ylabel(f"{'travel' if zoom else 'position'} ({way_unit})", fontsize=8)
    lower.set_xlabel(f"time{' since it slips' if zoom else ''} ({time_unit})", fontsize=8)
    upper.set_title(_heading(course, title, zoom=zoom), fontsize=8)


def _heading(course: Course, title: str, *, zoom: bool) -> str:
    if zoom:
        factor, unit = scaled([course.jump_m], "m")
        return f"{title}: jump of {course.jump_m * factor:.3g} {unit}"
    left = "" if course.released else ", left in place"
    return f"{title}: no. {course.run_index}, {course.stiction_n:.4g} N{left}"


def _position_at(course: Course, time_s: float) -> float:
    return float(np.interp(time_s, course.slip["t_s"], course.slip["position_m"]))
