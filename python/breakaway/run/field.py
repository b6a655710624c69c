"""Friction along the way, as a run of a scenario meets it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway import _core
from breakaway.base.arguments import check_arguments, check_whole, column_of
from breakaway.base.equality import ByValue
from breakaway.errors import ScenarioError
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import core_job, resolve


@dataclass(frozen=True, eq=False)
class FrictionField(ByValue):
    """What multiplies the friction levels along the way; one value for each position."""

    position_m: NDArray[np.float64]
    """x in m."""
    factor: NDArray[np.float64]
    """1 + s(x)."""
    slope_per_m: NDArray[np.float64]
    """ds/dx, in 1/m."""


def friction_field(
    scenario: Scenario, position_m: ArrayLike, *, run_index: int = 0
) -> FrictionField:
    """Give the field of friction that a run of a scenario meets, with its exact slope.

    ``1 + s(x)`` by which a `FieldDisturbance` multiplies all friction levels, in the very
    arithmetic of the run. It depends on the scenario's seed, the number of the run and the place.

    Parameters
    ----------
    scenario : Scenario
        Its disturbance is of the kind ``field``.
    position_m : array_like
        Positions in m, one-dimensional and finite; the guide is from 0 to the engagement length.
    run_index : int, optional
        Number of the run among the runs of the scenario's seed, 0 to 2^64 - 1.

    Returns
    -------
    FrictionField

    Raises
    ------
    ScenarioError
        The disturbance is of another kind, or an argument is not valid.

    Examples
    --------
    >>> import breakaway as bk
    >>> along = bk.FieldDisturbance(var=0.3, correlation_length_m=1e-3)
    >>> scenario = bk.load_scenario("paper_as_computed").with_(disturbance=along)
    >>> field = friction_field(scenario, np.linspace(0.0, 0.1, 1001))
    >>> bool(abs(field.factor - 1.0).max() <= 0.3)
    True

    """
    check_arguments(friction_field, locals(), ScenarioError)
    check_whole("run_index", run_index, ScenarioError, 0, 2**64 - 1)
    x = column_of("position_m", position_m, ScenarioError)
    if not x.size or not np.isfinite(x).all():
        raise ScenarioError(
            "position_m: is empty or holds a number that is not finite; give positions in m"
        )
    if scenario.disturbance.kind != "field":
        raise ScenarioError(
            f"disturbance.kind: {scenario.disturbance.kind!r} is no field; give 'field'"
        )
    field = core_job(resolve(scenario), run_index)["extraction"]["variation"]["field"]
    found = _core.friction_field(field, scenario.seed, run_index, x)
    return FrictionField(x, *(np.frombuffer(column) for column in found))
