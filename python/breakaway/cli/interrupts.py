"""Ctrl-C, also where a library loses the exception."""

from __future__ import annotations

import signal
from types import FrameType

_requested = False


def note_interrupts() -> None:
    """Let Ctrl-C, and a request to terminate, be remembered beside raising KeyboardInterrupt.

    Libraries in C or Rust drop what is raised inside a call they can do without, such as asking
    whether a value is an instance of an abstract class. Where Ctrl-C is ignored, it stays so.
    """
    signal.signal(signal.SIGTERM, _interrupt)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)


def raise_if_interrupted() -> None:
    """Raise what was requested and lost on the way.

    Raises
    ------
    KeyboardInterrupt
        It was requested.

    """
    if _requested:
        raise KeyboardInterrupt


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _requested
    _requested = True
    signal.default_int_handler(number, frame)
