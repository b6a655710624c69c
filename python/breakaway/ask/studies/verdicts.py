"""What several friction laws say of the same differences, and whether they agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.studies.agreement_disturbance import REDRAWN
from breakaway.ask.studies.statistics import clopper_pearson, median_interval

Array = NDArray[np.float64]
Row = dict[str, Any]
Direction = Literal["lower", "higher", "same", "undecided"]
Under = tuple[str, str]
"""A friction law, and how friction varies."""
REDRAWN_IN_TIME = "redrawn in time"
"""Names the disturbances that are drawn anew in time, together."""

ROUNDING = 1e-9
"""Relative difference up to which two numbers are the same."""


def direction_of(low: float | None, high: float | None, relevant: float) -> Direction:
    """Say which way a difference goes whose interval is known.

    Examples
    --------
    >>> direction_of(-3.0, -1.0, 0.0), direction_of(-3.0, -1.0, 2.0), direction_of(-1.0, 1.0, 2.0)
    ('lower', 'undecided', 'same')

    """
    if low is None or high is None:
        return "undecided"
    if high < -relevant:
        return "lower"
    if low > relevant:
        return "higher"
    return "same" if -relevant <= low and high <= relevant else "undecided"


def compared(
    before: Array, after: Array, confidence: float, relevant: float, *, certain: bool
) -> Row:
    """Give what the pairs of two columns show of their difference, which is not a number for some.

    Parameters
    ----------
    before, after : numpy.ndarray
        A value for each run, the same runs in both.
    confidence : float
        Of the intervals of the medians, by order statistics.
    relevant : float
        Difference up to which they count as the same.
    certain : bool
        Whether nothing was drawn, so that a difference is what it is.

    Examples
    --------
    >>> import numpy as np
    >>> row = compared(np.full(9, 4.0), np.full(9, 3.0), 0.95, 0.0, certain=False)
    >>> row["difference_high"], row["relative"], row["direction"]
    (-1.0, -0.25, 'lower')

    """
    both = np.isfinite(before) & np.isfinite(after)
    first, other = before[both], after[both]
    difference = other - first
    difference[np.abs(difference) <= ROUNDING * np.maximum(np.abs(first), np.abs(other))] = 0.0
    row: Row = {"pairs": len(difference)}
    row["first_value"] = float(np.median(first)) if len(first) else None
    row["other_value"] = float(np.median(other)) if len(other) else None
    row |= _interval("difference", difference, confidence, certain=certain)
    positive = len(first) > 0 and bool((first > 0.0).all())
    ratios = difference / first if positive else difference[:0]
    row |= _interval("relative", ratios, confidence, certain=certain)
    row["direction"] = direction_of(row["difference_low"], row["difference_high"], relevant)
    return row


def _interval(name: str, values: Array, confidence: float, *, certain: bool) -> Row:
    if not len(values):
        return {name: None, f"{name}_low": None, f"{name}_high": None}
    found = median_interval(values, confidence)
    low, high = (found.median, found.median) if certain else (found.low, found.high)
    return {name: found.median, f"{name}_low": low, f"{name}_high": high}


def compared_shares(
    before: Array, after: Array, confidence: float, relevant: float, *, certain: bool
) -> Row:
    """Give what pairs show of the difference of two shares.

    Of the pairs that differ, the share that differs one way has an interval of Clopper and
    Pearson; times the share of pairs that differ it is that of the difference. It excludes 0
    exactly where McNemar's exact test does. Where no pair differs, as many may as that leaves open.

    Parameters
    ----------
    before, after : numpy.ndarray
        1 for each run in which it happened, else 0, the same runs in both.
    confidence : float
        Of the interval.
    relevant : float
        Difference of the shares up to which they count as the same.
    certain : bool
        Whether nothing was drawn, so that a difference is what it is.

    Examples
    --------
    >>> import numpy as np
    >>> row = compared_shares(np.zeros(8), np.ones(8), 0.95, 0.0, certain=False)
    >>> row["difference"], round(row["difference_low"], 2), row["direction"]
    (1.0, 0.26, 'higher')

    """
    runs, gained = len(before), int((after > before).sum())
    differing = int((after != before).sum())
    difference = (2 * gained - differing) / runs
    low = high = difference
    if not certain and differing:
        share = differing / runs
        low, high = (
            share * (2.0 * end - 1.0) for end in clopper_pearson(gained, differing, confidence)
        )
    elif not certain:
        high = clopper_pearson(0, runs, confidence)[1]
        low = -high
    return {
        "pairs": runs,
        "first_value": float(before.mean()),
        "other_value": float(after.mean()),
        "difference": difference,
        "difference_low": low,
        "difference_high": high,
        **dict.fromkeys(("relative", "relative_low", "relative_high")),
        "direction": direction_of(low, high, relevant),
    }


def verdict_of(directions: Mapping[Under, Direction]) -> str:
    """Say whether laws agree on which way a difference goes.

    ``agreed``: all say the same. ``only ...``: one law alone, or the laws with one disturbance
    alone, say that there is a difference; ``only redrawn in time``: those alone whose disturbance
    is drawn anew in time. ``contradicted``: some say lower and others higher, or some that there
    is a difference and others that there is none. ``undecided``: anything else.

    Parameters
    ----------
    directions : mapping
        Law and disturbance -> which way the difference goes.

    Examples
    --------
    >>> laws = [("lugre", "joint_force"), ("gms", "joint_force"), ("two_region", "joint_force")]
    >>> verdict_of(dict.fromkeys(laws, "lower"))
    'agreed'
    >>> verdict_of(dict(zip(laws, ["lower", "same", "undecided"])))
    'only lugre'
    >>> verdict_of(dict(zip(laws, ["lower", "lower", "higher"])))
    'contradicted'
    >>> verdict_of(dict(zip(laws, ["lower", "lower", "undecided"])))
    'undecided'

    """
    found = set(directions.values())
    if len(found) == 1 and "undecided" not in found:
        return "agreed"
    if {"lower", "higher"} <= found:
        return "contradicted"
    said = [under for under, direction in directions.items() if direction in ("lower", "higher")]
    alone = _alone([law for law, _ in said], [law for law, _ in directions])
    disturbances = [how for _, how in said], [how for _, how in directions]
    alone += _alone(*disturbances) or _redrawn_alone(*disturbances)
    if alone:
        return f"only {' with '.join(alone)}"
    return "contradicted" if said and "same" in found else "undecided"


def _alone(said: Sequence[str], asked: Sequence[str]) -> list[str]:
    """Give what alone said it, where more were asked."""
    return list(set(said)) if len(set(said)) == 1 < len(set(asked)) else []


def _redrawn_alone(said: Sequence[str], asked: Sequence[str]) -> list[str]:
    """Give the words for disturbances that are redrawn in time, where they alone said it."""
    alone = bool(said) and set(said) <= set(REDRAWN) and not set(asked) <= set(REDRAWN)
    return [REDRAWN_IN_TIME] if alone else []


def turns_on(directions: Mapping[Under, Direction]) -> list[str]:
    """Say on what a difference turns: on the law, on the disturbance, on both or on neither.

    It turns on one where the other is the same and two directions that are shown differ.

    Parameters
    ----------
    directions : mapping
        Law and disturbance -> which way the difference goes.

    Examples
    --------
    >>> cases = [(law, how) for law in ("lugre", "gms") for how in ("field", "none")]
    >>> turns_on(dict(zip(cases, ["lower", "same", "lower", "same"])))
    ['disturbance']
    >>> turns_on(dict(zip(cases, ["lower", "undecided", "same", "undecided"])))
    ['law']

    """
    shown = {under: way for under, way in directions.items() if way != "undecided"}
    pairs = [(a, b) for a, b in combinations(shown, 2) if shown[a] != shown[b]]
    found = []
    if any(one[1] == other[1] for one, other in pairs):
        found.append("law")
    if any(one[0] == other[0] for one, other in pairs):
        found.append("disturbance")
    return found


def conclusion_of(rows: Sequence[Row]) -> Row:
    """Sum up what the laws say of one difference.

    Parameters
    ----------
    rows : sequence of dict
        One for each law and disturbance, as from `compared`, with ``law`` and ``disturbance``.

    """
    directions: dict[Under, Direction] = {_under(row): row["direction"] for row in rows}
    verdict = verdict_of(directions)
    disturbances = list(dict.fromkeys(how for _, how in directions))
    parts = {
        f"verdict_{how}": verdict_of({u: d for u, d in directions.items() if u[1] == how})
        for how in disturbances
    }
    ways = [way for way in directions.values() if way in ("lower", "higher")]
    return {
        **{name: rows[0][name] for name in ("other", "first", "quantity")},
        "verdict": verdict,
        "direction": _common(ways or list(directions.values())),
        "said_by": ", ".join(
            _named(row, disturbances) for row in rows if row["direction"] in ("lower", "higher")
        ),
        **(parts if len(disturbances) > 1 else {}),
        "turns_on": ", ".join(turns_on(directions)),
        "shown_by_all": _shown_by_all(rows) if verdict == "agreed" else None,
    }


def _under(row: Row) -> Under:
    return row["law"], row["disturbance"]


def _common(ways: Sequence[Direction]) -> str:
    return ways[0] if len(set(ways)) == 1 else "mixed"


def _named(row: Row, disturbances: Sequence[str]) -> str:
    return f"{row['law']} with {row['disturbance']}" if len(disturbances) > 1 else str(row["law"])


def _shown_by_all(rows: Sequence[Row]) -> float | None:
    """Give the difference that every law shows at least: the bound next to 0 of the least sure."""
    if rows[0]["direction"] == "lower":
        return float(max(row["difference_high"] for row in rows))
    if rows[0]["direction"] == "higher":
        return float(min(row["difference_low"] for row in rows))
    return None


def in_words(conclusion: Row, rows: Sequence[Row]) -> str:
    """Say a conclusion in a sentence.

    Parameters
    ----------
    conclusion : dict
        As from `conclusion_of`.
    rows : sequence of dict
        What it sums up.

    """
    several = len({row["disturbance"] for row in rows}) > 1
    names = [_named(row, ["", ""] if several else [""]) for row in rows]
    said = [f"{name} {_size(row)}" for name, row in zip(names, rows, strict=True)]
    parts = [
        f"{name.removeprefix('verdict_')} {value}"
        for name, value in conclusion.items()
        if name.startswith("verdict_")
    ]
    verdict, claim = conclusion["verdict"], _claim(conclusion)
    flag = ""
    if verdict.startswith("only"):
        flag = ", and nothing else that was asked shows it: it may be a property of this model only"
    if several and "disturbance" in conclusion["turns_on"]:
        flag += "; it turns on how friction varies"
    by = f" ({'; '.join(parts)})" if parts else ""
    return f"{verdict}{by}: {claim}{flag} [{', '.join(said)}]"


def _claim(conclusion: Row) -> str:
    """Say what is concluded, or what is left open."""
    other, first, quantity = (conclusion[name] for name in ("other", "first", "quantity"))
    way = conclusion["direction"]
    open_ = conclusion["verdict"] in ("undecided", "contradicted")
    if quantity == "released":
        words = {"lower": "releases less often than", "higher": "releases more often than"}
        words |= {"same": "releases as often as"}
        text = f"{other} {words.get(way, 'releases more or less often than')} {first}"
    else:
        words = {"lower": "a lower", "higher": "a higher", "same": "the same"}
        than = "as" if way == "same" else "than"
        text = f"{other} has {words.get(way, 'a lower or higher')} {quantity} {than} {first}"
    return f"whether {text}" if open_ else text


def _size(row: Row) -> str:
    """Say how large a difference is under a law, and mark what is not shown."""
    value, low, high, unit = row["difference"], row["difference_low"], row["difference_high"], ""
    if value is None:
        return "no pairs"
    if row["relative"] is not None or row["quantity"] == "released":
        name = "difference" if row["quantity"] == "released" else "relative"
        value, low, high = (
            None if row[f"{name}{end}"] is None else 100.0 * row[f"{name}{end}"]
            for end in ("", "_low", "_high")
        )
        unit = " %"
    text = f"{value:+.3g}{unit}"
    if low is not None and low != high:
        text += f" ({low:+.3g} to {high:+.3g})"
    return text if row["direction"] != "undecided" else f"{text}, not shown"
