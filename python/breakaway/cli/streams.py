"""Standard output and error of the command: a reader that is gone, a full disk, none at all."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from breakaway.errors import OutputError


class ClosedOutput(Exception):  # noqa: N818 - an end, not an error
    """Whoever read the standard output has stopped reading, as ``head`` does."""

    exit_code = OutputError.exit_code


class Output(io.TextIOWrapper):
    """A standard output whose failures are errors of ours, whatever library writes to it."""

    def write(self, text: str, /) -> int:
        """Write a text; an empty one, by which libraries ask what a stream takes, goes nowhere."""
        if text == "":
            return 0
        with told_failures():
            return super().write(text)

    def flush(self) -> None:
        """Write what is held back."""
        with told_failures():
            super().flush()


class Aside(io.TextIOWrapper):
    """A standard error that may fail: the exit code still tells what happened."""

    def write(self, text: str, /) -> int:
        """Write a text, if it can be written."""
        with suppress(OSError):
            super().write(text)
        return len(text)

    def flush(self) -> None:
        """Write what is held back, if it can be written."""
        with suppress(OSError):
            super().flush()


def prepare_streams() -> None:
    """Let the standard streams fail as this module says; where the caller closed one, have one."""
    for name, kind in (("stdout", Output), ("stderr", Aside)):
        stream = getattr(sys, name)
        if stream is None:  # closed by the caller
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif type(stream) is io.TextIOWrapper:
            same = kind(
                stream.buffer,
                encoding=stream.encoding,
                errors=stream.errors,
                line_buffering=stream.line_buffering,
                write_through=stream.write_through,
            )
            setattr(sys, name, same)


@contextmanager
def told_failures() -> Iterator[None]:
    """Turn what goes wrong at the standard output into an end or an error.

    Raises
    ------
    ClosedOutput
        Its reader is gone.
    OutputError
        It cannot be written to, such as on a full disk.

    """
    try:
        yield
    except BrokenPipeError:
        _discard_output()
        raise ClosedOutput from None
    except OSError as error:
        _discard_output()
        reason = error.strerror or str(error)
        raise OutputError(f"standard output: cannot be written: {reason}") from None


def _discard_output() -> None:
    """Let the interpreter flush what is left into nothing when it exits."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
