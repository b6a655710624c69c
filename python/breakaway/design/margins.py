"""Margins of a sampled open loop: how far it is from unstable, and in which direction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import inf, nan, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from breakaway.design.loop import check_system
from breakaway.errors import ScenarioError

if TYPE_CHECKING:
    import control

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Response = Callable[[Array], ComplexArray]

EDGE = 1e-12
"""A pole this near to the unit circle, or outside of it, does not count as stable."""
POINTS = 3000
"""Frequencies at which a loop is looked at, before crossings are refined."""


@dataclass(frozen=True)
class Margins:
    """How far a closed loop is from unstable. NaN where the loop is not stable as it is."""

    stable: bool
    """Whether all closed-loop poles lie within the unit circle."""
    poles: tuple[complex, ...]
    """Closed-loop poles in the z plane."""
    poles_per_s: tuple[complex, ...]
    """The same as ``ln(z) / T_s``, in 1/s; a pole at z = 0 is left out."""
    stable_factors: tuple[tuple[float, float], ...]
    """Ranges of a common factor on the loop's gain, above 0, for which it is stable."""
    gain_margin: float
    """Largest factor on the gain before the loop is unstable; infinite if none is."""
    gain_reduction_margin: float
    """Smallest such factor; 0 if none is too small."""
    phase_margin_deg: float
    """Smallest phase, lag or lead, that makes the loop unstable; infinite without a crossover."""
    crossover_rad_per_s: float
    """Where |L| = 1, at the crossover with that phase."""
    delay_margin_s: float
    """Smallest additional delay that makes the loop unstable, in s."""
    delay_margin_samples: float
    """The same in periods."""
    modulus_margin: float
    """Smallest |1 + L|: the distance of the Nyquist curve from -1."""
    modulus_rad_per_s: float
    """Where it is."""
    bandwidth_rad_per_s: float
    """Lowest frequency at which |L / (1 + L)| falls below 1 / sqrt(2); infinite if it does not."""

    @property
    def max_sensitivity(self) -> float:
        """Largest |1 / (1 + L)|, one over the modulus margin."""
        return 1.0 / self.modulus_margin if self.modulus_margin else inf


def margins(loop: control.StateSpace) -> Margins:
    """Find the margins of a sampled open loop under unit negative feedback.

    Stability is decided by the closed loop's poles, and so is every range of gains: margins read
    from a Bode plot alone mislead where a loop is stable only above some gain. Crossings are
    refined by root finding on the exact ``L(exp(j w T_s))`` up to the Nyquist frequency.
    The delay margin is, over all crossovers, the least ``phase lag to -180 deg / w``.

    Parameters
    ----------
    loop : control.StateSpace or control.TransferFunction
        L, of one input and one output, sampled, as from `open_loop`.

    Returns
    -------
    Margins

    Raises
    ------
    ScenarioError
        The loop is not sampled, or has more than one input or output.

    Notes
    -----
    Not exact: the delay margin between whole samples, where it holds for a delay of a signal that
    the hold has left without ripple; for whole samples it is exact. Not checked: uncertainty of
    the plant, other than in gain, phase and delay.

    Examples
    --------
    >>> import control
    >>> found = margins(control.tf([0.5], [1.0, -1.0], 0.1))  # 0.5 / (z - 1)
    >>> found.stable, round(found.gain_margin, 9), round(found.modulus_margin, 9)
    (True, 4.0, 0.75)

    """
    import control

    check_system("loop", loop, "open_loop returns one")
    if not (loop.issiso() and loop.isdtime(strict=True)):
        raise ScenarioError(
            f"loop: has {loop.ninputs} inputs, {loop.noutputs} outputs and dt = {loop.dt}; give a "
            "sampled loop with one input and one output, as open_loop returns"
        )
    period_s = float(loop.dt)
    loop = control.ss(loop)
    poles = _closed_poles(loop, 1.0)
    w = frequencies(loop, poles)
    response = _response_of(loop)
    factors = _stable_factors(loop, w)
    stable = bool(np.all(np.abs(poles) < 1.0 - EDGE))
    inside = [pair for pair in factors if pair[0] < 1.0 < pair[1]] if stable else []
    low, high = inside[0] if inside else (nan, nan)
    phase_deg, crossover, delay_s = _phase(response, w) if stable else (nan, nan, nan)
    modulus, modulus_at = _modulus(response, w) if stable else (nan, nan)
    return Margins(
        stable=stable,
        poles=tuple(complex(pole) for pole in poles),
        poles_per_s=tuple(complex(np.log(p)) / period_s for p in map(complex, poles) if p != 0.0),
        stable_factors=tuple(factors),
        gain_margin=high,
        gain_reduction_margin=low,
        phase_margin_deg=phase_deg,
        crossover_rad_per_s=crossover,
        delay_margin_s=delay_s,
        delay_margin_samples=delay_s / period_s,
        modulus_margin=modulus,
        modulus_rad_per_s=modulus_at,
        bandwidth_rad_per_s=_bandwidth(response, w) if stable else nan,
    )


