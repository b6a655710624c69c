"""Names with units, and how their values read: ``peak_force_n`` = 601.3765 is 601.38 N."""

from __future__ import annotations

from math import floor, isfinite, log10

from breakaway.model.units import unit_of, words_of

NOT_HAPPENED = "none"
"""How a value reads that is not a number: what it measures did not happen."""


def split_unit(name: str) -> tuple[str, str]:
    """Split a name into words and unit.

    Examples
    --------
    >>> split_unit("rms_force_n"), split_unit("stiffness_n_per_m"), split_unit("impacts")
    (('RMS force', 'N'), ('stiffness', 'N/m'), ('impacts', ''))

    """
    return words_of(name), unit_of(name).shown


def show_value(name: str, value: float | None) -> tuple[str, str]:
    """Give a value and its unit, with a prefix that makes the value easy to read.

    Examples
    --------
    >>> show_value("peak_force_n", 601.3765), show_value("iae_m_s", 3.03613e-6)
    (('601.38', 'N'), ('3.0361', 'µm s'))
    >>> show_value("kp_n_per_m", -27.2e6), show_value("impacts", 12.0)
    (('-27.2', 'MN/m'), ('12', ''))
    >>> show_value("time_to_release_s", float("nan"))
    ('none', '')

    """
    if value is None or value != value:
        return NOT_HAPPENED, ""
    unit = unit_of(name)
    rounded = float(f"{value:.5g}")  # so that 999.999 counts as 1 k
    if not 1e-9 <= abs(rounded) < 1e12:  # zero, or beyond all prefixes
        return f"{value:.5g}", unit.shown
    power = unit.power_of(abs(rounded))
    return f"{rounded / 10.0**power:.5g}", unit.prefixed(power)


def show(name: str, value: float | None) -> str:
    """Give a value with its unit as one text.

    Examples
    --------
    >>> show("stiffness_n_per_m", 3.6e7)
    '36 MN/m'

    """
    return " ".join(part for part in show_value(name, value) if part)


def show_digits(value: float) -> str:
    """Give a value with five digits, thousands apart, for columns that share one unit.

    Examples
    --------
    >>> show_digits(12.8e6), show_digits(-3137.31), show_digits(0.0046261), show_digits(1e-9)
    ('12,800,000', '-3,137.3', '0.0046261', '1e-09')

    """
    if value == 0.0 or not isfinite(value) or not 1e-4 <= abs(value) < 1e12:
        return f"{value:.5g}"
    places = max(0, 4 - floor(log10(float(f"{abs(value):.5g}"))))
    text = f"{value:,.{places}f}"
    return text.rstrip("0").rstrip(".") if places else text


def show_uncertain(value: float, error: float) -> tuple[str, str]:
    """Give a value and its standard error, the error with two digits and the value to match.

    Examples
    --------
    >>> show_uncertain(95.10894, 0.12345), show_uncertain(203456.0, 1234.0)
    (('95.11', '0.12'), ('203500', '1200'))

    """
    if not (isfinite(error) and error > 0.0):
        return f"{value:.6g}", f"{error:.2g}"
    places = 1 - floor(log10(float(f"{error:.1e}")))
    if places > 9:
        return f"{value:.6g}", f"{error:.2g}"
    shown = max(places, 0)
    return f"{round(value, places):.{shown}f}", f"{round(error, places):.{shown}f}"
