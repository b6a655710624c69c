"""What a comparison shows, in sentences; what holds only in some cases is flagged."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from breakaway.ask.comparison.asked import Asked
from breakaway.ask.comparison.case_words import cases_in_words, listing
from breakaway.ask.comparison.table import CRITERIA, Trials, case_of, paired, rank
from breakaway.ask.comparison.training import training_sentences
from breakaway.ask.studies.plan import Row
from breakaway.ask.studies.statistics import fewest_pairs
from breakaway.model.scenario.variation import VARIATIONS
from breakaway.run.trials import Case

SURE = 0.05
"""Chance, over all pairs and cases, that a difference is called clear where there is none."""
GENTLE_ENOUGH = 0.95
"""Share of gentle extractions below which it is said what fails a method."""
WORDS = {"gentle": "gently", "strict": "within the strict limits"}
CAUSE_WORDS = {
    "force": "the peak force",
    "jump": "the jump",
    "velocity": "the release velocity",
    "released": "parts that stay in place",
}
KEPT_WORDS = {
    **dict.fromkeys(CRITERIA, "within its limit for"),
    "released": "which are all but",
}

Verdicts = dict[tuple[str, str], dict[Case, int]]
"""Two methods -> case -> 1 where the first is clearly gentler, -1 the second, 0 neither."""
Leaders = dict[Case, tuple[str, ...]]
"""Case -> the methods that no other is clearly better than, the best first."""


def sentences_of(asked: Asked, trials: Trials, rows: Sequence[Row]) -> list[str]:
    """Say what was found: the gentlest, why the others fail, and what depends on the case."""
    few = _too_few(asked, rows)
    leading = [_leading(asked, trials, rows, name) for name in WORDS]
    return [
        *training_sentences(asked.methods, asked.seed, asked.numbers),
        *(few or [sentence for sentences in leading for sentence in sentences]),
        *_changing(asked, trials),
        *_one_variation(asked),
        *_failing(asked, rows),
        *_left_behind(asked, rows),
        *_stopped(asked, rows),
    ]


def notes_of(asked: Asked) -> list[str]:
    """Say what has to be known before the sentences are trusted."""
    pairs = _pairs(asked)
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


def _pairs(asked: Asked) -> int:
    """Count the pairs of methods over all cases."""
    return len(asked.methods) * (len(asked.methods) - 1) // 2 * len(asked.cases)


def _too_few(asked: Asked, rows: Sequence[Row]) -> list[str]:
    """Say so where no difference can be clear, whatever the parts do."""
    pairs, parts = _pairs(asked), rows[0]["runs"]
    if not pairs or parts >= fewest_pairs(SURE / pairs):
        return []
    return [
        f"too few parts to tell the methods apart: a difference with p < {SURE / pairs:.2g} needs "
        f"{fewest_pairs(SURE / pairs)} parts that only one of two methods frees, and {parts} were "
        "tried; raise --runs"
    ]


def _limits(asked: Asked, name: str) -> str:
    limits = getattr(asked.population, name)
    return (
        f"{limits.peak_over_breakaway_max:g} times its breakaway force, jumps of "
        f"{1e3 * limits.jump_max_m:g} mm and {limits.release_velocity_max_m_per_s:g} m/s at release"
    )


def verdicts_of(asked: Asked, trials: Trials, name: str) -> Verdicts:
    """Judge every pair of methods in every case, by the parts that only one of them spares."""
    pairs = list(combinations(asked.names, 2))
    allowed = SURE / max(1, _pairs(asked))
    verdicts: Verdicts = {}
    for one, other in pairs:
        for case in asked.cases:
            ours, theirs, p = paired(trials[case][one], trials[case][other])[name]
            sign = (ours > theirs) - (ours < theirs)
            verdicts.setdefault((one, other), {})[case] = sign if p < allowed else 0
    return verdicts


def _leading(asked: Asked, trials: Trials, rows: Sequence[Row], name: str) -> list[str]:
    """Say which methods no other is clearly better than, by case."""
    if len(asked.methods) < 2:
        return []
    leaders = _leaders(asked, verdicts_of(asked, trials, name), rows, name)
    shares = {(case_of(r), r["method"]): r for r in rows}
    groups: dict[frozenset[str], list[Case]] = {}
    for case, methods in leaders.items():
        groups.setdefault(frozenset(methods), []).append(case)
    said = [
        _leader_sentence(asked, leaders[cases[0]], cases, shares, name) for cases in groups.values()
    ]
    return said + [
        f"CAUTION: which method frees most parts {WORDS[name]} depends on {reason}"
        for reason in _reasons(asked, leaders)
    ]


def _leaders(asked: Asked, verdicts: Verdicts, rows: Sequence[Row], name: str) -> Leaders:
    leaders: Leaders = {}
    for case in asked.cases:
        of_case = sorted((r for r in rows if case_of(r) == case), key=rank, reverse=True)
        best = max(of_case, key=lambda row: row[name])["method"]
        first = [r["method"] for r in of_case if not _beats(verdicts, best, r["method"], case)]
        leaders[case] = tuple(sorted(first, key=lambda m: m != best))
    return leaders


def _reasons(asked: Asked, leaders: Leaders) -> list[str]:
    """Say what the leading methods depend on: the law, with the same variation; or the latter."""
    first = {case: frozenset(methods) for case, methods in leaders.items()}
    by_variation = [{first[Case(law, how)] for law in asked.laws} for how in asked.variations]
    by_law = [{first[Case(law, how)] for how in asked.variations} for law in asked.laws]
    reasons = []
    if any(len(found) > 1 for found in by_variation):
        reasons.append("the friction law; do not rely on one law")
    if any(len(found) > 1 for found in by_law):
        reasons.append("how friction varies; do not rely on one variation")
    return reasons


def _beats(verdicts: Verdicts, one: str, other: str, case: Case) -> bool:
    if one == other:
        return False
    if (one, other) in verdicts:
        return verdicts[one, other][case] > 0
    return verdicts[other, one][case] < 0


def _leader_sentence(
    asked: Asked,
    methods: Sequence[str],
    cases: Sequence[Case],
    shares: dict[tuple[Case, str], Row],
    name: str,
) -> str:
    where = f"under {cases_in_words(cases, asked.cases)}"
    if all(shares[case, method][name] == 0 for case in cases for method in methods):
        return f"no method frees any part {WORDS[name]} {where}"
    parts = [f"{m} ({_range([shares[c, m][f'{name}_share'] for c in cases])})" for m in methods]
    if len(methods) == 1:
        return f"{parts[0]} clearly frees most parts {WORDS[name]} {where}"
    if len(methods) == len(asked.methods):
        return f"no method clearly frees more parts {WORDS[name]} than another {where}: " + listing(
            parts
        )
    return f"no method clearly frees more parts {WORDS[name]} than {listing(parts)} {where}"


def _changing(asked: Asked, trials: Trials) -> list[str]:
    """Flag every pair whose order is clear in some cases and not the same in the others."""
    if len(asked.cases) < 2:
        return []
    said = []
    for (one, other), by_case in verdicts_of(asked, trials, "gentle").items():
        if len(set(by_case.values())) == 1:
            continue
        for first, second, sign in ((one, other, 1), (other, one, -1)):
            held, turned, even = (
                [case for case, verdict in by_case.items() if verdict == wanted]
                for wanted in (sign, -sign, 0)
            )
            if not held or (turned and sign < 0):
                continue
            but = [
                f"{how} under {cases_in_words(cases, asked.cases)}"
                for how, cases in (("the other way round", turned), ("not clearly", even))
                if cases
            ]
            said.append(
                f"CAUTION, {_only(asked, held)}: {first} is gentler than {second} under "
                f"{cases_in_words(held, asked.cases)}, " + " and ".join(but)
            )
    return said


def _only(asked: Asked, held: Sequence[Case]) -> str:
    """Say whether all cases in which something holds share what others do not have."""
    alone: list[str] = []
    several: list[str] = []
    for name, everyone, found in (
        ("law", asked.laws, {case.law for case in held}),
        ("variation", asked.variations, {case.variation for case in held}),
    ):
        if len(everyone) > 1:
            (alone if len(found) == 1 else several).append(name)
    if alone:
        return f"one {' and one '.join(alone)} only"
    return f"some {' and '.join(f'{name}s' for name in several)} only"


def _one_variation(asked: Asked) -> list[str]:
    """Flag all of it where friction varied in one way alone."""
    if len(asked.variations) > 1:
        return []
    return [
        f"CAUTION: asked under one kind of variation ({asked.variations[0]}) alone; --variations "
        f"{','.join(VARIATIONS)} shows what turns on it"
    ]


def _failing(asked: Asked, rows: Sequence[Row]) -> list[str]:
    """Say, of each method, in the cases in which it is not gentle enough, why most parts fail."""
    said = []
    for method in asked.names:
        of_method = [row for row in rows if row["method"] == method]
        failing = [row for row in of_method if row["gentle_share"] < GENTLE_ENOUGH]
        if not failing:
            continue
        by_criterion: dict[str, list[Row]] = {}
        for row in failing:
            by_criterion.setdefault(_failing_most(row), []).append(row)
        gentle = _range([row["gentle_share"] for row in of_method])
        parts = []
        for name, found in by_criterion.items():
            cases = cases_in_words([case_of(row) for row in found], asked.cases)
            where = f" under {cases}" if len(found) < len(of_method) else ""
            kept = _range([row[f"{name}_share"] for row in found])
            parts.append(f"{CAUSE_WORDS[name]}{where}, {KEPT_WORDS[name]} {kept} of the parts")
        said.append(
            f"{method} frees {gentle} gently; it fails most often because of {' and '.join(parts)}"
        )
    return said


def _failing_most(row: Row) -> str:
    """Name the limit that fewest parts keep; staying in place where all that are free keep all."""
    worst = min(CRITERIA, key=lambda name: float(row[f"{name}_share"]))
    return worst if row[f"{worst}_share"] < row["released_share"] else "released"


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


def _stopped(asked: Asked, rows: Sequence[Row]) -> list[str]:
    return [
        f"the watch stopped {row['method']} on {row['stopped']} of {row['runs']} parts under "
        f"{cases_in_words([case_of(row)], asked.cases)}"
        for row in rows
        if row["stopped"]
    ]


def _range(shares: Sequence[float]) -> str:
    """Give shares as percents, from the lowest to the highest."""
    low, high = (f"{100.0 * share:.4g}" for share in (min(shares), max(shares)))
    return f"{low} %" if low == high else f"{low} to {high} %"
