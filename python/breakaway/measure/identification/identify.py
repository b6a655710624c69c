"""Identify a joint from a log: the whole way from measured rows to parameters with intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.identification.cascade import Cascade
from breakaway.measure.identification.doubt import doubt, events, with_hidden_mass
from breakaway.measure.identification.faults.delay import find_delay, with_delay
from breakaway.measure.identification.faults.examine import examine
from breakaway.measure.identification.faults.fault import Fault
from breakaway.measure.identification.faults.units import find_units, plausibility
from breakaway.measure.identification.identifiability import Prepared, prepare
from breakaway.measure.identification.inertia_friction import identify_inertia_friction
from breakaway.measure.identification.laws import Law, LawName, Layout, check_law
from breakaway.measure.identification.output_error import (
    LOSSES,
    Loss,
    Minimum,
    Progress,
    minimize,
    minimize_all,
    screened_starts,
)
from breakaway.measure.identification.prediction import predict_rows
from breakaway.measure.identification.record import (
    MOTIONS,
    MotionKind,
    RunSettings,
    Span,
)
from breakaway.measure.identification.result import Identification, Internals
from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.identification.rig_intervals import IN_SERIES, stiffness_is_told, with_rig
from breakaway.measure.identification.settings import (
    at_least_one,
    check_run,
    check_seed,
    known,
)
from breakaway.measure.identification.together import sums, without_offset
from breakaway.measure.identification.uncertainty import (
    NOT_IDENTIFIABLE,
    NOT_TOLD_FROM_0,
    Covariance,
    covariance,
    few_events,
    interval,
)
from breakaway.measure.identification.verdicts import (
    Estimate,
    Verdict,
    untold,
    verdicts,
)
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.controller import Pid

Method = Literal["least_squares", "output_error"]
MOST_EVALUATIONS = 100
POOR_PERCENT = 20.0
"""Relative error from which a law explains a log poorly."""

NOISY_SPEED = 0.02
"""Noise of the velocity, as a share of v_s, from which Stribeck parameters are biased."""

STEPS: Mapping[str, int] = {"imposed": 4, "free": 1, "closed_loop": 1}


def identify(
    log: Log,
    *,
    law: LawName = "lugre",
    motion: MotionKind = "imposed",
    asymmetric: bool = False,
    position_dependent: bool = False,
    controller: Cascade | Pid | None = None,
    force_limit_n: float | None = None,
    repeats: Sequence[Span] = (),
    fixed: Mapping[str, float] | None = None,
    free: Sequence[str] = (),
    guesses: Mapping[str, float] | None = None,
    origin_m: float | None = None,
    force_held: bool = True,
    lowpass_hz: float | None = None,
    steps_per_row: int | None = None,
    loss: Loss = "linear",
    starts: int = 8,
    seed: int = 0,
    method: Method = "output_error",
    rig: RigFile | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Identify a joint by output error: the parameters whose simulation is nearest to the log.

    ::

        m a = F - R - F_0 - k_r x,     R = k_e z + c dz/dt + σ± v,     dz/dt = v - α k_e |v| z / g
        g   = (F_c± + s x) (1 + (ρ - 1) exp(-(v / v_s)²)),             ρ = F_s / F_c

    The model is stepped by the same code as an extraction, with exact derivatives.

    Parameters
    ----------
    log : Log
        Position and force; with ``reference_m`` for a closed loop.
    law : {'coulomb', 'stribeck', 'lugre', 'elasto_plastic'}
        Coulomb and viscous friction (ρ = 1, no bristle); with ρ and v_s; with k_e and c; with an
        elastic share of the deflection.
    motion : {'imposed', 'free', 'closed_loop'}
        ``imposed``: the measured motion is imposed and the force compared. ``free``: the measured
        force moves the part and the position is compared. ``closed_loop``: the controller
        follows the reference and its force is compared.
    asymmetric : bool
        Levels and viscous friction of their own in each direction; they hold the offset F_0.
    position_dependent : bool
        Fit s and k_r as well.
    controller : Cascade or Pid, optional
        For ``closed_loop``.
    force_limit_n : float, optional
        Where the force of a `Pid` saturates.
    repeats : sequence of (start_s, end_s)
        Spans that are fitted, each started from its first measured row with an offset of its own,
        which shows the drift between repeats. By default the whole log as one. What lies
        outside is not used. Gaps within a span split it.
    fixed : mapping of str to float, optional
        Parameters that are held.
    free : sequence of str
        Parameters that are fitted although the log hardly excites them. Otherwise such are held
        at a neutral value, and ``verdicts`` says so.
    guesses : mapping of str to float, optional
        Where the first start begins, by parameter; by default as a regression of the log says.
    origin_m : float, optional
        Position at which levels and offsets hold where they depend on position; by default the
        middle of the travel.
    force_held : bool
        Whether the measured force of ``free`` motion holds from row to row; else it is linear.
    lowpass_hz : float, optional
        Cutoff of the low-pass that velocity and acceleration are taken from, where the log is
        even; by default as `breakaway.measure.logs.derived.default_lowpass_hz` says.
    steps_per_row : int, optional
        Integrator steps from row to row; by default 4 where motion is imposed, else 1.
    loss : {'linear', 'soft_l1', 'huber', 'cauchy'}
        All but the first are robust to outliers.
    starts : int
        Starts that are followed: the first guess, and the best of eight times as many draws.
    seed : int
        Of those draws.
    method : {'output_error', 'least_squares'}
        ``least_squares`` fits the law 'coulomb' to ``imposed`` motion, inertia included, where the
        model is linear: see `identify_inertia_friction`.
    rig : RigFile, optional
        What lies between the part and the sensors. Without it the stiffness of the joint is a
        bound from below, and the gain of the load cell counts as exact.
    progress : callable, optional
        Called with starts done and starts in all.

    Returns
    -------
    Identification

    Raises
    ------
    LogError
        A setting is out of range, the log lacks a channel, never moves, or its force is 0.

    Notes
    -----
    Ctrl-C ends the fit and gives the best so far, with ``complete`` False. Standard errors allow
    for correlated residuals (Newey and West, 1987). Not checked: that the law holds; a model
    that is wrong in another way than its residuals show has parameters that mean less than their
    intervals say. `compare_laws` and held-out rows are the check.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(4000) / 1000.0
    >>> x = 0.1 * np.sin(3 * t_s) + 0.02 * np.sin(11 * t_s)
    >>> v = 0.3 * np.cos(3 * t_s) + 0.22 * np.cos(11 * t_s)
    >>> log = Log(t_s=t_s, position_m=x, force_n=5.0 * np.sign(v) + 20.0 * v)
    >>> found = identify(log, law="coulomb", starts=1)
    >>> round(found.values["coulomb_n"], 1), round(found.values["viscous_n_s_per_m"])
    (5.0, 20)

    """
    check_arguments(identify, locals(), LogError)
    chosen = check_law(law, asymmetric, position_dependent)
    known("method", method, get_args(Method))
    known("motion", motion, MOTIONS)
    known("loss", loss, LOSSES)
    at_least_one("starts", starts)
    check_seed(seed)
    steps = STEPS[motion] if steps_per_row is None else steps_per_row
    check_run(steps, force_limit_n, origin_m)
    settings = RunSettings(
        motion=motion,
        controller=controller,
        force_limit_n=force_limit_n,
        force_held=force_held,
        lowpass_hz=lowpass_hz,
        steps=steps,
        origin_m=_origin(log, position_dependent, origin_m),
        rig=rig,
    )
    seen = examine(
        log, chosen, settings, (*free, *(fixed or {}), *(["repeats"] if repeats else []))
    )
    log, faults = seen.log, seen.faults
    modeled = {} if method == "least_squares" else seen.modeled
    like_damping = ""
    free, guesses = (*free, *modeled), {**modeled, **(guesses or {})}
    asked = prepare(log, chosen, settings, repeats, fixed or {}, free, guesses, method)
    if method == "least_squares":
        layout = asked.problem.layout
        internal = _regressed(asked.rows.log, layout, chosen, settings, repeats, asked.held)
        best = Minimum(internal, 0.0, 1, converged=True)
        complete, starts, agreeing = True, 1, 1
    else:
        drawn = screened_starts(
            asked.problem, asked.guess, asked.spread, asked.bounds, starts, seed
        )
        best, agreeing, complete = minimize_all(
            asked.problem, drawn, asked.bounds, loss, MOST_EVALUATIONS, progress
        )
        values = asked.problem.layout.values(best.internal)
        late = find_delay(log, chosen, settings, asked.excitation, values)
        stated = "delay_s" in (*free, *(fixed or {}))
        if late and late.decided:
            faults = (*faults, late.fault)
            if motion != "closed_loop" and not stated:
                asked = with_delay(log, chosen, settings, repeats, asked, late, free, best.internal)
                best = minimize(asked.problem, asked.guess, asked.bounds, loss, MOST_EVALUATIONS)
        elif late and not stated:
            like_damping = late.remark
    found = _Found(log, chosen, settings, asked, loss, seed, faults, like_damping)
    return found.result(best.internal, best.converged, complete, starts, agreeing)


