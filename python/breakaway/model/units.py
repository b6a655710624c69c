"""The one table of units: which unit a name states, its base units, and how its values read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import floor, log10

PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""Power of ten -> its prefix."""
_SPELLING = {
    "iae": "IAE",
    "ise": "ISE",
    "itae": "ITAE",
    "rms": "RMS",
    "coulomb": "Coulomb",
    "stribeck": "Stribeck",
}


@dataclass(frozen=True)
class Unit:
    """An SI unit."""

    symbol: str
    """As files have it, such as ``m/s^2``; ``1`` for a number without a unit."""
    base: Mapping[str, int] = field(default_factory=dict)
    """Exponents of its SI base units."""
    powers: tuple[int, int] = (-9, 9)
    """Smallest and largest power of ten among its usual prefixes."""

    @property
    def shown(self) -> str:
        """As people read it, such as ``m/s²``; nothing for a number without a unit."""
        return "" if self.symbol == "1" else self.symbol.replace("^2", "²")

    def prefixed(self, power: int) -> str:
        """As people read it with the prefix of a power of ten, such as ``mm/s²``."""
        return PREFIXES[power] + self.shown

    def power_of(self, size: float) -> int:
        """Give the power of ten whose prefix makes a value of this size easy to read.

        Parameters
        ----------
        size : float
            Magnitude of the value in SI units, > 0 and finite.

        Examples
        --------
        >>> unit_of("stroke_m").power_of(38e-6), unit_of("stroke_m").power_of(2000.0)
        (-6, 0)
        >>> unit_of("mass_kg").power_of(2000.0)
        0

        """
        smallest, largest = self.powers
        return max(smallest, min(3 * floor(log10(size) / 3), largest))


NO_UNIT = Unit("1", powers=(0, 0))
"""What a number has whose name states no unit."""
_AS_IT_IS = (0, 0)  # no prefix is usual
_SMALL = (-9, 0)  # nobody reads kiloseconds
UNITS = {
    "n_per_m_s": Unit("N/(m s)", {"kg": 1, "s": -3}),
    "n_s_per_m": Unit("N s/m", {"kg": 1, "s": -1}),
    "n_per_m": Unit("N/m", {"kg": 1, "s": -2}),
    "n_per_k": Unit("N/K", {"kg": 1, "m": 1, "s": -2, "K": -1}),
    "n_per_s": Unit("N/s", {"kg": 1, "m": 1, "s": -3}),
    "m_per_s2": Unit("m/s^2", {"m": 1, "s": -2}, _SMALL),
    "rad_per_s": Unit("rad/s", {"rad": 1, "s": -1}, _AS_IT_IS),
    "m_per_s": Unit("m/s", {"m": 1, "s": -1}, _SMALL),
    "per_s": Unit("1/s", {"s": -1}, _AS_IT_IS),
    "m2_s": Unit("m^2 s", {"m": 2, "s": 1}, _AS_IT_IS),
    "m_s2": Unit("m s^2", {"m": 1, "s": 2}, _SMALL),
    "n_m": Unit("N m", {"kg": 1, "m": 2, "s": -2}),
    "n_s": Unit("N s", {"kg": 1, "m": 1, "s": -1}),
    "m_s": Unit("m s", {"m": 1, "s": 1}, _SMALL),
    "m2": Unit("m^2", {"m": 2}, _AS_IT_IS),
    "rad": Unit("rad", {"rad": 1}, _SMALL),
    "percent": Unit("%", powers=_AS_IT_IS),
    "degc": Unit("degC", {"K": 1}, _AS_IT_IS),
    "kg": Unit("kg", {"kg": 1}, _AS_IT_IS),
    "hz": Unit("Hz", {"s": -1}),
    "pa": Unit("Pa", {"kg": 1, "m": -1, "s": -2}),
    "n": Unit("N", {"kg": 1, "m": 1, "s": -2}),
    "m": Unit("m", {"m": 1}, _SMALL),
    "s": Unit("s", {"s": 1}, _SMALL),
    "j": Unit("J", {"kg": 1, "m": 2, "s": -2}),
    "w": Unit("W", {"kg": 1, "m": 2, "s": -3}),
    "v": Unit("V", {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "k": Unit("K", {"K": 1}, _AS_IT_IS),
    "a": Unit("A", {"A": 1}),
    "f": Unit("F", {"kg": -1, "m": -2, "s": 4, "A": 2}),
}
"""What a name ends with after an underscore -> its unit; longer endings come first."""


def unit_of(name: str) -> Unit:
    """Return the unit that the name of a number states.

    Parameters
    ----------
    name : str
        A name, or a dotted path; numbers at its end count places and state nothing.

    Examples
    --------
    >>> unit_of("controller.rate_n_per_s").symbol, unit_of("window_m.3").symbol
    ('N/s', 'm')
    >>> unit_of("impacts").symbol, unit_of("acceleration_m_per_s2").shown
    ('1', 'm/s²')

    """
    return UNITS.get(_ending(_without_places(name)), NO_UNIT)


def without_unit(name: str) -> str:
    """Return a name without the unit that it states.

    Examples
    --------
    >>> without_unit("joint.stiffness_n_per_m"), without_unit("impacts")
    ('joint.stiffness', 'impacts')

    """
    ending = _ending(name)
    return name.removesuffix(f"_{ending}") if ending else name


def words_of(name: str) -> str:
    """Return a name in words, without the unit that it states.

    Examples
    --------
    >>> words_of("rms_force_n"), words_of("joint.stribeck_velocity_m_per_s")
    ('RMS force', 'joint.Stribeck velocity')

    """
    parts = without_unit(name).split(".")
    spelled = ([_SPELLING.get(word, word) for word in part.split("_")] for part in parts)
    return ".".join(" ".join(words) for words in spelled)


def unit_with(symbol: str) -> Unit:
    """Return the unit with a symbol, such as ``N s/m``.

    Raises
    ------
    KeyError
        No unit has it.

    Examples
    --------
    >>> unit_with("m").powers
    (-9, 0)

    """
    return _BY_SYMBOL[symbol]


def _without_places(name: str) -> str:
    while name.rpartition(".")[2].isdigit():
        name = name.rpartition(".")[0]
    return name


def _ending(name: str) -> str:
    return next((ending for ending in UNITS if name.endswith(f"_{ending}")), "")


_BY_SYMBOL = {unit.symbol: unit for unit in (*UNITS.values(), NO_UNIT)}
