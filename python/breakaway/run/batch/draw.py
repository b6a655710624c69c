"""Values of what differs from run to run: random, or spread evenly by a design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from breakaway import _core
from breakaway.base.free_memory import check_fits
from breakaway.errors import StudyError
from breakaway.model.scenario.distribution import (
    Distribution,
    LogNormal,
    LogUniform,
    Normal,
    Samples,
    Uniform,
)

Array = NDArray[np.float64]
Design = Literal["random", "sobol", "latin_hypercube"]
DESIGNS = ("random", "sobol", "latin_hypercube")

_SHARED_ROWS = 2**31
"""Number of the draw that all shared samples take their row from."""


def draw_columns(
    vary: Mapping[str, Distribution],
    runs: range,
    *,
    seed: int,
    design: Design = "random",
    total: int | None = None,
) -> dict[str, Array]:
    """Draw the values of some numbers for some runs.

    Random values are a function of the seed, the run and the place of the number in ``vary``
    alone: any runs of a larger batch have the values that they have in it. A run of another
    design is a point of the whole design, whose size has to be said.

    Parameters
    ----------
    vary : mapping
        Distributions by dotted path.
    runs : range
        Run numbers, consecutive.
    seed : int
        Seed of the draws.
    design : {"random", "sobol", "latin_hypercube"}, optional
        How the values are spread. Sobol points are scrambled, as they have to be for means to be
        without bias.
    total : int, optional
        Runs of the whole design. Left out: up to the last of ``runs``.

    Returns
    -------
    dict
        One column of values for each path, in their order.

    Raises
    ------
    StudyError
        There is no such design, the runs are not among it, something is not a distribution,
        shared samples differ in length, or the values can not fit into the free memory.

    Examples
    --------
    >>> import breakaway as bk
    >>> vary = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)}
    >>> ten = draw_columns(vary, range(10), seed=1)["joint.stiction_n"]
    >>> three = draw_columns(vary, range(4, 7), seed=1)["joint.stiction_n"]
    >>> bool((ten[4:7] == three).all())
    True

    """
    if design not in DESIGNS:
        raise StudyError(f"design: {design!r} is not one of {', '.join(map(repr, DESIGNS))}")
    size = runs.stop if total is None else total
    if runs.step != 1 or runs.start < 0 or runs.stop > size:
        raise StudyError(f"runs: {runs} are not consecutive runs of a design of {size}")
    for path, distribution in vary.items():
        if not isinstance(distribution, Uniform | LogUniform | Normal | LogNormal | Samples):
            raise StudyError(f"vary[{path!r}]: {distribution!r} is not a distribution")
    _check_shared(vary)
    drawn = runs.stop - runs.start if design == "random" else size  # a design is made whole
    check_fits("runs", drawn, 8.0 * (len(vary) + 1), "draw fewer at a time")
    points = {} if design == "random" else _points(design, len(vary), size, seed)
    columns = {}
    for number, (path, distribution) in enumerate(vary.items()):
        if isinstance(distribution, Samples) and distribution.rows == "shared":
            u = _fractions(seed, runs, _SHARED_ROWS)
        elif design == "random":
            u = _fractions(seed, runs, number)
        else:
            u = points[number][runs.start : runs.stop]
        columns[path] = distribution.quantile(u)
    return columns


def _fractions(seed: int, runs: range, number: int) -> Array:
    run_index = np.arange(runs.start, runs.stop, dtype=np.uint64)
    return np.frombuffer(_core.fractions(seed, run_index, number))


def _points(design: Design, dimensions: int, size: int, seed: int) -> dict[int, Array]:
    """Give the points of a whole design, one column for each dimension, within (0, 1)."""
    if not dimensions:
        return {}
    import warnings

    from scipy.stats import qmc

    with warnings.catch_warnings():
        # A number of points that is no power of two costs some balance; that is the user's choice.
        warnings.filterwarnings("ignore", "The balance properties", UserWarning)
        if design == "sobol":
            table = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random(
                size
            )
        else:
            table = qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(size)
    inside = np.clip(table, 2.0**-53, 1.0 - 2.0**-53)
    return dict(enumerate(inside.T))


def _check_shared(vary: Mapping[str, Distribution]) -> None:
    lengths = {
        path: len(d.values)
        for path, d in vary.items()
        if isinstance(d, Samples) and d.rows == "shared"
    }
    if len(set(lengths.values())) > 1:
        raise StudyError(
            f"vary: shared samples have different numbers of rows: {lengths}; they are columns of "
            "one table"
        )


def grid_columns(levels: Mapping[str, Sequence[float]]) -> dict[str, Array]:
    """Give every combination of some values, the last path changing fastest.

    Parameters
    ----------
    levels : mapping
        Values by dotted path.

    Raises
    ------
    StudyError
        The combinations can not fit into the free memory.

    Examples
    --------
    >>> columns = grid_columns({"disturbance.var": [0.0, 0.1], "part.mass_kg": [1.0, 2.0]})
    >>> columns["disturbance.var"].tolist(), columns["part.mass_kg"].tolist()
    ([0.0, 0.0, 0.1, 0.1], [1.0, 2.0, 1.0, 2.0])

    """
    count = math.prod(map(len, levels.values()))
    check_fits("levels", count, 8.0 * len(levels), "give fewer levels")
    tables = np.meshgrid(*(np.asarray(v, dtype=np.float64) for v in levels.values()), indexing="ij")
    return {path: table.ravel() for path, table in zip(levels, tables, strict=True)}
