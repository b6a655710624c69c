"""A log as models of a rig are run against it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from breakaway._core import RigRecord
from breakaway.errors import LogError
from breakaway.measure.identification.cascade import Cascade
from breakaway.measure.identification.laws import Law
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.logs.derived import SPACING_TOLERANCE, derive_motion
from breakaway.measure.logs.findings import GAP
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.controller import Gains, Pid

MotionKind = Literal["imposed", "free", "closed_loop"]
MOTIONS: tuple[MotionKind, ...] = ("imposed", "free", "closed_loop")
"""Measured motion is imposed on the model; the measured force moves it; a controller does."""

Span = tuple[float, float]

STEP_LIMIT = 0.3
"""Largest h √(k_e / m): beyond, the linearly implicit midpoint creeps wrongly (adr/0006)."""

MINIMUM_SEGMENT = 10
"""Fewest rows between two gaps that are used."""

LIMITLESS_N = 1e12


@dataclass(frozen=True)
class RunSettings:
    """How a log is to be run, as `breakaway.identify` describes it.

    ``origin_m`` is the position at which friction levels and offsets hold; ``rig`` is what lies
    between the part and the sensors, None where it is not known.
    """

    motion: MotionKind
    controller: Cascade | Pid | None = None
    force_limit_n: float | None = None
    force_held: bool = True
    lowpass_hz: float | None = None
    steps: int = 1
    origin_m: float = 0.0
    rig: RigFile | None = None


@dataclass(frozen=True, eq=False)
class Rows:
    """Columns of a log that the core's rows are made of; positions count from the origin."""

    log: Log
    columns: Array
    even: bool
    lowpass_hz: float | None

    @property
    def driving_force_n(self) -> Array:
        """All that drives the part, in N: the force, and the known one outside."""
        force: Array = self.columns[3] + self.columns[9]
        return force


def measured_rows(log: Log, settings: RunSettings) -> Rows:
    """Derive what the core asks of each row; nothing is resampled.

    Speeds are those of the low-passed position where the log is even: differences of quantized
    positions would jump by more than the speed over which friction changes.
    """
    log.check_increasing()
    if settings.rig is not None:
        check_rig(settings.rig, settings.motion)
        log = settings.rig.at_part(log)
    t_s, x, force = log.t_s, log.position_m, log.force_n
    steps = np.diff(t_s)
    even = bool(np.all(np.abs(steps / np.median(steps) - 1.0) <= SPACING_TOLERANCE))
    lowpass_hz, path = None, x
    if even:
        motion = derive_motion(log, settings.lowpass_hz)
        velocity, acceleration = motion.velocity_m_per_s, motion.acceleration_m_per_s2
        lowpass_hz, path = motion.lowpass_hz, motion.position_m
    else:
        velocity = np.gradient(x, t_s)
        acceleration = np.gradient(velocity, t_s)
    reference = log.reference_m
    if settings.motion == "closed_loop" and reference is None:
        raise LogError(
            f"{log.name}: motion 'closed_loop' needs the channel 'reference_m', which the "
            "controller follows; map it, or use motion 'free'"
        )
    target = x if reference is None else reference
    held = force if settings.force_held else np.append(0.5 * (force[1:] + force[:-1]), force[-1])
    origin = settings.origin_m
    rate = np.gradient(target, t_s)
    columns = [x - origin, velocity, acceleration, force, target - origin, rate]
    columns += [np.append(steps, steps[-1]), np.append(np.diff(path) / steps, 0.0), held]
    columns += [log.driving_force_n - force, t_s - t_s[0]]
    return Rows(log, np.array(columns), even, lowpass_hz)


def check_rig(rig: RigFile, motion: MotionKind) -> None:
    """Raise `LogError` for a rig that cannot be taken off a kind of motion."""
    if motion == "closed_loop" and rig.stiffness_n_per_m is not None:
        raise LogError(
            "rig: stiffness_n_per_m cannot be taken off motion 'closed_loop', whose controller "
            "sees the drive; use motion 'imposed' or 'free', or leave it out of the rig file"
        )
    if motion != "imposed" and rig.mass_kg > 0.0:
        raise LogError(
            f"rig: mass_kg is part of the mass that motion {motion!r} finds; leave it out of the "
            "rig file and take it off the result, or use motion 'imposed'"
        )


def segments_of(
    rows: Rows, repeats: Sequence[Span]
) -> tuple[list[Span], list[tuple[int, int]], list[int]]:
    """Cut spans in s at gaps.

    Returns the spans, the first and the end row of each segment, and the span that each is of.

    Raises
    ------
    LogError
        A span is empty, or overlaps the one before.

    """
    t_s, name = rows.log.t_s, rows.log.name
    steps = np.diff(t_s)
    gaps = np.flatnonzero(steps > GAP * np.median(steps)) + 1
    spans = list(repeats) or [(float(t_s[0]), float(np.nextafter(t_s[-1], np.inf)))]
    segments, owners = [], []
    end_before = 0
    for number, (start_s, end_s) in enumerate(spans):
        first, end = (int(row) for row in np.searchsorted(t_s, (start_s, end_s)))
        if end - first < MINIMUM_SEGMENT or first < end_before:
            raise LogError(
                f"{name}: the span {start_s:g} s to {end_s:g} s holds {max(end - first, 0)} rows "
                f"after the spans before it; at least {MINIMUM_SEGMENT} are needed, in order and "
                f"without overlap, within {t_s[0]:g} s to {t_s[-1]:g} s"
            )
        cuts = [first, *(int(gap) for gap in gaps if first < gap < end), end]
        for cut, next_cut in pairwise(cuts):
            if next_cut - cut >= MINIMUM_SEGMENT:
                segments.append((cut, next_cut))
                owners.append(number)
        if not owners or owners[-1] != number:
            raise LogError(
                f"{name}: the span {start_s:g} s to {end_s:g} s has under {MINIMUM_SEGMENT} rows "
                "between any two gaps, so nothing can be run; log without gaps"
            )
        end_before = end
    return spans, segments, owners


def core_record(
    rows: Rows, segments: Sequence[tuple[int, int]], law: Law, settings: RunSettings
) -> RigRecord:
    """Hand the rows over to the core."""
    columns = [np.ascontiguousarray(column) for column in rows.columns]
    return RigRecord(
        columns, list(segments), core_drive(settings), law.elasto_plastic, settings.steps
    )


def core_drive(settings: RunSettings) -> dict[str, Any]:
    """Return what moves the part, under the names of the core."""
    if settings.motion == "imposed":
        return {"kind": "imposed"}
    if settings.motion == "free":
        return {"kind": "force"}
    controller = settings.controller
    if isinstance(controller, Cascade):
        return controller.model_dump()
    if isinstance(controller, Pid) and isinstance(controller.gains, Gains):
        pid = controller.model_dump(exclude={"kind": True, "gains": {"kind"}})
        pid["derivative_filter_s"] = pid["derivative_filter_s"] or None
        limit_n = LIMITLESS_N if settings.force_limit_n is None else settings.force_limit_n
        return {"kind": "pid", "pid": pid, "force_limit_n": limit_n}
    raise LogError(
        "controller: motion 'closed_loop' needs a Cascade, or a Pid whose gains are given as "
        "numbers"
    )


def predicted_channel(motion: MotionKind) -> str:
    """Return the channel that is compared: what the model does not take from the log."""
    return "position_m" if motion == "free" else "force_n"
