"""The figures of a design: Bode, Nyquist, root locus, and the limit cycle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from breakaway.base import text
from breakaway.design.limit_cycle_course import SEEN, LimitCycleComparison
from breakaway.design.margins import closed_poles, frequencies, frequency_response
from breakaway.design.regimes import SampledLoop
from breakaway.drawing.style import COLORS, house_figure, house_style, scaled

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

DRAWN = ("ours", "alternative", "third")
"""Colors of stuck, sliding, and sliding with friction that changes with speed."""
FACTORS = np.geomspace(0.1, 10.0, 801)
"""Common factors on the gains that a root locus shows."""
LOWEST_GAIN = 1e-3
"""Gain below which a Bode plot has no more to say."""


def plot_bode(loops: Sequence[SampledLoop], title: str = "") -> Figure:
    """Draw gain and phase of the open loops up to the Nyquist frequency, margins marked.

    Parameters
    ----------
    loops : sequence of SampledLoop
        From `breakaway.design.sampled_loops`.
    title : str, optional
        Above the figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)
    >>> loops = bk.design.sampled_loops(bk.design.SampledPid(gains, 1e-5), joint, 1.0)
    >>> [axes.get_ylabel() for axes in plot_bode(loops).axes]
    ['gain |L|', 'phase of L (°)']

    """
    with house_style():
        figure = house_figure(height=5.4)
        gain, phase = figure.subplots(2, 1, sharex=True)
        low = min(_frequencies(loop)[0] for loop in loops)
        for color, loop in zip(DRAWN, loops, strict=False):
            hz, response = _curve(loop, low)
            turned = _phase_deg(response)
            style: dict[str, Any] = {"color": COLORS[color], "label": _label(loop)}
            gain.loglog(hz, np.abs(response), **style)
            phase.semilogx(hz, turned, **style)
            _mark_phase_margin(gain, phase, loop, hz, turned, COLORS[color])
            first = next((one for one in loops if one.margins.gain_margin < np.inf), None)
            _mark_gain_margins(gain, loop, hz, response, COLORS[color], above=loop is first)
        gain.axhline(1.0, color=COLORS["axis"], linewidth=0.9)
        phase.axhline(-180.0, color=COLORS["axis"], linewidth=0.9)
        gain.set_ylim(LOWEST_GAIN, 1e5)
        gain.set_xlim(low / (2.0 * np.pi), 0.6 / float(loops[0].open_loop.dt))
        gain.set_ylabel("gain |L|")
        phase.set_ylabel("phase of L (°)")
        phase.yaxis.set_major_locator(MultipleLocator(90.0))
        phase.set_xlabel("frequency (Hz)")
        _legend_above(gain)
        _title(figure, title)
        figure.align_ylabels()
    return figure


def plot_nyquist(loops: Sequence[SampledLoop], title: str = "") -> Figure:
    """Draw the open loops around -1, each stable one with the circle that it keeps out of.

    Parameters
    ----------
    loops : sequence of SampledLoop
        From `breakaway.design.sampled_loops`.
    title : str, optional
        Above the figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)
    >>> loops = bk.design.sampled_loops(bk.design.SampledPid(gains, 1e-5), joint, 1.0)
    >>> plot_nyquist(loops).axes[0].get_xlabel()
    'Re L'

    """
    with house_style():
        figure = house_figure(height=4.9)
        axes = figure.subplots()
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        axes.plot(np.cos(angle), np.sin(angle), color=COLORS["reference"], linestyle=":")
        for color, loop in zip(DRAWN, loops, strict=False):
            _, response = _curve(loop)
            axes.plot(response.real, response.imag, color=COLORS[color], label=_label(loop))
            axes.plot(response.real, -response.imag, color=COLORS[color], alpha=0.35, zorder=1)
            _arrow(axes, response, COLORS[color])
            size = loop.margins.modulus_margin
            if loop.margins.stable and size < 0.95:
                x, y = -1.0 + size * np.cos(angle), size * np.sin(angle)
                axes.plot(x, y, color=COLORS[color], linewidth=0.9, linestyle="--")
                axes.fill(x, y, color=COLORS[color], alpha=0.1, linewidth=0)
                axes.annotate(
                    f"modulus margin {size:.2f}",
                    (-1.0 - size * 0.7, size * 0.7),
                    xytext=(-1.35, 0.75),
                    color=COLORS[color],
                    fontsize=8,
                    ha="right",
                    arrowprops={"arrowstyle": "-", "color": COLORS[color], "linewidth": 0.7},
                )
        axes.plot(-1.0, 0.0, marker="+", markersize=9, color=COLORS["text"], markeredgewidth=1.6)
        axes.axhline(0.0, color=COLORS["axis"], linewidth=0.6, zorder=0)
        axes.axvline(0.0, color=COLORS["axis"], linewidth=0.6, zorder=0)
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlim(-3.4, 1.5)
        axes.set_ylim(-1.6, 1.6)
        axes.set_xlabel("Re L")
        axes.set_ylabel("Im L")
        _legend_above(axes)
        _title(figure, title)
    return figure


def plot_root_locus(loops: Sequence[SampledLoop], title: str = "") -> Figure:
    """Draw where the closed loop's poles go under a common factor of 0.1 to 10 on the gains.

    Poles z of the sampled loop are drawn as ln(z) / T_s, so that they read as those of a
    continuous loop; right of the vertical line is outside of the unit circle. The upper half is
    shown, and only the poles near those at factor 1.

    Parameters
    ----------
    loops : sequence of SampledLoop
        From `breakaway.design.sampled_loops`.
    title : str, optional
        Above the figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)
    >>> loops = bk.design.sampled_loops(bk.design.SampledPid(gains, 1e-5), joint, 1.0)
    >>> plot_root_locus(loops).axes[0].get_title("left").split()
    ['stuck', '(stable)']

    """
    with house_style():
        figure = house_figure(height=3.4)
        panels = np.atleast_1d(figure.subplots(1, len(loops)))
        for axes, loop in zip(panels, loops, strict=True):
            shown = _draw_locus(axes, loop)
            axes.set_title("\n".join(_lines(loop)), fontsize=9)
        panels[0].set_ylabel("Im ln(z)/$T_s$ (1/ms)")
        bar = figure.colorbar(shown, ax=list(panels), shrink=0.9, aspect=30)
        bar.set_label("factor on all gains")
        bar.set_ticks([-1.0, 0.0, 1.0], labels=["0.1", "1", "10"])
        bar.outline.set_visible(False)
        _title(figure, title)
    return figure


def plot_limit_cycle(found: LimitCycleComparison, title: str = "") -> Figure:
    """Draw the predicted limit cycle along a motion against the cycles that a run shows.

    Parameters
    ----------
    found : LimitCycleComparison
        From `breakaway.design.compare_limit_cycle`.
    title : str, optional
        Above the figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import breakaway as bk
    >>> run = bk.simulate(bk.load_scenario("paper_as_computed"))
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)
    >>> columns = {key: run.trace[key] for key in ("t_s", "reference_m", "velocity_m_per_s")}
    >>> figure = plot_limit_cycle(bk.design.compare_limit_cycle(
    ...     bk.design.SampledPid(gains, 1e-5), run.scenario.joint, 1.0, **columns))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['amplitude (mm/s)', 'frequency (Hz)', 'growth (1/s)']

    """
    with house_style():
        figure = house_figure(height=6.0)
        ratios = {"height_ratios": [1.5, 1.0, 1.0]}
        amplitude, frequency, growth = figure.subplots(3, 1, sharex=True, gridspec_kw=ratios)
        until_s = _until(found)
        per_s, unit = scaled([until_s], "s")
        t = found.predicted_t_s * per_s
        _draw_amplitude(amplitude, found, t, per_s)
        _draw_frequency(frequency, found, t, per_s)
        growth.axhline(0.0, color=COLORS["axis"], linewidth=0.9)
        growth.plot(t, found.growth_per_s, color=COLORS["third"])
        growth.set_ylabel("growth (1/s)")
        growth.set_xlabel(f"time ({unit})")
        growth.set_xlim(0.0, until_s * per_s)
        growth.annotate(
            "growth of a small oscillation: above 0 it builds up",
            (0.99, 0.9),
            xycoords="axes fraction",
            ha="right",
            va="top",
            fontsize=8,
            color=COLORS["third"],
        )
        figure.align_ylabels()
        _title(figure, title)
    return figure


def _frequencies(loop: SampledLoop) -> Array:
    """In rad/s, but for the Nyquist frequency itself."""
    return frequencies(loop.open_loop, np.array(loop.margins.poles))[:-1]


def _curve(loop: SampledLoop, low: float | None = None) -> tuple[Array, ComplexArray]:
    """Frequencies in Hz, from ``low`` in rad/s on if it is given, and L at them."""
    w = _frequencies(loop)
    if low is not None and low < w[0]:
        w = np.concatenate([np.geomspace(low, w[0], 200, endpoint=False), w])
    return w / (2.0 * np.pi), frequency_response(loop.open_loop, w)


def _phase_deg(response: ComplexArray) -> Array:
    """Phase without jumps, so placed that its high end lies within -360 to 0 degrees."""
    turned: Array = np.degrees(np.unwrap(np.angle(response)))
    turns = float(np.ceil(turned[-1] / 360.0))
    return np.asarray(turned - 360.0 * turns, dtype=np.float64)


def _lines(loop: SampledLoop) -> tuple[str, str]:
    at = f"at {loop.velocity_m_per_s:.3g} m/s " if loop.velocity_m_per_s is not None else ""
    return loop.regime, f"{at}({'stable' if loop.margins.stable else 'UNSTABLE'})"


def _label(loop: SampledLoop) -> str:
    return " ".join(_lines(loop))


def _mark_phase_margin(
    gain: Axes, phase: Axes, loop: SampledLoop, hz: Array, turned: Array, color: str
) -> None:
    at = loop.margins.crossover_rad_per_s / (2.0 * np.pi)
    if not np.isfinite(at):
        return
    at_phase = float(np.interp(at, hz, turned))
    gain.plot(at, 1.0, "o", color=color, markersize=4)
    nearest = 360.0 * np.round((at_phase + 180.0) / 360.0) - 180.0
    phase.plot([at, at], [nearest, at_phase], color=color, linewidth=2.4, alpha=0.6)
    phase.plot(at, at_phase, "o", color=color, markersize=4)
    _note(phase, f"{loop.margins.phase_margin_deg:.1f}°", at, at_phase, color)


def _mark_gain_margins(
    gain: Axes, loop: SampledLoop, hz: Array, response: ComplexArray, color: str, *, above: bool
) -> None:
    """Mark by how much the gain may fall or rise, at the frequency at which it then oscillates.

    The upper one is named for one loop only: at high frequencies the loops are the same.
    """
    for factor in (loop.margins.gain_reduction_margin, loop.margins.gain_margin):
        if not (np.isfinite(factor) and factor > 0.0):
            continue
        i = int(np.argmin(np.abs(1.0 + factor * response)))
        if not 1.0 / factor > LOWEST_GAIN:
            continue
        gain.plot([hz[i], hz[i]], [1.0, 1.0 / factor], color=color, linewidth=2.4, alpha=0.6)
        gain.plot(hz[i], 1.0 / factor, "o", color=color, markersize=4)
        if factor < 1.0:
            _note(gain, f"×{factor:.2g}", hz[i], 1.0 / factor, color, right=True)
        elif above:
            _note(gain, f"×{factor:.3g}", hz[i], 1.0 / np.sqrt(factor), color)


def _note(axes: Axes, text: str, x: float, y: float, color: str, *, right: bool = False) -> None:
    axes.annotate(
        text,
        (x, y),
        xytext=(5 if right else -6, 3),
        textcoords="offset points",
        ha="left" if right else "right",
        fontsize=8,
        color=color,
    )


def _arrow(axes: Axes, response: ComplexArray, color: str) -> None:
    """Point along rising frequency, where the curve is within sight."""
    seen = np.flatnonzero((np.abs(response.real + 0.9) < 2.0) & (np.abs(response.imag) < 1.6))
    seen = seen[np.abs(response[seen]) > 0.3]
    if seen.size < 3:
        return
    i = int(seen[seen.size // 3])
    start, end = response[i], response[min(i + 3, response.size - 1)]
    axes.annotate(
        "",
        (end.real, end.imag),
        xytext=(start.real, start.imag),
        arrowprops={"arrowstyle": "-|>", "color": color, "mutation_scale": 11},
    )


def _draw_locus(axes: Axes, loop: SampledLoop) -> Any:  # noqa: ANN401 - matplotlib's mappable
    period_s = float(loop.open_loop.dt)

    def shown(z: ComplexArray) -> ComplexArray:
        kept = np.log(z[np.abs(z) > 1e-12].astype(np.complex128)) / (1e3 * period_s)
        return np.asarray(kept[kept.imag >= -1e-9], dtype=np.complex128)

    now = shown(np.array(loop.margins.poles))
    slow = now[np.abs(now) < 0.3 * np.pi / period_s / 1e3]
    near = 4.0 * float(np.max(np.abs(slow if slow.size else now)))
    points: list[ComplexArray] = []
    colors: list[Array] = []
    for factor, z in zip(FACTORS, closed_poles(loop.open_loop, FACTORS), strict=True):
        points.append(shown(z))
        colors.append(np.full(points[-1].size, np.log10(factor)))
    all_points, all_colors = np.concatenate(points), np.concatenate(colors)
    sizes = np.abs(all_points)
    reach = 1.15 * float(np.max(sizes[sizes < near]))
    axes.axvspan(0.0, 10.0 * reach, color=COLORS["alarm"], alpha=0.06, linewidth=0)
    axes.axvline(0.0, color=COLORS["alarm"], linewidth=0.9)
    mappable = axes.scatter(
        all_points.real, all_points.imag, c=all_colors, s=3, cmap="viridis", vmin=-1.0, vmax=1.0
    )
    axes.plot(now.real, now.imag, "x", color=COLORS["text"], markersize=6, markeredgewidth=1.5)
    axes.set_xlim(-reach, 0.45 * reach)
    tallest = max(float(np.max(all_points.imag[sizes < near])), 0.2 * reach)
    axes.set_ylim(-0.05 * tallest, 1.15 * tallest)
    axes.set_xlabel("Re ln(z)/$T_s$ (1/ms)")
    return mappable


def _until(found: LimitCycleComparison) -> float:
    """End of what is worth showing: somewhat after the oscillation."""
    ends = [found.predicted_window_s[1], found.simulated_window_s[1]]
    finite = [end for end in ends if np.isfinite(end)]
    last = float(found.predicted_t_s[-1]) if found.predicted_t_s.size else 1.0
    return min(last, 1.5 * max(finite)) if finite else last


def _draw_amplitude(axes: Axes, found: LimitCycleComparison, t: Array, per_s: float) -> None:
    cycles = found.cycles
    sight = found.predicted_t_s <= _until(found)
    speed, steady, along = (
        values * 1e3
        for values in (
            found.speed_m_per_s,
            found.steady_amplitude_m_per_s,
            found.course_amplitude_m_per_s,
        )
    )
    ours, other = COLORS["ours"], COLORS["alternative"]
    axes.plot(t, speed, color=COLORS["reference"], linewidth=3.0, label="mean speed")
    axes.plot(t, steady, color=ours, linestyle="--", label="predicted at constant speed")
    axes.plot(t, along, color=ours, label="predicted along the motion")
    at, amplitude = cycles.t_s * per_s, cycles.amplitude_m_per_s * 1e3
    axes.plot(at, amplitude, "o", color=other, markersize=3.5, label="simulated")
    tallest = float(np.max(speed[sight], initial=0.0))
    axes.set_ylim(0.0, 1.05 * max(tallest, 1e-12))
    axes.set_ylabel("amplitude (mm/s)")
    _legend_above(axes)


def _draw_frequency(axes: Axes, found: LimitCycleComparison, t: Array, per_s: float) -> None:
    """Draw the frequencies of visible oscillations: those of the last traces say nothing."""
    cycles = found.cycles
    predicted = found.course_amplitude_m_per_s > SEEN * found.speed_m_per_s
    simulated = cycles.amplitude_m_per_s > SEEN * cycles.speed_m_per_s
    hz = np.where(predicted, found.course_frequency_hz, np.nan)
    axes.plot(t, hz, color=COLORS["ours"])
    at = cycles.t_s[simulated] * per_s
    axes.plot(at, cycles.frequency_hz[simulated], "o", color=COLORS["alternative"], markersize=3.5)
    if np.any(predicted):
        middle = float(np.nanmedian(hz))
        axes.set_ylim(0.9 * middle, 1.1 * middle)
    axes.set_ylabel("frequency (Hz)")


def _legend_above(axes: Axes) -> None:
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.1)


def _title(figure: Figure, title: str) -> None:
    if title:
        figure.suptitle(text.figure(title), x=0.01, ha="left", fontsize=11)
