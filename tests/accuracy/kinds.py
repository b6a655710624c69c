"""Which law, actuator and controller a case has: every combination, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from breakaway.model.scenario.laws import LAWS

PUSHES = tuple(
    product(
        ("ideal", "push_only", "force"),
        ("pid", "fm_vibration", "force_ramp", "timed_impacts", "two_step"),
    )
)
FEEDS = (
    ("feed_rigid", "steady_feed"),
    ("feed_grip", "steady_feed"),
    ("feed_piezo", "steady_feed"),
    ("feed_piezo", "vibrated_feed"),
)


@dataclass(frozen=True)
class Kind:
    """What a case is made of."""

    law: str
    actuator: str
    controller: str

    @property
    def feeds(self) -> bool:
        return self.actuator.startswith("feed")

    def __str__(self) -> str:
        return f"{self.law} {self.actuator} {self.controller}"


KINDS = tuple(Kind(law, *drive) for law, drive in product(LAWS, PUSHES + FEEDS))


def kind_of(seed: int, number: int) -> Kind:
    """Every kind once in as many cases as there are kinds, in an order of the seed's."""
    lap, place = divmod(number, len(KINDS))
    order = np.random.default_rng([seed, lap, len(KINDS)]).permutation(len(KINDS))
    return KINDS[order[place]]
