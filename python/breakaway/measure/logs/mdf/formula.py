"""Formulas from a file: parsed into steps by a grammar of their own, never run as code.

What two readers could understand in two ways is refused: a number that is certainly wrong is
worse than none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from breakaway.measure.logs.channel import Array

LONGEST = 1000
"""Most characters of a formula."""
MOST_STEPS = 200
"""Most numbers, variables and operations of a formula."""
DEEPEST = 32
"""Most brackets and signs within each other."""

VARIABLES = ("x", "x1")
"""Names of the raw value, in either case."""

FUNCTIONS: dict[str, np.ufunc] = {
    "abs": np.absolute,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "ln": np.log,
    "log10": np.log10,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "arcsin": np.arcsin,
    "arccos": np.arccos,
    "arctan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "pow": np.power,
}
"""Function -> what computes it; ``pow`` takes two arguments."""

SUMS: dict[str, np.ufunc] = {"+": np.add, "-": np.subtract}
PRODUCTS: dict[str, np.ufunc] = {"*": np.multiply, "/": np.divide}
POWERS = ("^", "**")

Step = float | str | np.ufunc
"""A number, the variable, or an operation on the latest results."""


class FormulaError(ValueError):
    """A formula is not understood, or goes beyond a limit."""


@dataclass(frozen=True)
class Formula:
    """A function of the raw value, as steps in the order in which they are done."""

    steps: tuple[Step, ...]

    def __call__(self, raw: npt.NDArray[Any]) -> Array:
        """Return the values; where the mathematics has none, they are not finite."""
        x: Array = raw.astype(np.float64, copy=False)
        results: list[Array | np.float64] = []
        with np.errstate(all="ignore"):
            for step in self.steps:
                if isinstance(step, np.ufunc):
                    arguments = results[-step.nin :]
                    del results[-step.nin :]
                    results.append(step(*arguments))
                else:
                    results.append(x if isinstance(step, str) else np.float64(step))
        return np.broadcast_to(np.asarray(results[0], dtype=np.float64), x.shape)


def parse(text: str) -> Formula:
    """Parse a formula of ``X`` or ``X1``.

    It may hold numbers, ``+ - * / ^``, brackets, and `FUNCTIONS`. Angles are in radians.

    Parameters
    ----------
    text : str
        The formula.

    Raises
    ------
    FormulaError
        It holds anything else, goes beyond a limit, or has two meanings: ``log`` is the natural
        logarithm to some readers and that of base 10 to others, a sign may be within a power or
        before it, and powers of powers may be taken from either end.

    Notes
    -----
    Not checked: whether the result is finite, and whether ``X`` lies where the formula holds.

    Examples
    --------
    >>> parse("2*(X1 - 1)^2 + sqrt(X1)")(np.array([4.0, 9.0]))
    array([ 20., 131.])
    >>> parse("log(X1)")
    Traceback (most recent call last):
        ...
    breakaway.measure.logs.mdf.formula.FormulaError: 'log' may mean ln or log10

    """
    if len(text) > LONGEST:
        raise FormulaError(f"it has more than {LONGEST} characters")
    parser = _Parser(_tokens(text))
    parser.sum(0)
    if parser.next is not None:
        raise FormulaError(f"{parser.next!r} stands where it should end")
    return Formula(tuple(parser.steps))


_TOKEN = re.compile(
    r"\s*((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[A-Za-z][A-Za-z0-9_]*|\*\*|[-+*/^(),])"
)


def _tokens(text: str) -> list[str]:
    tokens, place, end = [], 0, len(text.rstrip())
    while place < end:
        found = _TOKEN.match(text, place)
        if found is None:
            raise FormulaError(f"{text[place:].lstrip()[:1]!r} has no meaning in it")
        tokens.append(found[1].lower())
        place = found.end()
    return tokens


class _Parser:
    """Turns tokens into steps: a method for each level, from sums down to atoms."""

    def __init__(self, tokens: list[str]) -> None:
        self.steps: list[Step] = []
        self._tokens = tokens[::-1]

    @property
    def next(self) -> str | None:
        """The token that comes next, or None at the end."""
        return self._tokens[-1] if self._tokens else None

    def sum(self, depth: int) -> None:
        """Parse terms that are added and subtracted."""
        if depth > DEEPEST:
            raise FormulaError(f"it has more than {DEEPEST} nested brackets and signs")
        self._product(depth)
        while self.next in SUMS:
            operation = SUMS[self._take()]
            self._product(depth)
            self._add(operation)

    def _product(self, depth: int) -> None:
        self._signed(depth)
        while self.next in PRODUCTS:
            operation = PRODUCTS[self._take()]
            self._signed(depth)
            self._add(operation)

    def _signed(self, depth: int) -> None:
        if self.next not in SUMS:
            self._power(depth)
            return
        if depth >= DEEPEST:
            raise FormulaError(f"it has more than {DEEPEST} nested brackets and signs")
        sign = self._take()
        if self.next in SUMS:
            self._signed(depth + 1)
        else:
            self._atom(depth)
        if self.next in POWERS:
            raise FormulaError("a sign before a power has two meanings; it needs brackets")
        if sign == "-":
            self._add(np.negative)

    def _power(self, depth: int) -> None:
        self._atom(depth)
        if self.next not in POWERS:
            return
        self._take()
        negative = self.next == "-"
        if negative:
            self._take()
        self._atom(depth)
        if negative:
            self._add(np.negative)
        if self.next in POWERS:
            raise FormulaError("a power of a power has two meanings; it needs brackets")
        self._add(np.power)

    def _atom(self, depth: int) -> None:
        token = self._take()
        if token == "(":
            self.sum(depth + 1)
            self._expect(")")
        elif token in VARIABLES:
            self._add("x")
        elif token in FUNCTIONS:
            self._call(FUNCTIONS[token], depth)
        elif token[0].isdigit() or token[0] == ".":
            value = float(token)
            if not np.isfinite(value):
                raise FormulaError(f"{token[:40]!r} is not a finite number")
            self._add(value)
        elif token == "log":
            raise FormulaError("'log' may mean ln or log10")
        else:
            raise FormulaError(f"{token[:40]!r} is unknown or out of place")

    def _call(self, function: np.ufunc, depth: int) -> None:
        self._expect("(")
        for argument in range(function.nin):
            if argument:
                self._expect(",")
            self.sum(depth + 1)
        self._expect(")")
        self._add(function)

    def _add(self, step: Step) -> None:
        self.steps.append(step)
        if len(self.steps) > MOST_STEPS:
            raise FormulaError(f"it has more than {MOST_STEPS} numbers and operations")

    def _take(self) -> str:
        if not self._tokens:
            raise FormulaError("it ends too early")
        return self._tokens.pop()

    def _expect(self, token: str) -> None:
        if self.next != token:
            raise FormulaError(f"{token!r} is missing")
        self._take()
