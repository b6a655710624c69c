"""Quantities of a part that go together: correlated by their normal scores."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from breakaway.model.scenario.model import Model, Name

Array = NDArray[np.float64]

SMALLEST_EIGENVALUE = 1e-9
"""A correlation matrix is positive definite where its smallest eigenvalue is above this."""


class Correlation(Model):
    """The correlation of two quantities of a part.

    Both keep their distributions. What is correlated are their normal scores, the standard normal
    values with the same shares below (a Gaussian copula). Spearman's rank correlation is then
    (6/pi) asin(normal/2).

    Examples
    --------
    >>> Correlation(of=("stiction_n", "presliding_m"), normal=0.5).normal
    0.5

    """

    of: Annotated[tuple[Name, Name], Field(strict=False)]
    """The two quantities, by their names among the parts' distributions."""
    normal: Annotated[float, Field(gt=-1.0, lt=1.0)]
    """Correlation of their normal scores."""


def correlation_matrix(names: Sequence[str], correlations: Sequence[Correlation]) -> Array:
    """Give the correlations of the normal scores of some quantities.

    Examples
    --------
    >>> one = Correlation(of=("b", "a"), normal=0.5)
    >>> correlation_matrix(["a", "b"], [one]).tolist()
    [[1.0, 0.5], [0.5, 1.0]]

    """
    matrix = np.eye(len(names))
    for correlation in correlations:
        i, j = (list(names).index(name) for name in correlation.of)
        matrix[i, j] = matrix[j, i] = correlation.normal
    return matrix


def check_correlations(names: Sequence[str], correlations: Sequence[Correlation]) -> None:
    """Raise a ValueError unless the quantities exist and can go together like this."""
    pairs: set[frozenset[str]] = set()
    for place, correlation in enumerate(correlations):
        where = f"correlations.{place}.of"
        for name in correlation.of:
            if name not in names:
                raise ValueError(f"{where}: {name!r} is not one of {', '.join(names)}")
        pair = frozenset(correlation.of)
        if len(pair) < 2:
            raise ValueError(f"{where}: names {correlation.of[0]!r} twice; give two quantities")
        if pair in pairs:
            raise ValueError(
                f"{where}: {' and '.join(correlation.of)} have a correlation already; leave one out"
            )
        pairs.add(pair)
    smallest = float(np.linalg.eigvalsh(correlation_matrix(names, correlations))[0])
    if not smallest > SMALLEST_EIGENVALUE:
        raise ValueError(
            "correlations: no parts can have all of them: the smallest eigenvalue of their matrix "
            f"is {smallest:.3g}, not > 0; give weaker ones"
        )


def lower_factor(matrix: Array) -> Array:
    """Give the lower triangular factor L of a positive definite matrix, L L' = matrix (Cholesky).

    Written out, so that it has the same bits on every machine.

    Examples
    --------
    >>> lower_factor(np.array([[1.0, 0.6], [0.6, 1.0]])).tolist()
    [[1.0, 0.0], [0.6, 0.8]]

    """
    lower = np.zeros_like(matrix)
    for i in range(len(matrix)):
        for j in range(i + 1):
            rest = matrix[i, j] - sum(lower[i, k] * lower[j, k] for k in range(j))
            lower[i, j] = np.sqrt(rest) if i == j else rest / lower[j, j]
    return lower
