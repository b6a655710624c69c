"""An advice: what was asked, what was tried, and what follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from breakaway.ask.advice.measurement import Measurement
from breakaway.ask.advice.outcome import Bounds
from breakaway.ask.advice.parts import Parts
from breakaway.ask.advice.ranking import Difference, Ranked
from breakaway.ask.advice.trying import ENDED_WORDS, Tried
from breakaway.ask.advice.wanted import WantedRig
from breakaway.ask.advice.worth import Worth
from breakaway.base.one_line import OneLine, counted
from breakaway.model.scenario.method import Method


@dataclass(frozen=True)
class NotJudged:
    """A way to free parts that is used in shops, and that no model here covers."""

    name: str
    """What it is called."""
    what: str
    """What it does to a joint."""
    why: str
    """Why nothing is said of it."""
    source: str
    """Where it is described."""


@dataclass(frozen=True, eq=False)
class Advice(OneLine):
    """How to get parts out with a rig, and what is known of it.

    Attributes
    ----------
    ranking : tuple of Ranked
        All ways of the rig, the best first, each under the law where it does worst.
    worths : tuple of Worth
        What it would buy to know a quantity of the part, or the law, the most first.
    sentences : tuple of str
        What follows, in words.

    """

    parts: Parts
    bounds: Bounds
    tried: Tried
    ranking: tuple[Ranked, ...]
    difference: Difference | None
    worths: tuple[Worth, ...]
    wanted: tuple[WantedRig, ...]
    measurement: Measurement | None
    not_judged: tuple[NotJudged, ...]
    sentences: tuple[str, ...]
    rests_on: tuple[str, ...]
    seed: int
    folder: Path | None = None

    def __repr__(self) -> str:
        best = self.ranking[0]
        return (
            f"<advice: {best.way} with {self.bounds.rig.name!r}, {100 * best.unharmed:.3g} % of "
            f"{counted(best.parts, 'part')} unharmed>"
        )

    @property
    def best(self) -> Ranked:
        """The way that is recommended."""
        return self.ranking[0]

    @property
    def method(self) -> Method:
        """The recommended way and setting, as a method that `compare` and `tune` take."""
        return self.tried.chosen[self.best.way].model_copy(update={"name": self.best.way})

    def to_dict(self) -> Mapping[str, Any]:
        """Give the advice as plain values, as ``advice.json`` holds it."""
        return {
            "parts": {
                "name": self.parts.name,
                "told": list(self.parts.told),
                "assumed": list(self.parts.assumed),
                "laws": list(self.parts.laws),
                "judged": self.tried.parts,
                "seed": self.seed,
                "ended": ENDED_WORDS[self.tried.ended],
            },
            "rig": self.bounds.rig.model_dump(mode="json"),
            "limits": self.bounds.words,
            "ranking": [asdict(row) for row in self.ranking],
            "difference": None if self.difference is None else asdict(self.difference),
            "worths": [asdict(one) for one in self.worths],
            "wanted": [asdict(one) for one in self.wanted],
            "measurement": self._measurement(),
            "not_judged": [asdict(one) for one in self.not_judged],
            "sentences": list(self.sentences),
            "rests_on": list(self.rests_on),
        }

    def _measurement(self) -> Mapping[str, Any] | None:
        """Give the measurement before the pull without its samples."""
        if self.measurement is None:
            return None
        values = asdict(self.measurement)
        return {name: one for name, one in values.items() if name not in ("t_s", "force_n")}
