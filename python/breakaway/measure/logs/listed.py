"""A channel of a file as it is listed, before its values are read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ListedChannel:
    """What a log file says of one channel.

    Parameters
    ----------
    name : str
        Its name in the file, as a mapping takes it.
    unit : str
        The unit that the file states beside the name, empty for none.
    type : str
        The type of its numbers there.
    samples : int, optional
        How many, where that is known without reading them.
    rate_hz, start_s : float, optional
        Rate and first stamp of stamps of its own, where the file states them.
    has_stamps : bool
        Whether it has stamps of its own.
    unreadable : str
        Why it cannot be read; empty where it can, as far as is known before it is.

    """

    name: str
    unit: str = ""
    type: str = ""
    samples: int | None = None
    rate_hz: float | None = None
    start_s: float | None = None
    has_stamps: bool = False
    unreadable: str = ""
