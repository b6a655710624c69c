"""What is odd about a log: its time stamps, and the values of its channels.

Findings state facts; they repair nothing. `Log.findings` lists them. The rules:

=================  ===============================================================================
kind               rule
=================  ===============================================================================
repeated_stamps    a stamp equals that of the sample before
unordered_stamps   a stamp is earlier than that of the sample before
gap                a step exceeds 2.5 median steps: at least two samples are missing
jitter             a step, no gap, deviates by more than 1 % from the median step
constant           all values are equal
quantization       the values are multiples of a step, see `quantum`
unit               the mapping's unit is not the one that the file states
cut_off            the recording ends within a piece that was not finished
invalid            samples that the file marks as invalid, or messages that cannot be read, are
                   left out
unset_start        a start of a recording that was never set, 1904, is ignored
blank              blank lines are left out
slower             a column has a value in every so many-th row only
ends               a column has no values from some row on
no_header          a table has no header, and its columns are named by number
footer             rows at the end that are none of the table, such as statistics, are left out
dropped            bad rows are left out because that was asked for
saturation         at least 5 samples in a row equal the largest or smallest value, and steps of
                   more than 2 quanta lead there and away
=================  ===============================================================================

A turning point is not saturation: at constant acceleration it stays for n samples on its last
level and came there at less than 2/n levels per sample, so after 5 equal samples by a step of one
level. A part that slows down to a rest at the end of its travel is not saturated either. What is
commanded (``reference_m``) and channels of fewer than 10 levels are not searched for saturation.
A clipped signal that creeps into its limit by at most 2 quanta per sample is missed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from breakaway.measure.logs.channel import Array, Channel

Kind = Literal[
    "gap",
    "jitter",
    "repeated_stamps",
    "unordered_stamps",
    "saturation",
    "quantization",
    "constant",
    "unit",
    "cut_off",
    "invalid",
    "unset_start",
    "blank",
    "slower",
    "ends",
    "no_header",
    "footer",
    "dropped",
]

GAP = 2.5
"""A step of more than this many median steps is a gap."""

JITTER = 0.01
"""A step that deviates by more than this share of the median step is uneven."""

SATURATED_ROWS = 5
SATURATED_LEVELS = 10
SATURATION_STEP = 2.0
"""Saturation: samples in a row, levels of the channel, quanta of the steps there and away."""

QUANTUM_GAPS = 50.0
QUANTUM_DEVIATION = 0.15
QUANTUM_SHARE = 0.9
QUANTUM_SHOWN = 0.5
"""See `quantum`."""


@dataclass(frozen=True)
class Finding:
    """One odd thing about a log.

    Parameters
    ----------
    kind : str
        One of the kinds in the table of `breakaway.measure.logs.findings`.
    channel : str
        The channel, or ``t_s`` for stamps that all channels share; its name in the file where it is
        about the file, empty for the file as a whole.
    first_t_s : float
        Stamp of the first sample concerned; of a gap, the last sample before it; 0 for the file.
    count : int
        How many gaps, steps, stamps or samples; of a quantization, how many levels.
    message : str
        All this in words, which `str` gives.

    """

    kind: Kind
    channel: str
    first_t_s: float
    count: int
    message: str

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def find(channels: Iterable[Channel]) -> tuple[Finding, ...]:
    """Return the findings of all channels; stamps that channels share count once."""
    bases: dict[int, list[Channel]] = {}
    every = list(channels)
    for channel in every:
        bases.setdefault(id(channel.t_s), []).append(channel)
    found: list[Finding] = []
    for group in bases.values():
        name = "t_s" if len(bases) == 1 else f"t_s of {', '.join(c.name for c in group)}"
        found += _about_stamps(name, group[0].t_s)
    for channel in every:
        found += _about_values(channel)
    return tuple(found)


def gaps(t_s: Array) -> npt.NDArray[np.intp]:
    """Return the places of the samples after which there is a gap."""
    steps = np.diff(t_s)
    return np.flatnonzero(steps > GAP * _median_step(steps))


def _median_step(steps: Array) -> float:
    forward = steps[steps > 0.0]
    return float(np.median(forward)) if forward.size else float("inf")


def _about_stamps(name: str, t_s: Array) -> list[Finding]:
    steps = np.diff(t_s)
    median = _median_step(steps)
    found = []
    rows = np.flatnonzero(steps == 0.0)
    if rows.size:
        text = f"{name}: {rows.size} stamps repeat the one before, first row {rows[0] + 2}"
        found.append(Finding("repeated_stamps", name, float(t_s[rows[0]]), rows.size, text))
    rows = np.flatnonzero(steps < 0.0)
    if rows.size:
        text = (
            f"{name}: {rows.size} stamps go back, first row {rows[0] + 2}, from "
            f"{t_s[rows[0]]:.9g} s to {t_s[rows[0] + 1]:.9g} s"
        )
        found.append(Finding("unordered_stamps", name, float(t_s[rows[0]]), rows.size, text))
    rows = gaps(t_s)
    if rows.size:
        text = (
            f"{name}: {_count(rows.size, 'gap')} of up to {steps[rows].max():.4g} s, first after "
            f"{t_s[rows[0]]:.9g} s; the median step is {median:.4g} s"
        )
        found.append(Finding("gap", name, float(t_s[rows[0]]), rows.size, text))
    uneven = (np.abs(steps - median) > JITTER * median) & (steps > 0.0) & (steps <= GAP * median)
    rows = np.flatnonzero(uneven)
    if rows.size:
        text = (
            f"{name}: {_count(rows.size, 'uneven step')} of {steps[rows].min():.4g} to "
            f"{steps[rows].max():.4g} s, first after {t_s[rows[0]]:.9g} s; the median step is "
            f"{median:.4g} s"
        )
        found.append(Finding("jitter", name, float(t_s[rows[0]]), rows.size, text))
    return found


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _about_values(channel: Channel) -> list[Finding]:
    name, values, start = channel.name, channel.values, float(channel.t_s[0])
    levels = np.unique(values)
    if len(levels) == 1:
        text = f"{name}: all {len(values)} values are {values[0]:.6g}"
        return [Finding("constant", name, start, len(values), text)]
    found = []
    step = quantum(levels)
    if step is not None:
        text = f"{name}: quantized in steps of {step:.4g}, {len(levels)} levels occur"
        found.append(Finding("quantization", name, start, len(levels), text))
    if name != "reference_m" and len(levels) >= SATURATED_LEVELS:
        found += _saturation(channel, (levels[0], levels[-1]), step or 0.0)
    return found


def quantum(values: Array) -> float | None:
    """Return the step of which all values are multiples (but for an offset), or None.

    The smallest gap between neighboring levels is refined over ever larger gaps. It counts if
    at least half of the gaps are below 50 steps, of which at least 90 % are within 0.15 steps of
    a whole number of steps; so levels that were rounded once more are recognized.

    Parameters
    ----------
    values : array
        The values of a channel, or its levels.

    Notes
    -----
    A quantum that the signal seldom shows, because it changes faster, is not resolved.

    Examples
    --------
    >>> quantum(np.round(np.sin(np.arange(500.0)), 2))
    0.01

    """
    levels = np.unique(values)
    between = np.sort(np.diff(levels))
    # What rounding in a conversion of units leaves is no gap.
    between = between[between > 1e-10 * np.abs(levels).max()]
    if between.size < 5:
        return None
    step = float(between[0])
    for most in (1.5, 2.5, 5.5, 10.5, QUANTUM_GAPS):
        small = between[between < most * step]
        counts = np.round(small / step)
        step = float(small @ counts / (counts @ counts))
    small = between[between < QUANTUM_GAPS * step]
    off = np.abs(small / step - np.round(small / step))
    if small.size < QUANTUM_SHOWN * between.size:
        return None
    if np.mean(off <= QUANTUM_DEVIATION) < QUANTUM_SHARE:
        return None
    return float(f"{step:.12g}")


def _saturation(channel: Channel, extremes: Sequence[float], step: float) -> list[Finding]:
    found = []
    for value, word in zip(extremes, ("smallest", "largest"), strict=True):
        runs = [run for run in _runs(channel.values == value) if _is_cut(channel.values, run, step)]
        if runs:
            rows = sum(end - begin for begin, end in runs)
            first = float(channel.t_s[runs[0][0]])
            text = (
                f"{channel.name}: {rows} samples stand at the {word} value {value:.6g} as if cut "
                f"off, {_count(len(runs), 'time')}, first at {first:.9g} s"
            )
            found.append(Finding("saturation", channel.name, first, rows, text))
    return found


def _runs(mask: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return begin and end of the long runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    pairs = edges.reshape(-1, 2)
    return [(int(a), int(b)) for a, b in pairs if b - a >= SATURATED_ROWS]


def _is_cut(values: Array, run: tuple[int, int], step: float) -> bool:
    """Whether steps of more than 2 quanta lead to a run of equal values, and away from it."""
    begin, end = run
    sides = [values[k] for k in (begin - 1, end) if 0 <= k < len(values)]
    return all(abs(side - values[begin]) > SATURATION_STEP * step for side in sides)
