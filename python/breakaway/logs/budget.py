"""How much memory a log may take: what a file claims is asked before anything is unpacked."""

from __future__ import annotations

import os
from dataclasses import dataclass

from breakaway.errors import LogError

SHARE = 0.5
"""Part of the free memory that a log may take, where nothing is said."""


def free_memory_bytes() -> int:
    """Return how much memory this process may still take."""
    return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


@dataclass
class Budget:
    """The memory that one file may take, all its channels together."""

    file: str
    """Name of the file, for errors."""

    most_bytes: float
    """How much it may take."""

    taken_bytes: float = 0.0
    """How much it has taken, or has claimed, so far."""

    def take(self, what: str, count: float) -> None:
        """Ask for some bytes before they are taken.

        Raises
        ------
        LogError
            The file takes more than it may, or claims a negative number.

        """
        self.taken_bytes += count
        if not 0.0 <= self.taken_bytes <= self.most_bytes or count < 0.0:
            raise LogError(
                f"{self.file}: with {what} it takes {self.taken_bytes / 2**20:,.0f} MiB of memory, "
                f"more than the {self.most_bytes / 2**20:,.0f} MiB that it may; it is damaged or "
                "too large: export the log in parts, with fewer channels, or allow more memory"
            )
