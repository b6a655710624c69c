"""A model of friction that presumes no law: any hysteresis with any dependence on speed, linear."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from breakaway.measure.identification.record import Rows
from breakaway.measure.identification.uncertainty import covariance
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array

ELEMENTS = 16
"""Springs that each slip at a travel of their own, from the noise up to `WIDEST` of the travel."""

WIDEST = 0.4
STRIBECK = (0.02, 0.06, 0.2)
"""Speeds over which friction may fall, as shares of the largest."""

PEAKED = (0, 4, 8, 12)
"""The elements whose level may fall with speed."""

MOST_ROWS = 20_000
HIDDEN = 1e-6
"""Share of the acceleration that friction and offset cannot stand for, below which it is hidden."""

RANK = 1e-8
"""Singular value, relative to the largest, below which columns count as dependent."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Columns (n, k) of length 1 that friction and inertia are sums of.

    ``joint`` are friction's; the first is the acceleration over ``acceleration_norm``.
    """

    columns: Array
    joint: NDArray[np.bool_]
    acceleration_norm: float

    def friction(self, force: Array) -> Array:
        """Return the share of the force that friction takes."""
        found = np.linalg.lstsq(self.columns, force, rcond=RANK)[0]
        friction: Array = self.columns[:, self.joint] @ found[self.joint]
        return friction

    def mass_kg(self, force: Array) -> tuple[float, float]:
        """Return the mass that the force shows, and its standard error, in kg."""
        inertia, others = self.columns[:, 0], self.columns[:, 1:]
        alone = inertia - others @ np.linalg.lstsq(others, inertia, rcond=RANK)[0]
        if np.linalg.norm(alone) < HIDDEN:
            return 0.0, np.inf
        found = np.linalg.lstsq(self.columns, force, rcond=RANK)[0]
        own = covariance(self.columns @ found - force, self.columns).matrix[0, 0]
        mass = float(alone @ force) / float(alone @ alone)
        return mass / self.acceleration_norm, float(np.sqrt(own)) / self.acceleration_norm

    def resisting(self, force: Array) -> Array:
        """Return the measured force without inertia, viscous friction and offset."""
        found = np.linalg.lstsq(self.columns, force, rcond=RANK)[0]
        left: Array = force - self.columns[:, ~self.joint] @ found[~self.joint]
        return left


def thinned(rows: Rows) -> Rows:
    """Return every so many-th row, so that at most some ten thousand are left."""
    return replace(rows, columns=rows.columns[:, :: 1 + rows.columns.shape[1] // MOST_ROWS])


def reference(rows: Rows) -> Reference:
    """Lay out the columns for the motion of a log.

    ::

        F = m a + σ v + F_0 + Σ_i (w_i + Σ_j w_ij exp(-(v / v_j)²)) P_i

    with P_i the force of a spring that slips at a travel r_i (a stop operator): their sums are the
    hystereses of Prandtl and Ishlinskii, which Maxwell-slip friction is, and near to which LuGre
    and elasto-plastic friction come.
    """
    x, v, a = rows.columns[:3]
    noise = noise_floor(rows.log, "position_m")
    travel, top = float(np.ptp(x)), float(np.quantile(np.abs(v), 0.99))
    finest = max(2.0 * max(noise.white, noise.quantization), 1e-5 * travel)
    reaches = np.geomspace(min(finest, 0.1 * travel), WIDEST * travel, ELEMENTS)
    stops = _stops(x, reaches)
    parts = [a, v, np.ones_like(v), *stops.T]
    for share in STRIBECK:
        slow = np.exp(-((v / (share * top)) ** 2))
        parts += [slow * stops[:, i] for i in PEAKED]
    columns = np.array(parts).T
    norms = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    return Reference(columns / norms, np.arange(len(parts)) >= 3, float(norms[0]))


def _stops(x: Array, reaches: Array) -> Array:
    """Return the force, from -1 to 1, of springs that slip at each reach."""
    out = np.empty((len(x), len(reaches)))
    z = np.zeros_like(reaches)
    for row, step in enumerate(np.diff(x, prepend=x[0])):
        z = np.minimum(np.maximum(z + step, -reaches), reaches)
        out[row] = z
    return out / reaches