def _regressed(
    log: Log,
    layout: Layout,
    law: Law,
    settings: RunSettings,
    repeats: Sequence[Span],
    fixed: Mapping[str, float],
) -> Array:
    """Fit the linear law by regression; return the internal parameters."""
    given = law.position_dependent or settings.motion != "imposed" or repeats or fixed
    if law.name != "coulomb" or given:
        raise LogError(
            "method: 'least_squares' fits law 'coulomb' to imposed motion, the whole log at once, "
            "with nothing fixed; take method 'output_error', or cut the log with `between`"
        )
    fit = identify_inertia_friction(log, lowpass_hz=settings.lowpass_hz or 100.0)
    values = fit.asymmetric if law.asymmetric else fit.symmetric
    found = [getattr(values, one.name) for one in layout.free]
    for one, value in zip(layout.free, found, strict=True):
        if one.positive and not value > 0.0:
            raise LogError(
                f"{log.name}: {one.name} comes out as {value:.4g} and must be > 0; record a log "
                "whose speeds span a wider range"
            )
    return np.array([one.internal(value) for one, value in zip(layout.free, found, strict=True)])


def _origin(log: Log, position_dependent: bool, origin_m: float | None) -> float:
    if not position_dependent:
        return 0.0
    x = log.position_m
    return 0.5 * float(x.min() + x.max()) if origin_m is None else origin_m


