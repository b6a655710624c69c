"""What is wrong with a log, before and after it is fitted, and what of it a fit can model."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from breakaway.measure.identification.faults.backlash import find_backlash
from breakaway.measure.identification.faults.drift import find_drift
from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.faults.spikes import leave_out_spikes
from breakaway.measure.identification.laws import Law
from breakaway.measure.identification.record import MotionKind, RunSettings, measured_rows
from breakaway.measure.logs.log import Log


@dataclass(frozen=True)
class Examined:
    """A log without its spikes, its faults, and where the parameters that model them start."""

    log: Log
    faults: tuple[Fault, ...]
    modeled: Mapping[str, float]


def examine(log: Log, law: Law, settings: RunSettings, taken: Collection[str]) -> Examined:
    """Look for spikes, drift, warming and backlash.

    Parameters
    ----------
    log : Log
        The log.
    law : Law
        The law that is fitted: without a bristle there is no free travel.
    settings : RunSettings
        How it is run.
    taken : collection of str
        Parameters that the user frees or fixes, which are left to them. With ``repeats`` among them
        each repeat has an offset of its own, and neither drift nor warming is looked for.

    """
    cleaned, spiked = leave_out_spikes(log)
    rows = measured_rows(cleaned, RunSettings("imposed", lowpass_hz=settings.lowpass_hz))
    found = find_backlash(rows)
    if "repeats" not in taken:
        found = (*find_drift(rows), *found)
    fits = [one for one in found if _fits(one, law, settings.motion)]
    modeled = {one.parameter: one.value for one in fits if one.parameter not in taken}
    return Examined(cleaned, (*spiked, *found), modeled)


def _fits(fault: Fault, law: Law, motion: MotionKind) -> bool:
    """Whether a parameter can stand for a fault in this fit."""
    return fault.kind != "backlash" or (law.has_bristle and motion == "imposed")
