"""What ``--help`` says beside docstrings: examples, and lists of commands."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import typer


def add_command(
    app: typer.Typer, command: Callable[..., None], *examples: str, name: str | None = None
) -> None:
    """Add a command with examples; lists of commands show its first paragraph, whole."""
    summary = (command.__doc__ or "").split("\n\n")[0]
    app.command(name, short_help=summary, epilog=unwrapped("Examples", examples))(command)


def unwrapped(heading: str, lines: Sequence[str]) -> str:
    r"""Give lines that help does not wrap.

    Examples
    --------
    >>> unwrapped("Examples", ["breakaway presets"])
    '\x08\nExamples:\n  breakaway presets'

    """
    return "\n  ".join((f"\b\n{heading}:", *lines))
