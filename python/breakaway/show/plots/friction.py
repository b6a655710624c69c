"""Figures of an identified friction force: against velocity, and about reversals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import signal

from breakaway.drawing.style import COLORS, house_figure, house_style, scaled
from breakaway.errors import LogError
from breakaway.measure.identification.friction import (
    FrictionPath,
    fitted_rows,
    measured_friction,
    simulated_friction,
    steady_friction,
)
from breakaway.measure.identification.laws import SHARED
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.uncertainty import LEVEL
from breakaway.measure.identification.verdicts import SPEED_RATIO, excitation

Array = NDArray[np.float64]
Places = NDArray[np.intp]

POINTS = 50_000
"""Most measured points in a cloud; of more, every so many-th is drawn."""

DRAWS = 200
"""Draws of the parameters that a band is made of."""

TURNS = 8
"""Most reversals whose hysteresis is drawn, in one panel."""

TURN = 0.05
"""A reversal counts if the part then goes back by this share of its travel."""

REACH = 5.0
"""Travel shown about a reversal, in times of the deflection from one level to the other."""


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
            "record motion back and forth"
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
    lowpass_hz = fitted_rows(found)[0].lowpass_hz
    t_s, all_s = found.fit.t_s, found.log.t_s
    period_s = 1.0 / lowpass_hz if lowpass_hz else 0.0
    return np.flatnonzero((t_s >= all_s[0] + period_s) & (t_s <= all_s[-1] - period_s))


def _check_speeds(found: Identification) -> None:
    rows, places = fitted_rows(found)
    shown = excitation(rows, places)
    if shown.speed_ratio < SPEED_RATIO:
        raise LogError(
            f"{found.log.name}: nearly one speed, {1e3 * shown.slow_speed_m_per_s:.3g} to "
            f"{1e3 * shown.fast_speed_m_per_s:.3g} mm/s, so friction over velocity has no visible "
            "shape; slide at speeds from creeping to fast"
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


def _ordinal(number: int) -> str:
    ends = {1: "st", 2: "nd", 3: "rd"}
    end = "th" if 10 < number % 100 < 14 else ends.get(number % 10, "th")
    return f"{number}{end}"
