"""A row of the reproduction: what is printed, what we get, and whether they agree."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Row:
    """One printed figure beside ours."""

    key: str
    """Dotted name, such as ``table2.without_vibration.static.kp``."""
    what: str
    """What it is, in words."""
    printed: float | str | None
    """The figure in the paper; None where it prints none."""
    ours: float | str | None
    """Ours, in the same unit; None where there is none."""
    unit: str
    """The unit of both."""
    agrees: bool | None
    """Whether they agree; None where the paper prints nothing to agree with."""
    reason: str
    """The measure of agreement, or why they differ."""
    decimals: int = 0
    """Decimal places of the printed number."""

    def to_dict(self) -> dict[str, object]:
        """Plain values, without the key."""
        values = asdict(self)
        del values["key"]
        return values


def printed_row(key: str, what: str, printed: str, ours: float, unit: str, reason: str) -> Row:
    """Compare with a printed number: it agrees within one unit of its last printed digit."""
    decimals = len(printed.partition(".")[2])
    last_digit = 10.0**-decimals
    agrees = abs(ours - float(printed)) <= last_digit
    measure = f"within {last_digit:g}, the last printed digit"
    reason = measure if agrees else reason
    return Row(key, what, float(printed), ours, unit, agrees, reason, decimals)
