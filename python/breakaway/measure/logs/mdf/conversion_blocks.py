"""Conversions as the blocks of a file state them. Source: ASAM MDF 4.1, the block CC."""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.mdf.blocks import Block, Blocks
from breakaway.measure.logs.mdf.conversion import (
    DEEPEST,
    Choice,
    Conversion,
    ConversionError,
    Keys,
    Linear,
    Ranges,
    RangeTable,
    Rational,
    Table,
    identity,
)
from breakaway.measure.logs.mdf.formula import FormulaError, parse

PARAMETERS = "<BBHHHdd"
"""Type, precision, flags, number of references, number of values, and the range of values."""

FIRST_REFERENCE = 4
"""Number of the first link to what is referred to, behind name, unit, comment and inverse."""

TEXTS = {9: "texts to numbers", 10: "texts to texts", 11: "bits to texts"}
"""Kinds that are made for texts."""

SHOWN = 80
"""Most characters of a formula or a text in a message."""


class Conversions:
    """The conversions of a file, each read once."""

    def __init__(self, blocks: Blocks) -> None:
        self._blocks = blocks
        self._known: dict[tuple[int, int], Conversion | ConversionError] = {}

    def at(self, place: int, depth: int = 0) -> Conversion:
        """Return the conversion at a place; that of 0 leaves values as they are.

        Raises
        ------
        ConversionError
            It gives no numbers, or is not understood.
        LogError
            The block is damaged.

        """
        if not place:
            return identity
        key = place, depth
        if key not in self._known:
            try:
                self._known[key] = self._read(place, depth)
            except ConversionError as error:
                self._known[key] = error
        found = self._known[key]
        if isinstance(found, ConversionError):
            raise found
        return found

    def unit(self, place: int) -> str:
        """Return the unit of the values of a conversion."""
        return self._blocks.text(self._blocks.block(place, "CC").link(1)) if place else ""

    def _read(self, place: int, depth: int) -> Conversion:
        if depth > DEEPEST:
            raise ConversionError(f"more than {DEEPEST} conversions lead on to each other")
        block = self._blocks.block(place, "CC")
        kind, _, _, references, count, _, _ = self._blocks.unpack(block, PARAMETERS)
        p = np.array(self._blocks.unpack(block, f"<{count}d", struct.calcsize(PARAMETERS)))
        if references != len(block.links) - FIRST_REFERENCE or count != _expected(kind, p, block):
            raise self._blocks.damaged(place, "claims more or fewer parameters than it has")
        match kind:
            case 0:
                return identity
            case 1:
                return Linear(*p.tolist())
            case 2:
                return Rational(*p.tolist())
            case 3:
                return self._formula(block)
            case 4 | 5:
                return Table(p[::2], p[1::2], interpolated=kind == 4)
            case 6:
                return RangeTable(Ranges(p[:-1:3], p[1:-1:3]), np.append(p[2:-1:3], p[-1]))
            case 7:
                return Choice(Keys(p), self._rows(block, depth))
            case 8:
                return Choice(Ranges(p[::2], p[1::2]), self._rows(block, depth))
        raise ConversionError(f"its values are converted by {TEXTS.get(kind, f'kind {kind}')}")

    def _formula(self, block: Block) -> Conversion:
        text = self._blocks.text(block.link(FIRST_REFERENCE))
        try:
            return parse(text)
        except FormulaError as error:
            shown = text if len(text) <= SHOWN else text[:SHOWN] + "..."
            raise ConversionError(f"its formula {shown!r} is not applied: {error}") from None

    def _rows(self, block: Block, depth: int) -> Callable[[int], Conversion | str]:
        """Return what gives the text or the conversion of a row of a table."""

        def row(number: int) -> Conversion | str:
            place = block.link(FIRST_REFERENCE + number)
            if not place:
                return "nothing"
            if self._blocks.block(place, "TX", "CC").kind == "CC":
                return self.at(place, depth + 1)
            return f"the text {self._blocks.text(place)[:SHOWN]!r}"

        return row


def _expected(kind: int, p: Array, block: Block) -> int:
    """Return how many values a conversion must have, with as many references as it has."""
    references = len(block.links) - FIRST_REFERENCE
    return {
        0: 0,
        1: 2,
        2: 6,
        3: 0,
        4: len(p) // 2 * 2,
        5: len(p) // 2 * 2,
        6: len(p) // 3 * 3 + 1,
        7: references - 1,
        8: 2 * (references - 1),
    }.get(kind, len(p))
