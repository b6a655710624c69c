"""A scenario some of whose numbers are columns, one value for each run."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from breakaway import _core
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.model import holds_number, numbers_of
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import core_job, resolve, with_gains

Array = NDArray[np.float64]
AnyModel = TypeVar("AnyModel", bound=BaseModel)

CORNERS_ALWAYS = 64
"""Combinations of extremes that are tried however few the runs are."""


def with_nominal_controller(scenario: Scenario) -> Scenario:
    """Give the scenario with its controller designed for it, whatever part it will meet."""
    return scenario.model_copy(update={"controller": with_gains(scenario)})


def at_run(scenario: Scenario, columns: Mapping[str, Array], i: int) -> Scenario:
    """Give the scenario of run ``i``, checked."""
    return scenario.with_({path: float(values[i]) for path, values in columns.items()})


def check_paths(scenario: Scenario, paths: Mapping[str, Any]) -> None:
    """Raise unless every path leads to a number that may differ within a batch.

    Raises
    ------
    StudyError
        A path leads nowhere, to no number, or to a number that all runs of a batch share.

    """
    for path in paths:
        owner, name = _owner(scenario, path)
        if not holds_number(type(owner).model_fields[name].annotation):
            raise StudyError(f"{path}: is not a number that can differ from run to run")
        if path.split(".")[0] in ("timing", "trace"):
            raise StudyError(
                f"{path}: all runs of a batch share it; sweep it in a study, where each value has "
                "its own batch"
            )


def _owner(scenario: Scenario, path: str) -> tuple[BaseModel, str]:
    *parents, name = path.split(".")
    model: Any = scenario
    for parent in parents:
        model = getattr(model, parent, None) if isinstance(model, BaseModel) else None
    if not isinstance(model, BaseModel) or name not in type(model).model_fields:
        known = ", ".join(number_paths(scenario))
        raise StudyError(f"{path}: is not a number of the scenario; its numbers are {known}")
    return model, name


def number_paths(scenario: Scenario) -> list[str]:
    """Paths of all numbers that may differ from run to run.

    Examples
    --------
    >>> import breakaway as bk
    >>> number_paths(bk.load_scenario("paper_as_computed"))[:2]
    ['joint.stiction_n', 'joint.coulomb_n']

    """
    return [
        path
        for path in numbers_of(with_nominal_controller(scenario))
        if not path.startswith(("timing.", "trace."))
    ]


def check_values(scenario: Scenario, columns: Mapping[str, Array], first_run: int = 0) -> None:
    """Raise unless every run is a valid scenario.

    Every rule of a scenario is a comparison that a number can only make worse in one direction. So
    if all combinations of the smallest and largest values are valid, every run is; if
    not, every run is looked at.

    Raises
    ------
    StudyError
        A run is not valid; the message names it, the field, the value and the range.

    """
    if not columns or not len(next(iter(columns.values()))):
        return
    runs = len(next(iter(columns.values())))
    if 2 ** len(columns) <= max(runs, CORNERS_ALWAYS) and _corners_are_valid(scenario, columns):
        return
    values = scenario.model_dump()
    for i in range(runs):
        for path, column in columns.items():
            _put(values, path, float(column[i]))
        try:
            Scenario.parse(values)
        except ScenarioError as error:
            raise StudyError(f"run {first_run + i}: {error}") from None


def _corners_are_valid(scenario: Scenario, columns: Mapping[str, Array]) -> bool:
    if not all(np.isfinite(column).all() for column in columns.values()):
        return False
    values = scenario.model_dump()
    extremes = [sorted({float(c.min()), float(c.max())}) for c in columns.values()]
    for corner in itertools.product(*extremes):
        for path, value in zip(columns, corner, strict=True):
            _put(values, path, value)
        try:
            Scenario.parse(values)
        except ScenarioError:
            return False
    return True


def core_columns(
    scenario: Scenario, columns: Mapping[str, Array]
) -> tuple[dict[str, Any], list[tuple[int, Array]]]:
    """Give the job that the runs share, and the numbers that differ with their places in it.

    What a scenario leaves open and follows from its numbers, such as the residual friction or a
    bound, is resolved column by column, in the arithmetic of a single scenario.
    """
    model = scenario
    for path, values in columns.items():
        model = _with_column(model, path.split("."), values)
    whole = core_job(resolve(model), 0)
    shared: dict[str, Any] = copy.deepcopy(whole)
    varied = dict(_arrays(whole, ""))
    for path, column in varied.items():
        _put(shared, path, float(column[0]))
    found = _core.number_places(shared)
    places = [(found[_named_in_core(path)], column) for path, column in varied.items()]
    return shared, places


def _with_column(model: AnyModel, path: list[str], values: Array) -> AnyModel:
    """Put a column where a number is, unchecked."""
    name, *rest = path
    inner = values if not rest else _with_column(getattr(model, name), rest, values)
    return model.model_copy(update={name: inner})


def _arrays(values: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Array]]:
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _arrays(value, f"{prefix}{name}.")
        elif isinstance(value, np.ndarray):
            yield f"{prefix}{name}", value


def _named_in_core(path: str) -> str:
    """Leave out the tables that hold a law's numbers: names of the core do."""
    return ".".join(name for name in path.split(".") if name not in ("friction", "law"))


def _put(values: dict[str, Any], path: str, value: float) -> None:
    *parents, last = path.split(".")
    for name in parents:
        values = values[name]
    values[last] = value
