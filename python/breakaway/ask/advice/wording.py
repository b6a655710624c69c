"""What an advice says, in sentences for the person who decides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from breakaway.ask.advice.measurement import RISK, Measurement
from breakaway.ask.advice.outcome import Bounds
from breakaway.ask.advice.parts import Parts
from breakaway.ask.advice.ranking import Difference, Ranked
from breakaway.ask.advice.trying import ENDED_WORDS, Tried
from breakaway.ask.advice.wanted import ENOUGH, WantedRig, force_needed_n
from breakaway.ask.advice.worth import SHOWN, Worth
from breakaway.model.scenario.laws import LAW_WORDS

CLEAR_SHARE = 0.02
"""Share of parts below which a gain is not worth a measurement."""
FAILING_WORDS = {
    "stays in place": "stay in place, or need more force or stroke than the rig has",
    "force": "are stressed beyond their limit",
    "jump": "slip farther than they may",
    "velocity": "leave faster than they may",
}


def sentences_of(
    tried: Tried,
    ranking: Sequence[Ranked],
    difference: Difference | None,
    worths: Sequence[Worth],
    wanted: Sequence[WantedRig],
    measurement: Measurement | None,
    bounds: Bounds,
) -> list[str]:
    """Say what to do, what is second and why, what decides it, and what more would buy."""
    best = ranking[0]
    return [
        _recommended(best),
        *(_failing(row) for row in ranking[:1] if row.failing),
        *([_second(best, ranking[1], difference)] if difference is not None else []),
        *_laws(best),
        *_worth(worths),
        *([] if measurement is None else [_measured(measurement)]),
        *_wanted(tried, best, wanted, bounds),
    ]


def rests_on(parts: Parts, tried: Tried, bounds: Bounds, seed: int) -> list[str]:
    """Say what the advice rests on."""
    told = [SHOWN[name] for name in parts.told if name in SHOWN]
    assumed = [SHOWN[name] for name in parts.assumed if name in SHOWN]
    laws = ", ".join(LAW_WORDS[law] for law in parts.laws)
    settings = ", ".join(f"{tried.settings_tried[way.name]} of {way.name}" for way in tried.ways)
    return [
        f"{tried.parts} parts of {parts.name!r}, seed {seed}, the same for every way; "
        f"{ENDED_WORDS[tried.ended]}",
        f"measured: {', '.join(told)}" if told else "nothing of the parts was measured",
        *([f"assumed, with wide ranges: {', '.join(assumed)}"] if assumed else []),
        f"friction laws asked: {laws}; none of them is excluded",
        f"settings tried on other parts: {settings}",
        *(f"limit: {words}" for words in bounds.words),
        "wear, heat and bonds that break for good have no model here",
    ]


def _recommended(best: Ranked) -> str:
    share = f"{100 * best.unharmed:.3g} %"
    what = "Use" if best.unharmed >= ENOUGH else "Nothing is good enough; the least bad is"
    return (
        f"{what} {best.setting}: {share} of {best.parts} parts come out within all limits under "
        f"the law where it does worst, {LAW_WORDS[best.law]} (95 % interval "
        f"{100 * best.low:.3g} to {100 * best.high:.3g} %)."
    )


def _failing(row: Ranked) -> str:
    causes = [f"{100 * share:.2g} % {FAILING_WORDS[limit]}" for limit, share in row.failing.items()]
    return f"Of all, {'; '.join(causes)}." if causes else ""


def _second(best: Ranked, second: Ranked, difference: Difference) -> str:
    share = f"{100 * second.unharmed:.3g} %"
    if difference.is_clear:
        return (
            f"Second best is {second.setting} with {share}: {difference.only_best} parts come out "
            f"unharmed by the first way alone, {difference.only_second} by the second alone "
            f"(p = {difference.p:.2g})."
        )
    return (
        f"Second is {second.setting} with {share}; {best.parts} parts do not tell the two apart "
        f"(p = {difference.p:.2g}). The first stands first for {_why(best, second)}."
    )


def _why(best: Ranked, second: Ranked) -> str:
    """Say by which figure one is put first."""
    if best.unharmed != second.unharmed:
        return "the parts that it spares more here"
    if best.freed != second.freed:
        return "the parts that it frees more"
    if round(best.load_high, 2) != round(second.load_high, 2):
        return (
            f"its peak force, {100 * best.load_high:.3g} % of the one allowed against "
            f"{100 * second.load_high:.3g} %, exceeded by one part in twenty"
        )
    return "the time that it takes"


def _laws(best: Ranked) -> list[str]:
    low, high = min(best.by_law.values()), max(best.by_law.values())
    shares = ", ".join(f"{LAW_WORDS[law]} {100 * one:.3g} %" for law, one in best.by_law.items())
    if high - low <= CLEAR_SHARE:
        return [f"The friction law does not decide it: {shares}."]
    return [f"It depends on the friction law, which is not known: {shares}."]


def _worth(worths: Sequence[Worth]) -> list[str]:
    clear = [one for one in worths if one.is_clear and one.gain >= CLEAR_SHARE]
    if not clear:
        return [
            "No single measurement before the pull would change the choice for more than "
            f"{100 * CLEAR_SHARE:.0f} parts in a hundred."
        ]
    gains = "; ".join(f"{one.words}: {100 * one.gain:.2g}" for one in clear)
    return [
        f"To know this before one chooses would spare so many more parts in a hundred, {gains}."
    ]


def _beyond(tried: Tried, bounds: Bounds) -> list[str]:
    """Say how many parts no pull can spare: what holds them is more than a place bears."""
    if bounds.limits is None or bounds.limits.weakest is None:
        return []
    allowed = bounds.limits.force_max_n
    share = float(np.mean(tried.quantities["stiction_n"] > allowed))
    if not share:
        return []
    return [
        f"{100 * share:.2g} % of the parts take more than {allowed:.4g} N to break loose, which is "
        f"what the {bounds.limits.weakest.place} bears: no pull spares them."
    ]


def _measured(found: Measurement) -> str:
    """Say what a measurement below breakaway would tell."""
    if not found.tells:
        return (
            f"No load below {found.peak_n:.3g} N, which {100 * (1 - RISK):.0f} parts in a hundred "
            f"bear, tells the breakaway force: {found.kind} leaves {100 * found.after:.2g} % of "
            f"{100 * found.before:.2g} %."
        )
    return (
        f"Before the pull, {found.kind} up to {found.peak_n:.3g} N (reference.csv) would tell the "
        f"breakaway force of the middle part to {100 * found.after:.2g} % at best, which is known "
        f"to {100 * found.before:.2g} % now; it frees at most {100 * RISK:.0f} parts in a hundred."
    )


def _wanted(tried: Tried, best: Ranked, wanted: Sequence[WantedRig], bounds: Bounds) -> list[str]:
    needed, has = force_needed_n(tried), bounds.rig.force_max_n
    said = _beyond(tried, bounds)
    if needed > has:
        said.append(
            f"The rig bears {has:.4g} N; one part in a hundred takes more than {needed:.4g} N to "
            "break loose."
        )
    if best.unharmed >= ENOUGH or not wanted:
        return said
    last = wanted[-1]
    if last.is_enough:
        said.append(
            f"A rig that would do: {last.change}, by {last.way}: "
            f"{100 * last.unharmed:.3g} % of {last.parts} parts."
        )
    else:
        most = max(wanted, key=lambda one: one.unharmed)
        said.append(
            f"No rig that was tried is good enough; the best was {most.change}, by {most.way}: "
            f"{100 * most.unharmed:.3g} % of {most.parts} parts."
        )
    return said
