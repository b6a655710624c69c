"""Trying the ways of a rig on the same parts, for as long as there is time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.advice.outcome import Bounds, Outcome, joined, outcome_of
from breakaway.ask.advice.parts import Parts, at_rig
from breakaway.ask.advice.ways import Way
from breakaway.ask.durable.progress import Progress
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.method import Method
from breakaway.run.trials import draw_parts, run_trial

TRAINING = range(16)
"""Parts that settings are chosen on; they are not those that are judged."""
FIRST_JUDGED = 10_000
"""Number of the first part that is judged."""
FIRST_ROUND = 16
"""Parts of the first round; each later one has as many as all before it."""
TUNING_SHARE, JUDGING_SHARE = 0.3, 0.8
"""Shares of the time after which settings are no longer chosen, and no more parts judged: what is
left is for a rig that would do better."""

Ended = Literal["parts", "time", "interrupted"]
ENDED_WORDS = {
    "parts": "all parts were tried",
    "time": "the time was up",
    "interrupted": "it was interrupted",
}


class TimeIsUpError(Exception):
    """The time that was given is over."""


@dataclass
class Deadline:
    """When trying has to end, and who is told how far it is."""

    budget_s: float
    report: Callable[[Progress], None] | None = None
    began: float = field(default_factory=time.monotonic)

    def check(self, doing: str, share: float = 1.0) -> None:
        """Tell how far it is.

        Raises
        ------
        TimeIsUpError
            A share of the time is over.

        """
        spent = time.monotonic() - self.began
        if self.report is not None:
            done = int(min(spent, self.budget_s))
            self.report(
                Progress(runs_done=done, runs_found=0, runs_max=int(self.budget_s) + 1, doing=doing)
            )
        if spent > share * self.budget_s:
            raise TimeIsUpError


@dataclass(frozen=True, eq=False)
class Tried:
    """What was tried, on which parts, and what became of them."""

    ways: tuple[Way, ...]
    """What the rig can do."""
    chosen: dict[str, Method]
    """Name of a way -> the setting that did best on the training parts."""
    settings_tried: dict[str, int]
    """Name of a way -> how many of its settings were tried."""
    outcomes: dict[Law, dict[str, Outcome]]
    """Law -> name of a way -> what became of each part."""
    quantities: dict[str, NDArray[np.float64]]
    """Quantities of the parts."""
    ended: Ended
    """Why no more parts were tried."""

    @property
    def parts(self) -> int:
        """How many parts were judged."""
        return len(self.quantities["stiction_n"])


@dataclass(frozen=True)
class Trying:
    """What trials have in common."""

    parts: Parts
    bounds: Bounds
    seed: int
    threads: int | None
    deadline: Deadline

    def at(self, rig: ExtractionRig) -> Trying:
        """Give the same before another rig."""
        return replace(self, bounds=replace(self.bounds, rig=rig))

    def outcome(self, method: Method, law: Law, runs: range, doing: str, share: float) -> Outcome:
        """Try a setting on parts, and judge what became of them."""
        trial = run_trial(
            at_rig(self.parts.population, self.bounds.rig),
            method,
            law=law,
            runs=runs,
            seed=self.seed,
            threads=self.threads,
            progress=lambda _done, _all: self.deadline.check(doing, share),
        )
        self.deadline.check(doing, share)
        return outcome_of(trial, self.bounds)


def try_ways(ways: list[Way], trying: Trying, parts_max: int) -> Tried:
    """Choose a setting of each way on training parts, then judge them on others in rounds.

    A round that the time or Ctrl-C cuts off counts for nothing: every way is judged on the same
    parts. The first one is finished however long it takes.

    Raises
    ------
    KeyboardInterrupt
        Ctrl-C before the first round was done.

    """
    chosen: dict[str, Method] = {}
    tried: dict[str, int] = {}
    rounds: list[dict[Law, dict[str, Outcome]]] = []
    done = 0
    ended: Ended = "parts"
    try:
        for way in ways:
            chosen[way.name], tried[way.name] = _choose(way, trying)
        for runs in _rounds(parts_max):
            rounds.append(_round(chosen, runs, trying, JUDGING_SHARE if rounds else np.inf))
            done = runs.stop - FIRST_JUDGED
    except TimeIsUpError:
        ended = "time"
    except KeyboardInterrupt:
        if not rounds:
            raise
        ended = "interrupted"
    laws = trying.parts.laws
    return Tried(
        ways=tuple(ways),
        chosen=chosen,
        settings_tried=tried,
        outcomes={
            law: {name: joined([one[law][name] for one in rounds]) for name in chosen}
            for law in laws
        },
        quantities=draw_parts(
            trying.parts.population, range(FIRST_JUDGED, FIRST_JUDGED + done), seed=trying.seed
        ),
        ended=ended,
    )


def _rounds(parts_max: int) -> Iterator[range]:
    begin, size = FIRST_JUDGED, FIRST_ROUND
    while begin < FIRST_JUDGED + parts_max:
        end = min(begin + size, FIRST_JUDGED + parts_max)
        yield range(begin, end)
        begin, size = end, end - FIRST_JUDGED


def _round(
    chosen: dict[str, Method], runs: range, trying: Trying, share: float
) -> dict[Law, dict[str, Outcome]]:
    return {
        law: {
            name: trying.outcome(method, law, runs, f"{name}, {law}", share)
            for name, method in chosen.items()
        }
        for law in trying.parts.laws
    }


def _choose(way: Way, trying: Trying) -> tuple[Method, int]:
    """Give the setting that does best on training parts, and how many were tried.

    The first is tried under every law, the others under the law where that does worst. It stands
    where there is no time for any.
    """
    usual, *others = way.settings
    doing = f"setting {way.name}"

    def score(method: Method, law: Law) -> tuple[float, float, float, float]:
        return _score(trying.outcome(method, law, TRAINING, doing, TUNING_SHARE))

    best, tried = usual, 0
    try:
        most, law = min((score(usual, law), law) for law in trying.parts.laws)
        tried = 1
        for method in others:
            found = score(method, law)
            tried += 1
            if found > most:
                best, most = method, found
    except TimeIsUpError:
        pass
    return best, tried


def _score(outcome: Outcome) -> tuple[float, float, float, float]:
    """Order settings: parts unharmed, parts freed, low load, little time."""
    load, time_s = np.median(outcome.load), outcome.time_s[np.isfinite(outcome.time_s)]
    slow = float(np.median(time_s)) if time_s.size else np.inf
    return float(outcome.unharmed.mean()), float(outcome.freed.mean()), -float(load), -slow
