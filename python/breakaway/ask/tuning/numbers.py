"""The numbers of a method, by dotted path."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any, get_type_hints

from pydantic import BaseModel, TypeAdapter, ValidationError

from breakaway.errors import StudyError
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.model import numbers_of, valid_range


def number_paths(method: Method) -> list[str]:
    """Give the paths of all numbers of a method that can be tuned.

    What a method knows of each part is not among them.

    Examples
    --------
    >>> import breakaway as bk
    >>> number_paths(bk.load_method("force_ramp"))[-1]
    'controller.rate_n_per_s'

    """
    return [path for path in numbers_of(method) if path not in method.knows]


def check_number(method: Method, path: str, values: Mapping[str, float]) -> None:
    """Raise unless a path is a number of the method, and may have each of the values by itself.

    Raises
    ------
    StudyError
        The message names the path, the value, the range and the remedy.

    """
    known = number_paths(method)
    if path in method.knows:
        raise StudyError(
            f"tune.{path}: is set for each part already (knows); take it out of one of the two"
        )
    if path not in known:
        near = difflib.get_close_matches(path, known, n=1, cutoff=0.6)
        hint = f"did you mean {near[0]}?" if near else f"its numbers are {', '.join(known)}"
        raise StudyError(f"tune.{path}: is not a number of the method {method.name!r}; {hint}")
    owner, name = _owner(method, path)
    allowed = TypeAdapter[float](get_type_hints(type(owner), include_extras=True)[name])
    for key, value in values.items():
        try:
            allowed.validate_python(value)
        except ValidationError:
            raise StudyError(
                f"tune.{path}.{key}: {value!r} is not {valid_range(type(owner), name)}; give such "
                "a number"
            ) from None


def number_of(method: Method, path: str) -> float | None:
    """Give a number of a method, None where it is left open."""
    owner, name = _owner(method, path)
    value: float | None = getattr(owner, name)
    return value


def with_numbers(method: Method, numbers: Mapping[str, float]) -> Method:
    """Give the method with other numbers, checked.

    Raises
    ------
    ScenarioError
        The numbers do not go together.

    Examples
    --------
    >>> import breakaway as bk
    >>> feed = bk.load_method("steady_feed")
    >>> with_numbers(feed, {"controller.speed_m_per_s": 0.02}).controller.speed_m_per_s
    0.02

    """
    values = method.model_dump()
    for path, number in numbers.items():
        *parents, last = path.split(".")
        inner: dict[str, Any] = values
        for name in parents:
            inner = inner[name]
        inner[last] = number
    return Method.parse(values)


def _owner(method: Method, path: str) -> tuple[BaseModel, str]:
    *parents, name = path.split(".")
    owner: BaseModel = method
    for parent in parents:
        owner = getattr(owner, parent)
    return owner, name
