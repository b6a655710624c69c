"""What was identified, as tables that a person reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from math import inf
from typing import TYPE_CHECKING

from breakaway.cli.quantity import show, show_uncertain, split_unit
from breakaway.cli.sheet import Sheet

if TYPE_CHECKING:
    from pathlib import Path

    from breakaway.measure.identification import (
        AsymmetricFit,
        ComparedLaw,
        Estimate,
        Identification,
        InertiaFrictionFit,
        Prediction,
        SymmetricFit,
    )
    from breakaway.measure.logs import Log


SYMBOLS = {
    "stiction_ratio": "F_s / F_c",
    "stribeck_velocity_m_per_s": "v_s",
    "stiffness_n_per_m": "k_e",
    "damping_n_s_per_m": "c",
}
"""Symbols of parameters whose names alone may not be known."""


def regression_tables(fit: InertiaFrictionFit, log: Log, path: Path) -> list[Sheet | str]:
    """Give the tables of a regression."""
    parts: list[Sheet | str] = [
        f"{path}: sampled at {fit.sample_rate_hz:.6g} Hz, low-pass {fit.lowpass_hz:g} Hz, "
        f"decimation {fit.decimation}, {fit.symmetric.samples} samples fitted",
        _fit("Symmetric: F = mass a + viscous v + coulomb sign(v) + offset", fit.symmetric),
        _fit("Asymmetric: separate friction in each direction, no offset", fit.asymmetric),
    ]
    if fit.not_identified:
        left_open = Sheet(
            "Not identified: the scenario's own values stay",
            ["field", "because"],
            prose=["because"],
        )
        for field, reason in fit.not_identified.items():
            left_open.add(field, reason)
        parts.append(left_open)
    shown = [note for note in fit.notes if not note.startswith("not identified:")]
    told = [*shown, *log.history, *(str(finding) for finding in log.findings)]
    return [*parts, *(f"- {note}" for note in told)]


def _fit(title: str, fit: SymmetricFit | AsymmetricFit) -> Sheet:
    shown = Sheet(
        title,
        ["parameter", "value", "std. error", "unit", "relative"],
        numbers=["value", "std. error", "relative"],
    )
    names = [field.name for field in fields(fit) if field.name in fit.standard_error]
    for name in names:
        value, error = getattr(fit, name), fit.standard_error[name]
        words, unit = split_unit(name)
        relative = f"{100.0 * abs(error / value):.2g} %" if value else ""
        shown.add(words, *show_uncertain(value, error), unit, relative)
    shown.add("relative force error", f"{fit.relative_force_error_percent:.2f}", "", "%", "")
    return shown


def law_tables(
    found: Identification, compared: Sequence[ComparedLaw], held_out: Prediction | None
) -> list[Sheet | str]:
    """Give the tables of a law that was fitted by simulation."""
    from breakaway.measure.identification.curve import peak_in_words

    parts: list[Sheet | str] = []
    if compared:
        parts.append(_laws(compared))
    parts.append(_estimates(found))
    if not all(one.identifiable for one in found.verdicts):
        parts.append(_open(found))
    error = show(_named(found.channel), found.rms_error)
    told = [
        f"RMS error of the {split_unit(found.channel)[0]}: {error} "
        f"({found.relative_error_percent:.3g} %) on the fitted rows"
    ]
    if held_out is not None:
        predicted = show(_named(held_out.channel), held_out.rms_error)
        told.append(f"RMS error on the held-out rows: {predicted}")
    told.append(peak_in_words(found))
    told += [*found.log.history, *found.notes]
    return [*parts, *(f"- {note}" for note in told)]


def _named(channel: str) -> str:
    return "rms_error_m" if channel == "position_m" else "rms_error_n"


def _estimates(found: Identification) -> Sheet:
    held = ", ".join(f"{name} = {value:g}" for name, value in found.fixed.items())
    title = f"{found.log.name}: {found.law.label}, {found.settings.motion} motion"
    if not found.complete:
        title += ", STOPPED early: best so far"
    shown = Sheet(
        title + (f" (held: {held})" if held else ""),
        ["parameter", "value", "std. error", "95 % interval", "unit", "told by the log"],
        numbers=["value", "std. error", "95 % interval"],
        prose=["told by the log"],
    )
    for one in (*found.estimates, *found.combined):
        words, unit = split_unit(one.name)
        value, error = show_uncertain(one.value, one.standard_error)
        told = one.remark or "yes"
        shown.add(words, value, error, _ends(one), unit, told)
    return shown


def _ends(one: Estimate) -> str:
    if one.high == inf:
        return f"at least {one.low:.4g}"
    return f"{one.low:.4g} to {one.high:.4g}"


def _open(found: Identification) -> Sheet:
    shown = Sheet(
        "Not identified",
        ["parameter", "because", "what would determine it"],
        prose=["because", "what would determine it"],
    )
    for one in found.verdicts:
        if not one.identifiable:
            symbol = SYMBOLS.get(one.parameter)
            name = f"{one.parameter} ({symbol})" if symbol else one.parameter
            shown.add(name, one.because, one.remedy)
    return shown


def _laws(compared: Sequence[ComparedLaw]) -> Sheet:
    rows = min(one.fit.effective_rows for one in compared)
    lowest = min(one.fit.aic_for(rows) for one in compared)
    shown = Sheet(
        "Laws compared",
        ["law", "parameters", "error", "held-out error", "AIC above best", "pays", "because"],
        numbers=["parameters", "error", "held-out error", "AIC above best"],
        prose=["because"],
    )
    for one in compared:
        name = _named(one.fit.channel)
        shown.add(
            one.fit.law.label,
            str(len(one.fit.estimates)),
            show(name, one.fit.rms_error),
            show(name, one.held_out_error),
            f"{one.fit.aic_for(rows) - lowest:.1f}",
            "yes" if one.pays else "no",
            one.because + (f" than {one.against}" if one.against else ""),
        )
    return shown
