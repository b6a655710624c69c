"""``breakaway study``: many simulations that answer one question."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
    from breakaway.ask.studies import StudyResult

ROWS_MAX = 40
"""Most rows of a table that are printed; its file has all."""

OUTCOMES = ("released", "not_released", "limit_exceeded", "diverged")


def study(
    file: Annotated[Path, typer.Argument(help="TOML file of the study.", metavar="STUDY.toml")],
    out: Annotated[
        Path, typer.Option(help="Folder for the results: summary, tables, figures.", metavar="DIR")
    ],
    joint: JointOfParts = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the study in DIR.")] = False,
    threads: Threads = None,
    json: Json = False,
) -> None:
    """Run many simulations that answer one question.

    There are five kinds: sweep, robustness, sensitivity, compare, and
    agreement (between friction laws). `breakaway init --kind` writes a file
    to start from.

    Runs are saved as they finish (Parquet). At the end the folder also holds
    summary.json, tables (CSV), figures, and study.toml, which is all it takes
    to run the study again. An interrupted or killed study continues with
    --resume and computes nothing twice.
    """
    from breakaway.ask.durable.journal import PIECES
    from breakaway.ask.studies import load_study, run_study

    asked = load_study(file, joint=joint)
    if is_there(out) and not resume:  # what goes on may be asked by its own study.toml
        from breakaway.base.output import refuse_to_overwrite

        refuse_to_overwrite(file, out / "study.toml")
    try:
        with shown_progress(asked.name) as progress:
            done = run_study(
                asked, out=out, resume=resume, threads=threads, progress=progress, notice=say_aside
            )
    except (KeyboardInterrupt, OutputError):
        if is_there(out / "manifest.json"):
            say_aside(
                f"what is finished is kept; go on with: breakaway study {file} --out {out} "
                f"{'' if joint is None else f'--joint {joint} '}--resume"
            )
        raise
    files = sorted(path for path in out.iterdir() if path.is_file() and path.name[0] != ".")
    summary = done.summary
    if json:
        say_json(summary | {"files": [str(path) for path in files]})
        return
    say(*_tables(done, summary))
    for sentence in summary["result"]:
        say(sentence)
    for note in summary["notes"]:
        say(f"note: {note}")
    say(f"wrote {len(done.piece_files)} pieces to {out / PIECES}")
    say_written(files)


def _tables(done: StudyResult, summary: Mapping[str, Any]) -> list[Sheet | str]:
    """Give the tables of a kind of study, as far as they are wanted on a screen."""
    tables, metrics = summary["tables"], done.study.shown
    make: dict[str, Callable[[list[dict[str, Any]]], Sheet]] = {
        "points": lambda rows: _points(rows, list(done.manifest["labels"]), metrics),
        "trail": lambda rows: _trail(rows, summary["over"]),
        "indices": lambda rows: _indices(rows, metrics),
        "outcomes": _outcomes,
        "differences": lambda rows: _differences(rows, metrics),
        "conclusions": _conclusions,
        "laws": _laws,
        "variants": _variants,
        "smallest": _smallest,
    }
    shown: list[Sheet | str] = []
    for name, rows in tables.items():
        sheet = make[name](rows)
        shown.append(sheet)
        if len(sheet.rows) == ROWS_MAX:
            shown.append(f"the first {ROWS_MAX} rows; {name}.csv has all")
    return shown


def _points(rows: Sequence[Mapping[str, Any]], labels: list[str], metrics: Sequence[str]) -> Sheet:
    seen = [name for name in OUTCOMES if any(row[name] for row in rows)]
    columns = [*labels, "runs", *seen, *(f"{split_unit(name)[0]}: median" for name in metrics)]
    sheet = Sheet("", columns, numbers=columns, labels=len(labels))
    for row in rows[:ROWS_MAX]:
        sheet.add(
            *(_level(row[name]) for name in labels),
            str(row["runs"]),
            *(_share(row, name) for name in seen),
            *(show(name, row[f"{name}_median"]) for name in metrics),
        )
    return sheet


def _trail(rows: Sequence[Mapping[str, Any]], over: str) -> Sheet:
    columns = ["step", over, "runs", "failures", "estimate", "upper bound", "verdict"]
    sheet = Sheet("", columns, numbers=columns[:-1])
    for row in rows[:ROWS_MAX]:
        sheet.add(
            str(row["step"]),
            _level(row[over]),
            str(row["runs"]),
            str(row["failures"]),
            f"{row['failure_probability']:.3g}",
            f"{row['upper_bound']:.3g}",
            "survived" if row["survived"] else "not shown to be survived",
        )
    return sheet


def _indices(rows: Sequence[Mapping[str, Any]], metrics: Sequence[str]) -> Sheet:
    columns = ["metric", "input", "first order", "total order"]
    sheet = Sheet("", columns, numbers=columns[2:])
    for row in [row for row in rows if row["metric"] in metrics][:ROWS_MAX]:
        sheet.add(
            split_unit(row["metric"])[0],
            row["input"],
            *(
                f"{row[key]:.3f} ± {row[f'{key}_error']:.3f}"
                for key in ("first_order", "total_order")
            ),
        )
    return sheet


def _outcomes(rows: Sequence[Mapping[str, Any]]) -> Sheet:
    seen = [name for name in OUTCOMES if any(row[name] for row in rows)]
    columns = ["controller", "runs", *seen, "p"]
    sheet = Sheet("", columns, numbers=columns[1:])
    for row in rows[:ROWS_MAX]:
        p = "" if row["p"] is None else f"{row['p']:.2g}"
        sheet.add(row["controller"], str(row["runs"]), *(_share(row, name) for name in seen), p)
    return sheet


def _differences(rows: Sequence[Mapping[str, Any]], metrics: Sequence[str]) -> Sheet:
    columns = ["controller", "metric", "pairs", "median difference", "from", "to", "lower in"]
    sheet = Sheet("", columns, numbers=columns[2:])
    for row in [row for row in rows if row["metric"] in metrics][:ROWS_MAX]:
        name = row["metric"]
        lower = "" if row["lower_share"] is None else f"{100 * row['lower_share']:.1f} %"
        sheet.add(
            row["controller"],
            split_unit(name)[0],
            str(row["pairs"]),
            *(show(name, row[key]) for key in ("difference", "difference_low", "difference_high")),
            lower,
        )
    return sheet


def _conclusions(rows: Sequence[Mapping[str, Any]]) -> Sheet:
    parts = [name for name in rows[0] if name.startswith("verdict_")]
    words = [name.removeprefix("verdict_").replace("_", " ") for name in parts]
    sheet = Sheet("", ["of", "than", "quantity", "goes", "verdict", *words], labels=3)
    for row in rows[:ROWS_MAX]:
        sheet.add(
            row["other"],
            row["first"],
            split_unit(row["quantity"])[0],
            row["direction"],
            row["verdict"],
            *(row[name] for name in parts),
        )
    return sheet


def _laws(rows: Sequence[Mapping[str, Any]]) -> Sheet:
    columns = ["quantity", "law", "disturbance", "pairs", "difference", "from", "to", "relative"]
    sheet = Sheet("", ["of", "than", *columns, "says"], numbers=columns[3:])
    keys = ("difference", "difference_low", "difference_high")
    for row in rows[:ROWS_MAX]:
        name = row["quantity"]
        sheet.add(
            row["other"],
            row["first"],
            split_unit(name)[0],
            row["law"],
            row["disturbance"],
            str(row["pairs"]),
            *(show(name, row[key]) for key in keys),
            "" if row["relative"] is None else f"{100 * row['relative']:+.3g} %",
            "not shown" if row["direction"] == "undecided" else row["direction"],
        )
    return sheet


def _variants(rows: Sequence[Mapping[str, Any]]) -> Sheet:
    seen = [name for name in OUTCOMES if any(row[name] for row in rows)]
    sheet = Sheet("", ["law", "disturbance", "variant", "runs", *seen], numbers=["runs", *seen])
    for row in rows[:ROWS_MAX]:
        labels = (row["law"], row["disturbance"], row["variant"], str(row["runs"]))
        sheet.add(*labels, *(_share(row, name) for name in seen))
    return sheet


def _smallest(rows: Sequence[Mapping[str, Any]]) -> Sheet:
    numbers = ["runs", "smallest: 5 %", "median", "95 %", "at lowest", "above highest"]
    sheet = Sheet("", ["law", "disturbance", "variant", *numbers], numbers=numbers)
    for row in rows[:ROWS_MAX]:
        sheet.add(
            *(row[name] for name in ("law", "disturbance", "variant")),
            str(row["runs"]),
            *(_level(row[name]) for name in ("p05", "median", "p95")),
            *(str(row[name]) for name in ("at_lowest", "above_highest")),
        )
    return sheet


def _share(row: Mapping[str, Any], name: str) -> str:
    share, low, high = (100 * row[f"{name}_{key}"] for key in ("share", "low", "high"))
    return f"{share:.4g} % ({low:.3g} to {high:.3g})"


def _level(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
