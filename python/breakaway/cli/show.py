"""Showing results: tables for people, JSON for programs, on any terminal and in any pipe."""

from __future__ import annotations

import io
import json
import math
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from breakaway.base.text import terminal
from breakaway.cli.sheet import PIPED_WIDTH, Sheet, narrowest
from breakaway.cli.streams import told_failures


def say(*parts: str | Sheet) -> None:
    """Print text or tables: whole values always, colors and line breaks only on a terminal.

    Strings are plain text, without markup; what a terminal would obey is shown as an escape.

    Raises
    ------
    OutputError
        The standard output cannot be written to, such as on a full disk.

    Examples
    --------
    >>> say("peak force [N]")
    peak force [N]

    """
    collected = _Collected()
    console = _Console(file=collected, highlight=False)
    available = console.width if sys.stdout.isatty() else PIPED_WIDTH
    for part in parts:
        for shown in _pieces(part, available):
            # A word that is wider than the terminal is broken by the terminal.
            console.width = max(available, narrowest(shown))
            console.print(shown)
    _write("\n".join(line.rstrip() for line in collected.getvalue().split("\n")))


def _pieces(part: str | Sheet, width: int) -> Sequence[RenderableType]:
    return [Text(terminal(part))] if isinstance(part, str) else part.fitted(width)


def say_written(files: Sequence[Path]) -> None:
    """Print which files were written: one line, however many they are.

    Examples
    --------
    >>> say_written([Path("out/metrics.json")])
    wrote out/metrics.json
    >>> say_written([Path("out/metrics.json"), Path("out/trace.csv")])
    wrote 2 files to out/: metrics.json, trace.csv

    """
    if len(files) == 1:
        say(f"wrote {files[0]}")
    elif files:
        names = ", ".join(path.name for path in files)
        say(f"wrote {len(files)} files to {files[0].parent}{os.sep}: {names}")


def say_aside(sentence: str) -> None:
    """Print a sentence to the standard error, as plain as `say` does."""
    print(terminal(sentence), file=sys.stderr)


def say_json(content: object) -> None:
    """Print one JSON document; what is not finite becomes null.

    Examples
    --------
    >>> say_json({"time_to_release_s": float("nan")})
    {
      "time_to_release_s": null
    }

    """
    _write(json.dumps(plain(content), indent=2, allow_nan=False) + "\n")


def plain(content: object) -> Any:  # noqa: ANN401 - any JSON
    """Give what JSON can hold: None for what is not finite, [real, imaginary] for complex.

    Examples
    --------
    >>> plain({"poles_per_s": (complex(-1, 2),), "ki": float("inf")})
    {'poles_per_s': [[-1.0, 2.0]], 'ki': None}

    """
    if isinstance(content, complex):
        return [plain(content.real), plain(content.imag)]
    if isinstance(content, float):
        return content if math.isfinite(content) else None
    if isinstance(content, Mapping):
        return {str(key): plain(value) for key, value in content.items()}
    if isinstance(content, Sequence) and not isinstance(content, str):
        return [plain(value) for value in content]
    return content


@contextmanager
def busy(what: str) -> Iterator[None]:
    """Show on a terminal that something is computed; on the error stream, not in pipes."""
    if not sys.stderr.isatty():
        yield
        return
    with Console(stderr=True).status(Text(what)):
        yield


class _Collected(io.StringIO):
    """What will be written to the standard output; a terminal if that is one."""

    def isatty(self) -> bool:
        return sys.stdout.isatty()


class _Console(Console):
    """A console that draws with what the standard output's encoding has."""

    @property
    def encoding(self) -> str:
        return _encoding()


def _encoding() -> str:
    return (getattr(sys.stdout, "encoding", None) or "utf-8").lower()


def _write(text: str) -> None:
    encoding = _encoding()
    with told_failures():
        sys.stdout.write(_encodable(text, encoding))
        sys.stdout.flush()


def _encodable(text: str, encoding: str) -> str:
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return text.translate(_ASCII).encode(encoding, "replace").decode(encoding)
    return text


_ASCII = str.maketrans({"µ": "u", "²": "^2", "±": "+/-", "–": "-", "‖": "|"})
"""What stands for the signs of units where an old encoding lacks them."""
