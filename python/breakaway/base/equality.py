"""When two results are equal: every value is, and what did not happen in both counts as equal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class ByValue:
    """Base of dataclasses (with ``eq=False``) that are equal where their values are, arrays too.

    Not a number equals itself here; 0.0 equals -0.0, as everywhere in Python. There is no hash,
    since arrays have none.
    """

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in fields(self)]
        return all(same(getattr(self, name), getattr(other, name)) for name in names)


def same(one: Any, other: Any) -> bool:  # noqa: ANN401 - any value of a result
    """Whether two values are equal, where not a number equals itself.

    Examples
    --------
    >>> same({"release_s": float("nan")}, {"release_s": float("nan")}), same([0.0], [1.0])
    (True, False)

    """
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        has_nan = one.dtype.kind == "f" and other.dtype.kind == "f"
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=has_nan)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float) and isinstance(other, float) and one != one:
        return other != other
    return bool(one == other)
