"""Arguments of public functions: what is of a wrong kind is refused where it comes in.

The annotations of a function say what it takes, and nothing else does: `check_arguments` reads
them. What they cannot say, such as a range, is left to the function.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any, Literal, NoReturn, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from breakaway.base.text import brief, shown
from breakaway.errors import BreakawayError, LogError, OutputError, ScenarioError, StudyError

Refusal = type[BreakawayError]
"""Class of the error that refuses an argument."""

REMEDIES: dict[str, tuple[Refusal, str]] = {
    "Identification": (LogError, "identify returns one"),
    "InertiaFrictionFit": (LogError, "identify_inertia_friction returns one"),
    "JointFile": (ScenarioError, "give what identify found, or the file that it wrote"),
    "Log": (LogError, "read one from a file with read_log"),
    "Method": (ScenarioError, "load a preset or a file with load_method"),
    "PartPopulation": (ScenarioError, "load a preset or a file with load_population"),
    "SweepStudy": (StudyError, "load one from a file with load_study"),
    "Scenario": (ScenarioError, "load a preset or a file with load_scenario"),
    "Tuning": (StudyError, "load one from a file with load_tuning"),
}
"""Name of a class -> the error where something else is given, and how to come by one."""

FIRST_RUN_MAX = 2**63 - 1
"""Largest number that the first of some runs may have."""


def check_arguments(
    function: Callable[..., object], arguments: Mapping[str, object], error: Refusal
) -> None:
    """Refuse arguments that are not of the kinds that a function's annotations say.

    Called first thing in a public function, with ``locals()``. The error is of the class given, but
    for what has one of its own: a destination ``out``, and the classes of `REMEDIES`.

    Examples
    --------
    >>> def wait(duration_s: float, *, times: int = 1, told: Callable[[], None] | None = None):
    ...     check_arguments(wait, locals(), StudyError)
    >>> wait(1)
    >>> wait(1.0, times="twice")
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: times: 'twice' is not a whole number; give one

    """
    for name, hint in _hints(function).items():
        if name in arguments and not _fits(arguments[name], hint):
            _refuse(name, arguments[name], hint, OutputError if name == "out" else error)


@cache
def _hints(function: Callable[..., object]) -> dict[str, Any]:
    """Give the annotations of the parameters, but for those whose names type checkers alone see."""
    hints = {}
    for name, text in function.__annotations__.items():
        alone = types.SimpleNamespace(__annotations__={name: text})
        with suppress(NameError):
            hints[name] = get_type_hints(alone, function.__globals__)[name]
    hints.pop("return", None)
    return hints


def _fits(value: object, hint: Any) -> bool:  # noqa: ANN401 - any annotation
    """Whether a value is of the kind of an annotation; what is not understood fits everything."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, one) for one in inner)
    if origin is Literal:
        return any(type(value) is type(one) and value == one for one in inner)
    if origin is tuple and Ellipsis not in inner:
        return isinstance(value, tuple | list) and _all_fit(value, inner)
    if origin is Callable:
        return callable(value)
    if origin in (Sequence, Iterable, list, tuple):
        return _is_list(value, origin, inner[0])
    if origin in (Mapping, dict):
        return isinstance(value, Mapping) and all(_fits(key, inner[0]) for key in value)
    if hint in (int, float):
        return isinstance(value, Real if hint is float else Integral) and not isinstance(
            value, bool
        )
    if hint is bool:
        return isinstance(value, bool | np.bool_)
    if hint is Path:
        return isinstance(value, PathLike)
    if isinstance(origin, type):  # such as an array of numbers
        return isinstance(value, origin)
    return not _is_class(hint) or isinstance(value, hint)