def closed_poles(loop: control.StateSpace, factors: Array) -> list[ComplexArray]:
    """Closed-loop poles in the z plane for each common factor on the gain.

    Parameters
    ----------
    loop : control.StateSpace
        L, as from `open_loop`.
    factors : numpy.ndarray
        Factors on L.

    Returns
    -------
    list of numpy.ndarray

    Examples
    --------
    >>> import control
    >>> closed_poles(control.ss(control.tf([0.5], [1.0, -1.0], 0.1)), [1.0, 4.0])
    [array([0.5+0.j]), array([-1.+0.j])]

    """
    return [_closed_poles(loop, float(factor)) for factor in factors]


def frequencies(loop: control.StateSpace, poles: ComplexArray) -> Array:
    """Frequencies in rad/s that show a loop: over all its poles up to Nyquist, dense around them.

    Parameters
    ----------
    loop : control.StateSpace
        L, sampled.
    poles : numpy.ndarray
        Poles of the closed loop, in the z plane.

    Returns
    -------
    numpy.ndarray
        Ascending; the last one is the Nyquist frequency.

    Examples
    --------
    >>> import control, numpy
    >>> w = frequencies(control.ss(control.tf([0.5], [1.0, -1.0], 0.1)), numpy.array([0.5]))
    >>> bool(abs(w[-1] - numpy.pi / 0.1) < 1e-12)
    True

    """
    nyquist = pi / float(loop.dt)
    z = np.concatenate([poles, loop.poles(), loop.zeros()]).astype(np.complex128)
    z = z[(np.abs(z) > 1e-9) & np.isfinite(z)]
    sizes = np.abs(np.log(z)) / float(loop.dt)
    sizes = sizes[(sizes > 1e-9 * nyquist) & (sizes < nyquist)]
    low = sizes.min() / 100.0 if sizes.size else nyquist * 1e-4
    offsets = np.concatenate([-np.geomspace(1e-6, 0.3, 60), [0.0], np.geomspace(1e-6, 0.3, 60)])
    near = np.concatenate([[], *(size * (1.0 + offsets) for size in sizes)])
    w = np.unique(np.concatenate([np.geomspace(low, nyquist, POINTS), near]))
    return np.append(w[w < nyquist * (1.0 - 1e-12)], nyquist)


def frequency_response(loop: control.StateSpace, w: Array) -> ComplexArray:
    """``L(exp(j w T_s)) = C (z I - A)^-1 B + D``, for all frequencies at once.

    Parameters
    ----------
    loop : control.StateSpace
        L, sampled.
    w : numpy.ndarray
        Frequencies in rad/s.

    Returns
    -------
    numpy.ndarray

    Examples
    --------
    >>> import control, numpy
    >>> loop = control.ss(control.tf([0.5], [1.0, -1.0], 0.1))
    >>> complex(frequency_response(loop, numpy.array([numpy.pi / 0.1]))[0])  # at z = -1
    (-0.25+0j)

    """
    z = np.exp(1j * np.asarray(w, dtype=np.float64) * float(loop.dt))
    z = np.where(np.abs(z + 1.0) < 1e-9, -1.0, z)  # real at the Nyquist frequency
    system = z[:, None, None] * np.eye(loop.nstates) - loop.A
    states = np.linalg.solve(
        system, np.broadcast_to(loop.B.astype(complex), (*z.shape, *loop.B.shape))
    )
    return np.asarray((loop.C @ states)[:, 0, 0] + loop.D[0, 0], dtype=np.complex128)


