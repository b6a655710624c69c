"""Which parameters a log can determine, which it cannot, and what experiment would."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from breakaway.measure.identification.guess import MOVING
from breakaway.measure.identification.laws import Law
from breakaway.measure.identification.record import MotionKind, Rows, RunSettings
from breakaway.measure.identification.stretches import find_stretches
from breakaway.measure.identification.turns import (
    STILL,
    broke_away,
    find_turns,
    stick_slip,
)
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array

Places = NDArray[np.integer[Any]]
"""Numbers of rows."""

SPEED_RATIO = 3.0
"""Speeds must differ by this factor before what depends on speed shows."""

AT_ONE_SPEED = "the level at"
"""What is said of a sliding level where the law may have another at other speeds."""

SLIDING_SHARE = 0.02
"""Least share of the moving rows that makes a band of speed count."""

PRESLIDING_QUANTA = 5.0
"""A presliding deflection must exceed the noise of the position by this factor."""

OUTLYING = 7
"""Rows of a median of the force: up to three that stand out do not say how a joint slides."""

MEDIAN_NOISE = math.sqrt(0.5 * math.pi / OUTLYING)
"""White noise of that median, as a share of the noise of one row."""

NO_PEAK = 1.02
"""F_s / F_c whose interval ends below this is no stiction peak."""


@dataclass(frozen=True)
class Estimate:
    """One parameter: its value, standard error and 95 % interval.

    ``standard_error`` is that of the value; the interval of a positive parameter is that of its
    logarithm, so it is not symmetric. ``identifiable`` is whether the log tells it.
    """

    name: str
    value: float
    standard_error: float
    low: float
    high: float
    identifiable: bool
    remark: str = ""


@dataclass(frozen=True)
class Excitation:
    """What a log excites.

    Parameters
    ----------
    slow_speed_m_per_s, fast_speed_m_per_s : float
        5 % and 95 % quantiles of the speed where the part slides, its bristles loaded.
    reversals : int
        Changes of direction.
    rests : int
        Rests that end in motion, as `breakaway.find_breakaway_events` finds them.
    presliding_m, noise_m : float
        Deflection of the joint before it slides, as far as the force and the motion show it, and
        the noise of the position.
    both_directions : bool
        Whether at least 2 % of the moving rows go either way, and the part slides both ways.
    direction : int
        1 or -1 where nearly all rows that move go one way, else 0.
    broke_away : bool
        Whether the force levels off anywhere: below breakaway it goes on rising with the way.
    held_n : float
        Half the range of the force; a joint that never broke away held at least that.
    resting_n : float
        Smallest force in the direction of motion while the part stands still, infinite if it never
        does.
    slips, slip_rows : int
        Slips of a part that sticks in between, and the median rows of one; 0 without stick-slip.

    """

    slow_speed_m_per_s: float
    fast_speed_m_per_s: float
    reversals: int
    rests: int
    presliding_m: float
    noise_m: float
    both_directions: bool
    direction: int
    broke_away: bool
    held_n: float
    resting_n: float
    slips: int
    slip_rows: int

    def __str__(self) -> str:
        never = "" if self.broke_away else f", never broke away under {self.held_n:.3g} N"
        return (
            f"excited: {self.slow_speed_m_per_s:.3g} to {self.fast_speed_m_per_s:.3g} m/s, "
            f"{self.reversals} reversals, {self.rests} rests that end in motion, presliding of "
            f"{self.presliding_m:.2g} m against {self.noise_m:.2g} m of noise{never}"
        )

    @property
    def speed_ratio(self) -> float:
        """Fast over slow speed."""
        return self.fast_speed_m_per_s / max(self.slow_speed_m_per_s, 1e-300)

    @property
    def level_is_of(self) -> str:
        """Say of which speed a sliding level is, where the log has nearly one; else empty."""
        if self.speed_ratio >= SPEED_RATIO:
            return ""
        return f"{AT_ONE_SPEED} {self.fast_speed_m_per_s:.3g} m/s, nearly the only speed"


@dataclass(frozen=True)
class Verdict:
    """Whether a log determines one parameter, why, and which experiment would."""

    parameter: str
    identifiable: bool
    because: str
    remedy: str = ""


def excitation(rows: Rows, places: Places, mass_kg: float = 0.0) -> Excitation:
    """Measure what a log excites, in the rows at ``places``.

    Whether the joint slides is judged by the force without the inertia of ``mass_kg``.
    """
    x, v, force = *rows.columns[:2, places], rows.driving_force_n[places]
    noise = noise_floor(rows.log, "position_m")
    noise_m = max(noise.white, noise.quantization)
    speed = np.abs(v)
    top = float(np.quantile(speed, 0.99))
    moving = speed > MOVING * top
    sign = np.sign(v[moving])
    force_noise = noise_floor(rows.log, "force_n")
    noise_n = MEDIAN_NOISE * max(force_noise.white, force_noise.quantization)
    friction = median_filter(force - mass_kg * rows.columns[2, places], OUTLYING, mode="nearest")
    turns = find_turns(x, v)
    slides = broke_away(turns, friction, noise_m, noise_n)
    both = bool(min(np.mean(sign > 0), np.mean(sign < 0)) > SLIDING_SHARE)
    both = both and (slides is None or slides[0] == slides[1])
    direction = 0 if both else int(np.sign(np.median(sign)))
    slips, slip_rows = stick_slip(x, v, force)
    presliding_m = _presliding(x, v, force, top)
    sliding = moving & (turns.since_m > (presliding_m or _loading(x, v, force, top)))
    counted = sliding if np.sum(sliding) > 0.5 * np.sum(moving) else moving
    slow, fast = (float(q) for q in np.quantile(speed[counted], [0.05, 0.95]))
    still = speed < STILL * top
    return Excitation(
        slow_speed_m_per_s=slow,
        fast_speed_m_per_s=fast,
        reversals=int(np.count_nonzero(np.diff(sign))),
        rests=_rests(rows, places),
        presliding_m=presliding_m,
        noise_m=noise_m,
        both_directions=both,
        direction=direction,
        broke_away=slides is None or any(slides),
        held_n=0.5 * float(np.ptp(np.quantile(force, [0.001, 0.999]))),
        resting_n=float(np.min(direction * force[still])) if still.any() else math.inf,
        slips=slips,
        slip_rows=slip_rows,
    )


def _rests(rows: Rows, places: Places) -> int:
    starts = [motion.first for motion in find_stretches(rows.log).starts()]
    return int(np.count_nonzero(np.isin(starts, places)))


def _presliding(x: Array, v: Array, force: Array, top: float) -> float:
    """Return the median travel from a turn until the force has changed by 80 % of both levels."""
    level = float(np.median(np.abs(force[np.abs(v) > 0.5 * top])))
    moving = np.flatnonzero(np.abs(v) > 0.02 * top)
    turns = np.flatnonzero(np.diff(np.sign(v[moving])))
    if turns.size == 0:
        return 0.0
    travels = []
    lasts = [*moving[turns[1:]], len(x) - 1]
    for before, after, last in zip(moving[turns], moving[turns + 1], lasts, strict=True):
        ahead = slice(before, last + 1)
        changed = np.abs(force[ahead] - force[before]) > 0.8 * 2.0 * level
        if changed.any():
            there = before + int(np.argmax(changed))
            turn = x[before : after + 1]
            far = turn.max() if v[before] > 0.0 else turn.min()
            travels.append(abs(float(x[there]) - float(far)))
    return float(np.median(travels)) if travels else 0.0


def _loading(x: Array, v: Array, force: Array, top: float) -> float:
    """Return the way from the start until the force has made 80 % of its change."""
    change = force - force[0]
    level = float(np.median(change[np.abs(v) > 0.5 * top]))
    loaded = np.flatnonzero(np.sign(level) * change > 0.8 * abs(level))
    return abs(float(x[loaded[0]] - x[0])) if loaded.size else 0.0


def verdicts(
    estimates: Sequence[Estimate], held: Sequence[Verdict], law: Law, fixed: Mapping[str, float]
) -> tuple[Verdict, ...]:
    """Judge each parameter of a LuGre joint: what was fitted, held back, and left out."""
    found = {one.name: one for one in estimates}
    named = {one.parameter for one in held} | found.keys() | fixed.keys()
    out = [_by_error(one, found) for one in estimates]
    left_out = [
        Verdict(name, False, f"law '{law.name}' does not have it", remedy)
        for name, remedy in _LEFT_OUT.items()
        if name not in named
    ]
    return (*out, *held, *left_out)


_LEFT_OUT = {
    "stiction_ratio": "fit law 'stribeck' or 'lugre'",
    "stribeck_velocity_m_per_s": "fit law 'stribeck' or 'lugre'",
    "stiffness_n_per_m": "fit law 'lugre' or 'elasto_plastic'",
    "damping_n_s_per_m": "fit law 'lugre' or 'elasto_plastic'",
}


def _remedy(name: str, because: str) -> str:
    """Return the experiment that would tell a parameter."""
    for words, remedy in _REMEDIES_BY_REASON.items():
        if words in because:
            return remedy
    return _REMEDIES.get(name, _MORE)


def _by_error(one: Estimate, found: Mapping[str, Estimate]) -> Verdict:
    ratio = found.get("stiction_ratio")
    if one.name == "stribeck_velocity_m_per_s" and ratio and ratio.low < 1.0 < ratio.high:
        because = "F_s / F_c is not distinct from 1, so it has no effect"
        return Verdict(one.name, False, because, _SPEEDS)
    if one.identifiable and one.remark:
        return Verdict(one.name, True, f"at least {one.low:.4g}: {one.remark}")
    if one.identifiable:
        return Verdict(one.name, True, f"95 % interval {one.low:.4g} to {one.high:.4g}")
    return Verdict(one.name, False, one.remark, _remedy(one.name, one.remark))


_MORE = "record for longer, with more reversals and more speeds"
_SPEEDS = (
    "slide at constant speeds from creeping to fast, at least a factor of 30 apart, in both "
    "directions"
)
_REMEDIES = {
    "stiction_ratio": "start from rest many times, after rests of several lengths, and creep",
    "stribeck_velocity_m_per_s": _SPEEDS,
    "viscous_n_s_per_m": _SPEEDS,
    "viscous_positive_n_s_per_m": _SPEEDS,
    "viscous_negative_n_s_per_m": _SPEEDS,
    "stiffness_n_per_m": "load the joint slowly back and forth below breakaway, with a position "
    "sensor that resolves a twentieth of the deflection",
    "damping_n_s_per_m": "strike or shake the joint while it sticks, sampled at ten times its "
    "resonance",
    "offset_n": "let the part slide both ways",
    "elastic_share": "load the joint slowly back and forth up to breakaway",
    "mass_kg": "accelerate harder, or weigh the part and fix the mass (`fixed`, --fix)",
}
_REMEDIES_BY_REASON = {
    "only one way": "let the part slide both ways, or fix the offset (`fixed`, --fix)",
    "never": "load the joint until it slides, in both directions",
    "stick-slip": "pull faster or through a stiffer drive, until the part slides steadily; "
    "`breakaway events` tells the force at which each slip began",
}


def unexcited(
    names: Sequence[str], shown: Excitation, settings: RunSettings, mass_shows: bool
) -> dict[str, tuple[float, Verdict]]:
    """Return the parameters that a log does not excite: the value to hold each at, and why.

    Fitted all the same, they would take any value that suits the error of the law, and pull the
    others with them.
    """
    out: dict[str, tuple[float, Verdict]] = {}

    def hold(name: str, value: float, because: str) -> None:
        if name in names:
            remedy = _remedy(name, because)
            verdict = Verdict(name, False, f"held at {value:g}: {because}", remedy)
            out[name] = (value, verdict)

    if settings.motion == "imposed" and not mass_shows:
        hold("mass_kg", 0.0, "inertia is too small against friction to show")
    if shown.speed_ratio < SPEED_RATIO:
        speeds = (
            f"nearly one speed, 90 % of the sliding rows lie between "
            f"{shown.slow_speed_m_per_s:.3g} and {shown.fast_speed_m_per_s:.3g} m/s"
        )
        hold("stiction_ratio", 1.0, speeds)
        hold("stribeck_velocity_m_per_s", 1.0, speeds)
        for name in names:
            if name.startswith("viscous"):
                hold(name, 0.0, speeds)
        if settings.motion == "imposed":
            hold("damping_n_s_per_m", 0.0, speeds)
    if not shown.broke_away and settings.motion == "imposed":
        hold("stiction_ratio", 1.0, "the part never broke away")
        hold("stribeck_velocity_m_per_s", 1.0, "the part never broke away")
        for name in names:
            if name.startswith("viscous"):
                hold(name, 0.0, "the part never slid")
    if not shown.both_directions:
        for name in ("offset_n", "offset_1_n"):
            hold(name, 0.0, "the part slides only one way, so an offset looks like friction")
    if shown.presliding_m < PRESLIDING_QUANTA * shown.noise_m and settings.motion == "imposed":
        depth = f"presliding is {shown.presliding_m:.2g} m, the noise {shown.noise_m:.2g} m"
        hold("elastic_share", 0.5, depth)
        hold("damping_n_s_per_m", 0.0, depth)
    return out


def untold(
    names: Sequence[str], shown: Excitation, motion: MotionKind, held: Sequence[str]
) -> dict[str, str]:
    """Return which fitted parameters a log cannot tell by the way it moves, and why."""
    out: dict[str, str] = {}
    if motion != "imposed":
        return out
    if not shown.both_directions and {"offset_n", "offset_1_n"} & set(held):
        word = "plus" if shown.direction > 0 else "minus"
        sum_only = f"the part slides only one way: only coulomb {word} offset is told"
        out = {"coulomb_n": sum_only, "stiction_ratio": sum_only}
        load = "the part slides only one way, and how far its bristle was loaded is not known"
        out |= dict.fromkeys(("stiffness_n_per_m", "damping_n_s_per_m", "elastic_share"), load)
    if not shown.broke_away:
        bound = f"the part never broke away; it held at least {shown.held_n:.3g} N"
        levels = [name for name in names if name.startswith(("coulomb", "stiction"))]
        out |= dict.fromkeys(levels, bound)
        rest = "the part never broke away, so a bristle that is loaded looks like an offset"
        out |= {name: rest for name in names if name.startswith("offset")}
        loss = "below breakaway, friction that slips in part looks like a damper"
        out["damping_n_s_per_m"] = loss
    if shown.slips:
        slips = (
            f"stick-slip: {shown.slips} slips of about {shown.slip_rows} rows, in which force and "
            "motion follow from each other; inertia and friction look alike"
        )
        out |= dict.fromkeys(names, slips)
    if "backlash_m" in names:
        free_travel = "each turn begins with free travel, which hides how the bristle is loaded"
        out |= dict.fromkeys(("stiffness_n_per_m", "damping_n_s_per_m"), free_travel)
    return {name: because for name, because in out.items() if name in names}


def stiction_peak(found: Mapping[str, Estimate], verdict: Sequence[Verdict]) -> str:
    """Say in one sentence whether friction peaks before sliding."""
    ratio = found.get("stiction_ratio")
    judged = next((one for one in verdict if one.parameter == "stiction_ratio"), None)
    if ratio is None or judged is None:
        because = "it was held in the fit" if judged is None else judged.because
        return f"stiction peak: not identified ({because})"
    figure = f"F_s / F_c = {ratio.value:.3g}, 95 % interval {ratio.low:.3g} to {ratio.high:.3g}"
    if not judged.identifiable:
        return f"stiction peak: this log cannot tell ({judged.because})"
    if ratio.high < NO_PEAK:
        return f"stiction peak: none; {figure}"
    if ratio.low > 1.0:
        return f"stiction peak: seen; {figure}"
    return f"stiction peak: this log cannot tell; {figure}"
