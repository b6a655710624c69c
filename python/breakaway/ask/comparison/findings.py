"""What a comparison shows, in sentences; what holds only under some friction laws is flagged."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from breakaway.ask.comparison.asked import Asked
from breakaway.ask.comparison.table import CRITERIA, Trials, paired, rank
from breakaway.ask.studies.plan import Row

SURE = 0.05
"""Chance, over all pairs and laws, that a difference is called clear where there is none."""
GENTLE_ENOUGH = 0.95
"""Share of gentle extractions below which it is said what fails a method."""
WORDS = {"gentle": "gently", "strict": "within the strict limits"}
CRITERION_WORDS = {
    "force": "the peak force",
    "jump": "the jump",
    "velocity": "the release velocity",
}

Verdicts = dict[tuple[str, str], dict[str, int]]
"""Two methods -> law -> 1 where the first is clearly gentler, -1 the second, 0 neither."""


def sentences_of(asked: Asked, trials: Trials, rows: Sequence[Row]) -> list[str]:
    """Say what was found: the gentlest, why the others fail, and what depends on the law."""
    return [
        *_leading(asked, trials, rows, "gentle"),
        *_leading(asked, trials, rows, "strict"),
        *_changing(asked, trials),
        *_failing(asked, rows),
        *_left_behind(asked, rows),
        *_stopped(rows),
    ]


def notes_of(asked: Asked) -> list[str]:
    """Say what has to be known before the sentences are trusted."""
    pairs = len(asked.methods) * (len(asked.methods) - 1) // 2 * len(asked.laws)
    notes = [
        f"a part is freed gently if it is released and suffers at most {_limits(asked, 'gentle')}",
        f"the strict limits are {_limits(asked, 'strict')}",
    ]
    if pairs:
        notes.append(
            "a difference is called clear where McNemar's exact test on the same parts gives "
            f"p < {SURE / pairs:.2g}, which is {SURE:g} over {pairs} pairs"
        )
    if len(asked.laws) == 1:
        notes.append(
            f"all of this holds under the law {asked.laws[0]} alone; name more laws to see what "
            "remains"
        )
    return notes


def _limits(asked: Asked, name: str) -> str:
    limits = getattr(asked.population, name)
    return (
        f"{limits.peak_over_breakaway_max:g} times its breakaway force, jumps of "
        f"{1e3 * limits.jump_max_m:g} mm and {limits.release_velocity_max_m_per_s:g} m/s at release"
    )


def verdicts_of(asked: Asked, trials: Trials, name: str) -> Verdicts:
    """Judge every pair of methods under every law, by the parts that only one of them spares."""
    pairs = list(combinations(asked.names, 2))
    allowed = SURE / max(1, len(pairs) * len(asked.laws))
    verdicts: Verdicts = {}
    for one, other in pairs:
        for law in asked.laws:
            ours, theirs, p = paired(trials[law][one], trials[law][other])[name]
            sign = (ours > theirs) - (ours < theirs)
            verdicts.setdefault((one, other), {})[law] = sign if p < allowed else 0
    return verdicts


def _leading(asked: Asked, trials: Trials, rows: Sequence[Row], name: str) -> list[str]:
    """Say which methods no other is clearly better than, by law."""
    if len(asked.methods) < 2:
        return []
    verdicts = verdicts_of(asked, trials, name)
    leaders: dict[str, tuple[str, ...]] = {}
    for law in asked.laws:
        of_law = sorted((r for r in rows if r["law"] == law), key=rank, reverse=True)
        best = max(of_law, key=lambda row: row[name])["method"]
        first = [r["method"] for r in of_law if not _beats(verdicts, best, r["method"], law)]
        leaders[law] = tuple(sorted(first, key=lambda m: m != best))
    shares = {(r["law"], r["method"]): r for r in rows}
    groups: dict[frozenset[str], list[str]] = {}
    for held, methods in leaders.items():
        groups.setdefault(frozenset(methods), []).append(held)
    said = [
        _leader_sentence(asked, leaders[laws[0]], laws, shares, name) for laws in groups.values()
    ]
    if len(groups) > 1:
        said.append(
            f"CAUTION: which method frees most parts {WORDS[name]} depends on the friction law; do "
            "not rely on one law"
        )
    return said


def _beats(verdicts: Verdicts, one: str, other: str, law: str) -> bool:
    if one == other:
        return False
    if (one, other) in verdicts:
        return verdicts[one, other][law] > 0
    return verdicts[other, one][law] < 0


def _leader_sentence(
    asked: Asked,
    methods: Sequence[str],
    laws: Sequence[str],
    shares: dict[tuple[str, str], Row],
    name: str,
) -> str:
    where = _under(asked, laws)
    if all(shares[law, method][name] == 0 for law in laws for method in methods):
        return f"no method frees any part {WORDS[name]} {where}"
    parts = [f"{m} ({_range([shares[law, m][f'{name}_share'] for law in laws])})" for m in methods]
    if len(methods) == 1:
        return f"{parts[0]} clearly frees most parts {WORDS[name]} {where}"
    if len(methods) == len(asked.methods):
        return (
            f"no method clearly frees more parts {WORDS[name]} than another {where}: "
            + _listing(parts)
        )
    return f"no method clearly frees more parts {WORDS[name]} than {_listing(parts)} {where}"


def _changing(asked: Asked, trials: Trials) -> list[str]:
    """Flag every pair whose order is clear under some laws and not the same under the others."""
    if len(asked.laws) < 2:
        return []
    said = []
    for (one, other), by_law in verdicts_of(asked, trials, "gentle").items():
        if len(set(by_law.values())) == 1:
            continue
        for first, second, sign in ((one, other, 1), (other, one, -1)):
            held = [law for law, verdict in by_law.items() if verdict == sign]
            turned = [law for law, verdict in by_law.items() if verdict == -sign]
            even = [law for law, verdict in by_law.items() if verdict == 0]
            if not held or (turned and sign < 0):
                continue
            but = [f"the other way round under {_listing(turned)}"] if turned else []
            but += [f"not clearly under {_listing(even)}"] if even else []
            only = "one law only" if len(held) == 1 else "some laws only"
            said.append(
                f"CAUTION, {only}: {first} is gentler than {second} under {_listing(held)}, "
                + " and ".join(but)
            )
    return said


def _failing(asked: Asked, rows: Sequence[Row]) -> list[str]:
    """Say, of each method that is not gentle enough, which limit most parts pass."""
    said = []
    for method in asked.names:
        of_method = [row for row in rows if row["method"] == method]
        if all(row["gentle_share"] >= GENTLE_ENOUGH for row in of_method):
            continue
        by_criterion: dict[str, list[Row]] = {}
        for row in of_method:
            by_criterion.setdefault(_failing_most(row), []).append(row)
        gentle = _range([row["gentle_share"] for row in of_method])
        parts = []
        for name, found in by_criterion.items():
            where = (
                "" if len(by_criterion) == 1 else f" under {_listing([r['law'] for r in found])}"
            )
            kept = _range([row[f"{name}_share"] for row in found])
            parts.append(
                f"{CRITERION_WORDS[name]}{where}, within its limit for {kept} of the parts"
            )
        said.append(
            f"{method} frees {gentle} gently; it fails most often because of {' and '.join(parts)}"
        )
    return said


def _failing_most(row: Row) -> str:
    return min(CRITERIA, key=lambda name: float(row[f"{name}_share"]))


def _left_behind(asked: Asked, rows: Sequence[Row]) -> list[str]:
    """Say which methods leave parts in place."""
    said = []
    for method in asked.names:
        of_method = [row for row in rows if row["method"] == method]
        left = [1.0 - row["released_share"] for row in of_method]
        if max(left) > 0.0:
            said.append(
                f"{method} leaves {_range(left)} of the parts in place after "
                f"{asked.population.duration_s:g} s"
            )
    return said


def _stopped(rows: Sequence[Row]) -> list[str]:
    return [
        f"the watch stopped {row['method']} on {row['stopped']} of {row['runs']} parts under "
        f"{row['law']}"
        for row in rows
        if row["stopped"]
    ]


def _under(asked: Asked, laws: Sequence[str]) -> str:
    if len(laws) == len(asked.laws) > 1:
        return "under every law"
    return f"under {_listing(laws)}"


def _listing(words: Sequence[str]) -> str:
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"


def _range(shares: Sequence[float]) -> str:
    """Give shares as percents, from the lowest to the highest."""
    low, high = (f"{100.0 * share:.4g}" for share in (min(shares), max(shares)))
    return f"{low} %" if low == high else f"{low} to {high} %"
