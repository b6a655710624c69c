"""Results that show themselves in one line, in a terminal and in a notebook."""

from __future__ import annotations

from breakaway.base.text import xml


class OneLine:
    """Base of results whose ``repr`` is a line of words; a notebook shows the same line.

    Examples
    --------
    >>> class Found(OneLine):
    ...     def __repr__(self) -> str:
    ...         return "<3 events in 'a&b.csv'>"
    >>> Found()._repr_html_()
    '<code>&lt;3 events in &#x27;a&amp;b.csv&#x27;&gt;</code>'

    """

    def _repr_html_(self) -> str:
        return f"<code>{xml(repr(self))}</code>"


def counted(count: int, noun: str) -> str:
    """Give a number of things.

    Examples
    --------
    >>> counted(1, "run"), counted(2000, "run")
    ('1 run', '2,000 runs')

    """
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
