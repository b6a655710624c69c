"""Self-excited oscillation of a sliding part: the describing function of friction in the loop."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from breakaway.base.arguments import check_arguments
from breakaway.design.describing_function import POINTS, harmonic, midpoints
from breakaway.design.loop import SampledPid
from breakaway.design.pole_placement import check_positive, with_residual
from breakaway.errors import ScenarioError
from breakaway.model.friction.curve import has_elements, steepest_change_velocity
from breakaway.model.friction.periodic import friction_over_period
from breakaway.model.scenario.joint import AnyJoint

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

AMPLITUDES = np.geomspace(0.01, 10.0, 61)
"""Amplitudes that are looked at, over the mean speed."""
HARMONICS_MAX = 15
"""Most harmonics of a balance: friction is evaluated at `POINTS` points of a period."""


@dataclass(frozen=True)
class LimitCycle:
    """A self-sustained oscillation while the part slides at a mean speed."""

    speed_m_per_s: float
    """Mean speed, in m/s."""
    position_m: float
    """Where along the guide, in m."""
    frequency_hz: float
    """Its frequency, in Hz."""
    amplitude_m_per_s: float
    """Amplitude of the speed's first harmonic, in m/s."""
    stable: bool
    """Whether it attracts. One that does not is the threshold beyond which an oscillation grows."""
    harmonics_m_per_s: tuple[float, ...]
    """Amplitudes of the harmonics that were balanced, in m/s, the first one first."""

    @property
    def period_s(self) -> float:
        """Its period, in s."""
        return 1.0 / self.frequency_hz


def limit_cycles(
    pid: SampledPid,
    joint: AnyJoint,
    mass_kg: float,
    speed_m_per_s: float,
    *,
    position_m: float = 0.0,
    harmonics: int = 1,
) -> tuple[LimitCycle, ...]:
    """Predict the limit cycles of a part that slides at a mean speed.

    With the speed ``v0 + A cos(w t)`` the first harmonics of all forces balance::

        1 + N(A, w; v0) L(j w) = 0,   1 / L = j w m + G(j w),   N A = first harmonic of R
        G = H0 z**-n [(kp + ki T_s z / (z - 1)) / (j w) + kd D(z)],   z = exp(j w T_s)

    with the hold ``H0 = (1 - 1/z) / (j w T_s)``, n samples of delay and the derivative's filter D.
    R passes through the bristles of equation (2), reversal included. More harmonics are balanced
    the same way, each by itself, and show what a single one leaves out.

    Parameters
    ----------
    pid : SampledPid
        The controller.
    joint : AnyJoint
        The joint.
    mass_kg : float
        m, above 0.
    speed_m_per_s : float
        v0, above 0.
    position_m : float, optional
        Where along the guide, in m: friction falls with it.
    harmonics : int, optional
        How many harmonics are balanced, 1 to 15.

    Returns
    -------
    tuple of LimitCycle
        By amplitude; empty where none is found up to ten times the mean speed, for a law
        without Stribeck curve, and for one of Maxwell-slip elements.

    Raises
    ------
    ScenarioError
        A parameter is out of range.

    Notes
    -----
    Neglected: change of speed and position during a period; aliases of harmonics beyond Nyquist;
    limits of the actuator; for laws other than LuGre, bristles that differ from LuGre's. Not found:
    cycles far from the frequency at which the loop without friction is in balance.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> gains = bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2)  # Table II
    >>> [cycle] = bk.design.limit_cycles(
    ...     bk.design.SampledPid(gains, period_s=1e-5), joint, 1.0, 0.06)
    >>> round(cycle.frequency_hz), round(cycle.amplitude_m_per_s, 3), cycle.stable
    (292, 0.062, True)

    """
    check_arguments(limit_cycles, locals(), ScenarioError)
    check_positive(speed_m_per_s=speed_m_per_s)
    if harmonics not in range(1, HARMONICS_MAX + 1):
        raise ScenarioError(
            f"harmonics: {harmonics!r} is not a whole number within 1 to {HARMONICS_MAX}"
        )
    if not 0.0 <= position_m <= joint.engagement_length_m:
        raise ScenarioError(
            f"position_m: {position_m!r} is not within the guide, 0 to "
            f"joint.engagement_length_m = {joint.engagement_length_m!r}; give a position in m"
        )
    oscillator = oscillator_of(pid, joint, mass_kg)
    if oscillator is None:
        return ()
    found = oscillator.orbits(speed_m_per_s, position_m)
    if harmonics > 1:
        found = [oscillator.balanced(cycle, harmonics) for cycle in found]
    return tuple(found)


