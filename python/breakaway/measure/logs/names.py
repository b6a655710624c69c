"""What the header of a file says: which column is which channel, in which unit."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass

from breakaway.measure.logs.raw import RawFile
from breakaway.measure.logs.units import FileUnit, stated

WORDS = {
    "t": "t_s",
    "time": "t_s",
    "timestamp": "t_s",
    "x": "position_m",
    "pos": "position_m",
    "position": "position_m",
    "displacement": "position_m",
    "f": "force_n",
    "force": "force_n",
    "friction_force": "force_n",
    "outside_force": "outside_force_n",
    "friction": "friction_n",
    "normal_force": "normal_force_n",
    "ref": "reference_m",
    "reference": "reference_m",
    "setpoint": "reference_m",
    "v": "velocity_m_per_s",
    "velocity": "velocity_m_per_s",
    "a": "acceleration_m_per_s2",
    "acceleration": "acceleration_m_per_s2",
    "p": "pressure_pa",
    "pressure": "pressure_pa",
    "temp": "temperature_degc",
    "temperature": "temperature_degc",
}
"""What the name of a column begins with, in lower case -> channel. Other columns need a mapping."""

MOST_PARTS = max(word.count("_") + 1 for word in WORDS)
"""Most parts that a word has between its underscores."""

SECOND_CHOICE = {"friction_force": "friction_n"}
"""What a word means where another column gives its channel of `WORDS`."""


@dataclass(frozen=True)
class Stated:
    """A column whose name, or whose file, states which channel it is and in which unit."""

    name: str
    word: str
    channel: str
    unit: FileUnit


def read_headers(raw: RawFile) -> list[Stated]:
    """Return the columns that need no mapping, in the order of the file."""
    found = [item for name in raw.names if (item := read_header(name, file_unit(raw, name)))]
    first = {item.channel for item in found if item.word not in SECOND_CHOICE}
    return [
        Stated(item.name, item.word, SECOND_CHOICE[item.word], item.unit)
        if item.word in SECOND_CHOICE and item.channel in first
        else item
        for item in found
    ]


def file_unit(raw: RawFile, name: str) -> str:
    """Return the unit that the file itself states for a channel, or nothing."""
    return raw.listed[name].unit if name in raw.listed else ""


def read_header(name: str, unit: str = "") -> Stated | None:
    """Return what the name of a column states, or None where word or unit are unknown.

    Parameters
    ----------
    name : str
        Such as ``force_kN``, ``Force [kN]`` or ``Rig/Force (kN)``.
    unit : str
        The unit that the file states beside the name; where both do, they must agree.

    Examples
    --------
    >>> read_header("Rig/Pos [mm]").channel, read_header("force_mm"), read_header("force")
    ('position_m', None, None)

    """
    for what, symbol in _splits(name):
        channel = WORDS.get(what)
        if channel is None:
            continue
        known = {found for text in (unit, symbol) if text and (found := stated(text, channel))}
        if len(known) == 1:
            return Stated(name, what, channel, known.pop())
    return None


def _splits(name: str) -> list[tuple[str, str]]:
    """Return the ways to split a name into what it is and its unit, the longest unit first."""
    text, symbol = bracketed(re.sub(r"#\d+$", "", name))
    cased = re.split(r"[\s_.\-]+", re.split(r"[/.\\]", text.strip())[-1])
    parts = [part.lower() for part in cased]
    if symbol is not None:
        return [("_".join(parts), symbol)]
    most = min(len(parts), MOST_PARTS)
    ways = [("_".join(parts[:k]), "_".join(cased[k:])) for k in range(1, most + 1)]
    # `position_in` is more often the position at an inlet than one in inches.
    return [(what, unit) for what, unit in ways if unit.lower() != "in"]


def bracketed(name: str) -> tuple[str, str | None]:
    """Split off a unit in brackets at the end; None where there is none."""
    text = name.rstrip()
    start = max(text.rfind("["), text.rfind("("))
    unit = text[start + 1 : -1]
    if start < 0 or text[-1] not in "])" or "]" in unit or ")" in unit:
        return name, None
    return text[:start].rstrip(BLANKS), unit


BLANKS = " _\t\n\r\v\f"
"""What may stand between the name of a quantity and its unit."""

NEAREST_OF = 1000
"""Among how many names the nearest is looked for."""


def nearest(name: str, others: Iterable[str]) -> str | None:
    """Return the name that is most like another, if any is; long names are like none.

    >>> nearest("position_m", ["Time", "Position_mm"])
    'Position_mm'
    """
    short = itertools.islice((other for other in others if len(other) <= 80), NEAREST_OF)
    lower = {other.lower(): other for other in short}
    near = difflib.get_close_matches(name.lower()[:80], lower, n=1)
    return lower[near[0]] if near else None
