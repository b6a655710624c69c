"""``breakaway run``: simulate one extraction."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.cli.quantity import show, show_value, split_unit
from breakaway.cli.show import Sheet, busy, say, say_json

if TYPE_CHECKING:
    from breakaway.cli.overlay import Overlay
    from breakaway.model.scenario import Scenario
    from breakaway.run.finished import Run

LIMIT_OF = {
    "peak_force_n": "peak_force_max_n",
    "largest_jump_m": "jump_max_m",
    "release_velocity_m_per_s": "release_velocity_max_m_per_s",
}
"""Figure -> the limit of a scenario that judges it."""

MEANING = {
    "released": "the part is free, and no limit was exceeded",
    "not_released": "time ran out before the part was free",
    "diverged": "error or force passed its bound, or was not a number",
    "limit_exceeded": "the part saw more than its limits allow",
}
"""Outcome -> what it says."""


def run(
    scenario: Annotated[str, typer.Argument(help="Name of a preset, or path of a TOML file.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for scenario, metrics, trace and figure.", metavar="DIR"),
    ] = None,
    joint: Annotated[
        Path | None,
        typer.Option(
            help="Joint file of `breakaway identify`, laid over the scenario.", metavar="FILE"
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of all random draws, in place of the scenario's.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Simulate one extraction and show its figures.

    With --out, the folder receives scenario.toml (every number explicit:
    running it gives the same bits), metrics.json, trace.parquet, trace.csv,
    figure.png and figure.svg; none of them where the run is interrupted.
    """
    from breakaway.model.scenario import load_scenario

    asked = load_scenario(scenario)
    if out is not None:
        from breakaway.base.output import refuse_to_overwrite

        refuse_to_overwrite(Path(scenario), out / "scenario.toml")
    if seed is not None:
        asked = asked.with_(seed=seed)
    overlay = None
    if joint is not None:
        from breakaway.cli.overlay import overlay_of

        overlay = overlay_of(joint, asked)
        asked = overlay.scenario
    finished, files = _simulate(asked, out)
    if json:
        _show_json(finished, files, overlay)
        return
    if overlay:
        say(*overlay.tables())
    _show(finished)
    for note in _notes(finished, out):
        say(note)
    for path in files:
        say(f"wrote {path}")


def _simulate(scenario: Scenario, out: Path | None) -> tuple[Run, list[Path]]:
    from breakaway.run.simulation import simulate

    what = f"simulating {show('duration_s', scenario.timing.duration_s)} ..."
    if out is None:
        with busy(what):
            return simulate(scenario), []
    from breakaway.show.run_files import written_run

    with busy(what), written_run(out) as write:  # a folder that can not be written fails now
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
    notes = [*_warnings(finished)]
    if out is not None and not finished.trace:
        notes.append("no trace and no figure: trace.every_samples is 0")
    if out is None:
        notes.append("--out DIR keeps trace, figure and the scenario that reruns this")
    return notes


def _warnings(finished: Run) -> Iterator[str]:
    """What a user should know before trusting the figures."""
    from breakaway.model.scenario import Gains, gain_sets

    scenario, m = finished.scenario, finished.metrics
    limits = scenario.limits
    if finished.outcome == "diverged":
        for name, value, field in (
            ("largest_error_m", m.largest_error_m, "diverged_error_m"),
            ("peak_force_n", m.peak_force_n, "diverged_force_n"),
        ):
            limit = getattr(limits, field)
            if not value <= limit:
                yield (
                    f"diverged at {show('t_s', m.simulated_s)}: {split_unit(name)[0]} "
                    f"{show(name, value)} is above limits.{field} = {show(name, limit)}"
                )
    presliding_m = scenario.joint.stiction_n / scenario.joint.stiffness_n_per_m
    if limits.breakaway_travel_m is not None and limits.breakaway_travel_m <= presliding_m:
        yield (
            f"limits.breakaway_travel_m = {show('x_m', limits.breakaway_travel_m)} is within the "
            f"presliding travel {show('x_m', presliding_m)}: a stuck joint counts as loose"
        )
    for which, gains in gain_sets(scenario.controller).items():
        if isinstance(gains, Gains) and min(gains.kp_n_per_m, gains.kd_n_s_per_m) < 0.0:
            yield (
                f"controller.{which}: one is negative: kp = {gains.kp_n_per_m:.4g} N/m, kd = "
                f"{gains.kd_n_s_per_m:.4g} N s/m; see `breakaway design`"
            )
    if scenario.joint.law == "lugre" and m.time_to_breakaway_s > 0 and m.peak_over_breakaway < 1:
        yield (
            f"the joint let go at {m.peak_over_breakaway:.2f} of stiction_n: LuGre friction creeps "
            "under a rising force; compare with law = 'two_region' before sizing an actuator"
        )


def _show_json(finished: Run, files: list[Path], overlay: Overlay | None) -> None:
    from breakaway.show.run_files import run_summary

    content = run_summary(finished) | {"files": [str(path) for path in files]}
    if overlay:
        content["joint"] = overlay.to_dict()
    say_json(content)
