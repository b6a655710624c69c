"""The units that names state."""

from __future__ import annotations

_UNITS = {
    "n_per_m_s": "N/(m s)",
    "n_s_per_m": "N s/m",
    "n_per_m": "N/m",
    "n_per_s": "N/s",
    "m_per_s2": "m/s2",
    "m_per_s": "m/s",
    "per_s": "1/s",
    "hz": "Hz",
    "kg": "kg",
    "n": "N",
    "m": "m",
    "s": "s",
    "v": "V",
    "a": "A",
    "f": "F",
}
"""What a name ends with, after an underscore -> its unit; the first counts, the longest."""


def unit_of(name: str) -> str:
    """Return the SI unit that the name of a number states, ``1`` where it states none.

    Examples
    --------
    >>> unit_of("controller.gains.ki_n_per_m_s"), unit_of("watch.reason"), unit_of("window_m.3")
    ('N/(m s)', '1', 'm')

    """
    parts = [part for part in name.split(".") if not part.isdigit()]
    last = parts[-1]
    endings = (unit for ending, unit in _UNITS.items() if f"_{last}".endswith(f"_{ending}"))
    return next(endings, "1")


BASE_UNITS: dict[str, dict[str, int]] = {
    "N/(m s)": {"kg": 1, "s": -3},
    "N s/m": {"kg": 1, "s": -1},
    "N/m": {"kg": 1, "s": -2},
    "N/s": {"kg": 1, "m": 1, "s": -3},
    "m/s2": {"m": 1, "s": -2},
    "m/s": {"m": 1, "s": -1},
    "1/s": {"s": -1},
    "Hz": {"s": -1},
    "kg": {"kg": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "m": {"m": 1},
    "s": {"s": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "A": {"A": 1},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
}
"""Unit -> the exponents of its SI base units."""
