"""``breakaway run``: simulate one extraction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.cli.accuracy import accuracy_of, accuracy_sheet
from breakaway.cli.options import Joint, Json, ScenarioName
from breakaway.cli.quantity import show, show_value, split_unit
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.cli.overlay import Overlay
    from breakaway.model.scenario import Scenario
    from breakaway.run.accuracy import Accuracy
    from breakaway.run.finished import Run

LIMIT_OF = {
    "peak_force_n": "peak_force_max_n",
    "largest_jump_m": "jump_max_m",
    "release_velocity_m_per_s": "release_velocity_max_m_per_s",
}
"""Figure -> the limit of a scenario that judges it."""

MEANING = {
    "released": "the part is free and no limit was exceeded",
    "not_released": "time ran out before the part was free",
    "diverged": "error or force exceeded its bound, or was not a number",
    "limit_exceeded": "the part exceeded a limit",
}
"""Outcome -> what it says."""


def run(
    scenario: ScenarioName,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the results: scenario, metrics, trace, figure.", metavar="DIR"
        ),
    ] = None,
    joint: Joint = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of all random draws. Left out: the scenario's.")
    ] = None,
    check_accuracy: Annotated[
        bool,
        typer.Option(
            "--check-accuracy",
            help="Run again with finer steps until nothing moves, and say what steps are wanted.",
        ),
    ] = False,
    json: Json = False,
) -> None:
    """Simulate one extraction and show its metrics.

    With --out, the folder gets scenario.toml (with every number explicit, so
    that it reruns to the same bits), metrics.json, trace.parquet, trace.csv,
    figure.png and figure.svg. An interrupted run writes nothing.
    """
    from breakaway.model.scenario import load_scenario

    asked = load_scenario(scenario)
    if out is not None:
        from breakaway.base.output import refuse_to_overwrite

        refuse_to_overwrite(Path(scenario), out / "scenario.toml")
    if seed is not None:
        asked = asked.with_(seed=seed)
    from breakaway.cli.laid import laid

    asked, overlay = laid(asked, joint)
    finished, files = _simulate(asked, out)
    accuracy = accuracy_of(finished.scenario) if check_accuracy else None
    if json:
        _show_json(finished, files, overlay, accuracy)
        return
    if overlay:
        say(*overlay.tables())
    _show(finished)
    if accuracy:
        say(*accuracy_sheet(accuracy))
    for note in _notes(finished, out):
        say(note)
    say_written(files)


def _simulate(scenario: Scenario, out: Path | None) -> tuple[Run, list[Path]]:
    from breakaway.run.simulation import simulate

    what = f"simulating {show('duration_s', scenario.timing.duration_s)} ..."
    if out is None:
        with busy(what):
            return simulate(scenario), []
    from breakaway.show.run_files import written_run

    with busy(what), written_run(out) as write:  # a folder that cannot be written fails now
        finished = simulate(scenario)
        return finished, write(finished)


def _show(finished: Run) -> None:
    limits = finished.scenario.limits
    judged = {
        name: limit
        for name, field in LIMIT_OF.items()
        if (limit := getattr(limits, field)) is not None
    }
    columns = ["metric", "value", "unit", *(["limit"] if judged else [])]
    shown = Sheet("", columns, numbers=["value"])
    for name, value in finished.metrics.to_dict().items():
        row = [split_unit(name)[0], *show_value(name, value)]
        if judged and name not in judged:
            row.append("")
        elif judged:
            exceeded = " exceeded" if value is not None and value > judged[name] else ""
            row.append(f"{show(name, judged[name])}{exceeded}")
        shown.add(*row)
    outcome = str(finished.outcome)
    say(f"{finished.scenario.name}: {outcome} ({MEANING[outcome]}), seed {finished.seed}", shown)


def _notes(finished: Run, out: Path | None) -> list[str]:
    notes = [*finished.warnings]
    if out is not None and not finished.trace:
        notes.append("no trace and no figure: trace.every_samples is 0")
    if out is None:
        notes.append("--out DIR saves trace, figure and the scenario that reruns this")
    return notes


def _show_json(
    finished: Run, files: list[Path], overlay: Overlay | None, accuracy: Accuracy | None
) -> None:
    from breakaway.show.run_files import run_summary

    content = run_summary(finished) | {"files": [str(path) for path in files]}
    if overlay:
        content["joint"] = overlay.to_dict()
    if accuracy:
        content["accuracy"] = accuracy.to_dict()
    say_json(content)
