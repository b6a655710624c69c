"""What a trial is under: a friction law, and how friction varies."""

from __future__ import annotations

from dataclasses import dataclass

from breakaway.model.scenario.laws import LAW_WORDS, Law
from breakaway.model.scenario.variation import VARIATION_WORDS, VariationKind


@dataclass(frozen=True)
class Case:
    """A friction law, and how friction varies.

    Examples
    --------
    >>> Case("gms", "field").words
    'generalized Maxwell-slip, friction varies along the way'

    """

    law: Law
    """The friction law of the joints."""
    variation: VariationKind
    """How their friction varies."""

    @property
    def key(self) -> str:
        """A name for files and places on a page."""
        return f"{self.law}_{self.variation}"

    @property
    def words(self) -> str:
        """Law and variation in words."""
        return f"{LAW_WORDS[self.law]}, friction {VARIATION_WORDS[self.variation]}"
