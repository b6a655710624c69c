"""The drawing of figure 10: IAE against var, and how many runs failed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D

from breakaway.ask.reproduction.survey import CONFIDENCE, NAMES, DisturbanceRange
from breakaway.drawing.style import COLORS, house_figure, house_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PRINTED_VAR = {"without_vibration": 0.125, "with_vibration": 0.085}
"""The limits of var that the paper prints, by control."""

CONTROL_COLORS = dict(
    zip(NAMES, (COLORS["ours"], COLORS["third"], COLORS["alternative"]), strict=True)
)
"""Control -> its color."""


def draw_figure_10(ranges: Mapping[str, DisturbanceRange]) -> Figure:
    """Draw IAE above, as median and 5 to 95 % band, and the share of failed runs below.

    Parameters
    ----------
    ranges : mapping
        What was simulated, by control.

    Examples
    --------
    >>> import breakaway as bk
    >>> from breakaway.ask.reproduction.survey import disturbance_range
    >>> survey = disturbance_range(bk.load_scenario("paper_as_computed"), [0.0, 0.5], 2)
    >>> len(draw_figure_10({"without_vibration": survey}).axes)
    2

    """
    with house_style():
        drawing = house_figure(height=5.4)
        top, bottom = drawing.subplots(2, sharex=True, height_ratios=[1.75, 1.0])
        for control, survey in ranges.items():
            _draw_iae(top, control, survey)
            _draw_failures(bottom, control, survey)
        runs = max(survey.runs for survey in ranges.values())
        last = max(float(survey.var[-1]) for survey in ranges.values())
        top.set(ylabel="IAE (m s)", yscale="log")
        top.margins(y=0.08)
        top.set_title(f"{runs:,} runs at each level: median and 5 to 95 % of those not diverged")
        bottom.set(ylabel="share of runs", yscale="log", ylim=(0.5 / runs, 2.5))
        bottom.set(xlabel="var, half width of the disturbance (%)", xlim=(-2, 100 * last + 2))
        bottom.set_title(
            "Runs that did not release the part, with upper bound at "
            f"{100 * CONFIDENCE:g} % (triangles: no such run)"
        )
        _mark_printed_limits(top, bottom)
        _add_legend(drawing, ranges)
        drawing.align_ylabels()
    return drawing


def _draw_iae(axes: Axes, control: str, survey: DisturbanceRange) -> None:
    """Draw a band where runs are left; where all diverged there is none."""
    rows = survey.rows()
    low, median, high = (
        np.array([row[f"iae_{name}_m_s"] for row in rows], dtype=float)
        for name in ("5_percent", "median", "95_percent")
    )
    color = CONTROL_COLORS[control]
    axes.fill_between(100.0 * survey.var, low, high, color=color, alpha=0.25, lw=0)
    axes.plot(100.0 * survey.var, median, "o-", ms=3, color=color)


def _draw_failures(axes: Axes, control: str, survey: DisturbanceRange) -> None:
    """Draw shares as dots with a bar up to the bound, and the bound alone where none failed.

    Nothing at var = 0, where all runs are the same one and a share means nothing.
    """
    color = CONTROL_COLORS[control]
    share = 1.0 - survey.released / survey.runs
    var = 100.0 * survey.var
    bound = np.array([row["not_extracted_upper_bound"] for row in survey.rows()], dtype=float)
    drawn = survey.var > 0.0
    share, var, bound = share[drawn], var[drawn], bound[drawn]
    some = share > 0.0
    axes.vlines(var[some], share[some], bound[some], color=color, lw=1.2)
    axes.plot(var[some], share[some], "o", ms=3, color=color)
    size = 6.5 - 1.3 * list(NAMES).index(control)  # one may lie on another
    axes.plot(var[~some], bound[~some], "v", ms=size, mfc="none", color=color)


def _mark_printed_limits(top: Axes, bottom: Axes) -> None:
    for var in PRINTED_VAR.values():
        for axes in (top, bottom):
            axes.axvline(100.0 * var, color=COLORS["axis"], lw=0.9, ls=":")
    without, with_it = (f"{100.0 * var:g} %" for var in PRINTED_VAR.values())
    top.annotate(
        f"limits that the paper prints:\n{with_it} with vibration, {without} without",
        (100.0 * max(PRINTED_VAR.values()), 0.5),
        xycoords=("data", "axes fraction"),
        xytext=(5, 0),
        textcoords="offset points",
        fontsize=8,
        color=COLORS["axis"],
        va="center",
    )


def _add_legend(drawing: Figure, ranges: Mapping[str, DisturbanceRange]) -> None:
    handles = [
        Line2D(
            [],
            [],
            color=CONTROL_COLORS[control],
            marker="o",
            markersize=3,
            label=NAMES[control] + ("" if survey.stable.any() else " (all diverged)"),
        )
        for control, survey in ranges.items()
    ]
    drawing.legend(handles=handles, loc="outside upper center", ncols=len(handles))
