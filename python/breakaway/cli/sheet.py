"""A table that fits: side by side, in pieces below each other, or row by row."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from breakaway.base.text import visible, visible_lines

PIPED_WIDTH = 10_000
"""Width, in characters, for output that no terminal shows: lines are never broken there."""

PROSE_WIDTH = 18
"""Narrowest column of prose, in characters."""


class Sheet:
    """A table that breaks only its columns of prose, never a number or a name.

    Parameters
    ----------
    title : str
        Stands above it; empty for none.
    columns : sequence of str
        Headings.
    numbers : sequence of str
        Columns that are aligned to the right.
    prose : sequence of str
        Columns whose lines may be broken.
    labels : int, optional
        How many of the first columns tell the rows apart. Left out: those before the first number
        or prose, one at least.

    """

    def __init__(
        self,
        title: str,
        columns: Sequence[str],
        *,
        numbers: Sequence[str] = (),
        prose: Sequence[str] = (),
        labels: int | None = None,
    ) -> None:
        self.title = title
        self.columns = list(columns)
        self.numbers = set(numbers)
        self.prose = set(prose)
        before = takewhile(lambda name: name not in self.numbers | self.prose, columns)
        self.labels = max(1, len([*before]) if labels is None else labels)
        self.rows: list[list[Text]] = []

    def add(self, *cells: str) -> None:
        """Add a row of plain text."""
        if len(cells) != len(self.columns):
            raise ValueError(f"{len(cells)} cells in a table of {len(self.columns)} columns")
        self.rows.append([Text(visible_lines(cell)) for cell in cells])

    def fitted(self, width: int) -> list[RenderableType]:
        """Give what to print, for a width in characters.

        A table that is too wide becomes several, which all begin with its labels. Where labels
        leave less than a third of the width, each row becomes lines of its own.
        """
        heading: list[RenderableType] = []
        if self.title:
            heading = [Text(visible(self.title), style="bold")]
        every = range(len(self.columns))
        if narrowest(self._table(every)) <= width:
            return [*heading, self._table(every)]
        return [*heading, *(self._pieces(width) or [self._list()])]

    def _pieces(self, width: int) -> list[Table]:
        """Give tables that fit, none where labels or a single column are too wide."""
        labels = [*range(self.labels)]
        if narrowest(self._table(labels)) > 2 * width // 3:
            return []
        groups: list[list[int]] = [[]]
        for column in range(self.labels, len(self.columns)):
            if groups[-1] and narrowest(self._table([*labels, *groups[-1], column])) > width:
                groups.append([])
            groups[-1].append(column)
        tables = [self._table([*labels, *group]) for group in groups]
        return tables if all(narrowest(table) <= width for table in tables) else []

    def _table(self, which: Sequence[int]) -> Table:
        table = Table(box=SIMPLE_HEAD)
        for index in which:
            name, heading = self.columns[index], Text(visible(self.columns[index]))
            cells = [heading, *(row[index] for row in self.rows)]
            table.add_column(
                heading,
                justify="right" if name in self.numbers else "left",
                no_wrap=name not in self.prose,
                overflow="fold",
                min_width=PROSE_WIDTH if name in self.prose else max(map(_widest_line, cells)),
            )
        for row in self.rows:
            table.add_row(*(row[index] for index in which))
        return table

    def _list(self) -> Table:
        """Give one line for each cell, and an empty one between rows."""
        table = Table.grid(padding=(0, 2, 0, 0))
        table.add_column(overflow="fold")
        table.add_column(overflow="fold")
        table.add_row("", "")
        for row in self.rows:
            for name, cell in zip(self.columns, row, strict=True):
                if cell.plain:
                    table.add_row(Text(visible(name)), cell)
            table.add_row("", "")
        return table


def _widest_line(text: Text) -> int:
    return max(cell_len(line) for line in text.plain.split("\n"))


def narrowest(shown: RenderableType) -> int:
    """Give the smallest width, in characters, in which no word is broken."""
    console = Console(width=PIPED_WIDTH)
    return Measurement.get(console, console.options, shown).minimum
