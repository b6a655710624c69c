"""Names with units, and how their values read: ``peak_force_n`` = 601.3765 is 601.38 N."""

from __future__ import annotations

from math import floor, isfinite, log10

NOT_HAPPENED = "none"
"""How a value reads that is not a number: what it measures did not happen."""

# Suffix of a name -> unit, and whether prefixes are usual with it; the first match counts.
_UNITS = (
    ("_m_per_s2", "m/s²", True),
    ("_n_s_per_m", "N s/m", True),
    ("_n_per_m_s", "N/(m s)", True),
    ("_n_per_m", "N/m", True),
    ("_rad_per_s", "rad/s", False),
    ("_m_per_s", "m/s", True),
    ("_per_s", "1/s", False),
    ("_m2_s", "m² s", False),
    ("_m_s2", "m s²", True),
    ("_m_s", "m s", True),
    ("_n_s", "N s", True),
    ("_percent", "%", False),
    ("_kg", "kg", False),
    ("_hz", "Hz", True),
    ("_n", "N", True),
    ("_j", "J", True),
    ("_s", "s", True),
    ("_a", "A", True),
    ("_w", "W", True),
    ("_f", "F", True),
    ("_v", "V", True),
    ("_m", "m", True),
)
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
_SPELLING = {"iae": "IAE", "ise": "ISE", "itae": "ITAE", "rms": "RMS", "coulomb": "Coulomb"}


def split_unit(name: str) -> tuple[str, str]:
    """Split a name into words and unit.

    Examples
    --------
    >>> split_unit("rms_force_n"), split_unit("stiffness_n_per_m"), split_unit("impacts")
    (('RMS force', 'N'), ('stiffness', 'N/m'), ('impacts', ''))

    """
    stem, unit, _ = _matched(name)
    return " ".join(_SPELLING.get(word, word) for word in stem.split("_")), unit


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
    _, unit, prefixed = _matched(name)
    if not prefixed or value == 0.0 or not isfinite(value):
        return f"{value:.5g}", unit
    rounded = float(f"{value:.5g}")  # so that 999.999 counts as 1 k
    power = 3 * floor(log10(abs(rounded)) / 3)
    if unit in ("m", "s", "m s", "m s²", "m/s", "m/s²"):
        power = min(power, 0)  # nobody reads kiloseconds
    if power not in _PREFIXES:
        return f"{value:.5g}", unit
    return f"{rounded / 10.0**power:.5g}", _PREFIXES[power] + unit


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


def _matched(name: str) -> tuple[str, str, bool]:
    for suffix, unit, prefixed in _UNITS:
        if name.endswith(suffix):
            return name.removesuffix(suffix), unit, prefixed
    return name, "", False
