"""Our own drawings of what the paper's figures 2b, 4, 7, 8, 9 and 10 show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.reproduction.figure_10 import CONTROL_COLORS, draw_figure_10
from breakaway.ask.reproduction.runs import Runs
from breakaway.ask.reproduction.survey import NAMES, DisturbanceRange
from breakaway.drawing.style import COLORS, house_figure, house_style
from breakaway.model.friction.curve import breakaway_force, steady_force
from breakaway.model.friction.imposed import impose_motion
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.joint import Lugre
from breakaway.run.finished import Run
from breakaway.run.resolution import resolve

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Values = NDArray[np.float64]


@dataclass(frozen=True)
class ReproducedFigure:
    """One figure with its words and the numbers behind it."""

    key: str
    """Name of its files."""
    title: str
    """What it is."""
    caption: str
    """How to read it."""
    drawing: Figure
    """The drawing."""
    data: dict[str, object]
    """Its main figures, for reproduction.json."""
    table: Sequence[Mapping[str, object]] = ()
    """Its data row by row, for a CSV file; empty where there is none."""


def draw_all(runs: Runs) -> list[ReproducedFigure]:
    """Draw every figure."""
    with house_style():
        return [
            stribeck_curve(),
            loss_of_contact(),
            forces(runs, "figure_7", ("without_vibration",)),
            forces(runs, "figure_8", ("with_vibration", "with_vibration_bounded")),
            displacement(runs),
            iae_against_var(runs.ranges),
        ]


def _paper_joint() -> Lugre:
    joint = resolve(load_scenario("paper_as_computed")).joint
    if not isinstance(joint, Lugre):
        raise TypeError("the preset paper_as_computed is a LuGre joint")
    return joint


def stribeck_curve() -> ReproducedFigure:
    """Figure 2b: steady friction against velocity, simulated and by equation (4)."""
    joint = _paper_joint()
    speeds = np.geomspace(1e-3, 0.5, 40)
    velocities = np.concatenate([-speeds[::-1], speeds])
    steady = np.array([_steady_friction(joint, v) for v in velocities])
    v = np.linspace(-0.5, 0.5, 801)
    drawing = house_figure(height=2.9)
    axes = drawing.subplots()
    axes.plot(v, steady_force(joint, v), color=COLORS["ours"], label="equation (4)")
    axes.plot(
        velocities,
        steady,
        "o",
        markersize=3.5,
        markerfacecolor="none",
        color=COLORS["alternative"],
        label="simulated, sliding until steady",
    )
    axes.set(xlabel="velocity (m/s)", ylabel="friction at the seat (N)")
    axes.legend(loc="lower right")
    worst = float(np.max(np.abs(steady / steady_force(joint, velocities) - 1.0)[speeds.size :]))
    return ReproducedFigure(
        "figure_2b",
        "Figure 2b: the Stribeck curve.",
        "Friction falls from stiction to the Coulomb level over the Stribeck velocity of "
        f"{joint.stribeck_velocity_m_per_s:g} m/s. The simulated bristle settles on the curve to a "
        f"relative {worst:.1e}; the paper draws the same shape without numbers.",
        drawing,
        {"largest_relative_difference": worst},
    )


def _steady_friction(joint: Lugre, velocity: float) -> float:
    """Joint force at the seat after sliding for 20 bristle deflections, contact loss left out."""
    seated = joint.model_copy(update={"engagement_length_m": 1e6})
    travel = 20 * joint.stiction_n / joint.stiffness_n_per_m
    steps = 2000
    motion = impose_motion(
        seated, np.full(steps, velocity), period_s=travel / abs(velocity) / steps
    )
    return float(motion.joint_force_n[-1])


def loss_of_contact() -> ReproducedFigure:
    """Figure 4: breakaway force against position, simulated and by equation (5)."""
    joint = _paper_joint()
    x = np.array([0.0, joint.engagement_length_m])
    end = joint.residual_n or 0.0
    starts = np.linspace(0.0, 0.099, 12)
    measured = np.array([_measured_breakaway_force(joint, start) for start in starts])
    drawing = house_figure(height=2.7)
    axes = drawing.subplots()
    axes.plot(
        x * 1e3, [joint.stiction_n, end], color=COLORS["ours"], label="stiction, equation (5)"
    )
    axes.plot(
        x * 1e3, [joint.coulomb_n, end], "--", color=COLORS["ours"], label="Coulomb, equation (6)"
    )
    axes.plot(
        starts * 1e3,
        measured,
        "o",
        markersize=4,
        markerfacecolor="none",
        color=COLORS["alternative"],
        label="simulated peak force of a slow pull",
    )
    axes.set(xlabel="position (mm)", ylabel="force (N)", xlim=(-2, 102), ylim=(0, None))
    axes.legend()
    worst = float(np.max(np.abs(measured / breakaway_force(joint, starts) - 1.0)))
    return ReproducedFigure(
        "figure_4",
        "Figure 4: loss of contact.",
        "As the part leaves its guide, the force that breaks it loose falls linearly to its "
        f"weight. A slow pull from each position peaks within {worst:.2%} of equation (5).",
        drawing,
        {"largest_relative_difference": worst},
    )


def _measured_breakaway_force(joint: Lugre, start_m: float) -> float:
    """Peak joint force while pulling at 10 um/s from a position."""
    motion = impose_motion(joint, np.full(6000, 1e-5), period_s=2e-3, start_m=start_m)
    return float(motion.joint_force_n.max())


def forces(runs: Runs, key: str, controls: Sequence[str]) -> ReproducedFigure:
    """Figures 7 and 8: applied and joint force at var = 5 %."""
    drawing = house_figure(height=2.9 * len(controls))
    panels = drawing.subplots(len(controls), squeeze=False)[:, 0]
    data: dict[str, object] = {}
    for axes, control in zip(panels, controls, strict=True):
        run = runs.disturbed[control]
        _draw_forces(axes, run)
        axes.set_title(_panel_title(control, run), loc="left")
        data[control] = {
            "outcome": str(run.outcome),
            "peak_force_n": run.metrics.peak_force_n,
            "iae_m_s": run.metrics.iae_m_s,
        }
    panels[-1].set_xlabel("time (s)")
    return ReproducedFigure(key, *_FORCE_WORDS[key], drawing, data)


_FORCE_WORDS = {
    "figure_7": (
        "Figure 7: forces without vibration, var = 5 %.",
        "The applied force hides behind the joint force once the part slides. The burst between "
        "0.03 and 0.12 s is the Stribeck-driven oscillation, which the paper does not mention.",
    ),
    "figure_8": (
        "Figure 8: forces with vibration, var = 5 %.",
        "One run of each. Read literally the loop diverges soon after breakaway. Bounded, it "
        "hammers: pulses exceed the breakaway force of 450 N and throw the part ahead of the "
        "reference; the commanded force then turns negative, the tip delivers none, and fewer "
        "pulses appear than are commanded. The paper shows a smooth force.",
    ),
}


def _draw_forces(axes: Axes, run: Run) -> None:
    t = run.trace["t_s"]
    axes.plot(t, run.trace["applied_force_n"], color=COLORS["ours"], lw=0.8, label="applied F")
    axes.plot(t, run.trace["joint_force_n"], color=COLORS["alternative"], lw=0.8, label="joint R")
    axes.set(ylabel="force (N)")
    axes.legend(loc="upper left" if run.outcome == "diverged" else "upper right")


def _panel_title(control: str, run: Run) -> str:
    if run.outcome == "diverged":
        return f"{NAMES[control]}: diverged at {run.metrics.simulated_s:.3f} s"
    return NAMES[control]


def displacement(runs: Runs) -> ReproducedFigure:
    """Figure 9: desired and measured displacement, and the error that the paper cannot show."""
    drawing = house_figure(height=4.6)
    top, bottom = drawing.subplots(2, sharex=True)
    reference = runs.disturbed["without_vibration"].trace
    top.plot(reference["t_s"], reference["reference_m"] * 1e3, "--", color="0.35", label="desired")
    data: dict[str, object] = {}
    for control, run in runs.disturbed.items():
        t, x = run.trace["t_s"], run.trace["position_m"]
        error = np.abs(run.trace["reference_m"] - x)
        top.plot(t, x * 1e3, color=CONTROL_COLORS[control], lw=1.1, label=NAMES[control])
        bottom.semilogy(t, np.maximum(error, 1e-10) * 1e3, color=CONTROL_COLORS[control], lw=0.8)
        data[control] = {"largest_error_m": run.metrics.largest_error_m}
    top.set(ylabel="position (mm)")
    top.legend(loc="upper left")
    bottom.set(xlabel="time (s)", ylabel="|error| (mm)", ylim=(1e-5, 1e2))
    return ReproducedFigure(
        "figure_9",
        "Figure 9: displacement, var = 5 %.",
        "One run of each. Above, without vibration the measured position lies on the desired one, "
        "as the paper shows; bounded, the part advances in steps of millimeters and flies on once "
        "it is free. Below, the error on a logarithmic scale distinguishes the controllers.",
        drawing,
        data,
    )


def iae_against_var(ranges: Mapping[str, DisturbanceRange]) -> ReproducedFigure:
    """Figure 10: IAE against var, median and 5 to 95 % band, and the share of failed runs."""
    data: dict[str, object] = {}
    table: list[Mapping[str, object]] = []
    for control, survey in ranges.items():
        rows = survey.rows()
        table += [{"control": control, **row} for row in rows]
        data[control] = {
            **{name: [row[name] for row in rows] for name in rows[0] if name != "runs"},
            "stable": survey.stable.tolist(),
            "runs": survey.runs,
            "largest_stable_var": survey.largest_stable_var,
        }
    return ReproducedFigure(
        "figure_10",
        "Figure 10: IAE against the disturbance.",
        _figure_10_caption(ranges),
        draw_figure_10(ranges),
        data,
        table,
    )


def _figure_10_caption(ranges: Mapping[str, DisturbanceRange]) -> str:
    plain, bounded = (ranges[name] for name in ("without_vibration", "with_vibration_bounded"))
    total = plain.runs * len(plain.var)
    return (
        f"Above, median and 5 to 95 % band of {plain.runs:,} runs at each of {len(plain.var)} "
        "levels, over those that did not diverge: "
        f"{plain.stable.sum():,} of {total:,} without vibration and {bounded.stable.sum():,} of "
        f"{total:,} of the bounded reading. Neither changes its course at a printed limit. "
        "Below, runs that had not released the part when the reference ended, diverged or not: "
        f"{total - plain.released.sum():,} without vibration, {total - bounded.released.sum():,} "
        f"of the bounded reading, at most {bounded.runs - bounded.released.min():,} of "
        f"{bounded.runs:,} at one level. With vibration read literally there is no IAE to draw: "
        f"{total - ranges['with_vibration'].stable.sum():,} of {total:,} runs diverged, those "
        "without any disturbance among them. Bounded, the loop is chaotic: only distributions "
        "over many runs mean something."
    )
