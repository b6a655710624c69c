"""``breakaway tune``: numbers of a method chosen on training parts, scored on unseen ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.base.reading import is_there
from breakaway.cli.options import JointOfParts, Json, Threads
from breakaway.cli.progress import shown_progress
from breakaway.cli.quantity import show, split_unit
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import say, say_aside, say_json, say_written
from breakaway.errors import OutputError

if TYPE_CHECKING:
    from breakaway.ask.durable.progress import Progress
    from breakaway.ask.tuning import Tuning, TuningProgress


def tune(
    file: Annotated[Path, typer.Argument(help="TOML file of the tuning.", metavar="TUNING.toml")],
    out: Annotated[
        Path, typer.Option(help="Folder for the results: methods, tables, figures.", metavar="DIR")
    ],
    joint: JointOfParts = None,
    evaluations: Annotated[
        int | None, typer.Option(min=1, help="How many methods to try. Left out: as in the file.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the tuning in DIR.")] = False,
    threads: Threads = None,
    json: Json = False,
) -> None:
    """Tune a method on parts of a population, and score it on parts that tuning never saw.

    Each evaluation is saved as it finishes. At the end the folder also holds
    summary.json, best.toml (the recommended method, complete), a file for each
    point of the front, tables (CSV) and figures. An interrupted or killed
    tuning continues with --resume, also with more --evaluations.
    """
    from breakaway.ask.tuning import load_tuning
    from breakaway.ask.tuning import tune as run_tuning
    from breakaway.base.output import refuse_to_overwrite

    asked = load_tuning(file, joint=joint)
    refuse_to_overwrite(file, out / "best.toml")
    try:
        with shown_progress(asked.name) as progress:
            done = run_tuning(
                asked,
                out=out,
                evaluations=evaluations,
                resume=resume,
                threads=threads,
                progress=_told(progress),
                notice=say_aside,
            )
    except (KeyboardInterrupt, OutputError):
        if is_there(out / "manifest.json"):
            more = "" if joint is None else f" --joint {joint}"
            more += "" if evaluations is None else f" --evaluations {evaluations}"
            say_aside(
                f"what is finished is kept; go on with: breakaway tune {file} --out {out}{more} "
                "--resume"
            )
        raise
    files = sorted(path for path in out.iterdir() if path.is_file() and path.name[0] != ".")
    summary = done.summary
    if json:
        say_json(summary | {"files": [str(path) for path in files]})
        return
    if summary["recommended"]:
        say(_scores(asked, summary), _numbers(asked, summary))
    for sentence in summary["result"]:
        say(sentence)
    for note in summary["notes"]:
        say(f"note: {note}")
    say_written(files)


def _told(progress: Callable[[Progress], None]) -> Callable[[TuningProgress], None]:
    """Tell the best so far beside how far the parts are."""

    def tell(at: TuningProgress) -> None:
        best = ", ".join(f"{split_unit(name)[0]} {show(name, v)}" for name, v in at.best.items())
        progress(replace(at, doing=f"{at.doing}, best: {best}") if best else at)

    return tell


def _scores(asked: Tuning, summary: Mapping[str, Any]) -> Sheet:
    """Give the objectives of start and front, training and unseen side by side."""
    columns = [
        "method",
        *(f"{split_unit(name)[0]}: {on}" for name in asked.objectives for on in ON),
    ]
    sheet = Sheet("", columns, numbers=columns[1:])
    rows = {row["score"]: row for row in summary["overfitting"]}
    cells = [show(n, rows[n][f"start_{on}"]) for n in asked.objectives for on in ON]
    sheet.add("as it was", *cells)
    for row in summary["front"]:
        name = f"{row['file']}, recommended" if row["recommended"] else row["file"]
        cells = [show(n, row[f"{n}_{on}"]) for n in asked.objectives for on in ON]
        sheet.add(name, *cells)
    return sheet


ON = ("training", "unseen")


def _numbers(asked: Tuning, summary: Mapping[str, Any]) -> Sheet:
    """Give the numbers of the recommended method beside what they were and could be."""
    from breakaway.ask.tuning.numbers import number_of

    columns = ["number", "was", "is", "from", "to"]
    sheet = Sheet("", columns, numbers=columns[1:])
    for path, value in summary["recommended"]["numbers"].items():
        span = asked.tune[path]
        was = number_of(asked.method, path)
        sheet.add(path, *(show(path, number) for number in (was, value, span.low, span.high)))
    return sheet
