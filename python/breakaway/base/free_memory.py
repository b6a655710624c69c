"""How much memory this process may still take."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

from breakaway.errors import StudyError

ALWAYS_BYTES = 2**26
"""So little is taken without a look at the system."""


def free_memory_bytes() -> float:
    """Return the least that machine, control groups and limits of the process leave.

    Examples
    --------
    >>> free_memory_bytes() > 0.0
    True

    """
    return max(0.0, min(_machine_bytes(), group_bytes(Path("/")), _process_bytes()))


def check_fits(field: str, count: int, bytes_each: float, remedy: str) -> None:
    """Refuse what cannot fit into the free memory, before any of it is taken.

    Parameters
    ----------
    field : str
        What says how many.
    count : int
        How many.
    bytes_each : float
        The least that each takes.
    remedy : str
        What to do.

    Raises
    ------
    StudyError
        They take more than is free.

    Examples
    --------
    >>> check_fits("runs", 10**15, 100.0, "run them in batches")
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: runs: 1,000,000,000,000,000 need 93132257.5 GiB of memory, ...

    """
    needed = count * bytes_each
    if needed > ALWAYS_BYTES and needed > (free := free_memory_bytes()):
        raise StudyError(
            f"{field}: {count:,} need {needed / 2**30:.1f} GiB of memory, but only "
            f"{free / 2**30:.1f} GiB are free; {remedy}"
        )


if sys.platform == "win32":

    def _machine_bytes() -> float:
        import ctypes

        class MemoryStatus(ctypes.Structure):
            """MEMORYSTATUSEX of the Windows API."""

            _fields_ = (
                ("length", ctypes.c_uint32),
                ("load_percent", ctypes.c_uint32),
                ("total", ctypes.c_uint64),
                ("free", ctypes.c_uint64),
                ("rest", ctypes.c_uint64 * 5),
            )

        status = MemoryStatus(length=ctypes.sizeof(MemoryStatus))
        found = ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))
        return float(status.free) if found else math.inf

    def _process_bytes() -> float:
        return math.inf

else:

    def _machine_bytes() -> float:
        """Return what Linux says is available; elsewhere, all memory that there is."""
        for line in _words(Path("/proc/meminfo"), "\n"):
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))

    def _process_bytes() -> float:
        """Return what the limit of the address space leaves."""
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit == resource.RLIM_INFINITY:
            return math.inf
        used = next(iter(_words(Path("/proc/self/statm"))), "0")
        return float(limit - int(used) * os.sysconf("SC_PAGE_SIZE"))


def group_bytes(root: Path) -> float:
    """Return what Linux control groups, of version 1 or 2, leave to this process.

    Parameters
    ----------
    root : Path
        The folder that ``proc`` and ``sys`` are in.

    Source: Linux kernel documentation, cgroup-v1/memory and cgroup-v2, memory interface files.
    """
    least = math.inf
    for line in _words(root / "proc/self/cgroup", "\n"):
        _, kinds, place = line.split(":", 2)
        if kinds not in ("", "memory"):
            continue
        top = root / "sys/fs/cgroup" / kinds
        limit, used = ("limit_in_bytes", "usage_in_bytes") if kinds else ("max", "current")
        folder = top / place.lstrip("/")
        for group in (folder, *folder.parents):
            if not group.is_relative_to(top):
                break
            most = _number(group / f"memory.{limit}")
            least = min(least, most - _number(group / f"memory.{used}") + _cache(group))
    return least


def _cache(group: Path) -> float:
    """Return the memory of a group that is only a cache of files, and is given back."""
    words = _words(group / "memory.stat")
    place = words.index("inactive_file") if "inactive_file" in words else None
    return 0.0 if place is None else float(words[place + 1])


def _number(path: Path) -> float:
    """Return the number in a file of the kernel; infinity where it says none."""
    word = next(iter(_words(path)), "max")
    return math.inf if word == "max" else float(word)


def _words(path: Path, separator: str | None = None) -> list[str]:
    try:
        return [word for word in path.read_text(encoding="ascii").split(separator) if word]
    except OSError:
        return []
