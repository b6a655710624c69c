"""A measurement before the pull: a force that loads the joint and does not free it.

While a joint holds, and is loaded slowly, every law with bristles yields alike: with k_e the
stiffness and F_s the force that breaks it loose, from a turn at (x_0, F_0) on ::

    x - x_0 = s (F_s / k_e) ln((F_s - s F_0) / (F_s - s F)),    s = +1 loading, -1 unloading

(the quasi-static limit of Canudas de Wit et al., 1995, and of Dahl). How x bends tells F_s before
it is reached. With white noise of the position the Fisher information of (ln k_e, ln F_s) is
J'J / sigma^2, J the derivatives of x, and no unbiased estimate is better than its inverse (Cramer
and Rao).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.advice.outcome import Bounds
from breakaway.ask.advice.trying import Tried
from breakaway.model.scenario.laws import stiffness_of

Array = NDArray[np.float64]

UNSURE = 0.05
"""Relative standard deviation of the breakaway force below which it is known well enough."""
RISK = 0.02
"""Share of parts that may break loose in the measurement."""
MARGIN = 0.9
"""Share of the force that this allows, of what is loaded."""
DURATION_S = 10.0
RATE_HZ = 200.0
"""Samples of the reference, and of the position that is read with it."""
STEP = 1e-4
"""Relative step of the derivatives."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """A reference, and how well it would tell the force that breaks a part loose."""

    kind: str
    """Its shape in words."""
    t_s: Array
    force_n: Array
    peak_n: float
    """Its largest force: below what all but 2 % of the parts bear, and within all limits."""
    before: float
    """Relative standard deviation of F_s over the parts, as far as is known."""
    after: float
    """The same after it, at best, for the part in the middle."""
    others: dict[str, float]
    """The same for the references that were not chosen."""

    @property
    def tells(self) -> bool:
        """Whether it tells more than is known."""
        return self.after < 0.5 * self.before


def design_measurement(tried: Tried, bounds: Bounds) -> Measurement | None:
    """Choose the reference that tells most of F_s.

    None where the rig reads no position, or F_s is known to 5 % already.
    """
    noise_m = bounds.rig.sensors.position.noise_rms_m
    before = float(np.std(np.log(tried.quantities["stiction_n"])))
    if "position" not in bounds.rig.reads or noise_m <= 0.0 or before < UNSURE:
        return None
    stiction_n, stiffness = tried.quantities["stiction_n"], stiffness_of(tried.quantities)
    allowed = np.inf if bounds.limits is None else bounds.limits.force_max_n
    safe = float(np.quantile(stiction_n, RISK))
    peak_n = MARGIN * min(safe, allowed, bounds.rig.force_max_n)
    t_s = np.arange(round(DURATION_S * RATE_HZ) + 1) / RATE_HZ
    references = {kind: peak_n * shape(t_s / DURATION_S) for kind, shape in SHAPES.items()}
    errors = {
        kind: float(np.median(_errors(force_n, stiffness, stiction_n, noise_m)))
        for kind, force_n in references.items()
    }
    best = min(errors, key=lambda kind: errors[kind])
    return Measurement(
        kind=best,
        t_s=t_s,
        force_n=references[best],
        peak_n=peak_n,
        before=before,
        after=errors.pop(best),
        others=errors,
    )


def yielding(force_n: Array, stiffness_n_per_m: Array, stiction_n: Array) -> Array:
    """Give the position of joints that hold under a slow force, one row for each joint.

    Parameters
    ----------
    force_n : array of shape (n,)
        The force, from 0, below every stiction.
    stiffness_n_per_m, stiction_n : array of shape (k,)
        k_e and F_s of each joint.

    Examples
    --------
    >>> one = np.ones(1)
    >>> yielding(np.array([0.0, 0.5]), one, one).round(3).tolist()  # ln 2
    [[0.0, 0.693]]

    """
    steps = np.sign(np.diff(force_n))[None, :]
    level, k_e = stiction_n[:, None], stiffness_n_per_m[:, None]
    before, after = level - steps * force_n[None, :-1], level - steps * force_n[None, 1:]
    moved = steps * level / k_e * np.log(before / after)
    return np.concatenate([np.zeros((len(stiction_n), 1)), np.cumsum(moved, axis=1)], axis=1)


def _errors(force_n: Array, stiffness: Array, stiction_n: Array, noise_m: float) -> Array:
    """Give the least relative standard error of F_s of each part that holds."""
    holds = stiction_n > np.max(force_n)
    k_e, level = stiffness[holds], stiction_n[holds]
    by = [
        (yielding(force_n, *up) - yielding(force_n, *down)) / (2.0 * STEP)
        for up, down in (
            ((k_e * (1 + STEP), level), (k_e * (1 - STEP), level)),
            ((k_e, level * (1 + STEP)), (k_e, level * (1 - STEP))),
        )
    ]
    information = np.einsum("akt,bkt->kab", np.array(by), np.array(by)) / noise_m**2
    return np.asarray(np.sqrt(np.linalg.inv(information)[:, 1, 1]))


def _ramp(u: Array) -> Array:
    """Load slowly, and unload."""
    return np.minimum(u / 0.9, (1.0 - u) / 0.1)


def _loops(u: Array) -> Array:
    """Load and unload in loops that grow."""
    count = 5
    loop = np.minimum(np.floor(u * count), count - 1)
    within = u * count - loop
    return (loop + 1.0) / count * (1.0 - np.abs(2.0 * within - 1.0))


def _pulses(u: Array) -> Array:
    """Pulses of full height, with rests between them."""
    return np.clip(1.0 - np.abs(4.0 * ((10.0 * u) % 1.0) - 1.0), 0.0, None)


SHAPES: dict[str, Callable[[Array], Array]] = {
    "a slow ramp": _ramp,
    "five loops that grow": _loops,
    "ten pulses": _pulses,
}
"""Shape of a reference over the share of its duration, from 0 to 1."""
