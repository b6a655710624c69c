"""Tables of a study file that are keyed by dotted paths: what varies, and what is swept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil, isfinite
from typing import Any, get_args

import numpy as np

from breakaway.base.text import shown
from breakaway.errors import ScenarioError
from breakaway.model.scenario.distribution import Distribution
from breakaway.model.scenario.model import Model, Name

Level = bool | int | float | Name
"""A value that is swept."""

_DISTRIBUTIONS: dict[str, type[Model]] = {
    model.model_fields["distribution"].default: model
    for model in get_args(get_args(Distribution)[0])
}


def varied_numbers(tables: object) -> object:
    """Read distributions by dotted path, from quoted paths or from tables within tables.

    Raises
    ------
    ValueError
        A table is not a distribution, or not a valid one.

    """
    if not isinstance(tables, Mapping):
        return tables
    return {path: _distribution(path, table) for path, table in _flat(tables)}


def _distribution(path: str, table: object) -> object:
    if isinstance(table, Model):
        return table
    known = ", ".join(repr(name) for name in _DISTRIBUTIONS)
    if not isinstance(table, Mapping) or "distribution" not in table:
        raise ValueError(
            f"{path}: {shown(table)} is not a distribution; give a table with distribution = one "
            f"of {known}"
        )
    kind = table["distribution"]
    if not isinstance(kind, str) or kind not in _DISTRIBUTIONS:
        raise ValueError(f"{path}.distribution: {shown(kind)} is not one of {known}")
    try:
        return _DISTRIBUTIONS[kind](**table)
    except ScenarioError as error:
        raise ValueError(f"{path}.{error}".replace("\n", f"\nvary.{path}.")) from None


def grid_levels(tables: object) -> object:
    """Read the values of each swept path: a list, or a range with a count.

    Raises
    ------
    ValueError
        A path has no values, the same value twice, or an invalid range.

    Examples
    --------
    >>> grid_levels({"joint": {"stiction_n": {"from": 100, "to": 400, "count": 3}}})
    {'joint.stiction_n': [100.0, 250.0, 400.0]}
    >>> grid_levels({"part.mass_kg": {"from": 1, "to": 100, "count": 3, "spacing": "log"}})
    {'part.mass_kg': [1.0, 10.0, 100.0]}

    """
    if not isinstance(tables, Mapping):
        return tables
    return {path: _levels(path, values) for path, values in _flat(tables)}


def stepped_levels(low: float, high: float, resolution: float) -> list[float]:
    """Give the levels that a search may try: low, low + resolution, ..., high.

    Examples
    --------
    >>> stepped_levels(0.1, 0.45, 0.1)
    [0.1, 0.2, 0.3, 0.4, 0.45]

    """
    steps = ceil((high - low) / resolution - 1e-9)
    # Twelve digits, so that a level reads as it was meant: 0.3 and not 0.30000000000000004.
    inner = [float(f"{low + k * resolution:.12g}") for k in range(1, steps)]
    return [low, *inner, high]


def _levels(path: str, values: object) -> list[Level]:
    levels = _spaced(path, values) if isinstance(values, Mapping) else values
    if not isinstance(levels, list | tuple) or not levels:
        raise ValueError(
            f"{path}: {shown(values)} holds no values; give a list of them, or "
            "{ from = ..., to = ..., count = ... }"
        )
    for level in levels:
        if not isinstance(level, bool | int | float | str) or (
            isinstance(level, float) and not isfinite(level)
        ):
            raise ValueError(
                f"{path}: {shown(level)} is not a finite number, a text, true or false"
            )
    if len(set(levels)) < len(levels):
        twice = next(level for level in levels if levels.count(level) > 1)
        raise ValueError(f"{path}: {shown(twice)} is given twice; give each value once")
    kinds = {float if type(level) is int else type(level) for level in levels}
    if len(kinds) > 1:
        raise ValueError(f"{path}: {shown(levels)} mixes kinds of values; give numbers or texts")
    return list(levels)


_SPACINGS: dict[str, Callable[[float, float, int], Any]] = {
    "linear": np.linspace,
    "log": np.geomspace,
}


def _spaced(path: str, table: Mapping[str, Any]) -> list[Level]:
    unknown = sorted(set(table) - {"from", "to", "count", "spacing"})
    if unknown:
        raise ValueError(
            f"{path}.{unknown[0]}: is not a known key; known keys: from, to, count, spacing"
        )
    for key, kinds, wanted in (
        ("from", int | float, "a number"),
        ("to", int | float, "a number"),
        ("count", int, "a whole number >= 2"),
    ):
        value = table.get(key)
        if not isinstance(value, kinds) or isinstance(value, bool) or not isfinite(value):
            found = "is missing" if key not in table else f"{value!r} is not {wanted}"
            raise ValueError(f"{path}.{key}: {found}; give {wanted}")
    first, last, count = float(table["from"]), float(table["to"]), table["count"]
    spacing = table.get("spacing", "linear")
    if spacing not in _SPACINGS:
        raise ValueError(f"{path}.spacing: {spacing!r} is not one of 'linear', 'log'")
    if not first < last:
        raise ValueError(f"{path}.from: {first!r} is not < to = {last!r}; swap them")
    if not 2 <= count <= 100_000:
        raise ValueError(f"{path}.count: {count!r} is not within 2 to 100000; give such a number")
    if spacing == "log" and first <= 0.0:
        raise ValueError(f"{path}.from: {first!r} is not > 0; a logarithmic scale needs that")
    return [float(value) for value in _SPACINGS[spacing](first, last, count)]


def _flat(tables: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Give the innermost tables and values by dotted path."""
    found: list[tuple[str, Any]] = []
    for name, value in tables.items():
        deeper = isinstance(value, Mapping) and any(
            isinstance(inner, Mapping | Model | list) for inner in value.values()
        )
        if deeper and "distribution" not in value:
            found += _flat(value, f"{prefix}{name}.")
        else:
            found.append((f"{prefix}{name}", value))
    return found
