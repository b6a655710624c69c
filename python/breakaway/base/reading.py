"""Reading other people's files: regular ones only, no larger than they may be, in linear time.

Every file that a user names is opened here. A device, a pipe or a socket is refused before it is
opened, so nothing waits for it or sets it off.
"""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from collections.abc import Callable
from io import BufferedReader
from pathlib import Path
from typing import Any

from breakaway.base.text import shown, visible
from breakaway.errors import BreakawayError

MOST_TEXT_BYTES = 4 * 2**20
"""Most bytes of a TOML file: a joint file with all its draws has under 200 kB."""
MOST_WORDS = 100_000
"""Most keys, numbers and texts of a TOML file, all together."""
DEEPEST = 32
"""Most tables and lists within each other, and most parts of a dotted key."""
LONGEST_WORD = 400
"""Most characters of a TOML number or bare key."""

KINDS: tuple[tuple[Callable[[int], bool], str], ...] = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file to read its bytes; a link to one is followed.

    Raises
    ------
    FileNotFoundError
        There is nothing at this path.
    OSError
        It is not a regular file, or cannot be read; the text of the error says which.

    """
    _check_regular(os.stat(path).st_mode)  # noqa: PTH116 - a device is not to be opened at all
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags)
    try:
        _check_regular(os.fstat(descriptor).st_mode)  # it may have been exchanged since
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def _check_regular(mode: int) -> None:
    if not stat.S_ISREG(mode):
        kind = next((name for is_kind, name in KINDS if is_kind(mode)), "something else")
        raise OSError(f"is {kind}, not a file; give the path of a regular file")


# Methods of Path raise where a name is too long, or a folder on the way cannot be looked into; for
# these there is nothing, and whatever opens or writes the place then says why it cannot.


def is_there(path: Path) -> bool:
    """Whether there is something at a path."""
    return os.path.exists(path)  # noqa: PTH110


def is_file(path: Path) -> bool:
    """Whether there is a regular file, or a link to one, at a path."""
    return os.path.isfile(path)  # noqa: PTH113


def is_folder(path: Path) -> bool:
    """Whether there is a folder, or a link to one, at a path."""
    return os.path.isdir(path)  # noqa: PTH112


def is_link(path: Path) -> bool:
    """Whether there is a symbolic link at a path."""
    return os.path.islink(path)  # noqa: PTH114


def read_text(path: Path, most_bytes: int = MOST_TEXT_BYTES) -> str:
    """Read a UTF-8 text of limited size.

    Raises
    ------
    FileNotFoundError
        There is nothing at this path.
    OSError
        It is not a regular file, or cannot be read.
    ValueError
        It is larger than ``most_bytes``, or not UTF-8.

    """
    with open_regular(path) as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise ValueError(f"has more than {most_bytes} bytes, the limit")
    return content.decode("utf-8")


def parse_toml(text: str) -> dict[str, Any]:
    r"""Parse TOML of limited depth, and limited number and length of words.

    Raises
    ------
    ValueError
        It is not TOML, or goes beyond a limit; the text of the error says which, and where.

    Examples
    --------
    >>> parse_toml("[part]\nmass_kg = 1.5")
    {'part': {'mass_kg': 1.5}}
    >>> parse_toml("a" + ".a" * 40 + " = 1")
    Traceback (most recent call last):
        ...
    ValueError: line 1: a key of more than 32 parts; make it shorter

    """
    _check_limits(text)
    try:
        values = tomllib.loads(text)
        _check_keys(values)
    except RecursionError:  # not to be had within the limits
        raise ValueError("tables or lists are nested too deeply") from None
    return values


def _check_keys(value: object) -> None:
    """Refuse keys that a quoted one may be: of many lines, with control characters, without end."""
    if isinstance(value, list):
        for inner in value:
            _check_keys(inner)
    if not isinstance(value, dict):
        return
    for key, inner in value.items():
        if visible(key) != key or len(key) > LONGEST_WORD:
            raise ValueError(
                f"key {shown(key)}: has control characters, or more than {LONGEST_WORD} characters"
            )
        _check_keys(inner)


_TOKEN = re.compile(
    r'(?P<text>"""(?:[^"\\]++|\\.|"(?!""))*+"{3,5}'
    r"|'''(?:[^']++|'(?!''))*+'{3,5}"
    r'|(?!""")"(?:[^"\\\n]++|\\.)*+"'
    r"|(?!''')'[^'\n]*+')"
    r"|(?P<open>\"\"\"|''')"
    r"|(?P<comment>\#[^\n]*+)"
    r"|(?P<word>[^\s\[\]{}=,\#\"'.]++)"
    r"|(?P<mark>[\[\]{}=,.\n])",
    re.DOTALL,
)
"""The pieces of TOML that count here; blanks, and what is no TOML, lie between them."""