def _response_of(loop: control.StateSpace) -> Response:
    return partial(frequency_response, loop)


def _closed_poles(loop: control.StateSpace, factor: float) -> ComplexArray:
    """Eigenvalues of A - B k C / (1 + k D)."""
    gain = factor / (1.0 + factor * loop.D[0, 0])
    poles: ComplexArray = np.linalg.eigvals(loop.A - gain * loop.B @ loop.C).astype(np.complex128)
    return poles


def _stable_factors(loop: control.StateSpace, w: Array) -> list[tuple[float, float]]:
    """Test between the gains at which a pole can cross the unit circle: where L is real."""
    response = _response_of(loop)
    at = np.append(_crossings(response, w, np.imag), w[-1])
    values = response(at).real
    start = np.atleast_1d(loop(1.0, squeeze=True, warn_infinite=False))
    real = np.concatenate([values, start[np.isfinite(start)].real])
    edges = np.unique(-1.0 / real[(real < 0.0) & np.isfinite(real)])
    edges = np.concatenate([[0.0], edges[np.isfinite(edges)], [inf]])
    ranges: list[tuple[float, float]] = []
    for low, high in pairwise(edges):
        if np.max(np.abs(_closed_poles(loop, _between(low, high)))) >= 1.0 - EDGE:
            continue
        if ranges and ranges[-1][1] == low:
            ranges[-1] = (ranges[-1][0], float(high))
        else:
            ranges.append((float(low), float(high)))
    return ranges


def _between(low: float, high: float) -> float:
    if high == inf:
        return 2.0 * low if low else 1.0
    return float(np.sqrt(low * high)) if low else 0.5 * high


def _crossings(response: Response, w: Array, of: Callable[[ComplexArray], Array]) -> Array:
    """Frequencies at which a real function of the response passes zero, refined."""
    values = of(response(w))
    found = np.flatnonzero(np.isfinite(values[:-1] * values[1:]) & (values[:-1] * values[1:] < 0.0))

    def at(frequency: float) -> float:
        return float(of(response(np.array([frequency])))[0])

    from scipy.optimize import brentq

    return np.array([brentq(at, w[i], w[i + 1], xtol=1e-300, rtol=1e-13) for i in found])


def _phase(response: Response, w: Array) -> tuple[float, float, float]:
    """Smallest phase margin in degrees, its frequency, and the smallest delay margin in s."""
    at = _crossings(response, w, lambda value: np.abs(value) - 1.0)
    if not at.size:
        return inf, nan, inf
    lag = np.angle(-response(at)) % (2.0 * pi)  # how far the phase may fall to reach -180 degrees
    either = np.minimum(lag, 2.0 * pi - lag)
    nearest = int(np.argmin(either))
    return float(np.degrees(either[nearest])), float(at[nearest]), float(np.min(lag / at))


def _modulus(response: Response, w: Array) -> tuple[float, float]:
    """Smallest |1 + L|, and its frequency."""

    def distance(frequency: float) -> float:
        return float(np.abs(1.0 + response(np.array([frequency]))[0]))

    values = np.abs(1.0 + response(w))
    best = int(np.argmin(values))
    low, high = w[max(best - 1, 0)], w[min(best + 1, len(w) - 1)]
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        distance, bounds=(low, high), method="bounded", options={"xatol": 1e-9 * low}
    )
    if found.fun < values[best]:
        return float(found.fun), float(found.x)
    return float(values[best]), float(w[best])


def _bandwidth(response: Response, w: Array) -> float:
    """Where |L / (1 + L)| first falls below 1 / sqrt(2)."""

    def above(value: ComplexArray) -> Array:
        return np.asarray(np.sqrt(2.0) * np.abs(value) - np.abs(1.0 + value), dtype=np.float64)

    at = _crossings(response, w, above)
    if above(response(w[:1]))[0] < 0.0:
        return 0.0
    return float(at[0]) if at.size else inf
