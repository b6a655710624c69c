"""A force under an input that oscillates about a mean, harmonic by harmonic."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from numpy.typing import NDArray

from breakaway.base.arguments import check_arguments
from breakaway.design.pole_placement import check_positive
from breakaway.errors import ScenarioError

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

POINTS = 128
"""Points of a period at which friction is evaluated."""


def describing_function(
    force: Callable[[Array], Array], amplitude: float, *, bias: float = 0.0, points: int = 4096
) -> tuple[float, complex]:
    """Mean and describing function of a force without memory under ``bias + A cos(theta)``.

    By numeric quadrature over one period (dual-input describing function; Gelb and Vander Velde,
    Multiple-Input Describing Functions, 1968)::

        mean = 1/(2 pi) integral f(b + A cos theta) d theta
        N    = 1/(pi A) integral f(b + A cos theta) exp(-j theta) d theta

    Parameters
    ----------
    force : callable
        f, of an array of inputs.
    amplitude : float
        A, above 0, in the unit of the input.
    bias : float, optional
        b, in the unit of the input.
    points : int, optional
        Points of the midpoint rule, at least 8. A jump of f causes an error of about its size
        divided by the number of points.

    Returns
    -------
    mean : float
        In the unit of the force.
    gain : complex
        N, force over input.

    Raises
    ------
    ScenarioError
        An amplitude or a number of points out of range.

    Examples
    --------
    >>> import numpy as np
    >>> mean, gain = describing_function(np.sign, 2.0)  # a relay: 4 / (pi A)
    >>> round(gain.real * np.pi * 2.0 / 4.0, 6), round(abs(mean), 9)
    (1.0, 0.0)

    """
    check_arguments(describing_function, locals(), ScenarioError)
    check_positive(amplitude=amplitude)
    if points < 8:
        raise ScenarioError(f"points: {points!r} is not >= 8; give a whole number >= 8")
    theta = midpoints(points)
    values = np.asarray(force(bias + amplitude * np.cos(theta)), dtype=np.float64)
    return float(np.mean(values)), complex(harmonic(values, 1) / amplitude)


def midpoints(points: int) -> Array:
    """Middles of equal parts of a period, in rad.

    Examples
    --------
    >>> midpoints(2)
    array([1.57079633, 4.71238898])

    """
    return np.asarray((np.arange(points) + 0.5) * (2.0 * pi / points), dtype=np.float64)


def harmonic(values: Array, order: int) -> ComplexArray:
    """Complex amplitude of a harmonic of what is given at `midpoints`, along the last axis.

    Examples
    --------
    >>> bool(abs(harmonic(3.0 * np.cos(2.0 * midpoints(16)), 2) - 3.0) < 1e-12)
    True

    """
    turn = np.exp(-1j * order * midpoints(values.shape[-1]))
    amplitude: ComplexArray = np.asarray(2.0 * np.mean(values * turn, axis=-1))
    return amplitude
