"""``breakaway advise``: how to get parts out with a rig, and what it does to them."""

from __future__ import annotations

import hashlib
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.reading import is_file
from breakaway.cli.completion import population_preset, rig_preset
from breakaway.cli.options import Json, Threads
from breakaway.cli.progress import shown_progress
from breakaway.cli.quantity import show
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_aside, say_json, say_written

if TYPE_CHECKING:
    from breakaway.ask.advice import Advice


def advise(
    parts: Annotated[
        str,
        typer.Argument(
            help="Joint file, population file, or name of a population.",
            autocompletion=population_preset,
            metavar="JOINT_OR_PARTS",
        ),
    ],
    out: Annotated[
        Path, typer.Option(help="Folder for report, figures and method.", metavar="DIR")
    ] = Path("advice"),
    rig: Annotated[
        str,
        typer.Option(
            help="What pulls: name of a preset, or a TOML file.",
            metavar="NAME_OR_FILE",
            autocompletion=rig_preset,
        ),
    ] = "electric_cylinder",
    limits: Annotated[
        Path | None,
        typer.Option(
            help="What the part and its host may suffer. Left out: the population's gentle limits, "
            "which are assumed.",
            metavar="FILE",
        ),
    ] = None,
    engagement_length_m: Annotated[
        float | None,
        typer.Option(
            help="Length of the guide in m, from the drawing. Left out: as the population says, or "
            "20 to 100 mm for a joint file.",
        ),
    ] = None,
    budget_s: Annotated[float, typer.Option(help="Time that it may take, in s.")] = 120.0,
    parts_max: Annotated[int, typer.Option(help="Most parts that are judged.")] = 2000,
    seed: Annotated[int, typer.Option(help="Seed of the parts.")] = 0,
    threads: Threads = None,
    json: Json = False,
) -> None:
    """Advise how to get parts out: with what, set to what, and what it does to them.

    Every way that the rig's drive and sensors allow is tried on the same
    parts, under every friction law that is open, and ranked by how many parts
    come out within all limits. The folder gets a report for the person who
    decides, as index.html and report.pdf, and the recommended method.
    Ctrl-C gives the best so far, marked as such.
    """
    from breakaway.ask.advice import advise as ask
    from breakaway.ask.advice import write_advice

    with shown_progress("advice") as progress:
        found = ask(
            parts,
            rig,
            limits,
            engagement_length_m=engagement_length_m,
            budget_s=budget_s,
            parts_max=parts_max,
            seed=seed,
            threads=threads,
            progress=progress,
        )
    with busy("figures and report"):
        read = [Path(one) for one in (parts, rig, limits) if one and is_file(Path(one))]
        written = write_advice(
            found,
            out,
            command=_command(parts, rig, limits, engagement_length_m, found),
            made_of=tuple(f"{path.name}: SHA-256 {_sha256(path)}" for path in read),
        )
    if json:
        say_json({**found.to_dict(), "files": [str(path) for path in written]})
    else:
        _show(found)
        say_written(written)
    if found.tried.ended == "interrupted":
        say_aside("this is the best so far")
        raise KeyboardInterrupt


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _command(
    parts: str, rig: str, limits: Path | None, engagement_length_m: float | None, found: Advice
) -> str:
    """Give the command that repeats an advice: with as many parts, and time enough for them."""
    words = ["breakaway", "advise", parts, "--rig", rig]
    words += ["--limits", str(limits)] if limits else []
    if engagement_length_m is not None:
        words += ["--engagement-length-m", repr(engagement_length_m)]
    words += ["--parts-max", str(found.tried.parts), "--budget-s", "100000"]
    return shlex.join([*words, "--seed", str(found.seed)])


def _show(found: Advice) -> None:
    columns = ["way", "unharmed %", "freed %", "peak/allowed", "peak", "jump", "release", "time"]
    sheet = Sheet(
        f"{found.parts.name} with {found.bounds.rig.name}: {found.tried.parts} parts",
        columns,
        numbers=columns[1:],
    )
    for row in found.ranking:
        velocity, time_s = row.velocity_high_m_per_s, row.time_median_s
        sheet.add(
            row.way,
            f"{100 * row.unharmed:.3g} ({100 * row.low:.3g} to {100 * row.high:.3g})",
            f"{100 * row.freed:.3g}",
            f"{row.load_high:.2f}",
            show("force_n", row.peak_high_n),
            show("jump_m", row.jump_high_m),
            "" if velocity is None else show("release_velocity_m_per_s", velocity),
            "" if time_s is None else f"{time_s:.2f} s",
        )
    say(sheet)
    say("under the law where a way does worst; peak, jump, release: exceeded by one part in twenty")
    for sentence in found.sentences:
        say(sentence)
    for line in found.rests_on:
        say(f"note: {line}")
