"""The figures of an advice: parts spared by each way, how hard it pulls, one part in motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.model.scenario.laws import LAW_WORDS

Array = NDArray[np.float64]

MARKERS = ("o", "D", "s", "^", "v")
LOAD_SHOWN = (0.03, 30.0)
"""Loads that are shown: peak force over the one allowed."""


@dataclass(frozen=True)
class WayShares:
    """A way, and the share of parts that it spares under each law, with its interval."""

    way: str
    by_law: Mapping[str, tuple[float, float, float]]
    """Law -> share, lower and upper end."""


def plot_spared(ways: Sequence[WayShares]) -> Figure:
    """Draw the share of parts that come out unharmed, by way and law, the best way first.

    Parameters
    ----------
    ways : sequence of WayShares
        All ways, at least one.

    """
    laws = list(ways[0].by_law)
    place = np.arange(len(ways))[::-1].astype(float)
    shifts = np.linspace(0.22, -0.22, len(laws)) if len(laws) > 1 else np.zeros(1)
    with house_style():
        figure = house_figure(height=1.1 + 0.45 * max(2, len(ways)))
        axes = figure.subplots()
        for way, y in zip(ways, place, strict=True):
            for k, (law, shift) in enumerate(zip(laws, shifts, strict=True)):
                share, low, high = (100.0 * one for one in way.by_law[law])
                axes.hlines(y + shift, low, high, color=f"C{k}", linewidth=2.0)
                axes.plot(
                    share, y + shift, MARKERS[k % len(MARKERS)], color=f"C{k}", markersize=5.0,
                    label=LAW_WORDS[law], clip_on=False, zorder=3,
                )  # fmt: skip
        axes.set_yticks(place, [text.label(way.way) for way in ways], fontsize=9)
        axes.set_xlim(-2.0, 102.0)
        axes.set_ylim(-0.6, len(ways) - 0.4)
        axes.set_xlabel("parts that come out within all limits (%), with 95 % intervals")
        handles, labels = axes.get_legend_handles_labels()
        shown = dict(zip(labels, handles, strict=True))
        figure.legend([*shown.values()], [*shown], loc="outside upper right", ncols=len(laws))
    return figure


def plot_loads(loads: Mapping[str, Array]) -> Figure:
    """Draw the distribution of the load of all parts, a line for each way.

    Parameters
    ----------
    loads : mapping of str to array
        Name of a way -> peak force over the one allowed, of each part.

    """
    with house_style():
        figure = house_figure(height=2.8)
        axes = figure.subplots()
        axes.axvspan(1.0, LOAD_SHOWN[1], color=COLORS["alarm"], alpha=0.08, linewidth=0)
        axes.axvline(1.0, color=COLORS["alarm"], linewidth=1.0)
        for name, values in loads.items():
            ordered = np.sort(np.clip(values, *LOAD_SHOWN))
            share = 100.0 * (np.arange(len(ordered)) + 1.0) / len(ordered)
            axes.step(
                np.r_[LOAD_SHOWN[0], ordered, LOAD_SHOWN[1]], np.r_[0.0, share, 100.0],
                where="post", label=text.label(name),
            )  # fmt: skip
        axes.set_xscale("log")
        axes.set_xlim(*LOAD_SHOWN)
        axes.set_ylim(0.0, 103.0)
        axes.set_xlabel("peak force over the one that is allowed; beyond the line it is too much")
        axes.set_ylabel("parts below (%)")
        axes.legend(loc="upper left")
    return figure


def plot_course(t_s: Array, position_m: Array, force_n: Array, force_max_n: float | None) -> Figure:
    """Draw how one part comes out: its position, and the force on it.

    Parameters
    ----------
    t_s, position_m, force_n : array of shape (n,)
        Time in s, position in m and force in N.
    force_max_n : float or None
        The force that is allowed, in N; None where none is stated.

    """
    with house_style():
        figure = house_figure(height=3.2)
        above, below = figure.subplots(2, 1, sharex=True)
        for axes, values, unit, what in (
            (above, force_n, "N", "force"),
            (below, position_m, "m", "position"),
        ):
            factor, symbol = scaled(values, unit)
            axes.plot(t_s, factor * values, color=COLORS["ours"])
            axes.set_ylabel(f"{what} ({symbol})")
        if force_max_n is not None and force_max_n < 20.0 * float(np.max(force_n)):
            factor, _ = scaled(force_n, "N")
            above.axhline(factor * force_max_n, color=COLORS["alarm"], linewidth=1.0)
            above.annotate(
                "allowed", (1.0, factor * force_max_n), (0.0, 2.0), ha="right",
                xycoords=above.get_yaxis_transform(), textcoords="offset points",
                color=COLORS["alarm"], fontsize=8,
            )  # fmt: skip
        below.set_xlabel("time (s)")
    return figure
