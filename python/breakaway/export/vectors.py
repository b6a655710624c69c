"""Recorded steps that exported code is compared with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from breakaway import _core
from breakaway.export.interface import Real, What
from breakaway.export.recording import Recording
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import core_job

STEPS = 300
"""Steps of a test program."""

COLUMNS: dict[What, tuple[str, ...]] = {
    "controller": ("position_m", "velocity_m_per_s", "force_n"),
    "plant": ("force_n", "feed_m_per_s", "stack_share"),
    "loop": ("", "", ""),
}
"""What is exported -> the columns of its inputs; not every scenario has all of them."""


def reference(
    resolved: Scenario, what: What, real: Real, inputs: NDArray[np.float64], run: int = 0
) -> dict[str, NDArray[np.float64]]:
    """Give the outputs that the core computes from rest, by name.

    Parameters
    ----------
    resolved : Scenario
        A resolved scenario.
    what, real : str
        What is exported, and in which real type the core computes.
    inputs : array of shape (steps, 3)
        The inputs of each step, in the order of `COLUMNS`.
    run : int, optional
        Number of the run, which random draws depend on.

    """
    rows = np.ascontiguousarray(inputs, dtype=np.float64).ravel()
    found = _core.export_reference(core_job(resolved, run), what, real, rows)
    return {name: np.frombuffer(column) for name, column in found.items()}


def likely_inputs(recording: Recording) -> NDArray[np.float64]:
    """Inputs of a test program: the course of the loop, then a traverse, then jumps."""
    loop = reference(recording.scenario, "loop", recording.real, np.zeros((STEPS, 3)))
    third = STEPS // 3
    if recording.what == "controller":
        names = ("position_m", "velocity_m_per_s", "applied_force_n")
        distance_m = recording.scenario.joint.engagement_length_m
        scales = (distance_m, 1.0, recording.scenario.joint.stiction_n)
    else:
        names = ("command_force_n", "command_feed_m_per_s", "command_stack_share")
        scales = (1.5 * recording.scenario.joint.stiction_n, 0.01, 1.0)
    columns = []
    for place, (name, scale) in enumerate(zip(names, scales, strict=True)):
        before = (
            np.concatenate([[0.0], loop[name]]) if recording.what == "controller" else loop[name]
        )
        traverse = scale * (np.arange(third) + 0.3 * _spread(third, place)) / third
        jumps = scale * (1.5 * _spread(third, place + 3) - 0.4)
        columns.append(np.concatenate([before[:third], traverse, jumps]))
    inputs = np.column_stack(columns)
    if recording.what == "plant":
        inputs[:, 2] = np.clip(inputs[:, 2], 0.0, 1.0)
    return inputs


def _spread(count: int, place: int) -> NDArray[np.float64]:
    """Numbers that fill 0 to 1 evenly: no generator whose versions differ."""
    step = (2.0**0.5, 3.0**0.5, 5.0**0.5, 7.0**0.5, 11.0**0.5, 13.0**0.5)[place]
    spread: NDArray[np.float64] = (np.arange(1, count + 1) * step) % 1.0
    return spread


def bits(values: Sequence[float] | NDArray[np.float64], real: Real) -> list[str]:
    """Bits of numbers, as C writes them."""
    if real == "float":
        narrow = np.asarray(values, dtype=np.float64).astype(np.float32)
        return [f"0x{one:08x}u" for one in narrow.view(np.uint32)]
    return [f"0x{one:016x}u" for one in np.asarray(values, dtype=np.float64).view(np.uint64)]