def _check_limits(text: str) -> None:
    """Refuse what would take a parser of TOML long, or deep recursion; one pass, linear time."""
    depth = words = dots = 0
    line = 1
    for token in _TOKEN.finditer(text):
        piece, over = token[0], ""
        match piece:
            case "\n":
                line, dots = line + 1, 0
            case "[" | "{":
                depth, dots = depth + 1, 0
                if depth > DEEPEST:
                    over = f"more than {DEEPEST} nested tables or lists"
            case "]" | "}":
                depth, dots = depth - 1, 0
            case ".":
                dots += 1
                if dots >= DEEPEST:
                    over = f"a key of more than {DEEPEST} parts"
            case "=" | ",":
                dots = 0
            case _ if token.lastgroup == "word" and len(piece) > LONGEST_WORD:
                over = f"a number or key of more than {LONGEST_WORD} characters"
            case _ if token.lastgroup == "open":
                over = "a text that is not closed"
            case _:
                line += piece.count("\n")
                words += 1
                if words > MOST_WORDS:
                    over = f"more than {MOST_WORDS} keys, numbers and texts"
        if over:
            raise ValueError(f"line {line}: {over}; make it shorter")


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file: `read_text`, then `parse_toml`.

    Raises
    ------
    FileNotFoundError
        There is nothing at this path.
    OSError, ValueError
        It cannot be read, is not TOML, or goes beyond a limit.

    """
    return parse_toml(read_text(path))


def text_of(
    path: Path,
    kind: type[BreakawayError],
    missing: str = "there is no such file; check the path",
) -> str:
    """Return the text of a TOML file; what is wrong becomes an error of the kind given.

    Parameters
    ----------
    path : Path
        The file.
    kind : type
        Class of the error.
    missing : str
        What the error says where there is nothing at this path.

    Raises
    ------
    BreakawayError
        Of the kind given: there is no such file, it is not a regular file, cannot be read, is too
        large, is not UTF-8, or starts with a byte order mark.

    """
    try:
        text = read_text(path)
    except FileNotFoundError:
        raise kind(f"{path}: {missing}") from None
    except (OSError, ValueError) as error:
        raise kind(f"{path}: cannot be read as text: {why(error)}") from None
    if text.startswith("\ufeff"):
        raise kind(f"{path}: starts with a byte order mark; save it as plain UTF-8")
    return text


def why(error: OSError | ValueError) -> str:
    """Say what is wrong, without the path that the system adds."""
    return getattr(error, "strerror", None) or str(error)


def table_of(text: str, source: object, kind: type[BreakawayError]) -> dict[str, Any]:
    """Parse TOML; what is wrong becomes an error of the kind given, which names the source.

    Raises
    ------
    BreakawayError
        Of the kind given: it is not TOML, or goes beyond a limit of `parse_toml`.

    """
    try:
        return parse_toml(text)
    except ValueError as error:
        raise kind(f"{source}: is not TOML: {error}") from None


def read_json(path: Path, most_bytes: int) -> Any:  # noqa: ANN401 - any JSON
    """Read a JSON file of limited size.

    Raises
    ------
    FileNotFoundError
        There is nothing at this path.
    OSError, ValueError
        It cannot be read, is larger than ``most_bytes``, or not JSON.

    """
    try:
        return json.loads(read_text(path, most_bytes))
    except RecursionError:
        raise ValueError("lists are nested too deeply") from None
