"""Units of the numbers in a file, and the units that names of channels state."""

from __future__ import annotations

import re
from dataclasses import dataclass

from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.model.units import UNITS, unit_of


@dataclass(frozen=True)
class FileUnit:
    """A unit of a file: SI value = factor * value + offset."""

    symbol: str
    dimension: str
    factor: float
    offset: float = 0.0


_FACTORS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "in": 0.0254},
    "speed": {"m/s": 1.0, "mm/s": 1e-3, "um/s": 1e-6, "in/s": 0.0254},
    "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e-3, "g": 9.80665},
    "force": {
        "N": 1.0,
        "mN": 1e-3,
        "daN": 10.0,
        "uN": 1e-6,
        "kN": 1e3,
        "MN": 1e6,
        "lbf": 4.4482216152605,
        "kgf": 9.80665,
    },
    "pressure": {
        "Pa": 1.0,
        "mPa": 1e-3,
        "hPa": 1e2,
        "kPa": 1e3,
        "MPa": 1e6,
        "mbar": 1e2,
        "bar": 1e5,
        "psi": 6894.757293168361,
    },
    "voltage": {"V": 1.0, "mV": 1e-3, "uV": 1e-6, "kV": 1e3},
    "current": {"A": 1.0, "mA": 1e-3, "uA": 1e-6},
    "torque": {"N m": 1.0, "mN m": 1e-3, "kN m": 1e3, "lbf in": 0.1129848290276167},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": 0.017453292519943295, "rev": 6.283185307179586},
    "ratio": {"1": 1.0, "%": 1e-2},
}

_UNITS = [
    *(
        FileUnit(symbol, dimension, factor)
        for dimension, units in _FACTORS.items()
        for symbol, factor in units.items()
    ),
    FileUnit("degC", "temperature", 1.0),
    FileUnit("K", "temperature", 1.0, -273.15),
]

_SPELLINGS = {
    "s": ("sec", "second", "seconds", "sekunde", "sekunden"),
    "ms": ("msec", "millisecond", "milliseconds", "millisekunden"),
    "us": ("usec", "microsecond", "microseconds", "mikrosekunden"),
    "min": ("minute", "minutes", "minuten"),
    "h": ("hr", "hour", "hours", "stunden"),
    "m": ("meter", "meters", "metre", "metres"),
    "mm": ("millimeter", "millimeters", "millimetre", "millimetres"),
    "um": ("micron", "microns", "micrometer", "micrometers", "mikrometer"),
    "in": ("inch", "inches"),
    "mm/s": ("mm/sec",),
    "N": ("newton", "newtons"),
    "kN": ("kilonewton", "kilonewtons"),
    "lbf": ("lb", "lbs", "pound", "pounds"),
    "deg": ("degree", "degrees", "grad"),
    "degC": ("celsius",),
    "V": ("volt", "volts"),
    "A": ("ampere", "amperes", "amps"),
}
"""Symbol -> other words for it in headers, in lower case."""

_WORDS = {word: symbol for symbol, words in _SPELLINGS.items() for word in words}

_DIMENSIONS = {
    unit.symbol: unit.dimension for unit in _UNITS if unit.factor == 1.0 and not unit.offset
}
"""Unit in which channels are kept -> what it measures."""
_ENDINGS = [ending for ending, unit in UNITS.items() if unit.symbol in _DIMENSIONS] + ["1"]
"""What the name of a channel may end with, after an underscore."""


def dimension_of(channel: str) -> str:
    """Return the dimension that the name of a channel states.

    Raises
    ------
    LogError
        The name is not lower case with a unit at its end.

    Examples
    --------
    >>> dimension_of("velocity_m_per_s")
    'speed'

    """
    symbol = si_symbol(channel)
    states = symbol in _DIMENSIONS and (symbol != "1" or channel.endswith("_1"))
    if states and re.fullmatch(r"[a-z][a-z0-9_]*", channel):
        return _DIMENSIONS[symbol]
    raise LogError(
        f"channel '{channel}': the name does not end with its unit; it must be lower case and "
        f"end with one of {', '.join('_' + ending for ending in _ENDINGS)}, such as position_m"
    )


def si_symbol(channel: str) -> str:
    """Return the unit in which a channel is kept, such as ``N`` for ``force_n``."""
    return unit_of(channel).symbol


def unit_named(symbol: str, channel: str) -> FileUnit:
    """Return the unit that a symbol means for a channel.

    Raises
    ------
    LogError
        No unit has this symbol, or it measures something other than the channel.

    Examples
    --------
    >>> unit_named("µm", "position_m").factor
    1e-06
    >>> unit_named("mm", "force_n")
    Traceback (most recent call last):
        ...
    breakaway.errors.LogError: channel 'force_n': the unit 'mm' measures length, not force; it \
must be one of N, mN, daN, uN, kN, MN, lbf, kgf

    """
    dimension = dimension_of(channel)
    known = ", ".join(u.symbol for u in _UNITS if u.dimension == dimension)
    text = plain(_WORDS.get(symbol.lower(), symbol))
    found = next((u for u in _UNITS if plain(u.symbol) == text), None)
    if found is None:
        raise LogError(
            f"channel '{channel}': the unit '{brief(symbol)}' is unknown; it must be one of "
            f"{known}; for any other unit, give the SI value of 1 as `scale`"
        )
    if found.dimension != dimension:
        raise LogError(
            f"channel '{channel}': the unit '{brief(symbol)}' measures {found.dimension}, not "
            f"{dimension}; it must be one of {known}"
        )
    return found


def is_unit(text: str) -> bool:
    """Whether a text is a known unit.

    Examples
    --------
    >>> is_unit("kN"), is_unit("Millimeters"), is_unit("kn"), is_unit("Force")
    (True, True, False, False)

    """
    symbol = plain(_WORDS.get(text.lower(), text))
    return any(plain(unit.symbol) == symbol for unit in _UNITS)


def stated(symbol: str, channel: str) -> FileUnit | None:
    """Return the unit that a header or a file states for a channel, or None.

    Upper and lower case count where they tell units apart (mN, MN), else they do not. None
    stands for no such unit of the channel's dimension, and for one that is not certain.

    Examples
    --------
    >>> stated("KN", "force_n").symbol, stated("mn", "force_n"), stated("m_s", "velocity_m_per_s")
    ('kN', None, FileUnit(symbol='m/s', dimension='speed', factor=1.0, offset=0.0))

    """
    text = plain(symbol.replace("_per_", "/").replace("_", "/"))
    text = plain(_WORDS.get(text.lower(), text))
    units = [u for u in _UNITS if u.dimension == dimension_of(channel)]
    exact = [u for u in units if plain(u.symbol) == text]
    found = exact or [u for u in units if plain(u.symbol).lower() == text.lower()]
    return found[0] if len(found) == 1 else None


def plain(symbol: str) -> str:
    """Return one spelling for all: ``m/s²``, ``m/s^2`` and ``m / s2`` are ``m/s2``."""
    text = symbol.replace("\N{GREEK SMALL LETTER MU}", "u").replace("\N{MICRO SIGN}", "u")
    text = text.replace("²", "2").replace("°", "deg")
    return re.sub(r"[\s^*]", "", text)
