"""How many threads computing takes."""

from __future__ import annotations

import os
from numbers import Integral

from breakaway.errors import StudyError

MOST_THREADS = 1024
"""More threads than any machine that this runs on has processors are a slip of the pen."""


def usable_processors() -> int:
    """Return how many processors this process may use.

    >>> usable_processors() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def thread_count(threads: int | None) -> int:
    """Return how many threads to start: those asked for, else one for each usable processor.

    Raises
    ------
    StudyError
        ``threads`` is not a whole number from 1 to 1024.

    Examples
    --------
    >>> thread_count(3)
    3

    """
    if threads is None:
        return usable_processors()
    whole = isinstance(threads, Integral) and not isinstance(threads, bool)
    if not (whole and 1 <= threads <= MOST_THREADS):
        raise StudyError(f"threads: {threads!r} is not a whole number >= 1 and <= {MOST_THREADS}")
    return int(threads)
