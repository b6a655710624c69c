"""The kinds of variation of friction: one word for each, in files, tables and sentences."""

from __future__ import annotations

from typing import Literal, get_args

VariationKind = Literal["field", "part", "none", "paper_random_factor"]
"""How the friction of a part varies."""
VARIATIONS: tuple[VariationKind, ...] = get_args(VariationKind)
"""All kinds of variation."""
VARIATION_WORDS: dict[str, str] = {
    "field": "varies along the way",
    "part": "varies from part to part",
    "none": "does not vary",
    "paper_random_factor": "is redrawn in time",
}
"""Kind of variation -> what friction does, in words."""
