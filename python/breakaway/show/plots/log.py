"""The figure of a log as it was measured, with what was found odd about it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.measure.logs.channel import Channel
from breakaway.measure.logs.findings import GAP, Finding
from breakaway.measure.logs.log import Log
from breakaway.model.units import unit_of, words_of

Array = NDArray[np.float64]

FIRST = ("force_n", "position_m", "reference_m", "velocity_m_per_s")
"""Channels that are drawn first, in this order."""
MOST_PANELS = 5
"""Panels of a figure; what is left out is told in its title."""
PLACED = ("gap", "jitter", "repeated_stamps", "unordered_stamps", "saturation", "invalid")
"""Kinds of findings that begin somewhere; the others are of a channel or a file as a whole."""
BINS = 2000
"""Of a longer channel the least and the largest value of each of so many stretches are drawn."""


def plot_log(log: Log) -> Figure:
    """Draw the channels of a log over time, and mark what is odd about them.

    Lines break at gaps, which are shaded. A dashed line stands where a finding begins that has a
    place, and its kind is named in the first panel that it is about. Nothing is fitted or filtered.

    Parameters
    ----------
    log : Log
        The log.

    Examples
    --------
    >>> t_s = np.arange(400) / 100.0
    >>> figure = plot_log(Log(t_s=t_s, position_m=2e-3 * np.sin(t_s), force_n=np.cos(t_s)))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['force (N)', 'position (mm)']

    """
    names = [*(n for n in FIRST if n in log.channels), *(n for n in log.channels if n not in FIRST)]
    shown = [log.channels[name] for name in names[:MOST_PANELS]]
    with house_style():
        figure = house_figure(height=0.9 + 1.35 * len(shown))
        panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        named: list[Finding] = []
        for axes, channel in zip(panels, shown, strict=True):
            _draw(axes, channel)
            found = [one for one in log.findings if one.kind in PLACED and _is_about(one, channel)]
            _mark(axes, found, named)
            named += found
        panels[-1].set_xlabel("time (s)")
        left = len(names) - len(shown)
        more = f"; {left} more channels are not shown" if left else ""
        panels[0].set_title(text.label(log.name) + more, fontsize=9)
    return figure


def _draw(axes: Axes, channel: Channel) -> None:
    steps = np.diff(channel.t_s)
    usual = float(np.median(steps)) if steps.size else 0.0
    after = np.flatnonzero(steps > GAP * usual)
    for k in after:
        axes.axvspan(channel.t_s[k], channel.t_s[k + 1], color="#EFEFEF", linewidth=0.0)
    factor, unit = scaled(channel.values, unit_of(channel.name).symbol)
    for part in np.split(np.arange(channel.rows), after + 1):
        kept = part[_kept(channel.values[part])]
        axes.plot(channel.t_s[kept], factor * channel.values[kept], color=COLORS["ours"])
    axes.set_ylabel(f"{words_of(channel.name)} ({unit})")


def _kept(values: Array) -> NDArray[np.intp]:
    """Give the places that are drawn: all, or the least and the largest of each stretch."""
    if len(values) <= 2 * BINS:
        return np.arange(len(values))
    places = np.array_split(np.arange(len(values)), BINS)
    ends = [(one[np.argmin(values[one])], one[np.argmax(values[one])]) for one in places]
    return np.unique(np.array(ends))


def _is_about(finding: Finding, channel: Channel) -> bool:
    """Whether a finding is of a place in a channel: of the channel, or of shared stamps."""
    named = finding.channel.removeprefix("t_s of ").split(", ")
    return finding.channel in (channel.name, "t_s") or channel.name in named


def _mark(axes: Axes, findings: list[Finding], named: list[Finding]) -> None:
    """Stand a dashed line where each finding begins, and its kind beside it unless it is named."""
    for finding in findings:
        axes.axvline(finding.first_t_s, color=COLORS["alarm"], linewidth=0.9, linestyle="--")
    for row, finding in enumerate(one for one in findings if one not in named):
        axes.annotate(
            finding.kind.replace("_", " "), (finding.first_t_s, 0.97 - 0.14 * (row % 6)),
            (3.0, 0.0), xycoords=("data", "axes fraction"), textcoords="offset points",
            va="top", fontsize=7, color=COLORS["alarm"],
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )  # fmt: skip
