"""A joint as one log tells it: parameters, how well they are known, and what they predict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.base.text import shown
from breakaway.errors import LogError
from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.laws import Law
from breakaway.measure.identification.output_error import Problem, Progress
from breakaway.measure.identification.prediction import Prediction, predict_rows
from breakaway.measure.identification.record import (
    MOTIONS,
    MotionKind,
    RunSettings,
    Span,
    measured_rows,
)
from breakaway.measure.identification.rig_intervals import profile_with_rig, spread_by_rig
from breakaway.measure.identification.settings import at_least_one, check_seed, known
from breakaway.measure.identification.uncertainty import (
    Covariance,
    Posterior,
    Profile,
    posterior,
    profile,
)
from breakaway.measure.identification.verdicts import Estimate, Excitation, Verdict
from breakaway.measure.logs.log import Array, Log


@dataclass(frozen=True, eq=False)
class Identification(OneLine):
    """A joint as one log tells it.

    ``estimates`` are the parameters that were fitted, ``fixed`` those that were held. ``combined``
    are sums that the log tells although it does not tell their parts, such as
    ``coulomb_plus_offset_n`` where the part slides only one way.
    ``converged`` is whether the best start was done, ``complete`` whether no Ctrl-C cut the fit
    short: what is given then is the best so far.
    """

    log: Log
    law: Law
    settings: RunSettings
    spans: tuple[Span, ...]
    excitation: Excitation
    estimates: tuple[Estimate, ...]
    combined: tuple[Estimate, ...]
    fixed: Mapping[str, float]
    rms_error: float
    relative_error_percent: float
    residual_autocorrelation: float
    effective_rows: float
    condition_number: float
    verdicts: tuple[Verdict, ...]
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    converged: bool
    complete: bool
    starts: int
    starts_agreeing: int
    seed: int
    loss: str
    fit: Prediction
    internals: Internals = field(repr=False)

    def __repr__(self) -> str:
        told = sum(one.identifiable for one in self.estimates)
        known = f"{told} of {counted(len(self.estimates), 'parameter')} identifiable"
        off = f"{self.relative_error_percent:.3g} % off"
        return f"<{self.law.name} fit of {shown(self.log.name)}: {known}, {off}>"

    @property
    def channel(self) -> str:
        """The channel whose error was made small."""
        return self.internals.problem.channel

    @property
    def values(self) -> dict[str, float]:
        """The fitted parameters by name."""
        return {one.name: one.value for one in self.estimates}

    @property
    def aic(self) -> float:
        """Akaike's information criterion, for the effective number of rows."""
        return self.aic_for(self.effective_rows)

    @property
    def bic(self) -> float:
        """Bayes' information criterion, for the effective number of rows."""
        rows = self.effective_rows
        return self.aic_for(rows) + (math.log(max(rows, 1.0)) - 2.0) * (len(self.estimates) + 1)

    def aic_for(self, rows: float) -> float:
        """Return n ln(s²) + 2 (p + 1), with n independent rows and s the RMS error.

        Parameters
        ----------
        rows : float
            n; laws that are compared have to be given the same.

        """
        check_arguments(Identification.aic_for, locals(), LogError)
        deviance = rows * math.log(max(self.rms_error, 1e-300) ** 2)
        return deviance + 2.0 * (len(self.estimates) + 1)

    def __getitem__(self, name: str) -> Estimate:
        for one in self.estimates:
            if one.name == name:
                return one
        raise KeyError(name)

    def predict(
        self,
        log: Log | None = None,
        *,
        spans: Sequence[Span] = (),
        motion: MotionKind | None = None,
    ) -> Prediction:
        """Simulate rows with the identified parameters and compare them with what was measured.

        Parameters
        ----------
        log : Log, optional
            Another log of the same rig; by default the log that was identified.
        spans : sequence of (start_s, end_s), optional
            Spans that are simulated, each from its first measured row; by default the whole log.
        motion : {'imposed', 'free', 'closed_loop'}, optional
            By default as in the fit.

        Returns
        -------
        Prediction
            Where the fit had an offset for each repeat, the last repeat's is used.

        Raises
        ------
        LogError
            The log lacks a channel that the motion needs, or a span is empty.

        """
        check_arguments(Identification.predict, locals(), LogError)
        settings = self.settings
        if motion is not None:
            known("motion", motion, MOTIONS)
            settings = RunSettings(**{**vars(settings), "motion": motion})
            mass_kg = self.internals.problem.layout.numbers(self.internals.best)[0]
            if motion != "imposed" and mass_kg == 0.0:
                raise LogError(
                    f"motion: {motion!r} needs a mass, and the fit held it at 0; identify with "
                    "--fix mass_kg=... (fixed={'mass_kg': ...})"
                )
        rows = measured_rows(self.log if log is None else log, settings)
        layout, best = self.internals.problem.layout, self.internals.best
        numbers, delay_s = layout.numbers(best), layout.delay_s(best)
        return predict_rows(rows, spans, self.law, settings, numbers, delay_s=delay_s)

    def profile(self, name: str) -> Profile:
        """Compute the profile likelihood of a parameter.

        Parameters
        ----------
        name : str
            One of the fitted parameters.

        Raises
        ------
        LogError
            The parameter was not fitted.

        """
        check_arguments(Identification.profile, locals(), LogError)
        inner = self.internals
        place = self._place(name)
        error = math.sqrt(inner.covariance.matrix[place, place])
        weight = inner.covariance.weight
        found = profile(inner.problem, inner.best, inner.bounds, place, error, weight)
        return profile_with_rig(found, self[name].value, self.settings.rig)

    def posterior(
        self, samples: int = 10_000, *, seed: int = 0, progress: Progress | None = None
    ) -> Posterior:
        """Draw parameters from their posterior, given the log.

        Parameters
        ----------
        samples : int
            Draws to keep.
        seed : int
            The same seed gives the same draws.
        progress : callable, optional
            Called with steps done and steps in all.

        Raises
        ------
        LogError
            emcee is not installed; it is the extra ``posterior``.

        """
        check_arguments(Identification.posterior, locals(), LogError)
        at_least_one("samples", samples)
        check_seed(seed)
        inner = self.internals
        low, high = inner.bounds
        error = np.sqrt(np.diag(inner.covariance.matrix))
        spread = np.where(np.isfinite(error), np.minimum(error, 0.1 * (high - low)), 0.0)
        spread = np.maximum(spread, 1e-6 * (high - low))
        found = posterior(
            inner.problem,
            inner.best,
            spread,
            inner.bounds,
            inner.covariance.weight,
            samples,
            seed,
            progress,
        )
        return replace(found, samples=spread_by_rig(found.samples, self.settings.rig, seed))

    def draws(self, samples: int, *, seed: int = 0) -> dict[str, Array]:
        """Draw parameters from the normal distribution that the covariance gives.

        Parameters
        ----------
        samples : int
            How many.
        seed : int
            The same seed gives the same draws.

        Notes
        -----
        Quicker than `posterior`, and rougher: parameters that are not identifiable are held, and
        draws below 0 of those that cannot be are mirrored there.

        """
        check_arguments(Identification.draws, locals(), LogError)
        at_least_one("samples", samples)
        check_seed(seed)
        inner = self.internals
        told = [i for i, one in enumerate(self.estimates) if one.identifiable]
        free = inner.problem.layout.free
        at = np.tile(inner.best, (samples, 1))
        rng = np.random.default_rng(seed)
        if told:
            matrix = inner.covariance.matrix[np.ix_(told, told)]
            at[:, told] += rng.multivariate_normal(
                np.zeros(len(told)), matrix, samples, check_valid="ignore", method="svd"
            )
        drawn = {one.name: one.external(at[:, i]) for i, one in enumerate(free)}
        mirrored = {
            one.name: np.abs(drawn[one.name]) if one.may_vanish else drawn[one.name] for one in free
        }
        return spread_by_rig(mirrored, self.settings.rig, seed)

    def _place(self, name: str) -> int:
        names = [one.name for one in self.estimates]
        if name not in names:
            raise LogError(f"parameter {name!r} was not fitted; those are {', '.join(names)}")
        return names.index(name)


