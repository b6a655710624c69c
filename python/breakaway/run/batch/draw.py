"""Values of what differs from run to run: random, or spread evenly by a design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from breakaway import _core
from breakaway.base.arguments import check_arguments, check_whole, column_of, run_numbers
from breakaway.base.free_memory import check_fits
from breakaway.base.text import shown
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

SEED_MAX = 2**63 - 1
"""Largest seed, as of a scenario: TOML's integers end there."""

_SHARED_ROWS = 2**31
"""Number of the draw that all shared samples take their row from."""


def draw_columns(
    vary: Mapping[str, Distribution],
    runs: int | range,
    *,
    seed: int,
    design: Design = "random",
    total: int | None = None,
) -> dict[str, Array]:
    """Draw the values of some numbers for some runs.

    Random values depend only on the seed, the run and the place of the number in ``vary``: a run
    has the same values in a batch of any size. A run of another design is a point of the whole
    design, whose size must be given.

    Parameters
    ----------
    vary : mapping
        Distributions by dotted path.
    runs : int or range
        How many, from number 0 on; or their numbers, consecutive.
    seed : int
        Seed of the draws, 0 to 2^63 - 1.
    design : {"random", "sobol", "latin_hypercube"}, optional
        How the values are spread. Sobol points are scrambled, or means would be biased.
    total : int, optional
        Runs of the whole design, which holds ``runs``. Left out: up to the last of them.

    Returns
    -------
    dict
        One column of values for each path, in their order.

    Raises
    ------
    StudyError
        There is no such design, the runs are not among it, an argument has a wrong type or is out
        of range, shared samples differ in length, or the values cannot fit into the free memory.

    Examples
    --------
    >>> import breakaway as bk
    >>> vary = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)}
    >>> ten = draw_columns(vary, range(10), seed=1)["joint.stiction_n"]
    >>> three = draw_columns(vary, range(4, 7), seed=1)["joint.stiction_n"]
    >>> bool((ten[4:7] == three).all())
    True

    """
    check_arguments(draw_columns, locals(), StudyError)
    check_seed(seed)
    numbers = run_numbers(runs, fewest=0)
    size = numbers.stop if total is None else total
    check_whole("total", size, StudyError, numbers.stop)
    for path, distribution in vary.items():
        if not isinstance(distribution, Uniform | LogUniform | Normal | LogNormal | Samples):
            raise StudyError(f"vary[{path!r}]: {shown(distribution)} is not a distribution")
    _check_shared(vary)
    drawn = numbers.stop - numbers.start if design == "random" else size  # a design is made whole
    check_fits("runs", drawn, 8.0 * (len(vary) + 1), "draw fewer at a time")
    points = {} if design == "random" else _points(design, len(vary), size, seed)
    columns = {}
    for number, (path, distribution) in enumerate(vary.items()):
        if isinstance(distribution, Samples) and distribution.rows == "shared":
            u = _fractions(seed, numbers, _SHARED_ROWS)
        elif design == "random":
            u = _fractions(seed, numbers, number)
        else:
            u = points[number][numbers.start : numbers.stop]
        columns[path] = distribution.quantile(u)
    return columns


def check_seed(seed: int) -> None:
    """Refuse what cannot seed the core's draws."""
    check_whole("seed", seed, StudyError, 0, SEED_MAX)


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
        Values by dotted path, finite numbers each.

    Raises
    ------
    StudyError
        There is something other than lists of numbers, or the combinations cannot fit into the free
        memory.

    Examples
    --------
    >>> columns = grid_columns({"disturbance.var": [0.0, 0.1], "part.mass_kg": [1.0, 2.0]})
    >>> columns["disturbance.var"].tolist(), columns["part.mass_kg"].tolist()
    ([0.0, 0.0, 0.1, 0.1], [1.0, 2.0, 1.0, 2.0])

    """
    check_arguments(grid_columns, locals(), StudyError)
    columns = [
        column_of(f"levels[{path!r}]", values, StudyError) for path, values in levels.items()
    ]
    count = math.prod(map(len, columns))
    check_fits("levels", count, 8.0 * len(levels), "give fewer levels")
    tables = np.meshgrid(*columns, indexing="ij")
    return {path: table.ravel() for path, table in zip(levels, tables, strict=True)}
