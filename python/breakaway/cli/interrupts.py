"""Ctrl-C, also where a library loses the exception."""

from __future__ import annotations

import signal
from types import FrameType

_requested = False


def note_interrupts() -> None:
    """Let Ctrl-C, and a request to terminate, be remembered beside raising KeyboardInterrupt.

    A terminal that is closed asks for it, too.
    Libraries in C or Rust drop what is raised inside a call they can do without, such as asking
    whether a value is an instance of an abstract class. Where Ctrl-C is ignored, it stays so.
    """
    signal.signal(signal.SIGTERM, _interrupt)
    for name, plain in (("SIGINT", signal.default_int_handler), ("SIGHUP", signal.SIG_DFL)):
        number = getattr(signal, name, None)  # no SIGHUP on Windows
        if number is not None and signal.getsignal(number) is plain:
            signal.signal(number, _interrupt)


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
