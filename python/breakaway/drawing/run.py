"""The figure of one run: position, error and forces over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import breakaway_force

if TYPE_CHECKING:
    from breakaway.run.finished import Run

Array = NDArray[np.float64]

BINS = 2000
"""Stretches of time of which a long trace keeps the lowest and the highest value."""


def plot_run(run: Run) -> Figure:
    """Draw position, tracking error and forces of a run, and when the joint broke loose.

    Traces of more than 4000 rows are drawn by their envelope, so that no peak is lost and files
    stay small.

    Parameters
    ----------
    run : Run
        A run with a trace; one that diverged is drawn up to the end of its trace.

    Returns
    -------
    matplotlib.figure.Figure
        Apart from pyplot's state; `breakaway.drawing.style.save_figure` saves it.

    Raises
    ------
    ScenarioError
        The run has no trace.

    Examples
    --------
    >>> import breakaway as bk
    >>> figure = plot_run(bk.simulate(bk.load_scenario("paper_as_computed")))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['position (mm)', 'error (µm)', 'force (N)']

    """
    if not any(len(column) for column in run.trace.values()):
        raise ScenarioError(
            "trace.every_samples: 0 keeps no trace to plot; give a whole number >= 1"
        )
    columns = _finite(run.trace)
    with house_style():
        figure = house_figure(height=6.2)
        position, error, force = figure.subplots(
            3, 1, sharex=True, gridspec_kw={"height_ratios": [1.0, 1.0, 1.3]}
        )
        per_s, time_unit = scaled(columns["t_s"], "s")
        _draw_position(position, columns, per_s)
        _draw_error(error, columns, per_s)
        _draw_forces(force, run, columns, per_s)
        end_s = max(run.metrics.simulated_s, float(run.trace["t_s"][-1]))
        force.set_xlim(0.0, 1.01 * end_s * per_s)
        force.set_xlabel(f"time ({time_unit})")
        _mark_events([position, error, force], run, per_s, end_s)
        figure.align_ylabels()
        figure.suptitle(
            text.figure(f"{run.scenario.name}: {str(run.outcome).replace('_', ' ')}"),
            x=0.01,
            ha="left",
            fontsize=11,
        )
    return figure


def _draw_position(axes: Axes, columns: Mapping[str, Array], per_s: float) -> None:
    factor, unit = scaled([*_range(columns["position_m"]), *_range(columns["reference_m"])], "m")
    t, reference = _thinned(columns["t_s"], columns["reference_m"])
    # Wide and pale below the position, so that both show where they agree.
    axes.plot(
        t * per_s, reference * factor, color=COLORS["reference"], linewidth=3.0, label="reference"
    )
    t, x = _thinned(columns["t_s"], columns["position_m"])
    axes.plot(t * per_s, x * factor, color=COLORS["ours"], label="position")
    axes.set_ylabel(f"position ({unit})")
    _legend(axes, above=1.1)  # leaves a line for the names of the events


def _draw_error(axes: Axes, columns: Mapping[str, Array], per_s: float) -> None:
    t, error = _thinned(columns["t_s"], columns["reference_m"] - columns["position_m"])
    factor, unit = scaled(error, "m")
    axes.axhline(0.0, color=COLORS["axis"], linewidth=0.7)
    axes.plot(t * per_s, error * factor, color=COLORS["ours"])
    axes.set_ylabel(f"error ({unit})")


def _draw_forces(axes: Axes, run: Run, columns: Mapping[str, Array], per_s: float) -> None:
    applied, joint = columns["applied_force_n"], columns["joint_force_n"]
    t, x = _thinned(columns["t_s"], columns["position_m"])
    loose = breakaway_force(run.scenario.joint, x)  # equation (5)
    factor, unit = scaled([*_range(applied), *_range(joint), *_range(loose)], "N")
    for label, values, color in (("applied", applied, "ours"), ("joint", joint, "alternative")):
        at, shown = _thinned(columns["t_s"], values)
        axes.plot(at * per_s, shown * factor, color=COLORS[color], label=label)
    axes.plot(t * per_s, loose * factor, color=COLORS["text"], linestyle=(0, (4, 2)), linewidth=1.0)
    axes.lines[-1].set_label("breakaway force $F_s(x)$")
    axes.set_ylabel(f"force ({unit})")
    _legend(axes, above=1.0)


def _legend(axes: Axes, *, above: float) -> None:
    """Put the legend over the panel, where it can hide nothing."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, above), ncols=3, borderaxespad=0.1)


def _mark_events(panels: list[Axes], run: Run, per_s: float, end_s: float) -> None:
    metrics = run.metrics
    events = [
        ("breakaway", metrics.time_to_breakaway_s, COLORS["event"]),
        ("release", metrics.time_to_release_s, COLORS["event"]),
    ]
    if run.outcome == "diverged":
        events.append(("diverged", metrics.simulated_s, COLORS["alarm"]))
    for label, at_s, color in events:
        if not np.isfinite(at_s):
            continue
        for axes in panels:
            axes.axvline(at_s * per_s, color=color, linewidth=1.0, linestyle=":")
        panels[0].annotate(
            label,
            (at_s * per_s, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2),
            textcoords="offset points",
            ha="left" if at_s < 0.5 * end_s else "right",
            va="bottom",
            fontsize=8,
            color=color,
        )


def _finite(trace: Mapping[str, Array]) -> dict[str, Array]:
    """Give the trace with gaps in place of what is not finite."""
    return {name: np.where(np.isfinite(v), v, np.nan) for name, v in trace.items()}


def _range(values: Array) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)


def _thinned(t: Array, values: Array) -> tuple[Array, Array]:
    """Keep the lowest and the highest value of each stretch of a long trace, in their order."""
    if len(values) <= 2 * BINS:
        return t, values
    edges = np.linspace(0, len(values), BINS + 1).astype(int)[:-1]
    low = np.fmin.reduceat(values, edges)
    high = np.fmax.reduceat(values, edges)
    rising = np.concatenate([values[edges[1:] - 1], values[-1:]]) >= values[edges]
    ends = np.append(edges[1:], len(values)) - 1
    return (
        np.column_stack([t[edges], t[ends]]).ravel(),
        np.where(
            np.column_stack([rising, rising]),
            np.column_stack([low, high]),
            np.column_stack([high, low]),
        ).ravel(),
    )
