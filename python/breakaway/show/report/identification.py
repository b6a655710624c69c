"""The report of an identification: one page that says what is known of a joint, and how well."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10
from pathlib import Path
from typing import Any

from markupsafe import Markup
from matplotlib.figure import Figure

from breakaway._core import __version__
from breakaway.base.output import write_atomically
from breakaway.drawing.style import scaled
from breakaway.errors import LogError
from breakaway.measure.identification.comparison import ComparedLaw
from breakaway.measure.identification.curve import peak_in_words
from breakaway.measure.identification.events import BreakawayReport
from breakaway.measure.identification.prediction import Prediction
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.uncertainty import Posterior, Profile
from breakaway.measure.identification.verdicts import Estimate, Verdict, stiction_peak
from breakaway.model.units import unit_of, words_of
from breakaway.show.plots.events import plot_breakaway
from breakaway.show.plots.friction import plot_friction_velocity, plot_hysteresis
from breakaway.show.plots.identification import (
    law_words,
    plot_drift,
    plot_fit,
    plot_laws,
    plot_posterior,
    plot_profiles,
    plot_residual,
)
from breakaway.show.report.page import drawn_svg, render

DRAWN = 4000
"""Draws from the normal distribution where no posterior is given."""

LISTED = 12
"""Most starts from rest that are listed."""

MOTION_WORDS = {
    "imposed": "with the measured motion imposed",
    "free": "moved by the measured force",
    "closed_loop": "in closed loop with its controller",
}
"""Kind of motion -> how the log was simulated."""


@dataclass(frozen=True)
class Shown:
    """A figure of the page, with its caption and what it says to who cannot see it."""

    key: str
    title: str
    caption: str
    alt: str
    svg: Markup


@dataclass(frozen=True)
class _Plan:
    """A figure that is to be drawn."""

    key: str
    title: str
    caption: str
    draw: Callable[[], Figure]


def identification_report(
    found: Identification,
    *,
    posterior: Posterior | None = None,
    profiles: Sequence[Profile] = (),
    compared: Sequence[ComparedLaw] = (),
    held_out: Prediction | None = None,
    events: BreakawayReport | None = None,
) -> str:
    """Write the page of an identification, as self-contained HTML.

    Parameters
    ----------
    found : Identification
        The fit.
    posterior : Posterior, optional
        Draws of the parameters; by default they come from the normal distribution.
    profiles : sequence of Profile
        Profile likelihoods, each of a fitted parameter.
    compared : sequence of ComparedLaw
        Laws that were compared on the log.
    held_out : Prediction, optional
        Rows that were not fitted, as predicted.
    events : BreakawayReport, optional
        Starts from rest in the same log.

    Returns
    -------
    str
        A page that needs no other file and no network. A figure that makes no sense for the log is
        left out, with a sentence that says why.

    Examples
    --------
    >>> import numpy as np
    >>> from breakaway.measure.identification import identify
    >>> from breakaway.measure.logs import Log
    >>> t_s = np.arange(4000) / 1000.0
    >>> x = 0.1 * np.sin(3 * t_s) + 0.02 * np.sin(11 * t_s)
    >>> v = 0.3 * np.cos(3 * t_s) + 0.22 * np.cos(11 * t_s)
    >>> log = Log(t_s=t_s, position_m=x, force_n=5.0 * np.sign(v) + 20.0 * v)
    >>> page = identification_report(identify(log, law="coulomb", starts=1))
    >>> "<h1>log: friction identified</h1>" in page
    True

    """
    figures, left_out = _drawn(_plans(found, posterior, profiles, compared, held_out, events))
    return render(
        "identification.html.j2",
        version=__version__,
        log=found.log.name,
        headline=_headline(found),
        held_out=_held_out(held_out),
        digest=_digest(found),
        parameters=_parameters(found, profiles),
        profiled=bool(profiles),
        untold=_untold(found),
        peak=_peak(found),
        laws=_laws(compared),
        events=_events(events),
        figures=figures,
        left_out=left_out,
        findings=[str(finding) for finding in found.log.findings],
        history=found.log.history,
        notes=found.notes,
        settings=list(_settings(found, posterior)),
    )


def save_identification_report(
    path: str | Path,
    found: Identification,
    *,
    posterior: Posterior | None = None,
    profiles: Sequence[Profile] = (),
    compared: Sequence[ComparedLaw] = (),
    held_out: Prediction | None = None,
    events: BreakawayReport | None = None,
) -> None:
    """Write the page of an identification to a file, whole or not at all.

    Parameters
    ----------
    path : str or Path
        The file, such as ``report.html``; missing folders are made.
    found, posterior, profiles, compared, held_out, events
        As for `identification_report`.

    Raises
    ------
    OutputError
        The folder cannot be made or not be written to, or the disk is full.

    """
    page = identification_report(
        found,
        posterior=posterior,
        profiles=profiles,
        compared=compared,
        held_out=held_out,
        events=events,
    )
    write_atomically(Path(path), page.encode())


def uncertain(value: float, error: float) -> tuple[str, str]:
    """Give a value and its standard error, the error with two digits and the value to match.

    Parameters
    ----------
    value, error : float
        In the same unit; an error that is no positive number gives a value of four digits.

    Examples
    --------
    >>> uncertain(95.0141, 0.2002), uncertain(-1282.8, 536.2), uncertain(3.0, float("inf"))
    (('95.01', '0.20'), ('−1280', '540'), ('3', 'unknown'))

    """
    if not (isfinite(error) and error > 0.0):
        return _minus(f"{value:.4g}"), "unknown"
    places = _places(error)
    shown = min(max(places, 0), 12)
    return _minus(f"{round(value, places):.{shown}f}"), f"{round(error, places):.{shown}f}"


def _minus(number: str) -> str:
    return number.replace("-", "−")


def _places(error: float) -> int:
    return 1 - floor(log10(float(f"{error:.1e}")))


def _headline(found: Identification) -> str:
    repeats = len(found.spans)
    where = f"{repeats} repeats" if repeats > 1 else "one span"
    channel, factor, unit = _error_unit(found.fit, found.rms_error)
    of = "the measured one" if channel == "force" else "the measured travel"
    sentence = (
        f"{_sentence(law_words(found.law))}: {len(found.estimates)} parameters from "
        f"{len(found.fit.t_s)} rows in {where} of {found.log.name}. Simulated "
        f"{MOTION_WORDS[found.settings.motion]}, the {channel} is "
        f"{found.rms_error * factor:.3g} {unit} (root mean square) off what was measured, "
        f"{found.relative_error_percent:.2g} % of {of}."
    )
    if found.complete and found.converged:
        return sentence
    state = "did not converge" if found.complete else "was stopped before it finished"
    return f"{sentence} The fit {state}: these are the best parameters so far."


def _error_unit(prediction: Prediction, error: float) -> tuple[str, float, str]:
    channel, unit = ("position", "m") if prediction.channel == "position_m" else ("force", "N")
    return (channel, *scaled([error], unit))


def _held_out(prediction: Prediction | None) -> str:
    if prediction is None:
        return ""
    channel, factor, unit = _error_unit(prediction, prediction.rms_error)
    if channel == "force":
        share = f"{prediction.relative_force_error_percent:.2g} % of the measured one"
    else:
        x = prediction.measured_position_m
        share = f"{100.0 * prediction.rms_error / float(x.max() - x.min()):.2g} % of the travel"
    return (
        f"On rows that were not fitted, {prediction.t_s[0]:.4g} s to {prediction.t_s[-1]:.4g} s, "
        f"the predicted {channel} is {prediction.rms_error * factor:.3g} {unit} (root mean square) "
        f"off the measured one, {share}."
    )


def _digest(found: Identification) -> str:
    if found.log.sha256 is None:
        return "The log was given as arrays; it has no digest."
    return f"SHA-256 of the log: {found.log.sha256}"


def _parameters(found: Identification, profiles: Sequence[Profile]) -> list[dict[str, str]]:
    because = {one.parameter: one.because for one in found.verdicts}
    profiled = {one.name: one for one in profiles}
    rows = [
        _parameter(one, because.get(one.name, ""), profiled.get(one.name))
        for one in (*found.estimates, *found.combined)
    ]
    return rows + [_held(name, value) for name, value in found.fixed.items()]


def _parameter(one: Estimate, because: str, profile: Profile | None) -> dict[str, str]:
    ends = [] if profile is None else [profile.low, profile.high]
    sizes = [one.value, one.standard_error, one.low, one.high, *ends]
    factor, shown = scaled(sizes, unit_of(one.name).symbol)
    value, error = uncertain(one.value * factor, float(one.standard_error) * factor)
    told = float(one.standard_error) * factor if one.identifiable else 0.0
    return {
        "words": words_of(one.name),
        "value": f"{value} ± {error}",
        "interval": _interval(one.low * factor, one.high * factor, told),
        "profile": ""
        if profile is None
        else _interval(profile.low * factor, profile.high * factor, told),
        "unit": shown,
        "told": "yes" if one.identifiable else "no",
        "remark": _remark(one, because),
    }


def _remark(one: Estimate, because: str) -> str:
    if not one.identifiable:
        return one.remark or because
    return one.remark or ("its interval includes 0" if one.low < 0.0 < one.high else "")


def _held(name: str, value: float) -> dict[str, str]:
    factor, shown = scaled([value], unit_of(name).symbol)
    nothing = dict.fromkeys(("interval", "profile"), "–")
    remark = "held, not fitted"
    return {
        "words": words_of(name), "value": f"{value * factor:.6g}", "unit": shown, "told": "–",
        "remark": remark, **nothing,
    }  # fmt: skip


def _interval(low: float, high: float, error: float) -> str:
    """Show an interval with the places of the standard error, or three digits where it is 0."""

    def shown(end: float) -> str:
        if not isfinite(end):
            return "∞" if end > 0.0 else "−∞"
        return uncertain(end, error)[0] if error > 0.0 else _minus(f"{end:.3g}")

    return f"{shown(low)} to {shown(high)}"


def _untold(found: Identification) -> list[dict[str, str]]:
    return [
        {
            "words": words_of(one.parameter),
            "because": one.because,
            "remedy": one.remedy,
        }
        for one in found.verdicts
        if not one.identifiable
    ]


def _peak(found: Identification) -> str:
    if not any(one.parameter == "stiction_ratio" for one in found.verdicts):
        held = Verdict("stiction_ratio", False, "F_s / F_c was held")
        return _sentence(stiction_peak({}, [held]))
    return _sentence(peak_in_words(found))


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _laws(compared: Sequence[ComparedLaw]) -> list[dict[str, Any]]:
    if not compared:
        return []
    rows = min(one.fit.effective_rows for one in compared)
    least = min(one.fit.aic_for(rows) for one in compared)
    worst = max(one.held_out_error for one in compared)
    _, factor, unit = _error_unit(compared[0].fit.fit, worst)
    words = {one.fit.law.label: law_words(one.fit.law) for one in compared}
    return [
        {
            "words": law_words(one.fit.law),
            "count": len(one.fit.estimates),
            "error": f"{one.held_out_error * factor:.3g} {unit}",
            "aic": f"{one.fit.aic_for(rows) - least:.1f}",
            "pays": one.pays,
            "because": f"against {words[one.against]}: {one.because}"
            if one.against
            else one.because,
        }
        for one in compared
    ]


def _events(report: BreakawayReport | None) -> dict[str, Any] | None:
    if report is None:
        return None
    rows = [
        {
            "time": f"{one.time_s:.4g}",
            "direction": "up" if one.direction > 0 else "down",
            "force": f"{'≥ ' if one.is_lower_bound else ''}{one.breakaway_force_n:.4g}",
            "sliding": _or_dash(one.sliding_force_n),
            "ratio": _or_dash(one.breakaway_over_sliding, 3),
            "remark": one.reason,
        }
        for one in report.events[:LISTED]
    ]
    return {"rows": rows, "count": len(report.events), "refused": report.refused}


def _or_dash(value: float | None, digits: int = 4) -> str:
    return "–" if value is None else f"{value:.{digits}g}"


def _settings(found: Identification, posterior: Posterior | None) -> Iterator[tuple[str, str]]:
    run = found.settings
    yield "breakaway", __version__
    yield "log", found.log.name
    yield "SHA-256 of the log", found.log.sha256 or "none: arrays"
    yield "law", law_words(found.law)
    yield "motion", f"{run.motion.replace('_', ' ')}: simulated {MOTION_WORDS[run.motion]}"
    if run.controller is not None:
        yield "controller", _flat(run.controller.model_dump())
    if run.rig is not None:
        yield "rig", _flat(run.rig.model_dump(exclude={"notes"}, exclude_defaults=True))
    if run.force_limit_n is not None:
        yield "force limit", f"{run.force_limit_n:g} N"
    yield "spans that were fitted", ", ".join(f"{a:.6g} s to {b:.6g} s" for a, b in found.spans)
    if found.law.position_dependent:
        yield "origin of position", f"{run.origin_m:.6g} m"
    if run.motion == "free":
        yield "measured force between rows", "held" if run.force_held else "linear"
    lowpass_hz = run.lowpass_hz
    yield "low-pass", "chosen by the noise" if lowpass_hz is None else f"{lowpass_hz:g} Hz"
    yield "integrator steps per row", str(run.steps)
    yield "loss", found.loss
    yield "starts", f"{found.starts}, of which {found.starts_agreeing} agree; seed {found.seed}"
    yield "converged, complete", f"{_yes(found.converged)}, {_yes(found.complete)}"
    yield "effective rows", f"{found.effective_rows:.4g} of {len(found.fit.t_s)}"
    yield "correlation of successive residuals", f"{found.residual_autocorrelation:.4f}"
    yield "condition number", f"{found.condition_number:.3g}"
    yield "AIC, BIC", f"{found.aic:.1f}, {found.bic:.1f}"
    if posterior is not None:
        yield "posterior", _about_posterior(posterior)


def _flat(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} = {_plain(value)}" for name, value in values.items())


def _plain(value: object) -> str:
    if isinstance(value, Mapping):
        return f"({_flat(value)})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"


def _about_posterior(posterior: Posterior) -> str:
    draws = len(next(iter(posterior.samples.values())))
    return (
        f"{draws} draws, {posterior.walkers} walkers, {posterior.steps} steps, autocorrelation "
        f"time {posterior.autocorrelation_steps:.3g} steps, "
        f"{100 * posterior.acceptance:.0f} % accepted, likelihood tempered by "
        f"{posterior.weight:.3g}"
    )


def _plans(
    found: Identification,
    posterior: Posterior | None,
    profiles: Sequence[Profile],
    compared: Sequence[ComparedLaw],
    held_out: Prediction | None,
    events: BreakawayReport | None,
) -> list[_Plan]:
    plans = [_fit_plan(found)]
    if held_out is not None:
        plans.append(_held_out_plan(held_out))
    plans += _friction_plans(found)
    plans.append(_residual_plan(found))
    if any(one.identifiable for one in found.estimates):
        plans.append(_posterior_plan(found, posterior))
    if profiles:
        plans.append(_profile_plan(found, profiles))
    plans.append(_drift_plan(found))
    if compared:
        plans.append(_law_plan(compared))
    if events is not None and events.events:
        plans.append(_event_plan(found, events))
    return plans


def _fit_plan(found: Identification) -> _Plan:
    return _Plan(
        "fit",
        "Measured and simulated.",
        "Where the thin line leaves the wide one, the law is wrong or the log is disturbed; the "
        "residual, simulated less measured, shows by how much. Below: the stretch with the largest "
        "change.",
        lambda: plot_fit(found.fit, found.spans),
    )


def _held_out_plan(held_out: Prediction) -> _Plan:
    return _Plan(
        "held_out",
        "Rows that were not fitted.",
        "The same parameters on rows that had no part in them: the test that a law with too many "
        "parameters fails. A simulated position accumulates the errors of all rows before it.",
        lambda: plot_fit(held_out),
    )


def _friction_plans(found: Identification) -> list[_Plan]:
    at = " at the middle of the travel" if found.law.position_dependent else ""
    return [
        _Plan(
            "friction_velocity",
            "Friction against velocity.",
            "Dots: the measured force less inertia, offset and spring, without what lies within a "
            "period of the low-pass of the log's ends. Line: friction of steady sliding as "
            f"identified{at}, with its 95 % band, which may be as narrow as the line. Loops of "
            "dots around the line are friction that lags the velocity; dots that leave it on one "
            "side are friction that the law lacks.",
            lambda: plot_friction_velocity(found),
        ),
        _Plan(
            "hysteresis",
            "Friction against position about reversals.",
            "The steep part after a reversal is presliding: its slope is the stiffness of the "
            "joint, its end the onset of sliding. Where position counts from the turn, each path "
            "counts from its own.",
            lambda: plot_hysteresis(found),
        ),
    ]


def _residual_plan(found: Identification) -> _Plan:
    return _Plan(
        "residual",
        "Residual.",
        "Left: how it spreads, beside the normal distribution of the same root mean square. "
        "Right: its autocorrelation. A law that holds leaves white noise, within the band; peaks "
        "at a lag point to something periodic that the law lacks. The standard errors allow for "
        "correlation up to the dashed line.",
        lambda: plot_residual(found),
    )


def _posterior_plan(found: Identification, posterior: Posterior | None) -> _Plan:
    samples = found.draws(DRAWN, seed=found.seed) if posterior is None else posterior.samples
    source = "the normal distribution of the estimates" if posterior is None else "the posterior"
    return _Plan(
        "posterior",
        "Parameters together.",
        f"Draws from {source}; areas hold 50 % and 95 % of them, lines mark the estimate. Slanted "
        "areas are parameters that the log determines better in combination than each by itself. "
        "Of more than six parameters, those that correlate most are shown.",
        lambda: plot_posterior(found, samples),
    )


def _profile_plan(found: Identification, profiles: Sequence[Profile]) -> _Plan:
    return _Plan(
        "profiles",
        "Profile likelihoods.",
        "The rise of the misfit with one parameter held and all others fitted again. The interval "
        "is where it stays below the dashed line; a branch that never crosses it leaves that side "
        "open.",
        lambda: plot_profiles(found, profiles),
    )


def _drift_plan(found: Identification) -> _Plan:
    return _Plan(
        "drift",
        "Offset of each repeat.",
        "Bars are 95 % intervals. Offsets that differ by more than their bars show a drift of the "
        "rig, such as that of its temperature or of its sensor's zero.",
        lambda: plot_drift(found),
    )


def _law_plan(compared: Sequence[ComparedLaw]) -> _Plan:
    return _Plan(
        "laws_compared",
        "Laws compared.",
        "Left: the error on rows that were not fitted. Right: Akaike's criterion, which charges "
        "for parameters. Laws in gray do not pay for theirs.",
        lambda: plot_laws(compared),
    )


def _event_plan(found: Identification, events: BreakawayReport) -> _Plan:
    return _Plan(
        "breakaway",
        "The first start from rest.",
        "Force and position as measured, and how the breakaway force was read from them.",
        lambda: plot_breakaway(found.log, events),
    )


def _drawn(plans: Sequence[_Plan]) -> tuple[list[Shown], list[str]]:
    """Draw what can be drawn, and say why of the rest."""
    shown, left_out = [], []
    for plan in plans:
        try:
            figure = plan.draw()
        except LogError as error:
            left_out.append(f"{plan.title.rstrip('.')}: {error}.")
            continue
        shown.append(
            Shown(
                plan.key, plan.title, plan.caption, _alt(plan, figure), drawn_svg(figure, plan.key)
            )
        )
    return shown, left_out


def _alt(plan: _Plan, figure: Figure) -> str:
    """Say what the axes of a figure show, to those who cannot see them."""
    labels = ((one.get_ylabel(), one.get_xlabel()) for one in figure.axes)
    shown = (" over ".join(filter(None, pair)) for pair in labels)
    return f"{plan.title} {'; '.join(dict.fromkeys(filter(None, shown)))}".replace("\n", " ")
