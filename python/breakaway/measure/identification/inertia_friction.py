"""Mass, Coulomb and viscous friction of a moving part from a log of position and force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.identification.checks import (
    SIGNIFICANCE,
    check_mass,
    check_motion,
    check_sampling,
    check_settings,
)
from breakaway.measure.identification.regression import (
    TRIM_PER_DECIMATION,
    Solution,
    least_squares,
    parallel_filter,
)
from breakaway.measure.logs.derived import derive_motion
from breakaway.measure.logs.log import Array, Log

NOT_IDENTIFIED: Mapping[str, str] = {
    "joint.stiction_n": "breakaway from rest is not part of a fit of sliding friction",
    "joint.stiffness_n_per_m": "the bristle's spring acts over micrometers before sliding",
    "joint.damping_n_s_per_m": "the bristle's damper acts over micrometers before sliding",
    "joint.stribeck_velocity_m_per_s": "the model has no velocity-weakening term",
    "joint.engagement_length_m": "the model's friction does not depend on position",
}
"""Field of a scenario -> why this identification leaves it open."""

SYMMETRIC = ("mass_kg", "viscous_n_s_per_m", "coulomb_n", "offset_n")
ASYMMETRIC = (
    "mass_kg",
    "viscous_positive_n_s_per_m",
    "viscous_negative_n_s_per_m",
    "coulomb_positive_n",
    "coulomb_negative_n",
)

LOW_SPEED = 0.05
"""Width of the term that looks for a stiction peak, as a share of the largest speed."""

PEAK = 0.05
"""A stiction peak counts from this share of the Coulomb friction."""

CORRELATED = 0.4
"""Residual correlation worth a caution; the parallel filter alone makes 0.23 of white noise."""


@dataclass(frozen=True, kw_only=True)
class FitQuality:
    """How well a set of parameters is known; ``standard_error`` has the parameters' names.

    The standard errors hold for independent residuals; ``residual_autocorrelation`` (of
    successive samples, 0 if independent) tells how far that is true, and ``covariance``, in the
    order of the names, allows for it.
    """

    standard_error: Mapping[str, float]
    covariance: tuple[tuple[float, ...], ...]
    relative_force_error_percent: float
    samples: int
    condition_number: float
    residual_autocorrelation: float


@dataclass(frozen=True, kw_only=True)
class SymmetricFit(FitQuality):
    """``F = mass a + viscous v + coulomb sign(v) + offset``, positive where it resists motion."""

    mass_kg: float
    viscous_n_s_per_m: float
    coulomb_n: float
    offset_n: float


@dataclass(frozen=True, kw_only=True)
class AsymmetricFit(FitQuality):
    """``F = mass a + viscous± v + coulomb± sign(v)``, with the sign of v choosing ±, no offset.

    All four friction parameters are positive where they resist motion, in either direction.
    The publication's table gives the negative direction's values a minus sign.
    """

    mass_kg: float
    viscous_positive_n_s_per_m: float
    viscous_negative_n_s_per_m: float
    coulomb_positive_n: float
    coulomb_negative_n: float


Fit = TypeVar("Fit", SymmetricFit, AsymmetricFit)


@dataclass(frozen=True, kw_only=True)
class InertiaFrictionFit:
    """Both fits of one log, the settings they were made with, and what they cannot tell."""

    symmetric: SymmetricFit
    asymmetric: AsymmetricFit
    lowpass_hz: float
    decimation: int
    sample_rate_hz: float
    trimmed_samples: int
    notes: tuple[str, ...]
    not_identified: Mapping[str, str]

    def intervals(self) -> dict[str, list[float]]:
        """Return 95 % intervals of the symmetric parameters, which allow for correlation."""
        both = self.symmetric
        half = 1.959964 * np.sqrt(np.diag(np.array(both.covariance)))
        values = [(name, getattr(both, name)) for name in both.standard_error]
        return {
            name: [value - float(reach), value + float(reach)]
            for (name, value), reach in zip(values, half, strict=True)
        }


def identify_inertia_friction(
    log: Log, *, lowpass_hz: float = 100.0, decimation: int = 10
) -> InertiaFrictionFit:
    """Identify mass, viscous and Coulomb friction by least squares (IDIM-LS).

    ::

        symmetric    F = M a + F_v v + F_c sign(v) + offset
        asymmetric   F = M a + F_v± v + F_c± sign(v)

    Position is low-passed without phase and differentiated centrally; force and every
    regressor then pass one common low-pass and are decimated, which decides the band that is
    fitted: 0 to 0.4 of the decimated rate.

    Source: A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of EMPS",
    Workshop on Nonlinear System Identification Benchmarks, 2019. The defaults are settings
    for a log at 1 kHz that reproduce its figures.

    Parameters
    ----------
    log : Log
        Evenly sampled within 1 %, at least ``70 * decimation`` rows, moving both ways.
    lowpass_hz : float
        Cutoff in Hz of the low-pass on position, from 0.4 of the decimated rate to below half
        of the sample rate.
    decimation : int
        Samples per sample kept, at least 1; ``10 * decimation`` samples are trimmed at either
        end, where the filters still ring.

    Returns
    -------
    InertiaFrictionFit

    Raises
    ------
    LogError
        A setting is out of range; the log is uneven, too short, never moves or moves one way
        only; its force is 0; parameters cannot be told apart; or the mass is not
        significantly positive. The message names the remedy.

    Notes
    -----
    Not checked: a delay between force and position; friction that depends on position,
    temperature or time; noise in the position, which draws the mass toward 0. Where the part
    rests, ``sign(v)`` is noise.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(5000) / 1000.0
    >>> v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    >>> a = -1.5 * np.sin(5 * t_s) - 0.4 * np.sin(2 * t_s)
    >>> x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    >>> log = Log(t_s=t_s, position_m=x, force_n=4.0 * a + 30.0 * v + 6.0 * np.sign(v) - 1.0)
    >>> fit = identify_inertia_friction(log).symmetric
    >>> [round(value, 1) for value in (fit.mass_kg, fit.viscous_n_s_per_m, fit.coulomb_n)]
    [4.0, 30.0, 6.0]

    """
    check_arguments(identify_inertia_friction, locals(), LogError)
    check_settings(log, lowpass_hz, decimation)
    check_sampling(log, decimation)
    moved = derive_motion(log, lowpass_hz)
    check_motion(log, moved)
    speed, sign = moved.velocity_m_per_s, np.sign(moved.velocity_m_per_s)
    mass, up, down = moved.acceleration_m_per_s2, speed > 0.0, speed < 0.0
    peak = sign * np.exp(-((speed / (LOW_SPEED * np.abs(speed).max())) ** 2))
    columns = [mass, speed, sign, np.ones_like(speed), peak]
    columns += [speed * up, speed * down, sign * up, sign * down, log.driving_force_n]
    filtered = parallel_filter(np.column_stack(columns), decimation)
    force = filtered[:, 9]
    symmetric = least_squares(log, SYMMETRIC, filtered[:, :4], force)
    asymmetric = least_squares(log, ASYMMETRIC, filtered[:, [0, 5, 6, 7, 8]], force)
    check_mass(log, symmetric.values[0], symmetric.errors[0])
    return InertiaFrictionFit(
        symmetric=_result(SymmetricFit, SYMMETRIC, symmetric),
        asymmetric=_result(AsymmetricFit, ASYMMETRIC, asymmetric),
        lowpass_hz=float(lowpass_hz),
        decimation=decimation,
        sample_rate_hz=log.sample_rate_hz,
        trimmed_samples=2 * TRIM_PER_DECIMATION * decimation,
        notes=(
            f"not identified: {', '.join(NOT_IDENTIFIED)}",
            _stiction(log, filtered[:, :5], force),
            *_cautions(log, symmetric),
        ),
        not_identified=dict(NOT_IDENTIFIED),
    )


def _result(kind: type[Fit], names: tuple[str, ...], solution: Solution) -> Fit:
    content: dict[str, Any] = dict(zip(names, solution.values.tolist(), strict=True))
    return kind(
        **content,
        standard_error=dict(zip(names, solution.errors.tolist(), strict=True)),
        covariance=tuple(map(tuple, (_inflation(solution) ** 2 * solution.covariance).tolist())),
        relative_force_error_percent=solution.relative_force_error_percent,
        samples=solution.samples,
        condition_number=solution.condition_number,
        residual_autocorrelation=solution.residual_autocorrelation,
    )


def _inflation(solution: Solution) -> float:
    """Return √((1 + ρ) / (1 - ρ)), by which first-order correlated residuals widen errors."""
    rho = min(max(solution.residual_autocorrelation, 0.0), 0.99)
    return float(np.sqrt((1.0 + rho) / (1.0 - rho)))


def _stiction(log: Log, columns: Array, force: Array) -> str:
    """Say whether sliding friction rises toward low speed, where the log can tell."""
    try:
        fit = least_squares(log, (*SYMMETRIC, "stiction peak"), columns, force)
    except LogError:
        return "stiction peak: this log cannot tell"
    excess, error = float(fit.values[4]), float(fit.errors[4]) * _inflation(fit)
    level = PEAK * abs(float(fit.values[2]))
    figure = f"friction below {100 * LOW_SPEED:g} % of the largest speed is {excess:+.2g} ± "
    figure += f"{error:.1g} N from the Coulomb level"
    if excess - SIGNIFICANCE * error > level:
        return f"stiction peak: seen, but not identified; {figure}"
    if excess + SIGNIFICANCE * error < level:
        return f"stiction peak: none; {figure}"
    return f"stiction peak: this log cannot tell; {figure}"


def _cautions(log: Log, fit: Solution) -> list[str]:
    notes = []
    if fit.residual_autocorrelation > CORRELATED:
        notes.append(
            f"successive residuals correlate ({fit.residual_autocorrelation:.2f}): the model lacks "
            f"something, and the parameters are about {_inflation(fit):.1f} times less certain "
            "than the standard errors say"
        )
    if fit.residual_autocorrelation < -CORRELATED / 2:
        notes.append(
            f"successive residuals alternate ({fit.residual_autocorrelation:.2f}): noise of the "
            "position reaches the acceleration and biases the mass toward 0 by more than its "
            "standard error; raise decimation"
        )
    for name, value, error in zip(SYMMETRIC[1:3], fit.values[1:3], fit.errors[1:3], strict=True):
        if value < -SIGNIFICANCE * error:
            notes.append(
                f"{name} is negative ({value:.4g} ± {error:.2g}): friction falls with speed in "
                "this log's range; the part needs a Stribeck law or a faster motion"
            )
    if log.ignored_columns:
        notes.append(f"columns not used: {', '.join(log.ignored_columns)}")
    return notes