def _is_list(value: object, origin: object, element: object) -> bool:
    """Whether a value is a list of its kind; words of which some are known are left to others."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        return False
    if not isinstance(value, Sequence):
        return origin is Iterable  # which looking at would use up
    return get_origin(element) is Literal or all(_fits(one, element) for one in value)


def _all_fit(values: Sequence[object], hints: Sequence[object]) -> bool:
    return len(values) == len(hints) and all(map(_fits, values, hints))


def _is_class(hint: object) -> bool:
    return isinstance(hint, type) and hint is not Any and not getattr(hint, "_is_protocol", False)


def _refuse(name: str, value: object, hint: object, error: Refusal) -> NoReturn:
    kinds = [one for one in _alternatives(hint) if one is not types.NoneType]
    words = " or ".join(dict.fromkeys(_words(one) for one in kinds))
    names = [getattr(one, "__name__", "") for one in kinds]
    error, remedy = next((REMEDIES[n] for n in names if n in REMEDIES), (error, "give one"))
    end = "" if get_origin(kinds[0]) is Literal else f"; {remedy}"
    raise error(f"{name}: {shown(value)} is not {words}{end}")


def _alternatives(hint: object) -> tuple[Any, ...]:
    """Give what a union is of; a text that may stand for a path is a path."""
    if get_origin(hint) not in (Union, types.UnionType):
        return (hint,)
    inner = get_args(hint)
    return tuple(one for one in inner if not (one is str and Path in inner))


_WORDS = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a text",
    Path: "a path",
}
_PLURALS = {int: "whole numbers", float: "numbers", str: "names"}


def _words(hint: Any) -> str:  # noqa: ANN401 - any annotation
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Literal:
        return f"one of {', '.join(map(str, inner))}"
    if origin is Callable:
        return "a function"
    if origin is tuple and Ellipsis not in inner:
        return f"a pair of {_PLURALS[inner[0]]}"
    if origin in (Sequence, Iterable, list, tuple):
        kind = _alternatives(inner[0])[-1]
        if get_origin(kind) is tuple:
            return "a list of pairs of numbers"
        return f"a list of {_PLURALS.get(kind, getattr(kind, '__name__', 'names'))}"
    if origin in (Mapping, dict):
        return "a mapping"
    if hint in _WORDS:
        return _WORDS[hint]
    name = (origin or hint).__name__
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def check_whole(name: str, value: int, error: Refusal, low: int, high: int | None = None) -> None:
    """Refuse what is not a whole number from ``low`` to ``high``, both included.

    Examples
    --------
    >>> check_whole("seed", -1, StudyError, 0)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: seed: -1 is not a whole number of at least 0

    """
    if not (_fits(value, int) and low <= value and (high is None or value <= high)):
        raise error(f"{name}: {shown(value)} is not a whole number {_between(low, high)}")


def _between(low: int, high: int | None) -> str:
    return f"of at least {low}" if high is None else f"from {low} to {high}"


def run_numbers(runs: int | range, *, fewest: int = 1, most: int | None = None) -> range:
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
    check_arguments(run_numbers, locals(), StudyError)
    numbers = runs if isinstance(runs, range) else range(runs)
    count = numbers.stop - numbers.start  # len() ends at 2^63
    consecutive = numbers.step == 1 and 0 <= numbers.start <= FIRST_RUN_MAX
    if not consecutive or count < fewest or (most is not None and count > most):
        raise StudyError(
            f"runs: {shown(runs)} is not a whole number {_between(fewest, most)}, nor a range of "
            "that length, such as range(100, 200)"
        )
    return numbers


def column_of(name: str, values: object, error: Refusal) -> NDArray[np.float64]:
    """Give numbers as a one-dimensional array, or refuse what is none.

    Examples
    --------
    >>> column_of("t_s", [0, 1], StudyError)
    array([0., 1.])
    >>> column_of("t_s", "now", StudyError)
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: t_s: 'now' is not a list of numbers; give one

    """
    try:
        column = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        column = np.zeros(())
    if column.ndim != 1:
        raise error(f"{name}: {shown(values)} is not a list of numbers; give one")
    return column


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
