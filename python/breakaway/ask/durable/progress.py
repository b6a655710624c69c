"""How far long work has come."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far long work has come.

    Examples
    --------
    >>> at = Progress(runs_done=3, runs_found=1, runs_max=9, doing="grid")
    >>> at.runs_done - at.runs_found
    2

    """

    runs_done: int
    """Runs that are done, including those found on disk."""
    runs_found: int
    """Runs that were found on disk, done by an earlier process."""
    runs_max: int
    """The most runs that it may take: a bisection may need fewer."""
    doing: str
    """What is done, in words."""
