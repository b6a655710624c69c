"""A joint file from a pull: what was seen, and a stated wide range for what was not."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from breakaway._core import __version__
from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.identification.events import BreakawayReport, find_breakaway_events
from breakaway.measure.identification.joint_file import DRAWS, JointFile
from breakaway.measure.identification.joint_tables import (
    Assumed,
    Draws,
    Joint,
    Part,
    Provenance,
    PullFigures,
    Rig,
    Search,
)
from breakaway.measure.identification.pull import Pull, Seen, pull_of
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.files import load_population

METHOD = "breakaway event"
USUAL = "seized_parts"
"""The population whose assumed ranges stand for what a pull does not tell."""
ROUNDS = 1000
"""Most times that draws which no joint can have are drawn again."""
WIDTH = 10.0
"""The Stribeck velocity is drawn from at least so many times less than its upper end."""
RANGES_NOTE = (
    f"the ranges of what is assumed are those of the preset {USUAL}; no measured population is "
    "behind them"
)
BOUND_FACTOR = 3.0
"""Above a bound from below, values up to this many times as large are drawn at least."""
VISCOUS = "joint.viscous_n_s_per_m"
VISCOUS_SPEED_M_PER_S = 1.0
"""Viscous friction is assumed to be at most the sliding friction at this speed."""


def joint_from_pull(
    log: Log,
    *,
    report: BreakawayReport | None = None,
    rig: RigFile | None = None,
    mass_kg: float | None = None,
    seed: int = 0,
) -> JointFile:
    """Make a joint of a log that shows one pull from rest to slip.

    The first start from rest counts. What the log shows has a 95 % interval::

        stiction_n           the largest load before the slip
        coulomb_n            the load of steady sliding after it, at its speed
        stiffness_n_per_m    dF/dx at the start of the rise, by least squares x = a + F/k + c F²

    The interval of ``stiction_n`` reaches up by what the joint yields before its peak, times twice
    the slope of the load's fall over the way after it: part of that fall is hidden by inertia.
    A peak that the log may have missed gives a bound from below: its interval has no upper end, and
    ``at_least`` says why. So does a stiffness where no rig file tells the rig's: it is that of
    joint and rig in series. What a pull cannot tell is in ``assumed``, as a usual value and a wide
    range: those of the preset ``seized_parts``, which are assumed as well. The Stribeck velocity is
    below what would leave no friction at speed, v / sqrt(ln(F_s/R)) with the load R of sliding at
    v. ``draws`` vary all; each slides with what was seen at that speed, so its ``coulomb_n`` is
    less where friction would still fall above it.

    Parameters
    ----------
    log : Log
        Position and force of the pull.
    report : BreakawayReport, optional
        What `find_breakaway_events` found in this log. Left out: it is asked, with ``rig``.
    rig : RigFile, optional
        What lies between part and sensors; not beside a ``report``, which has its own.
    mass_kg : float, optional
        Mass of the part from a scale, > 0 and at most 1e6. Left out: assumed.
    seed : int
        Chooses the draws, >= 0.

    Returns
    -------
    JointFile

    Raises
    ------
    LogError
        The log shows no start from rest, the report is of another log, or a number is out of range.

    Notes
    -----
    Not checked: inertia before the slip; that the position is that of the part, where no rig is
    given; friction that falls along the guide while the part slides.

    Examples
    --------
    >>> t_s = np.arange(400) / 100.0
    >>> x = 0.01 * np.maximum(t_s - 1.0, 0.0) + 1e-5 * np.minimum(t_s, 1.0)
    >>> load = np.where(t_s <= 1.0, 90.0 * t_s, 40.0 + 50.0 * np.exp(-(t_s - 1.0) / 0.02))
    >>> joint = joint_from_pull(Log(t_s=t_s, position_m=x, force_n=load), mass_kg=2.0)
    >>> joint.joint.stiction_n, round(joint.joint.coulomb_n, 3), joint.part.mass_kg
    (90.0, 40.0, 2.0)
    >>> joint.at_least
    {'joint.stiffness_n_per_m': "it is that of joint and rig in series; a rig file ..."}
    >>> joint.assumed["joint.viscous_n_s_per_m"].high
    40.0

    """
    check_arguments(joint_from_pull, locals(), LogError)
    if mass_kg is not None and not 0.0 < mass_kg <= 1e6:
        raise LogError(f"mass_kg: {mass_kg!r} is not > 0 and <= 1e6; give the part's mass in kg")
    if seed < 0:
        raise LogError(f"seed: {seed} is not >= 0; give such a number")
    if report is not None and rig is not None:
        raise LogError("rig: the report was made with its own; leave one of the two out")
    found = find_breakaway_events(log, rig=rig) if report is None else report
    pull = pull_of(found, log)
    seen = {
        name: one
        for name, one in (
            ("stiction_n", pull.stiction_n),
            ("coulomb_n", pull.coulomb_n),
            ("stiffness_n_per_m", pull.stiffness_n_per_m),
        )
        if one is not None
    }
    assumed = _assumed(pull, mass_kg)
    sliding: Seen | Assumed = pull.coulomb_n or assumed["joint.coulomb_n"]
    k = pull.stiffness_n_per_m
    release = pull.release_speed_m_per_s
    told = seen | ({} if release is None else {"release_speed_m_per_s": release})
    return JointFile(
        provenance=_provenance(found, log, pull, mass_kg),
        part=Part(mass_kg=mass_kg),
        joint=Joint(
            coulomb_n=sliding.value,
            stiction_n=pull.stiction_n.value,
            stiffness_n_per_m=None if k is None else k.value,
        ),
        rig=Rig(offset_n=found.offset_n or 0.0),
        standard_error={name: one.standard_error for name, one in told.items()},
        interval={name: [one.low, one.high] for name, one in told.items()},
        at_least={f"joint.{name}": one.at_least for name, one in seen.items() if one.at_least},
        assumed=assumed,
        not_identified={
            **{path: one.why for path, one in assumed.items() if path not in _named(seen)},
            "joint.engagement_length_m": "the length of the guide is known from the drawing",
        },
        pull=_figures(pull),
        draws=_draws(pull, assumed, mass_kg, seed),
    )


def _named(seen: Mapping[str, Seen]) -> set[str]:
    return {f"joint.{name}" for name in seen}


def _provenance(report: BreakawayReport, log: Log, pull: Pull, mass_kg: float | None) -> Provenance:
    given = [] if mass_kg is None else [f"part.mass_kg = {mass_kg:g} was given, not identified"]
    return Provenance(
        log=log.name,
        log_sha256=log.sha256,
        breakaway_version=__version__,
        method=METHOD,
        search=Search(
            **{name: value for name, value in report.settings.items() if value is not None},
            rig=report.rig,
        ),
        samples=len(log.t_s),
        notes=[*given, *pull.notes, RANGES_NOTE],
    )


def _figures(pull: Pull) -> PullFigures:
    event, release = pull.event, pull.release_speed_m_per_s
    return PullFigures(
        release_speed_m_per_s=None if release is None else release.value,
        sliding_speed_m_per_s=pull.sliding_speed_m_per_s,
        loading_rate_n_per_s=event.loading_rate_n_per_s,
        presliding_displacement_m=event.presliding_displacement_m,
    )


def _assumed(pull: Pull, mass_kg: float | None) -> dict[str, Assumed]:
    """Give usual value and range of what the pull leaves open, and of what it only bounds."""
    usual = load_population(USUAL)
    ends = {name: _ends(usual.parts, name) for name in RANGES}
    found: dict[str, Assumed] = {}
    stiction = pull.stiction_n
    if stiction.at_least:
        top = BOUND_FACTOR * stiction.value
        why = f"at least what was seen: {stiction.at_least}; no more than three times as much"
        found["joint.stiction_n"] = _range(stiction.value, top, why, value=stiction.value)
    if pull.coulomb_n is None:
        low, high = (stiction.value / one for one in reversed(ends["stiction_ratio"]))
        found["joint.coulomb_n"] = _range(low, high, "the log shows no steady sliding")
    found |= _bristle(pull, ends, mass_kg)
    if mass_kg is None:
        why = "inertia does not show in a pull; a scale tells it (--mass-kg)"
        found["part.mass_kg"] = _range(*ends["mass_kg"], why)
    top = (stiction if pull.coulomb_n is None else pull.coulomb_n).value / VISCOUS_SPEED_M_PER_S
    why = "the part slides at one speed; what is viscous there is in coulomb_n"
    found[VISCOUS] = Assumed(value=0.0, low=0.0, high=top, why=why)
    found["joint.stribeck_velocity_m_per_s"] = _stribeck(pull, *ends["stribeck_velocity_m_per_s"])
    return found


def _stribeck(pull: Pull, low: float, high: float) -> Assumed:
    """Give the range of v_s: no higher than what lets friction fall to the level that was seen.

    ::

        F_c = (R - F_s e) / (1 - e) > 0,  e = exp(-(v/v_s)²)   =>   v_s < v / sqrt(ln(F_s/R))
    """
    why = "how friction falls with speed takes sliding at many speeds, from creeping to fast"
    sliding, v = pull.coulomb_n, pull.sliding_speed_m_per_s
    if sliding is not None and v is not None and pull.stiction_n.value > sliding.value:
        most = v / math.sqrt(math.log(pull.stiction_n.value / sliding.value))
        if most < high:
            why += f"; friction that has fallen so far at {v:.3g} m/s has one below {most:.3g} m/s"
            low, high = min(low, most / WIDTH), most
    return _range(low, high, why)


RANGES = (
    "stiction_ratio",
    "presliding_m",
    "bristle_damping_ratio",
    "stribeck_velocity_m_per_s",
    "mass_kg",
)


def _ends(parts: object, name: str) -> tuple[float, float]:
    distribution = getattr(parts, name)
    low, high = distribution.quantile(np.array([0.0, 1.0]))
    return float(low), float(high)


def _range(low: float, high: float, why: str, *, value: float | None = None) -> Assumed:
    """Give a range of ratios, with its middle as the usual value."""
    middle = math.sqrt(low * high) if value is None else value
    return Assumed(value=middle, low=low, high=high, why=why)


def _bristle(
    pull: Pull, ends: Mapping[str, tuple[float, float]], mass_kg: float | None
) -> dict[str, Assumed]:
    """Give ranges of stiffness, where it is not seen in full, and of damping, c = 2 ζ sqrt(k m)."""
    found = {}
    held, k = pull.stiction_n.value, pull.stiffness_n_per_m
    shortest, longest = ends["presliding_m"]
    if k is None:
        why = "the log shows no presliding that its noise does not hide"
        found["joint.stiffness_n_per_m"] = _range(held / longest, held / shortest, why)
    elif k.at_least:
        top = max(held / shortest, BOUND_FACTOR * k.value)
        found["joint.stiffness_n_per_m"] = _range(k.low, top, k.at_least, value=k.value)
    told = found.get("joint.stiffness_n_per_m", k)
    masses = ends["mass_kg"] if mass_kg is None else (mass_kg, mass_kg)
    assert told is not None
    pairs = zip(ends["bristle_damping_ratio"], (told.low, told.high), masses, strict=True)
    low, high = (2.0 * ratio * math.sqrt(stiffness * mass) for ratio, stiffness, mass in pairs)
    why = "a stuck joint must be shaken to show its damping"
    found["joint.damping_n_s_per_m"] = _range(low, high, why)
    return found


def _draws(pull: Pull, assumed: Mapping[str, Assumed], mass_kg: float | None, seed: int) -> Draws:
    """Draw joints: what was seen by its interval, what is assumed by its range.

    A joint holds at least what it slides with, and slides with what was seen at that speed::

        F_c = R - σ₂ v - (F_s - R + σ₂ v) e / (1 - e),  e = exp(-(v/v_s)²)
    """
    rng = np.random.default_rng(seed)
    kept: dict[str, Array] = {}
    for _ in range(ROUNDS):
        rows = _rows(pull, assumed, mass_kg, rng)
        positive = [column > 0.0 for path, column in rows.items() if path != VISCOUS]
        good = np.all([*positive, *map(np.isfinite, rows.values())], axis=0)
        kept = {p: np.append(kept.get(p, ()), column[good]) for p, column in rows.items()}
        if len(kept["joint.stiction_n"]) >= DRAWS:
            break
    else:
        raise LogError(
            "no joint comes of this log: hardly any joint has what it shows; the load at rest or "
            "the noise is as large as the forces: give the offset, or record again"
        )
    values = {path: column[:DRAWS].tolist() for path, column in kept.items()}
    source = "intervals of what was seen, ranges of what is assumed"
    return Draws(source=source, seed=seed, values=values)


def _rows(
    pull: Pull, assumed: Mapping[str, Assumed], mass_kg: float | None, rng: np.random.Generator
) -> dict[str, Array]:
    seen = {
        "joint.stiction_n": pull.stiction_n,
        "joint.coulomb_n": pull.coulomb_n,
        "joint.stiffness_n_per_m": pull.stiffness_n_per_m,
    }
    known: dict[str, Seen | Assumed] = {p: one for p, one in seen.items() if one is not None}
    rows = {path: one.draws(rng, DRAWS) for path, one in (known | dict(assumed)).items()}
    if mass_kg is not None:
        rows["part.mass_kg"] = np.full(DRAWS, mass_kg)
    level = rows["joint.coulomb_n"]
    rows["joint.stiction_n"] = np.maximum(rows["joint.stiction_n"], level)
    v = pull.sliding_speed_m_per_s
    if pull.coulomb_n is not None and v is not None:
        dry = level - rows[VISCOUS] * v
        fallen = (v / rows["joint.stribeck_velocity_m_per_s"]) ** 2
        e, rest = np.exp(-fallen), -np.expm1(-fallen)
        # A slide much slower than v_s tells nothing of F_c: such rows are not finite, and dropped.
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            if pull.stiction_n.at_least:  # as far as F_c > 0 allows
                least = np.maximum(level, pull.stiction_n.value)
                most = least + rng.random(DRAWS) * (np.maximum(dry / e, least) - least)
                rows["joint.stiction_n"] = np.minimum(rows["joint.stiction_n"], most)
            rows["joint.coulomb_n"] = dry - (rows["joint.stiction_n"] - dry) * e / rest
    return rows
