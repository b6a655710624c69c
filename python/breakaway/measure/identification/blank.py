"""What pulls without a joint tell of a rig: against a part that is held, or with no part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine
from breakaway.errors import LogError
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.rig_intervals import QUANTILE
from breakaway.measure.identification.uncertainty import covariance
from breakaway.measure.logs.derived import LOWPASS_ORDER, derive_motion, noise_floor
from breakaway.measure.logs.log import Array, Log

LOADED = 0.1
"""A held part is loaded from this share of the range of the force; below, a rig may have play."""

HELD = 0.95
"""Correlation of force and position from which a part is held."""

LOOSE = 0.7
"""Correlation from which the part is neither held nor absent; inertia alone makes it negative."""

TOLD = 3.0
"""A figure is told if it exceeds this many standard errors."""

CLEAR = 20.0
"""The force of a pull against a held part exceeds its noise by this factor."""

FEWEST_ROWS = 20

BENDS = 0.05
"""Share by which the stiffness under low and high load may differ."""


@dataclass(frozen=True)
class BlankFigure:
    """A figure of the rig with its standard error and 95 % interval."""

    name: str
    value: float
    standard_error: float
    low: float
    high: float


@dataclass(frozen=True)
class Blank(OneLine):
    """What blank pulls tell: the rig file, its figures with intervals, and what stays open."""

    rig: RigFile
    figures: tuple[BlankFigure, ...]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        told = ", ".join(one.name for one in self.figures) or "nothing"
        return f"<blank pull: tells {told}>"


def rig_from_blank(logs: Sequence[Log]) -> Blank:
    """Derive a rig file from blank pulls: against a part that is held, or without a part.

    ::

        held part    x = x_0 + F / k_rig                      while F is above a tenth of its range
        no part      F = m_rig a + d v + f sign(v) + F_0      both sides behind one low-pass

    Which of the two a log is follows from itself: a spring explains the motion of a held part.
    Standard errors allow for correlated residuals (Newey and West, 1987).

    Parameters
    ----------
    logs : sequence of Log
        One pull of either kind, or both.

    Returns
    -------
    Blank
        Figures that a log does not tell are not in the rig file, and ``notes`` say why.

    Raises
    ------
    LogError
        There is no log, two are of one kind, or a log fits neither kind.

    Notes
    -----
    Not told by any blank pull: the filter, the uncertainty of the load cell's calibration and where
    the position is measured. Write them into the file by hand.

    Not checked: that the part is held by something much stiffer than the rig.

    Examples
    --------
    >>> t_s = np.arange(2000) / 1000.0
    >>> load = 500.0 * t_s
    >>> noise = np.random.default_rng(0).standard_normal((2, 2000))
    >>> held = Log(
    ...     t_s=t_s, position_m=load / 3e6 + 1e-7 * noise[0], force_n=load + 0.5 * noise[1]
    ... )
    >>> blank = rig_from_blank([held])
    >>> (figure,) = blank.figures
    >>> figure.name, bool(figure.low < 3e6 < figure.high), round(figure.value / 3e6, 3)
    ('stiffness_n_per_m', True, 1.0)

    """
    check_arguments(rig_from_blank, locals(), LogError)
    if not logs:
        raise LogError("logs: none is given; give a pull against a held part, or without a part")
    kinds = [_is_held(log) for log in logs]
    if len(set(kinds)) < len(kinds):
        what = "against a held part" if kinds[0] else "without a part"
        raise LogError(f"logs: two are pulls {what}; give one of each kind at most")
    found = [_held(log) if held else _free(log) for log, held in zip(logs, kinds, strict=True)]
    figures = tuple(figure for some, _ in found for figure in some)
    notes = [note for _, some in found for note in some]
    named = {one.name: one for one in figures}
    stiffness, mass = named.get("stiffness_n_per_m"), named.get("mass_kg")
    rig = RigFile(
        stiffness_n_per_m=stiffness.value if stiffness else None,
        stiffness_error_n_per_m=stiffness.standard_error if stiffness else 0.0,
        mass_kg=mass.value if mass else 0.0,
        mass_error_kg=mass.standard_error if mass else 0.0,
        notes=notes,
    )
    return Blank(rig, figures, tuple(notes))


def _is_held(log: Log) -> bool:
    """Whether the part of a pull was held: the force is large, and a spring explains the motion."""
    force, position = log.force_n, log.position_m
    noise = noise_floor(log, "force_n")
    if np.ptp(force) < CLEAR * max(noise.white, noise.quantization):
        return False
    still = noise_floor(log, "position_m")
    if np.ptp(position) < CLEAR * max(still.white, still.quantization):
        return True
    together = float(np.corrcoef(force, position)[0, 1])
    if LOOSE < together < HELD:
        raise LogError(
            f"{log.name}: force and position correlate by {together:.2g}, more than without a part "
            f"(at most {LOOSE:g}) and less than of a held part (at least {HELD:g}): hold the part "
            "so that it does not slip, or take it out"
        )
    return together >= HELD


def _held(log: Log) -> tuple[list[BlankFigure], list[str]]:
    """Return the stiffness of the rig from a pull against a part that is held."""
    force = log.force_n
    rows = np.flatnonzero(np.abs(force - force[0]) > LOADED * np.ptp(force))
    _check_rows(log, rows.size, "in which the force is above a tenth of its range")
    compliance, error = _slope(force[rows], log.position_m[rows])
    notes = [f"{log.name}: a pull against a held part, up to {np.abs(force).max():.4g} N"]
    if not compliance > TOLD * error:
        stiffest = compliance + QUANTILE * error
        least = f"at least {1.0 / stiffest:.3g} N/m" if stiffest > 0.0 else "not told"
        notes.append(
            f"{log.name}: the position hardly follows the force; the stiffness is {least}, or the "
            "position is measured at the part: then write position_sensor = 'part'"
        )
        return [], notes
    bend = _bend(force[rows], log.position_m[rows])
    if abs(bend) > BENDS * compliance:
        stiffer = "falls" if bend > 0.0 else "grows"
        notes.append(
            f"{log.name}: the stiffness {stiffer} with the load, by "
            f"{100 * abs(bend) / compliance:.0f} % between the lower and the upper half; the error "
            "allows for it"
        )
        error = math.hypot(error, 0.5 * abs(bend))
    low, high = compliance - QUANTILE * error, compliance + QUANTILE * error
    upper = 1.0 / low if low > 0.0 else math.inf
    stiffness = 1.0 / compliance
    figure = BlankFigure("stiffness_n_per_m", stiffness, stiffness**2 * error, 1.0 / high, upper)
    return [figure], [*notes, *_play(log, compliance, rows)]


def _slope(force: Array, position: Array) -> tuple[float, float]:
    """Return dx/dF of a line and its standard error, in m/N."""
    columns = np.column_stack([force - force.mean(), np.ones_like(force)])
    found = np.linalg.lstsq(columns, position, rcond=None)[0]
    known = covariance(position - columns @ found, columns)
    return float(found[0]), math.sqrt(float(known.matrix[0, 0]))


def _bend(force: Array, position: Array) -> float:
    """Return by how much dx/dF above the middle of the load exceeds that below, in m/N."""
    middle = 0.5 * (force.min() + force.max())
    halves = [force <= middle, force > middle]
    if min(np.count_nonzero(half) for half in halves) < FEWEST_ROWS:
        return 0.0
    (low, low_error), (high, high_error) = (_slope(force[h], position[h]) for h in halves)
    significant = abs(high - low) > TOLD * math.hypot(low_error, high_error)
    return high - low if significant else 0.0


def _play(log: Log, compliance: float, rows: npt.NDArray[np.intp]) -> list[str]:
    """Say how far the rig moves before it is loaded, where that shows."""
    loaded = log.position_m[rows] - compliance * log.force_n[rows]
    before = log.position_m[0] - compliance * log.force_n[0]
    way = abs(float(np.median(loaded)) - float(before))
    floor = noise_floor(log, "position_m")
    if way < TOLD * max(floor.white, floor.quantization) or way < 0.05 * compliance * np.ptp(
        log.force_n
    ):
        return []
    return [f"{log.name}: the rig moves {way:.2g} m before it takes load, as with play"]


def _free(log: Log) -> tuple[list[BlankFigure], list[str]]:
    """Return the mass behind the load cell from a pull without a part."""
    motion = derive_motion(log)
    low = signal.butter(LOWPASS_ORDER, motion.lowpass_hz, fs=log.sample_rate_hz, output="sos")
    v, a = motion.velocity_m_per_s, motion.acceleration_m_per_s2
    sign, force = (signal.sosfiltfilt(low, column) for column in (np.sign(v), log.force_n))
    edge = math.ceil(log.sample_rate_hz / motion.lowpass_hz)  # there the low-pass rings
    inside = slice(edge, log.rows - edge)
    _check_rows(log, log.rows - 2 * edge, "without those in which the low-pass rings")
    columns = [column[inside] for column in (a, v, sign)]
    matrix = np.column_stack([c for c in columns if np.ptp(c) > 0.0] + [np.ones(len(a[inside]))])
    found = np.linalg.lstsq(matrix, force[inside], rcond=None)[0]
    known = covariance(force[inside] - matrix @ found, matrix)
    notes = [f"{log.name}: a pull without a part; the rig's own friction stays in other logs"]
    mass, error = float(found[0]), math.sqrt(float(known.matrix[0, 0]))
    if not mass > TOLD * error:
        notes.append(
            f"{log.name}: mass_kg {mass:.3g} ± {error:.2g} is not distinct from 0; accelerate "
            "harder"
        )
        return [], notes
    ends = mass - QUANTILE * error, mass + QUANTILE * error
    return [BlankFigure("mass_kg", mass, error, *ends)], notes


def _check_rows(log: Log, count: int, which: str) -> None:
    if count < FEWEST_ROWS:
        raise LogError(
            f"{log.name}: {count} rows {which}; at least {FEWEST_ROWS} are needed: record for "
            "longer"
        )
