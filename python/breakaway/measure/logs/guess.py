"""A mapping guessed from the names and units of channels, in English and German."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import tomli_w

from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.names import bracketed
from breakaway.measure.logs.units import si_symbol, stated

WORDS: dict[str, tuple[str, ...]] = {
    "t_s": ("time", "zeit", "timestamp", "zeitstempel", "prüfzeit", "clock", "t"),
    "reference_m": ("reference", "setpoint", "ref", "soll", "sollwert", "sollweg", "demand"),
    "friction_n": ("friction", "reibkraft", "reibungskraft", "reibung"),
    "normal_force_n": ("normal force", "normalkraft"),
    "torque_n_m": ("torque", "drehmoment", "moment"),
    "angle_rad": ("angle", "winkel", "drehwinkel", "rotation"),
    "force_n": ("force", "kraft", "load", "load cell", "last", "kraftmessdose", "zugkraft", "f"),
    "position_m": (
        *("position", "pos", "displacement", "extension", "stroke", "travel", "encoder"),
        *("crosshead", "weg", "hub", "verschiebung", "traverse", "verlängerung", "x"),
    ),
    "velocity_m_per_s": ("velocity", "speed", "geschwindigkeit", "v"),
    "acceleration_m_per_s2": ("acceleration", "beschleunigung"),
    "pressure_pa": ("pressure", "druck", "p"),
    "temperature_degc": ("temperature", "temp", "temperatur"),
}
"""Channel -> what its name may be or end with. Those of more special channels stand first."""

SHORTEST_ENDING = 3
"""Letters of a word that may stand at the end of a longer one, as in Standardkraft."""

BY_UNIT = {"t_s": "time", "force_n": "force", "position_m": "length"}
"""Channels that a unit alone tells, where no name does."""

MOST_NOT_MAPPED = 100
"""How many names a comment lists."""


@dataclass(frozen=True)
class Guess:
    """A column that may be a channel; the unit is empty where nothing states it."""

    channel: str
    column: str
    unit: str


def guess(listed: Iterable[ListedChannel]) -> list[Guess]:
    """Return what columns are most likely which channels, one each.

    Examples
    --------
    >>> names = ["Zeit [s]", "Weg/mm", "Standardkraft in N", "Load"]
    >>> [(one.channel, one.unit) for one in guess(map(ListedChannel, names))]
    [('t_s', 's'), ('force_n', 'N'), ('position_m', 'mm')]

    """
    columns = [one for one in listed if not one.unreadable]
    words = {one.name: _words(one.name) for one in columns}
    found: dict[str, Guess] = {}
    taken: set[str] = set()
    for channel, known in WORDS.items():
        best = max(
            (one for one in columns if one.name not in taken),
            key=lambda one: _fit(channel, known, one, words[one.name]),
            default=None,
        )
        if best is not None and _fit(channel, known, best, words[best.name]) > 0:
            found[channel] = Guess(channel, best.name, unit_for(channel, best))
            taken.add(best.name)
    return list(found.values())


def _fit(channel: str, known: Sequence[str], one: ListedChannel, words: list[str]) -> int:
    """Say how well a column fits a channel: 0 where it does not."""
    text = " ".join(words)
    exact = text in known or any(word in known for word in words)
    ends = any(
        word.endswith(ending)
        for word in words
        for ending in known
        if len(ending) >= SHORTEST_ENDING
    )
    if not (exact or ends):
        return 0
    # A name of one letter says little without a unit.
    unit = unit_for(channel, one)
    if not unit and len(text) == 1 and channel != "t_s":
        return 0
    return 1 + 2 * exact + 4 * bool(unit)


def unit_for(channel: str, one: ListedChannel) -> str:
    """Return the unit that file or name state for a channel, or nothing.

    Examples
    --------
    >>> unit_for("force_n", ListedChannel("Kraft in kN")), unit_for("t_s", ListedChannel("t"))
    ('kN', '')

    """
    for text in (one.unit, *_unit_texts(one.name)):
        if text and (found := stated(text, channel)):
            return found.symbol
    return ""


def _unit_texts(name: str) -> list[str]:
    """Return what may be the unit in a name."""
    text, symbol = bracketed(name)
    if symbol is not None:
        return [symbol]
    after = re.split(r"\s+in\s+|/", name)
    last = re.split(r"[\s_]+", text.strip())
    return [after[-1].strip() if len(after) > 1 else "", last[-1] if len(last) > 1 else ""]


def _words(name: str) -> list[str]:
    text = bracketed(name)[0]
    return [word for word in re.split(r"[\W\d_]+", text.lower()) if word]


def mapping_text(file: str, listed: Sequence[ListedChannel], csv: Mapping[str, Any]) -> str:
    """Return a mapping in TOML for the channels of a file."""
    guesses = {one.channel: one for one in guess(listed)}
    clock = guesses.pop("t_s", None)
    parts = [f"# Guessed from the names and units in {file!a}: correct it by hand.\n"]
    if csv:
        parts.append("[csv]\n" + tomli_w.dumps(dict(csv)))
    columns = {one.name: one for one in listed}
    if clock and not all(columns[one.column].has_stamps for one in guesses.values()):
        parts.append("[time]\n" + _keys(clock))
    parts += [f"[channels.{one.channel}]\n{_keys(one)}" for one in guesses.values()]
    used = {one.column for one in guesses.values()} | ({clock.column} if clock else set())
    left = [one.name for one in listed if one.name not in used]
    if left:
        names = "".join(f"#   {name!a}\n" for name in left[:MOST_NOT_MAPPED])
        more = (
            f"#   and {len(left) - MOST_NOT_MAPPED} more\n" if len(left) > MOST_NOT_MAPPED else ""
        )
        parts.append(f"# Not mapped:\n{names}{more}")
    return "\n".join(parts)


def _keys(one: Guess) -> str:
    text = tomli_w.dumps({"from": one.column})
    if one.unit:
        return text + tomli_w.dumps({"unit": one.unit})
    return text + f'# unit = "{si_symbol(one.channel)}"  # the file states none\n'
