"""A fault of a log: what it is, how large, and what follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

FaultKind = Literal["spikes", "drift", "warming", "backlash", "delay", "units"]


@dataclass(frozen=True)
class Fault:
    """One fault of the data that intervals do not know.

    Parameters
    ----------
    kind : {'spikes', 'drift', 'warming', 'backlash', 'delay', 'units'}
        What it is.
    parameter : str
        The parameter of the rig that models it; empty where none does.
    value : float
        Its estimate before the fit, in the parameter's unit; for spikes, how many.
    message : str
        All this in words, which `str` gives.

    """

    kind: FaultKind
    parameter: str
    value: float
    message: str

    def __str__(self) -> str:
        """Return the message."""
        return self.message