@dataclass(frozen=True, eq=False)
class Internals:
    """What a finished fit keeps for profiles, posteriors and predictions."""

    problem: Problem
    best: Array
    bounds: tuple[Array, Array]
    covariance: Covariance


def as_dict(found: Identification) -> dict[str, Any]:
    """Return the figures of an identification as plain values, for JSON."""
    return {
        "log": found.log.name,
        "law": found.law.name,
        "asymmetric": found.law.asymmetric,
        "position_dependent": found.law.position_dependent,
        "motion": found.settings.motion,
        "rig": None if found.settings.rig is None else found.settings.rig.model_dump(),
        "excitation": vars(found.excitation),
        "estimates": [vars(one) for one in found.estimates],
        "combined": [vars(one) for one in found.combined],
        "fixed": dict(found.fixed),
        "channel": found.channel,
        "rms_error": found.rms_error,
        "relative_error_percent": found.relative_error_percent,
        "residual_autocorrelation": found.residual_autocorrelation,
        "aic": found.aic,
        "bic": found.bic,
        "condition_number": found.condition_number,
        "verdicts": [vars(one) for one in found.verdicts],
        "faults": [vars(one) for one in found.faults],
        "notes": list(found.notes),
        "converged": found.converged,
        "complete": found.complete,
        "starts": found.starts,
        "starts_agreeing": found.starts_agreeing,
    }
