"""``breakaway identify``: mass and friction from a measured log."""

from __future__ import annotations

from dataclasses import asdict, fields
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.cli.quantity import show_uncertain, split_unit
from breakaway.cli.show import Sheet, busy, say, say_json

if TYPE_CHECKING:
    from breakaway.identification import AsymmetricFit, InertiaFrictionFit, SymmetricFit


class LogFormat(StrEnum):
    """Formats of `breakaway.logs.FORMATS`, named here so that the command starts without them."""

    CSV = "csv"
    EMPS = "emps"


def identify(
    log: Annotated[Path, typer.Argument(help="The measured log.")],
    format: Annotated[
        LogFormat,
        typer.Option(
            help="csv: columns t_s, position_m, force_n, with units as named. "
            "emps: the EMPS benchmark's MATLAB file."
        ),
    ] = LogFormat.CSV,
    out: Annotated[
        Path | None,
        typer.Option(help="Joint file to write, for `breakaway run --joint`.", metavar="FILE"),
    ] = None,
    lowpass_hz: Annotated[
        float | None, typer.Option(help="Cutoff of the low-pass on position.", show_default="100")
    ] = None,
    decimation: Annotated[
        int | None, typer.Option(help="Samples per sample that is fitted.", show_default="10")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Identify mass, Coulomb and viscous friction from a log of position and force.

    Shows the fit with equal friction in both directions and the fit with
    friction of its own in each, with standard errors, and what the log can
    not tell.
    """
    from breakaway.identification import JointFile, identify_inertia_friction
    from breakaway.logs import read_log

    settings: dict[str, Any] = {"lowpass_hz": lowpass_hz, "decimation": decimation}
    given = {name: value for name, value in settings.items() if value is not None}
    if out is not None:
        _check_target(log, out)
    with busy("identifying ..."):
        measured = read_log(log, format=format.value)
        fit = identify_inertia_friction(measured, **given)
    if not json:
        _show(fit, log)
    if out is not None:
        JointFile.from_fit(fit, measured).save(out)
    if json:
        say_json({"log": str(log), **asdict(fit), "file": str(out) if out else None})
    elif out is not None:
        say(f"wrote {out}")


def _check_target(log: Path, out: Path) -> None:
    """Refuse to write over the log, or over anything but another joint file."""
    from breakaway.errors import OutputError, ScenarioError
    from breakaway.identification import JointFile
    from breakaway.output import refuse_to_overwrite

    refuse_to_overwrite(log, out)
    if out.is_file():
        try:
            JointFile.load(out)
        except ScenarioError:
            raise OutputError(f"{out}: is there and is no joint file; give another name") from None


def _show(fit: InertiaFrictionFit, log: Path) -> None:
    say(
        f"{log}: sampled at {fit.sample_rate_hz:.6g} Hz, low-pass {fit.lowpass_hz:g} Hz, "
        f"decimation {fit.decimation}, {fit.symmetric.samples} samples fitted"
    )
    _show_fit("Symmetric: F = mass a + viscous v + coulomb sign(v) + offset", fit.symmetric)
    _show_fit("Asymmetric: friction of its own in each direction, no offset", fit.asymmetric)
    if fit.not_identified:
        left_open = Sheet(
            "Not identified: a scenario's own values stay", ["field", "because"], prose=["because"]
        )
        for field, reason in fit.not_identified.items():
            left_open.add(field, reason)
        say(left_open)
    for note in fit.notes:
        if not note.startswith("not identified:"):  # the table says it
            say(f"- {note}")


def _show_fit(title: str, fit: SymmetricFit | AsymmetricFit) -> None:
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
    say(shown)
