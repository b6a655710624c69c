"""How much memory a log may take: what a file claims is asked before anything is unpacked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from breakaway.base.free_memory import free_memory_bytes
from breakaway.errors import LogError

SHARE = 0.5
"""Part of the free memory that a file may take where nothing is said: its log takes as much."""


@dataclass
class Budget:
    """The memory that one file may take, all its channels together.

    Examples
    --------
    >>> budget = Budget("motor.h5", 2**20)
    >>> budget.take("'force'", 800_000)
    >>> budget.take("'position'", 800_000)
    Traceback (most recent call last):
        ...
    breakaway.errors.LogError: motor.h5: with 'position' it takes 1.526 MiB of memory, ...

    """

    file: str
    """Name of the file, for errors."""

    most_bytes: float
    """How much it may take."""

    taken_bytes: float = 0.0
    """How much it takes so far."""

    @classmethod
    def of(cls, path: Path, most_bytes: float | None) -> Budget:
        """Give a file what it may take: what is said, or half of the free memory.

        Raises
        ------
        LogError
            ``most_bytes`` is not a number above 0.

        """
        if most_bytes is None:
            most_bytes = SHARE * free_memory_bytes()
        elif not 0.0 < most_bytes < math.inf:
            raise LogError(
                f"memory_bytes (--memory-gib): {most_bytes!r} is not a finite number > 0; leave it "
                "out for half of what is free"
            )
        return cls(path.name, most_bytes)

    def take(self, what: str, kept_bytes: float, passing_bytes: float = 0.0) -> None:
        """Ask for memory before it is taken.

        Parameters
        ----------
        what : str
            What it is for, in errors.
        kept_bytes : float
            What is held until the whole file is read.
        passing_bytes : float
            What is given back before the next is asked for.

        Raises
        ------
        LogError
            The file takes more than it may, or claims a negative number.

        """
        self.taken_bytes += kept_bytes
        needed = self.taken_bytes + passing_bytes
        if min(kept_bytes, passing_bytes) < 0.0 or not needed <= self.most_bytes:
            raise LogError(
                f"{self.file}: with {what} it needs {_size(needed)} of memory, more than the "
                f"{_size(self.most_bytes)} that it may take; it is damaged or too large: export "
                "the log in parts or with fewer channels, or allow more by "
                "memory_bytes= (--memory-gib)"
            )


def _size(count: float) -> str:
    """Say a number of bytes.

    >>> _size(3 * 2**30), _size(1000)
    ('3 GiB', '1000 bytes')
    """
    for unit, size in (("GiB", 2**30), ("MiB", 2**20), ("KiB", 2**10)):
        if count >= size:
            return f"{count / size:.4g} {unit}"
    return f"{count:.4g} bytes"