def oscillator_of(pid: SampledPid, joint: AnyJoint, mass_kg: float) -> Oscillator | None:
    """Give the loop as an oscillator, or None where nothing can keep it oscillating.

    Parameters
    ----------
    pid : SampledPid
        The controller.
    joint : AnyJoint
        The joint.
    mass_kg : float
        m, above 0.

    Returns
    -------
    Oscillator or None
        None for a law without Stribeck curve, one of Maxwell-slip elements, which have no
        describing function here, or a loop that without friction has no frequency below Nyquist
        at which mass and controller are in balance.

    Examples
    --------
    >>> import breakaway as bk
    >>> joint = bk.load_scenario("paper_as_computed").joint
    >>> pid = SampledPid(bk.design.PidGains(kp=3.1e6, ki=0.0, kd=700.0), period_s=1e-5)
    >>> round(oscillator_of(pid, joint, 1.0).free_hz)  # sqrt(kp / m) / (2 pi)
    280

    """
    check_positive(mass_kg=mass_kg)
    if steepest_change_velocity(joint) is None or has_elements(joint):
        return None
    w = np.geomspace(1e-6, 0.98, 4000) * pi / pid.period_s
    impedance = _impedance(pid, mass_kg, w)
    rising = np.flatnonzero((impedance.imag[:-1] < 0.0) & (impedance.imag[1:] >= 0.0))
    if not rising.size:
        return None
    least_damped = rising[np.argmin(impedance.real[rising])]
    free_hz = float(w[least_damped] / (2.0 * pi))
    return Oscillator(pid, with_residual(joint, mass_kg), mass_kg, free_hz)


