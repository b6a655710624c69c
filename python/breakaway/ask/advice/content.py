"""What the report of an advice says: texts and rows, and its figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from breakaway._core import __version__
from breakaway.ask.advice.parts import at_rig
from breakaway.ask.advice.ranking import CONFIDENCE, Ranked
from breakaway.ask.advice.result import Advice
from breakaway.ask.advice.trying import FIRST_JUDGED
from breakaway.ask.advice.wanted import ENOUGH
from breakaway.ask.advice.worth import SHOWN
from breakaway.ask.studies.statistics import clopper_pearson
from breakaway.model.units import unit_of
from breakaway.run.trials import run_trial
from breakaway.show.plots.advice import WayShares, plot_course, plot_loads, plot_spared

HEADINGS = (
    "unharmed",
    "freed",
    "peak / allowed",
    "peak",
    "jump",
    "speed at release",
    "time",
)
"""Columns of the table of ways; all but the last are of the law where a way does worst."""
SHOWN_GAIN = 5e-4
"""Gain of a measurement below which the table leaves it out."""
CAPTIONS = {
    "spared": "Parts that come out within all limits, by way and friction law.",
    "loads": "How hard each way pulls, part by part, under the law where it does worst.",
    "course": "One part in motion, in the recommended way: the middle one by its breakaway force.",
}
WAYS_NOTE = (
    "Unharmed with its 95 % interval, under the law where the way does worst. Peaks, jumps and "
    "speeds are those that one part in twenty exceeds; the time is that of the middle part."
)


def content_of(advice: Advice, command: str, made_of: Sequence[str]) -> dict[str, Any]:
    """Give all that the report says, as plain values."""
    best, rig = advice.best, advice.bounds.rig
    return {
        "version": __version__,
        "title": f"How to get {advice.parts.name} out",
        "question": (
            f"How do I get this part out with {rig.name.replace('_', ' ')}, set to what, and what "
            "will it do to the part?"
        ),
        "is_enough": best.unharmed >= ENOUGH,
        "sentences": list(advice.sentences),
        "log": list(advice.parts.provenance),
        "quantities": _quantities(advice),
        "rig": f"{rig.description} It bears {rig.force_max_n:.4g} N and reaches "
        f"{1e3 * rig.stroke_m:.4g} mm. It reads {' and '.join(rig.reads) or 'nothing'}.",
        "headings": list(HEADINGS),
        "ways": [_way(row) for row in advice.ranking],
        "ways_note": WAYS_NOTE,
        "figures": [{"name": name, "caption": text} for name, text in CAPTIONS.items()],
        "worths": [
            {
                "words": one.words,
                "gain": f"{100 * one.gain:.1f}",
                "noise": f"± {100 * one.noise:.1f}",
            }
            for one in advice.worths
            if one.gain >= SHOWN_GAIN
        ],
        "wanted": [
            f"{one.change}, by {one.way}: {100 * one.unharmed:.3g} % of {one.parts} parts unharmed"
            for one in advice.wanted
        ],
        "rests_on": list(advice.rests_on),
        "not_judged": [
            {"name": one.name, "what": one.what, "why": one.why} for one in advice.not_judged
        ],
        "sources": list(rig.sources) or ["no source is stated for its figures"],
        "command": command,
        "made_of": list(made_of),
    }


def figures_of(advice: Advice) -> Mapping[str, Figure]:
    """Draw the figures of the report."""
    outcomes, tried = advice.tried.outcomes, advice.tried
    spared = [
        WayShares(
            row.way,
            {
                law: (float(mask.mean()), *clopper_pearson(int(mask.sum()), len(mask), CONFIDENCE))
                for law, found in outcomes.items()
                for mask in [found[row.way].unharmed]
            },
        )
        for row in advice.ranking
    ]
    loads = {row.way: outcomes[row.law][row.way].load for row in advice.ranking}
    middle = int(np.argsort(tried.quantities["stiction_n"], kind="stable")[tried.parts // 2])
    return {
        "spared": plot_spared(spared),
        "loads": plot_loads(loads),
        "course": _course(advice, middle),
    }


def _course(advice: Advice, middle: int) -> Figure:
    """Draw one part under the law where the recommended way does worst."""
    bounds = advice.bounds
    part = FIRST_JUDGED + middle
    trial = run_trial(
        at_rig(advice.parts.population, bounds.rig),
        advice.method,
        law=advice.best.law,
        runs=range(part, part + 1),
        seed=advice.seed,
        threads=1,
    )
    trace = trial.replay(0, trace_every=_every(bounds.rig.control_period_s)).trace
    limits = bounds.limits
    if limits is not None:
        allowed = limits.force_max_n if limits.stresses else None
    else:
        peak, over = (trial.metrics[n][0] for n in ("peak_force_n", "peak_over_breakaway"))
        allowed = float(bounds.gentle.peak_over_breakaway_max * peak / over)
    return plot_course(trace["t_s"], trace["position_m"], trace["applied_force_n"], allowed)


def _every(control_period_s: float) -> int:
    """Give every how many samples a row is drawn: 2,000 rows a second show impacts."""
    return max(1, round(5e-4 / control_period_s))


def _quantities(advice: Advice) -> list[dict[str, Any]]:
    """Give the quantities of the parts that were judged."""
    rows = []
    for name, words in SHOWN.items():
        low, middle, high = np.quantile(advice.tried.quantities[name], [0.05, 0.5, 0.95])
        told = name in advice.parts.told
        rows.append(
            {
                "words": words,
                "median": _figure(name, float(middle)),
                "range": f"{_figure(name, float(low))} to {_figure(name, float(high))}",
                "told": told,
            }
        )
    return rows


def _figure(name: str, value: float) -> str:
    unit = unit_of(name)
    power = unit.power_of(abs(value)) if value else 0
    symbol = unit.prefixed(power)
    return f"{value * 10.0**-power:.3g} {symbol}".rstrip()


def _way(row: Ranked) -> dict[str, Any]:
    velocity, time_s = row.velocity_high_m_per_s, row.time_median_s
    return {
        "way": row.way.replace("_", " "),
        "setting": row.setting,
        "words": row.words,
        "cells": [
            f"{100 * row.unharmed:.3g} % ({100 * row.low:.0f} to {100 * row.high:.0f})",
            f"{100 * row.freed:.3g} %",
            f"{row.load_high:.2f}",
            _figure("peak_force_n", row.peak_high_n),
            _figure("jump_m", row.jump_high_m),
            "–" if velocity is None else _figure("release_velocity_m_per_s", velocity),
            "–" if time_s is None else f"{time_s:.2f} s",
        ],
    }
