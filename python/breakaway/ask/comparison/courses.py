"""How single parts came out: the middle and the worst one of each method, with the worst slip."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.comparison.table import Trials, median_row, worst_row
from breakaway.model.friction.curve import breakaway_force
from breakaway.run.field import friction_field
from breakaway.run.finished import Run
from breakaway.run.trials import Case, Trial
from breakaway.show.plots.comparison import Course

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

WHOLE_ROWS = 700
"""Rows, about, that are kept of a whole course."""
SLIP_ROWS = 500
"""Rows, about, that are kept of a slip."""
PAD_SHARE, PAD_MIN_S = 0.6, 2e-3
"""What is shown before and after a slip: a share of its duration, and at least so long."""

LOOSE_SHARE = 0.02
"""Share of its largest speed at which a slip is shown to begin."""


@dataclass(frozen=True)
class Courses:
    """The courses of two parts of a trial."""

    median: Course | None
    """The part in the middle by its jump, of those that came free; None if none did."""
    worst: Course
    """The part with the largest jump."""


def courses_of(trials: Trials) -> dict[Case, dict[str, Courses]]:
    """Simulate two parts of each method again in each case, with their traces."""
    return {
        case: {name: _courses(trial) for name, trial in by_method.items()}
        for case, by_method in trials.items()
    }


def _courses(trial: Trial) -> Courses:
    median = median_row(trial)
    return Courses(
        median=None if median is None else course_of(trial, median),
        worst=course_of(trial, worst_row(trial)),
    )


def course_of(trial: Trial, row: int) -> Course:
    """Simulate a part again and keep what a drawing needs: its extremes, and its worst slip."""
    run = trial.replay(row, trace_every=1)
    start, end = _loose(run, *worst_slip(run))
    t_s = run.trace["t_s"]
    pad_s = max(PAD_SHARE * (t_s[end] - t_s[start]), PAD_MIN_S)
    first, last = np.searchsorted(t_s, [t_s[start] - pad_s, t_s[end] + pad_s])
    inside = np.arange(first, min(int(last) + 1, len(t_s)))
    quantities = {name: float(values[row]) for name, values in trial.parts.items()}
    return Course(
        run_index=trial.runs[row],
        released=bool(trial.released[row]),
        stiction_n=run.scenario.joint.stiction_n,
        length_m=quantities["engagement_length_m"],
        mass_kg=quantities["mass_kg"],
        jump_m=run.metrics.largest_jump_m,
        peak_force_n=run.metrics.peak_force_n,
        peak_over_breakaway=run.metrics.peak_over_breakaway,
        end_s=float(t_s[-1]),
        slip_s=(float(t_s[start]), float(t_s[end])),
        whole=_columns(run, kept_rows(run.trace["applied_force_n"], WHOLE_ROWS)),
        slip=_columns(run, inside[kept_rows(run.trace["applied_force_n"][inside], SLIP_ROWS)]),
    )


def kept_rows(values: Array, count: int) -> Rows:
    """Choose rows that keep the lowest and the highest value of each stretch, and both ends."""
    if len(values) <= count:
        return np.arange(len(values))
    edges = np.linspace(0, len(values), count // 2 + 1).astype(int)
    kept = {0, len(values) - 1}
    for start, end in pairwise(edges):
        stretch = values[start:end]
        kept |= {start + int(np.argmin(stretch)), start + int(np.argmax(stretch))}
    return np.array(sorted(kept))


def _loose(run: Run, start: int, end: int) -> tuple[int, int]:
    """Leave out what comes before a slip proper: bristles that stretch also let the part creep."""
    steps = np.diff(run.trace["position_m"][start : end + 1])
    return start + int(np.argmax(steps >= LOOSE_SHARE * steps.max())), end


def worst_slip(run: Run) -> tuple[int, int]:
    """Find the first and last row of the slip whose travel above the commanded speed is largest.

    A trace has no commanded speed. It is that of the reference, or that of the feed, or none; the
    one is taken whose largest jump is nearest to that of the metrics.
    """
    t_s, x = run.trace["t_s"], run.trace["position_m"]
    tolerance = run.scenario.limits.release_tolerance_m
    free_m = run.scenario.joint.engagement_length_m - tolerance
    travel = np.where(x[:-1] < free_m, np.diff(x), 0.0)
    controller = run.scenario.controller
    feed = float(getattr(getattr(controller, "feed", controller), "speed_m_per_s", 0.0))
    commanded = (np.diff(run.trace["reference_m"]), feed * np.diff(t_s), 0.0 * travel)
    found = [_largest_stretch(travel - np.maximum(step, 0.0)) for step in commanded]
    jump = run.metrics.largest_jump_m
    _, start, end = min(found, key=lambda slip: abs(slip[0] - jump))
    return start, end


def _largest_stretch(excess: Array) -> tuple[float, int, int]:
    """Give the largest sum over a stretch without a sign change, and its first and last row."""
    above = np.concatenate([[False], excess > 0.0, [False]])
    edges = np.flatnonzero(np.diff(above.astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return 0.0, 0, min(1, len(excess))
    summed = np.concatenate([[0.0], np.cumsum(excess)])
    sums = summed[ends] - summed[starts]
    best = int(np.argmax(sums))
    return float(sums[best]), int(starts[best]), int(ends[best])


def _columns(run: Run, rows: Rows) -> dict[str, Array]:
    """Give time, position, force, the force that would break the joint loose there, and the axis.

    A tool without a stack is the tip, and is not told twice.
    """
    x = run.trace["position_m"][rows]
    axis = [name for name in ("feed_m", "tool_m", "tip_m") if name in run.trace]
    if axis and np.array_equal(run.trace["tool_m"], run.trace["tip_m"]):
        axis.remove("tool_m")
    return {
        "t_s": run.trace["t_s"][rows],
        "position_m": x,
        "force_n": run.trace["applied_force_n"][rows],
        "breakaway_n": _breakaway_n(run, x),
        **{name: run.trace[name][rows] for name in axis},
    }


def _breakaway_n(run: Run, x: Array) -> Array:
    """Give the force that breaks the joint loose at each place: what varies along the way, too.

    What is redrawn in time is left out.
    """
    force_n = breakaway_force(run.scenario.joint, x)
    if run.scenario.disturbance.kind != "field":
        return force_n
    return force_n * friction_field(run.scenario, x, run_index=run.run_index).factor
