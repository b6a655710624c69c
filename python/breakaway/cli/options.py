"""Arguments and options that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from breakaway.cli.completion import scenario_preset

ScenarioName = Annotated[
    str,
    typer.Argument(
        help="Name of a preset, or path of a TOML file.", autocompletion=scenario_preset
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]
Threads = Annotated[
    int | None, typer.Option(min=1, help="Threads. Left out: one for each processor.")
]

MappingFile = Annotated[
    Path | None,
    typer.Option(
        help="TOML file that names channels, units and signs.",
        metavar="FILE",
        show_default="LOG with .toml, if it is there",
    ),
]
MemoryGib = Annotated[
    float | None,
    typer.Option(
        help="Most memory in GiB that the content of a log may take.",
        show_default="half of what is free",
    ),
]
DropBadRows = Annotated[
    bool,
    typer.Option(
        "--drop-bad-rows",
        help="Leave out rows with a cell that is no finite number, and rows whose stamp repeats "
        "the one before; they are counted.",
    ),
]
Between = Annotated[
    tuple[float, float] | None,
    typer.Option(help="Cut the log to this span in s, before anything else.", metavar="START END"),
]
ResampleHz = Annotated[
    float | None,
    typer.Option(help="Bring channels with different time stamps to this rate, by interpolation."),
]
Rig = Annotated[
    Path | None,
    typer.Option(
        help="Rig file: stiffness, mass, filter and calibration (rig-from-blank writes one).",
        metavar="FILE",
    ),
]
Joint = Annotated[
    Path | None,
    typer.Option(
        help="Joint file from `breakaway identify` or `events`, laid over the scenario.",
        metavar="FILE",
    ),
]
JointOfParts = Annotated[
    Path | None,
    typer.Option(
        help="Joint file from `breakaway identify` or `events`: the parts are the joints that it "
        "draws.",
        metavar="FILE",
    ),
]
Use = Annotated[
    list[str] | None,
    typer.Option(
        help="Take one channel of the log for another, such as force_n=friction_n; repeatable.",
        metavar="CHANNEL=OTHER",
    ),
]
