"""What a peer offers to be measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from .equations import Rule
from .loop import FloatArray, Loop

Simulate = Callable[[], FloatArray]
"""Simulates the runs of a loop from the start; gives the IAE of each in m s."""
Prepare = Callable[[Loop, int], Simulate]
"""Makes ready to simulate a loop on a number of threads: builds, loads, compiles."""


@dataclass(frozen=True)
class Batch:
    """How a case simulates many runs, and how much of that is measured."""

    runs: int
    duration_s: float
    all_cores: Literal["threads", "processes"]
    """Its own threads, or one process for each core that shares out the runs."""


@dataclass(frozen=True)
class Case:
    """One way of one peer, ready to be measured."""

    name: str
    integrates: str
    settings: str
    prepare: Prepare
    single_s: float | None
    """Simulated seconds of the single run that is measured; none where it has no single run."""
    batch: Batch | None = None
    """None: run after run, as fast as a single one; on all cores in processes."""
    rule: Rule | None = None
    """One of the rules that we have too, so that rule and code can be told apart."""
    first_run: Prepare | None = None
    """Where the single run is prepared another way than the batch."""