@dataclass(frozen=True, eq=False)
class _Found:
    """What a fit was asked, from which its result is made."""

    log: Log
    law: Law
    settings: RunSettings
    asked: Prepared
    loss: Loss
    seed: int
    faults: tuple[Fault, ...]
    like_damping: str
    """What looks like a damper of the bristle, where the log does not tell it from one."""

    def result(
        self,
        best: Array,
        converged: bool,
        complete: bool,
        starts: int,
        agreeing: int,
    ) -> Identification:
        problem = self.asked.problem
        residual, slopes = problem.residual_and_slopes(best)
        weighted = _robust(self.loss, residual)
        known = covariance(weighted * residual, weighted[:, None] * slopes)
        known = few_events(known, events(self.asked, self.settings, best))
        known = with_hidden_mass(known, self.asked, slopes)
        in_doubt = None
        if self.asked.excitation.broke_away:
            in_doubt = doubt(self.asked, self.law, self.settings, self.loss, best, known)
        known = known if in_doubt is None else in_doubt.known
        estimates = self._estimates(best, known)
        estimates = estimates if in_doubt is None else in_doubt.judged(estimates)
        combined = self._combined(best, known, estimates)
        estimates = self._of_speed(with_rig(self._judged(estimates), self.settings.rig))
        errors = residual * problem.scale
        rms = float(np.sqrt(np.mean(errors**2)))
        power = float(residual @ residual)
        measured = problem.measured
        size = np.linalg.norm(measured if problem.channel == "force_n" else measured - measured[0])
        percent = 100.0 * float(np.linalg.norm(errors) / size)
        judged = verdicts(estimates, self.asked.held_back, self.law, self.asked.held)
        by_name = {one.name: one for one in estimates}
        fast_speed = self.asked.excitation.fast_speed_m_per_s
        faults = (*self.faults, *find_units(by_name, fast_speed))
        return Identification(
            log=self.log,
            law=self.law,
            settings=self.settings,
            spans=self.asked.spans,
            excitation=self.asked.excitation,
            estimates=tuple(_with_verdict(one, judged) for one in estimates),
            combined=tuple(self._of_speed(with_rig(combined, self.settings.rig))),
            fixed=dict(self.asked.held),
            rms_error=rms,
            relative_error_percent=percent,
            residual_autocorrelation=float(residual[1:] @ residual[:-1]) / max(power, 1e-300),
            effective_rows=known.weight * len(residual),
            condition_number=known.condition_number,
            verdicts=judged,
            faults=faults,
            notes=(
                *_unfinished(complete, converged),
                *map(str, faults),
                *self._warnings(best, percent),
                *self._notes(known, starts, agreeing),
                plausibility(by_name, fast_speed),
            ),
            converged=converged,
            complete=complete,
            starts=starts,
            starts_agreeing=agreeing,
            seed=self.seed,
            loss=self.loss,
            fit=predict_rows(
                self.asked.rows,
                self.asked.spans,
                self.law,
                self.settings,
                problem.layout.numbers(best),
                delay_s=problem.layout.delay_s(best),
                same=True,
            ),
            internals=Internals(problem, best, self.asked.bounds, known),
        )

    @property
    def _goes_one_way(self) -> bool:
        held = {one.parameter for one in self.asked.held_back}
        return bool({"offset_n", "offset_1_n"} & held)

    def _combined(
        self, best: Array, known: Covariance, estimates: Sequence[Estimate]
    ) -> tuple[Estimate, ...]:
        """Return what the log tells of friction and offset together, where it goes one way."""
        shown = self.asked.excitation
        if not self._goes_one_way or shown.slips or not shown.broke_away:
            return ()
        return sums(self.asked.problem.layout, best, known.matrix, shown, estimates)

    def _of_speed(self, estimates: Sequence[Estimate]) -> list[Estimate]:
        """Say of sliding levels at which speed they hold, where the log has nearly one."""
        said = self.asked.excitation.level_is_of if self.law.name != "coulomb" else ""
        return [
            replace(one, remark=said)
            if said and one.identifiable and one.name.startswith("coulomb")
            else one
            for one in estimates
        ]

    def _judged(self, estimates: Sequence[Estimate]) -> list[Estimate]:
        """Take back what the motion of the log does not tell."""
        shown = self.asked.excitation
        names = [one.name for one in estimates]
        held = [one.parameter for one in self.asked.held_back]
        reasons = untold(names, shown, self.settings.motion, held)
        out = [
            replace(one, identifiable=False, remark=reasons[one.name])
            if one.name in reasons
            else one
            for one in estimates
        ]
        if self.like_damping and "damping_n_s_per_m" in names:
            place = names.index("damping_n_s_per_m")
            out[place] = _at_most(out[place], self.like_damping)
        values = {one.name: one.value for one in estimates}
        if self._goes_one_way and "coulomb_n" in values:
            place = names.index("coulomb_n")
            stiction_n = values["coulomb_n"] * values.get("stiction_ratio", 1.0)
            out[place] = without_offset(out[place], shown, stiction_n)
        return out

    def _estimates(self, best: Array, known: Covariance) -> list[Estimate]:
        layout = self.asked.problem.layout
        slope = layout.slope(best)
        low, high = self.asked.bounds
        out = []
        for i, parameter in enumerate(layout.free):
            error = math.sqrt(known.matrix[i, i])
            value = float(parameter.external(best[i : i + 1])[0])
            ends = interval(self.asked.problem, best, i, error)
            width = high[i] - low[i]
            at_end = min(best[i] - low[i], high[i] - best[i]) < 1e-6 * width
            remark = ""
            if parameter.may_vanish:
                ends = (max(ends[0], 0.0), ends[1])
                if not error < NOT_TOLD_FROM_0 * value:
                    about = f"known only to {100 * error / value:.0f} %" if ends[0] > 0.0 else ""
                    remark = about or f"not distinct from 0, at most {ends[1]:.3g} in its unit"
            elif not math.isfinite(error):
                remark = "cannot be told apart from others"
            elif at_end:
                remark = "at the end of its range"
            elif parameter.positive and not error < NOT_IDENTIFIABLE:
                remark = f"known only within a factor of {math.exp(min(2 * error, 50.0)):.2g}"
            told = not remark
            out.append(Estimate(parameter.name, value, error * slope[i], *ends, told, remark))
        return out

    def _warnings(self, best: Array, percent: float) -> list[str]:
        """Say what makes the figures worth less than their intervals."""
        out = []
        if percent > POOR_PERCENT:
            out.append(
                f"this law explains the log poorly, with an error of {percent:.0f} %: the "
                "parameters mean little; try another law, motion or mapping"
            )
        free = [one.name for one in self.asked.problem.layout.free]
        if "stiffness_n_per_m" in free and not stiffness_is_told(self.settings.rig):
            out.append(f"stiffness_n_per_m is {IN_SERIES}")
        places = [
            i for i, one in enumerate(self.asked.problem.layout.free) if "stribeck" in one.name
        ]
        if self.settings.motion == "imposed" and places:
            share = self.asked.sizes.velocity_noise_m_per_s / math.exp(best[places[0]])
            if share > NOISY_SPEED:
                out.append(
                    f"noise of the position makes the velocity uncertain by {100 * share:.2g} % of "
                    "v_s, which biases F_s / F_c and v_s beyond their intervals: lower lowpass_hz, "
                    "or measure the position with less noise"
                )
        return out

    def _notes(
        self,
        known: Covariance,
        starts: int,
        agreeing: int,
    ) -> list[str]:
        notes = [str(self.asked.excitation)]
        if starts > 1:
            notes.append(f"{agreeing} of {starts} starts came to the same minimum")
        if known.window > 0:
            count = len(self.asked.problem.measured)
            notes.append(
                f"residuals correlate over about {known.window} rows: {count} rows tell as much as "
                f"{known.weight * count:.0f} independent ones, and the errors allow for that"
            )
        notes += [str(finding) for finding in self.log.findings]
        return notes


def _unfinished(complete: bool, converged: bool) -> list[str]:
    if not complete:
        return ["stopped before it finished: these are the best parameters so far"]
    return [] if converged else [f"not converged within {MOST_EVALUATIONS} evaluations"]


def _robust(loss: str, residual: Array) -> Array:
    """Return the square root of a robust loss's weights, ρ'(r²)^½."""
    z = residual**2
    if loss == "soft_l1":
        return (1.0 + z) ** -0.25
    if loss == "huber":
        return np.where(z <= 1.0, 1.0, np.maximum(z, 1e-300) ** -0.25)
    if loss == "cauchy":
        return (1.0 + z) ** -0.5
    return np.ones_like(residual)


def _at_most(estimate: Estimate, because: str) -> Estimate:
    """Return an estimate that may as well be 0."""
    remark = because if estimate.identifiable else estimate.remark
    return replace(estimate, low=0.0, identifiable=False, remark=remark)


def _with_verdict(estimate: Estimate, judged: Sequence[Verdict]) -> Estimate:
    for one in judged:
        if one.parameter == estimate.name and not one.identifiable and estimate.identifiable:
            return replace(estimate, identifiable=False, remark=one.because)
    return estimate
