"""Filters and least squares of the inverse dynamic identification model (IDIM)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from breakaway.errors import LogError
from breakaway.measure.logs.log import Array, Log

TRIM_PER_DECIMATION = 10
"""Samples cut off at either end, times ``decimation``: there the filters still ring."""

CONDITION_LIMIT = 30.0
"""Above this condition number of the scaled columns, collinearity is harmful (Belsley, 1980)."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Least-squares estimates with their quality; ``values`` and ``errors`` as the columns."""

    values: Array
    errors: Array
    covariance: Array
    relative_force_error_percent: float
    samples: int
    condition_number: float
    residual_autocorrelation: float


def parallel_filter(columns: Array, decimation: int) -> Array:
    """Filter all columns alike, trim both ends, and keep every ``decimation``-th row.

    The filter is Chebyshev of type I, order 8, ripple 0.05 dB, cutoff 0.8 of the new Nyquist
    frequency, forward and backward. Force and regressors pass the same filter, so it changes
    no parameter; it removes what lies above the band in which the model holds.
    """
    low = signal.cheby1(8, 0.05, 0.8 / decimation, output="sos")
    filtered = np.asarray(signal.sosfiltfilt(low, columns, axis=0), dtype=np.float64)
    trim = TRIM_PER_DECIMATION * decimation
    kept: Array = filtered[trim:-trim:decimation]
    return kept


def least_squares(log: Log, names: tuple[str, ...], columns: Array, force: Array) -> Solution:
    """Solve ``force = columns @ values`` with standard errors.

    ::

        values = (WᵀW)⁻¹ Wᵀ F,    sd² = diag((WᵀW)⁻¹) ‖F - W values‖² / (n - p)

    through the singular values of W with columns scaled to length 1, whose ratio is the
    condition number. The standard errors hold for independent residuals.

    Raises
    ------
    LogError
        The columns are too nearly dependent to tell the parameters apart.

    """
    scale = np.linalg.norm(columns, axis=0)
    left, singular, right = np.linalg.svd(columns / scale, full_matrices=False)
    condition = float(singular[0] / max(singular[-1], np.finfo(float).tiny))
    if not condition <= CONDITION_LIMIT:
        mixed = [
            name for name, part in zip(names, right[-1], strict=True) if abs(float(part)) > 0.3
        ]
        raise LogError(
            f"{log.name}: {' and '.join(mixed)} cannot be told apart (condition number "
            f"{condition:.3g}, at most {CONDITION_LIMIT:g}); record a motion that changes speed "
            "throughout, in both directions, for example a sum of sines"
        )
    values = right.T @ ((left.T @ force) / singular) / scale
    residual = force - columns @ values
    n, p = columns.shape
    power = float(residual @ residual)
    root = right.T / singular / scale[:, None]
    covariance = power / (n - p) * (root @ root.T)
    return Solution(
        values=values,
        errors=np.sqrt(np.diag(covariance)),
        covariance=covariance,
        relative_force_error_percent=100.0 * float(np.sqrt(power) / np.linalg.norm(force)),
        samples=n,
        condition_number=condition,
        residual_autocorrelation=float(residual[1:] @ residual[:-1]) / power if power else 0.0,
    )