@dataclass(frozen=True)
class Oscillator:
    """A mass under a PID, and the friction that may drive it."""

    pid: SampledPid
    joint: AnyJoint
    """The joint, its residual force explicit."""
    mass_kg: float
    free_hz: float
    """Frequency at which mass and controller balance without friction, in Hz."""

    def balance(self, amplitude: Array, w: Array, speed: Array, position: Array) -> ComplexArray:
        """1/L + N in N s/m, whose real part damps and whose imaginary part sets the frequency."""
        v = speed[..., None] + amplitude[..., None] * np.cos(midpoints(POINTS))
        force = friction_over_period(self.joint, v, w, position_m=position)
        total: ComplexArray = _impedance(self.pid, self.mass_kg, w) + harmonic(force, 1) / amplitude
        return total

    def growth(
        self, amplitude: ArrayLike, speed: ArrayLike, position: ArrayLike
    ) -> tuple[Array, Array]:
        """Growth rate in 1/s and frequency in rad/s of an oscillation of some amplitude.

        The root ``s = sigma + j w`` of ``1/L(s) + N = 0``, to first order in sigma: averaging
        after Krylov and Bogoliubov, ``dA/dt = sigma(A) A``. NaN where no frequency is found.
        """
        a, v0, x = np.broadcast_arrays(
            *(np.asarray(values, dtype=np.float64) for values in (amplitude, speed, position))
        )
        before = np.full(a.shape, 2.0 * pi * self.free_hz)
        w = 1.02 * before
        old, new = self.balance(a, before, v0, x), self.balance(a, w, v0, x)
        for _ in range(12):  # secant steps, each within a factor of 1.5
            rise = np.where(new.imag == old.imag, 1.0, new.imag - old.imag)
            after = np.clip(w - new.imag * (w - before) / rise, w / 1.5, 1.5 * w)
            before, w, old = w, np.minimum(after, 0.98 * pi / self.pid.period_s), new
            new = self.balance(a, w, v0, x)
            if np.all(np.abs(w - before) <= 1e-9 * w):
                break
        slope = (self.balance(a, 1.001 * w, v0, x) - new) / (0.001j * w)
        settled = np.abs(w - before) <= 1e-4 * w
        sigma = np.where(settled, (-new / slope).real, np.nan)
        return sigma, np.where(settled, w, np.nan)

    def orbits(self, speed: float, position: float) -> list[LimitCycle]:
        """Amplitudes at which an oscillation neither grows nor decays."""
        amplitudes = AMPLITUDES * speed
        sigma, _ = self.growth(amplitudes, speed, position)
        found = []
        for i in np.flatnonzero(sigma[:-1] * sigma[1:] < 0.0):
            fine = np.geomspace(amplitudes[i], amplitudes[i + 1], 17)
            sigmas, w = self.growth(fine, speed, position)
            order = slice(None, None, -1) if sigmas[-1] < sigmas[0] else slice(None)
            amplitude = float(np.interp(0.0, sigmas[order], fine[order]))
            frequency_hz = float(np.interp(amplitude, fine, w)) / (2.0 * pi)
            found.append(
                LimitCycle(
                    speed, position, frequency_hz, amplitude, bool(sigma[i] > 0.0), (amplitude,)
                )
            )
        return found

    def balanced(self, cycle: LimitCycle, harmonics: int) -> LimitCycle:
        """Balance several harmonics, from a cycle with one."""
        orders = np.arange(1, harmonics + 1)
        theta = np.outer(orders, midpoints(POINTS))
        scale = cycle.amplitude_m_per_s
        speed, position = np.asarray(cycle.speed_m_per_s), np.asarray(cycle.position_m)

        def waves(unknown: Array) -> tuple[float, ComplexArray]:
            """Frequency and harmonics; the phase of the first is zero."""
            parts = np.insert(unknown[1:], 1, 0.0).reshape(harmonics, 2) * scale
            return float(unknown[0] * 2.0 * pi * cycle.frequency_hz), parts @ np.array([1.0, 1j])

        def residual(unknown: Array) -> Array:
            w, parts = waves(unknown)
            v = speed + np.real(parts @ np.exp(1j * theta))
            force = friction_over_period(self.joint, v, np.asarray(w), position_m=position)
            forces = np.array([complex(harmonic(force, int(order))) for order in orders])
            missing = _impedance(self.pid, self.mass_kg, np.asarray(orders * w)) * parts + forces
            missing = missing / (self.mass_kg * w * scale)
            return np.column_stack([missing.real, missing.imag]).ravel()

        from scipy.optimize import root

        start = np.zeros(2 * harmonics)
        start[:2] = 1.0
        solved = root(residual, start, method="hybr", options={"xtol": 1e-9})
        if not solved.success and np.max(np.abs(solved.fun)) > 1e-6:
            raise ScenarioError(
                f"harmonics: {harmonics} could not be balanced at speed_m_per_s = "
                f"{cycle.speed_m_per_s:g}; ask for fewer"
            )
        w, parts = waves(solved.x)
        sizes = tuple(float(size) for size in np.abs(parts))
        return LimitCycle(
            cycle.speed_m_per_s, cycle.position_m, w / (2.0 * pi), sizes[0], cycle.stable, sizes
        )


def _impedance(pid: SampledPid, mass_kg: float, w: Array) -> ComplexArray:
    """1/L = j w m + G(j w): force over speed of mass and sampled controller, in N s/m."""
    gains, period_s, s = pid.gains, pid.period_s, 1j * w
    z = np.exp(s * period_s)
    hold = (1.0 - 1.0 / z) / (s * period_s) * z**-pid.delay_samples
    share = period_s / (pid.derivative_filter_s + period_s)
    filtered = share / (1.0 - (1.0 - share) / z)
    if pid.velocity_from == "position_difference":
        filtered = filtered * (1.0 - 1.0 / z) / (s * period_s)
    elastic = (gains.kp + gains.ki * period_s * z / (z - 1.0)) / s
    total: ComplexArray = s * mass_kg + hold * (elastic + gains.kd * filtered)
    return total
