"""The controllers that are proven on the processor, and what they are fed with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from tests.export.kinds import BASE, CONTROLLERS, IMPACTS, LENGTH_M

import breakaway as bk
from breakaway.export.recording import Recording
from breakaway.export.vectors import COLUMNS, reference

STEPS = 10_000
"""Steps of each controller; the firmware has the same number."""


@dataclass(frozen=True)
class Case:
    """A controller, and how many instructions a step may take."""

    name: str
    what: str
    scenario: bk.Scenario
    limit: int | None = None
    in_the_loop: bool = False
    """Whether a whole run is closed with the plant."""
    episode: int = 500
    """Steps from one reset to the next; within 400 the parts of `kinds` break loose and leave."""


def cases() -> list[Case]:
    """Every kind of controller; the paper's with their limits."""
    paper, vibration, bounded = (
        bk.load_scenario(f"paper_as_computed{suffix}")
        for suffix in ("", "_vibration", "_vibration_bounded")
    )
    impacts = BASE.with_(controller=IMPACTS, actuator=CONTROLLERS["impacts"].actuator)
    return [
        Case("paper_as_computed", "PID", paper, 60, True, STEPS),
        Case(
            "paper_as_computed_vibration",
            "two steps, half-sine pulses",
            vibration,
            250,
            True,
            STEPS,
        ),
        Case(
            "paper_as_computed_vibration_bounded",
            "the same, anti-windup",
            bounded,
            250,
            True,
            STEPS,
        ),
        Case("fm_rectangular", "FM vibration, rectangular", CONTROLLERS["fm_rectangular"]),
        Case("fm_half_sine", "FM vibration, half sine", CONTROLLERS["fm_half_sine"]),
        Case("fm_raised_cosine", "FM vibration, raised cosine", CONTROLLERS["fm_raised_cosine"]),
        Case("two_step_half_sine", "two steps, watch", CONTROLLERS["two_step_half_sine"]),
        Case("impacts", "timed impacts", impacts),
        Case("two_step_impacts", "ramp, then impacts, watch", CONTROLLERS["two_step_impacts"]),
        Case("ramp", "force ramp, watch", CONTROLLERS["ramp"]),
        Case("steady_feed", "steady feed", CONTROLLERS["steady_feed"]),
        Case("vibrated_feed", "vibrated feed, watch", CONTROLLERS["vibrated_feed"]),
    ]


def inputs_of(recording: Recording, episode: int) -> NDArray[np.float32]:
    """Compose the inputs of all episodes, one below the other."""
    rng = np.random.default_rng(11)
    episodes = [_episode(recording, rng, run, episode) for run in range(STEPS // episode)]
    return np.concatenate(episodes).astype(np.float32)


def _episode(
    recording: Recording, rng: np.random.Generator, run: int, steps: int
) -> NDArray[np.float64]:
    """Compose the loop's own course, in which the part breaks loose; from some point on anything.

    Each run draws other disturbances. In every second one anything comes early.
    """
    scenario = recording.scenario
    course = _course(scenario, run, min(scenario.samples, steps))
    kept = len(course) // 2 if run % 2 == 0 else len(course)
    scales = (min(scenario.joint.engagement_length_m, 30 * LENGTH_M), 1.0, 2000.0)
    anything = np.column_stack([_wild(rng, steps - kept, scale) for scale in scales])
    if scenario.watch is not None:
        # A watch also takes what is no number; it stops for good then.
        anything[-3:, 0] = (np.nan, 0.0, np.inf)
    return np.concatenate([course[:kept], anything])


def expected_of(
    recording: Recording, inputs: NDArray[np.float32], episode: int
) -> NDArray[np.float32]:
    """Outputs of the core in f32, from rest in each episode."""
    found = []
    for first in range(0, len(inputs), episode):
        rows = inputs[first : first + episode].astype(np.float64)
        given = reference(recording.scenario, "controller", "float", rows)
        found.append(np.column_stack([given[one.name] for one in recording.outputs]))
    return np.concatenate(found).astype(np.float32)


def read_by(recording: Recording, inputs: NDArray[np.float32]) -> NDArray[np.float32]:
    """Pick the columns that the controller has as inputs."""
    columns = [COLUMNS["controller"].index(one.name) for one in recording.inputs]
    return np.ascontiguousarray(inputs[:, columns])


def _course(scenario: bk.Scenario, run: int, steps: int) -> NDArray[np.float64]:
    """What ideal sensors show from rest on in the loop."""
    loop = reference(scenario, "loop", "float", np.zeros((steps, 3)), run)
    names = ("position_m", "velocity_m_per_s", "applied_force_n")
    return np.column_stack([np.concatenate([[0.0], loop[name][:-1]]) for name in names])


def _wild(rng: np.random.Generator, steps: int, scale: float) -> NDArray[np.float64]:
    """Draw numbers that walk, stand still and jump, for 50 steps each."""
    blocks = steps // 50 + 1
    walk = np.cumsum(rng.normal(scale=0.004, size=steps)) % 2.0 - 0.5
    jumps = rng.uniform(-1.5, 1.5, steps)
    still = np.repeat(rng.uniform(0.0, 1.0, blocks), 50)[:steps]
    kind = np.repeat(rng.integers(0, 3, blocks), 50)[:steps]
    chosen: NDArray[np.float64] = scale * np.select([kind == 0, kind == 1], [walk, jumps], still)
    return chosen
