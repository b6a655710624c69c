"""Arguments of public functions: what is of a wrong kind is refused where it comes in."""

from __future__ import annotations

from collections.abc import Collection
from math import isfinite
from numbers import Real
from os import PathLike
from pathlib import Path

from breakaway.base.text import brief, shown
from breakaway.errors import BreakawayError, StudyError

Refusal = type[BreakawayError]
"""Class of the error that refuses an argument."""

FIRST_RUN_MAX = 2**63 - 1
"""Largest number that the first of some runs may have."""


def check_kind(
    name: str, value: object, kinds: type | tuple[type, ...], remedy: str, error: Refusal
) -> None:
    """Refuse what is of none of the kinds, such as the name of a preset in place of a scenario.

    Examples
    --------
    >>> check_kind("mapping", 5, dict, "give a table of keys", StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: mapping: 5 is not a dict; give a table of keys

    """
    if isinstance(value, kinds):
        return
    names = [kind.__name__ for kind in (kinds if isinstance(kinds, tuple) else (kinds,))]
    article = "an" if names[0][0] in "AEIOU" else "a"
    raise error(f"{name}: {shown(value)} is not {article} {' or '.join(names)}; {remedy}")


def path_of(name: str, value: object, error: Refusal) -> Path:
    """Give a path, or refuse what is none.

    Examples
    --------
    >>> path_of("path", "motor.csv", StudyError).suffix
    '.csv'
    >>> path_of("path", ["motor.csv"], StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: path: ['motor.csv'] is not a path; give a str or a Path

    """
    if not isinstance(value, str | PathLike):
        raise error(f"{name}: {shown(value)} is not a path; give a str or a Path")
    return Path(value)


def is_number(value: object) -> bool:
    """Whether a value is a real number; a truth is none.

    Examples
    --------
    >>> is_number(1.5), is_number(float("nan")), is_number("1.5"), is_number(True)
    (True, True, False, False)

    """
    return isinstance(value, Real) and not isinstance(value, bool)


def check_finite(name: str, value: object, error: Refusal) -> None:
    """Refuse what is not a finite number.

    Examples
    --------
    >>> check_finite("start_s", "0.5", StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: start_s: '0.5' is not a finite number; give a number

    """
    if not (isinstance(value, Real) and is_number(value) and isfinite(value)):
        raise error(f"{name}: {shown(value)} is not a finite number; give a number")


def is_whole(value: object) -> bool:
    """Whether a value is a whole number; a truth is none.

    Examples
    --------
    >>> is_whole(3), is_whole(3.0), is_whole(True)
    (True, False, False)

    """
    return isinstance(value, int) and not isinstance(value, bool)


def check_whole(
    name: str, value: object, error: Refusal, low: int, high: int | None = None
) -> None:
    """Refuse what is not a whole number from ``low`` to ``high``, both included.

    Examples
    --------
    >>> check_whole("seed", -1, StudyError, 0)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: seed: -1 is not a whole number of at least 0

    """
    within = isinstance(value, int) and low <= value and (high is None or value <= high)
    if not (within and is_whole(value)):
        raise error(f"{name}: {shown(value)} is not a whole number {_between(low, high)}")


def _between(low: int, high: int | None) -> str:
    return f"of at least {low}" if high is None else f"from {low} to {high}"


def run_numbers(runs: object, *, fewest: int = 1, most: int | None = None) -> range:
    """Give the numbers of runs: so many from 0 on, or those of a range.

    Examples
    --------
    >>> run_numbers(3), run_numbers(range(100, 200))
    (range(0, 3), range(100, 200))
    >>> run_numbers(0)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: runs: 0 is not a whole number of at least 1, nor a range ...

    """
    if isinstance(runs, int) and is_whole(runs):
        numbers = range(runs)
    elif isinstance(runs, range) and runs.step == 1 and 0 <= runs.start <= FIRST_RUN_MAX:
        numbers = runs
    else:
        numbers = range(-1)
    count = numbers.stop - numbers.start  # len() ends at 2^63
    if count < fewest or (most is not None and count > most):
        raise StudyError(
            f"runs: {shown(runs)} is not a whole number {_between(fewest, most)}, nor a range of "
            "as many, such as range(100, 200)"
        )
    return numbers


def check_choice(name: str, value: object, known: Collection[str], error: Refusal) -> None:
    """Refuse what is not one of the words that are known.

    Examples
    --------
    >>> check_choice("real", "half", ("double", "float"), StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: real: 'half' is not one of double, float

    """
    if not (isinstance(value, str) and value in known):
        raise error(f"{name}: {shown(value)} is not one of {', '.join(map(brief, known))}")


def check_flag(name: str, value: object, error: Refusal) -> None:
    """Refuse what is neither True nor False.

    Examples
    --------
    >>> check_flag("resume", "no", StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: resume: 'no' is not True or False

    """
    if not isinstance(value, bool):
        raise error(f"{name}: {shown(value)} is not True or False")


def check_callable(name: str, value: object, error: Refusal) -> None:
    """Refuse what can not be called; nothing may be left out.

    Examples
    --------
    >>> check_callable("progress", 5, StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: progress: 5 is not callable; give a function, or leave it out

    """
    if value is not None and not callable(value):
        raise error(f"{name}: {shown(value)} is not callable; give a function, or leave it out")
