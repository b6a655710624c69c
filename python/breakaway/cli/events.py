"""``breakaway events``: breakaway found in measured logs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.one_line import counted
from breakaway.cli.measured import measured, rig_of
from breakaway.cli.options import (
    Between,
    DropBadRows,
    Json,
    MappingFile,
    MemoryGib,
    ResampleHz,
    Rig,
    Use,
)
from breakaway.cli.pulled import (
    check_pulled_target,
    joint_tables,
    parts_table,
    write_joint,
    write_parts,
)
from breakaway.cli.quantity import show
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_json, say_written
from breakaway.errors import LogError

if TYPE_CHECKING:
    from breakaway.measure.identification import BreakawayReport, Population
    from breakaway.measure.logs import Log


def events(
    logs: Annotated[list[Path], typer.Argument(help="Measured logs.", metavar="LOG...")],
    use: Use = None,
    passed_share: Annotated[
        float,
        typer.Option(
            min=0.0,
            max=1.0,
            help="Share of the fall from peak to sliding that must be recorded; otherwise the peak "
            "counts as a lower bound.",
        ),
    ] = 0.5,
    mapping: MappingFile = None,
    memory_gib: MemoryGib = None,
    drop_bad_rows: DropBadRows = False,
    between: Between = None,
    resample_hz: ResampleHz = None,
    rig: Rig = None,
    population: Annotated[
        bool,
        typer.Option(
            "--population",
            help="Fit how breakaway differs from log to log; each log is one part.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="File for what was found: the joint of one log, or the population of several, "
            "each log a part.",
            metavar="FILE",
        ),
    ] = None,
    mass_kg: Annotated[
        float | None, typer.Option(help="Mass of the part in kg, from a scale, for --out.")
    ] = None,
    json: Json = False,
) -> None:
    """Find breakaway in logs: force, presliding, loading rate, and which are lower bounds.

    A log in which the part already moves at the start is refused, with the
    reason. The force is used as measured: of inertia, only that of a rig file is
    subtracted.

    With --out, one log becomes a joint file, for --joint of other commands.
    Several become a population, for `breakaway compare` and `tune`. What logs do
    not tell has a usual value and a wide range there, marked as assumed.
    """
    from breakaway.measure.identification import find_breakaway_events, fit_population

    if out is not None:
        check_pulled_target(logs, out)
    elif mass_kg is not None:
        raise LogError("--mass-kg: is for --out; give --out, or leave it out")
    fits = population or (out is not None and len(logs) > 1)
    read, reports, hints, stands = [], [], [], rig_of(rig)
    with busy("looking for breakaway ..."):
        for path in logs:
            log = measured(
                path,
                mapping=mapping,
                memory_gib=memory_gib,
                drop_bad_rows=drop_bad_rows,
                between=between,
                resample_hz=resample_hz,
                use=use,
            )
            reports.append(find_breakaway_events(log, passed_share=passed_share, rig=stands))
            read += [] if out is None else [log]
            if not use and "friction_n" in log.channels:
                hints.append(
                    f"- {log.name}: this uses force_n; --use force_n=friction_n takes friction"
                )
        found = fit_population(reports, passed_share=passed_share) if fits else None
    if not json:
        _say(reports, hints, found)
    told = [] if out is None else _write(out, read, reports, found, mass_kg)
    if json:
        file = {} if out is None else {"file": str(out)}
        say_json({"logs": [_plain(report) for report in reports], **_fits(found), **file})
    elif out is not None:
        say(*told)
        say_written([out])


def _write(
    out: Path,
    logs: list[Log],
    reports: list[BreakawayReport],
    found: Population | None,
    mass_kg: float | None,
) -> list[Sheet | str]:
    """Write the joint of one log, or the population of several, and tell what it says."""
    if found is None or len(logs) == 1:
        return joint_tables(write_joint(logs[0], reports[0], out, mass_kg))
    return [parts_table(write_parts(logs, reports, found, out, mass_kg))]


def _say(reports: list[BreakawayReport], hints: list[str], found: Population | None) -> None:
    say(_table(reports))
    for report in reports:
        for reason in report.refused:
            say(f"- {report.name}: {reason}")
        if report.spikes:
            say(f"- {report.name}: {_spikes(report)}")
        if report.offset_n is None:
            say(f"- {report.name}: offset unknown, {report.offset_reason}")
    for hint in hints:
        say(hint)
    if found is not None:
        say(_population(found))
        for note in found.notes:
            say(f"- {note}")


def _plain(report: BreakawayReport) -> dict[str, object]:
    rig = None if report.rig is None else report.rig.model_dump()
    return {**asdict(report), "rig": rig}


def _table(reports: list[BreakawayReport]) -> Sheet:
    columns = ["log", "time", "breakaway", "±", "", "sliding", "ratio", "presliding", "loading"]
    shown = Sheet("Breakaway, offset subtracted", columns, numbers=columns[1:4] + columns[5:])
    for report in reports:
        for event in report.events:
            rate = event.loading_rate_n_per_s
            shown.add(
                report.name,
                f"{event.time_s:.3f} s",
                show("force_n", event.breakaway_force_n),
                show("force_n", float(f"{event.breakaway_error_n:.2g}")),
                "at least" if event.is_lower_bound else "",
                show("force_n", event.sliding_force_n),
                ""
                if event.breakaway_over_sliding is None
                else f"{event.breakaway_over_sliding:.2f}",
                show("travel_m", event.presliding_displacement_m),
                "" if rate is None else f"{rate:.3g} N/s",
            )
    return shown


def _spikes(report: BreakawayReport) -> str:
    first = report.spikes[0]
    stand = "stands" if len(report.spikes) == 1 else "stand"
    return (
        f"{counted(len(report.spikes), 'single sample')} of the force {stand} alone, the first of "
        f"{show('force_n', first.force_n)} at {first.time_s:.6g} s; they are not taken for load"
    )


def _population(found: Population) -> Sheet:
    shown = Sheet("Population", ["figure", "parameter", "value", "95 % interval"], labels=2)
    for name, fit in found.fits.items():
        for parameter, value in fit.parameters.items():
            low, high = fit.interval[parameter]
            shown.add(name, parameter, f"{value:.4g}", f"{low:.4g} to {high:.4g}")
    return shown


def _fits(found: Population | None) -> dict[str, object]:
    if found is None:
        return {}
    fits = {
        name: {"parameters": dict(fit.parameters), "interval": dict(fit.interval)}
        for name, fit in found.fits.items()
    }
    return {"population": fits, "notes": list(found.notes)}
