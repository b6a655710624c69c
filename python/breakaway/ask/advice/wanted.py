"""Which rig would do, where none of the ways of this one is good enough."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from breakaway.ask.advice.ranking import Ranked
from breakaway.ask.advice.trying import FIRST_JUDGED, TimeIsUpError, Tried, Trying
from breakaway.ask.advice.ways import Way, ways_of
from breakaway.model.scenario.actuator import Contact, FeedAxis, ForceActuator
from breakaway.model.scenario.extraction_rig import ExtractionRig

ENOUGH = 0.95
"""Share of parts that a way has to spare, to be good enough."""
PARTS = 48
"""Parts that a changed rig is tried on, under the law where this one does worst."""
FACTORS = (3.0, 10.0, 30.0)
"""By how much stiffness or bandwidth is raised, in turn."""
STIFF_N_PER_M = 3e7
"""Stiffness of the axis that is tried in place of a force, as in the preset `steady_feed`."""


@dataclass(frozen=True)
class WantedRig:
    """A change of the rig, and what it would do."""

    change: str
    """What is changed, in words."""
    way: str
    """The way that then does best."""
    unharmed: float
    """Share of the parts tried that come out within all limits."""
    parts: int
    """How many were tried."""

    @property
    def is_enough(self) -> bool:
        """Whether it would be good enough."""
        return self.unharmed >= ENOUGH


def force_needed_n(tried: Tried) -> float:
    """Give the force that frees 99 of 100 of the parts, in N, without any margin."""
    return float(np.quantile(tried.quantities["stiction_n"], 0.99))


def wanted_rigs(best: Ranked, trying: Trying) -> list[WantedRig]:
    """Try changes of the rig until one is good enough, or the time is up."""
    found = []
    runs = range(FIRST_JUDGED, FIRST_JUDGED + PARTS)
    for words, rig in _changes(trying.bounds.rig):
        try:
            shares = [
                (_share(way, rig, best, runs, trying), way.name)
                for way in ways_of(rig, trying.parts.population)
            ]
        except TimeIsUpError:
            break
        if not shares:  # the parts are given too little time
            continue
        share, name = max(shares)
        found.append(WantedRig(words, name, share, PARTS))
        if found[-1].is_enough:
            break
    return found


def _share(way: Way, rig: ExtractionRig, best: Ranked, runs: range, trying: Trying) -> float:
    there = trying.at(rig)
    outcome = there.outcome(way.settings[0], best.law, runs, f"another rig, {way.name}", 1.0)
    return float(outcome.unharmed.mean())


def _changes(rig: ExtractionRig) -> Iterator[tuple[str, ExtractionRig]]:
    """Give changed rigs in the order of what they cost."""
    drive = rig.actuator
    if isinstance(drive, FeedAxis):
        for factor in FACTORS:
            stiffer = drive.model_copy(
                update={
                    "stiffness_n_per_m": factor * drive.stiffness_n_per_m,
                    "damping_n_s_per_m": factor**0.5 * drive.damping_n_s_per_m,
                }
            )
            words = f"an axis of {stiffer.stiffness_n_per_m:.3g} N/m"
            yield words, rig.model_copy(update={"actuator": stiffer})
        return
    yield from _faster(rig, drive)
    yield f"an axis of {STIFF_N_PER_M:.3g} N/m in its place", _axis_of(rig)


def _faster(rig: ExtractionRig, drive: ForceActuator) -> Iterator[tuple[str, ExtractionRig]]:
    """Give rigs that read the position, and whose force follows faster."""
    reads = ("position", *(one for one in rig.reads if one != "position"))
    period_s = min(rig.control_period_s, 5e-5)
    for factor in FACTORS:
        quick = drive.model_copy(update={"bandwidth_hz": factor * drive.bandwidth_hz})
        words = f"a force of {quick.bandwidth_hz:.4g} Hz that reads the position at 20 kHz"
        changed = {"actuator": quick, "reads": reads, "control_period_s": period_s}
        yield words, rig.model_copy(update=changed)


def _axis_of(rig: ExtractionRig) -> ExtractionRig:
    axis = FeedAxis(
        speed_max_m_per_s=0.05,
        acceleration_max_m_per_s2=1.0,
        stiffness_n_per_m=STIFF_N_PER_M,
        damping_n_s_per_m=1e4,
        tool_mass_kg=5.0,
        contact=Contact(stiffness_n_per_m=3e8, damping_n_s_per_m=5e3, gap_m=1e-4),
    )
    return rig.model_copy(update={"actuator": axis})
