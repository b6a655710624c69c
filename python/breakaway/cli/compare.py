"""``breakaway compare``: methods of extraction side by side, on the same parts."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.base.reading import is_there
from breakaway.cli.completion import (
    friction_laws,
    friction_variations,
    method_preset,
    population_preset,
)
from breakaway.cli.options import JointOfParts, Json, Threads
from breakaway.cli.progress import shown_progress
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_aside, say_json, say_written
from breakaway.errors import OutputError

if TYPE_CHECKING:
    from breakaway.ask.comparison import Comparison
    from breakaway.ask.durable.progress import Progress

Row = Mapping[str, Any]

BEST = " *"
"""Marks the best of a column."""


def compare(
    population: Annotated[
        str,
        typer.Argument(
            help="Name of a preset, or path of a TOML file.", autocompletion=population_preset
        ),
    ] = "seized_parts",
    joint: JointOfParts = None,
    out: Annotated[
        Path, typer.Option(help="Folder for the results: table, figures, page.", metavar="DIR")
    ] = Path("comparison"),
    runs: Annotated[
        int | None, typer.Option(help="How many parts each method gets. Left out: 10,000.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the parts. Left out: 0.")] = None,
    method: Annotated[
        list[str] | None,
        typer.Option(
            help="Method: name of a preset, or a TOML file; repeatable. Left out: all presets.",
            metavar="NAME_OR_FILE",
            autocompletion=method_preset,
        ),
    ] = None,
    laws: Annotated[
        list[str] | None,
        typer.Option(
            help="Friction laws, with commas or repeated. Left out: lugre,elasto_plastic,gms.",
            metavar="LAWS",
            autocompletion=friction_laws,
        ),
    ] = None,
    variations: Annotated[
        list[str] | None,
        typer.Option(
            help="How friction varies: field,part,none,paper_random_factor, with commas or "
            "repeated. Left out: as the population says.",
            metavar="VARIATIONS",
            autocompletion=friction_variations,
        ),
    ] = None,
    baseline: Annotated[
        list[str] | None,
        typer.Option(
            help="Method to compare others with; repeatable, the best counts. Left out: all.",
            metavar="NAME",
            autocompletion=method_preset,
        ),
    ] = None,
    allow_training_parts: Annotated[
        bool | None,
        typer.Option(
            "--allow-training-parts",
            help="Compare a method even on parts that it was tuned on. Left out: refused.",
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue the comparison in DIR.")
    ] = False,
    threads: Threads = None,
    json: Json = False,
) -> None:
    """Try methods of extraction on the same parts of a population, under several friction laws.

    Every law is asked with each of the VARIATIONS: friction that varies along
    the way (field), from part to part (part), not at all (none), or anew in
    time as in the paper (paper_random_factor).
    POPULATION is a preset or a TOML file of a population. It can also be the
    comparison.toml of an earlier comparison, which is then run again.
    Results are saved as they finish (Parquet). At the end the folder also
    holds table.csv, figures, and index.html, a page that needs no network.
    An interrupted comparison continues with --resume and computes nothing
    twice.
    """
    from breakaway.ask.comparison import compare_methods

    try:
        with _progress() as progress:
            done = compare_methods(
                population,
                method,
                joint=joint,
                laws=_named(laws),
                variations=_named(variations),
                runs=runs,
                seed=seed,
                baselines=baseline,
                allow_training_parts=allow_training_parts,
                out=out,
                resume=resume,
                threads=threads,
                progress=progress,
                notice=say_aside,
            )
    except (KeyboardInterrupt, OutputError):
        if is_there(out / "manifest.json"):
            say_aside(f"what is finished is kept; go on with: {_again(out)}")
        raise
    if json:
        say_json(_document(done))
    else:
        _show(done)


def _named(given: Sequence[str] | None) -> list[str] | None:
    """Give the names of an option that is repeated, or has commas."""
    return [name.strip() for one in given for name in one.split(",")] if given else None


def _again(out: Path) -> str:
    """Give the command that goes on: the same, with --resume."""
    import shlex

    given = [word for word in sys.argv[1:] if word != "--resume"]
    if not given or given[0] != "compare":  # called otherwise than as a command
        given = ["compare", "--out", str(out)]
    return shlex.join(["breakaway", *given, "--resume"])


@contextmanager
def _progress() -> Iterator[Callable[[Progress], None]]:
    """Show how far the parts are, and then that figures are drawn."""
    with shown_progress() as report, ExitStack() as after:
        drawing = False

        def tell(at: Progress) -> None:
            nonlocal drawing
            report(at)
            if at.runs_done >= at.runs_max and not drawing:
                drawing = True
                after.enter_context(busy("figures and page"))

        yield tell


def _document(done: Comparison) -> dict[str, Any]:
    asked = done.asked
    return {
        "population": asked.population.name,
        "methods": asked.names,
        "laws": asked.laws,
        "variations": asked.variations,
        "runs": asked.runs,
        "seed": asked.seed,
        "result": list(done.result),
        "notes": list(done.notes),
        "table": list(done.table),
        "files": [str(path) for path in _files(done)],
    }


def _show(done: Comparison) -> None:
    stack = any(row["stack_cycles_median"] is not None for row in done.table)
    for case in done.asked.cases:
        named = (case.law, case.variation)
        rows = [row for row in done.table if (row["law"], row["variation"]) == named]
        heading = ", ".join(named)
        say(_outcomes(heading, rows), _harm(heading, rows))
        if stack:
            say(_wear(heading, rows))
    say("*: best of its column; time, jump, force and velocity: among methods that free 90 %")
    for sentence in done.result:
        say(sentence)
    for note in done.notes:
        say(f"note: {note}")
    say_written(_files(done))


def _files(done: Comparison) -> Sequence[Path]:
    if done.folder is None:
        return []
    return sorted(p for p in done.folder.iterdir() if p.is_file() and p.name[0] != ".")


def _outcomes(case: str, rows: Sequence[Row]) -> Sheet:
    """Give what became of the parts: shares of all, in percent, with 95 % intervals."""
    alone = ("force", "jump", "velocity")
    shares = ("released", "gentle", "strict")
    columns = ["method", *(f"{n} %" for n in shares), *(f"within {n} %" for n in alone)]
    columns += ["best other", "only this", "only other", "p"]
    sheet = Sheet(f"{case}: shares of {rows[0]['runs']} parts", columns, numbers=columns[1:])
    for row in rows:
        p = row["gentle_p"]
        pairing = [row["against"] or "", row["gentle_only_this"], row["gentle_only_other"]]
        sheet.add(
            row["method"],
            *(_share(row, name) for name in shares),
            *(_marked(row, f"{name}_share", 100.0, ".4g") for name in alone),
            *("" if value is None else str(value) for value in pairing),
            "" if p is None else f"{p:.2g}",
        )
    return sheet


def _harm(case: str, rows: Sequence[Row]) -> Sheet:
    """Give what the parts suffered: medians, and the 99 % quantiles behind them."""
    spreads = (
        ("time_to_release_s", "time to release s", 1.0),
        ("largest_jump_m", "largest jump mm", 1e3),
        ("peak_over_breakaway", "peak/breakaway", 1.0),
        ("release_velocity_m_per_s", "release m/s", 1.0),
        ("largest_impact_work_j", "largest impact J", 1.0),
        ("impulse_n_s", "impulse N s", 1.0),
    )
    columns = ["method", *(heading for _, heading, _ in spreads)]
    sheet = Sheet(f"{case}: median, and 99 %", columns, numbers=columns[1:])
    for row in rows:
        cells = [
            f"{_marked(row, f'{name}_median', factor)}, {_marked(row, f'{name}_p99', factor)}"
            for name, _, factor in spreads
        ]
        sheet.add(row["method"], *cells)
    return sheet


def _wear(case: str, rows: Sequence[Row]) -> Sheet:
    """Give what wears a piezo stack: medians."""
    keys = ("stack_cycles_median", "rms_current_a_median", "stack_loss_w_median")
    columns = ["method", "stack cycles", "RMS current A", "stack loss W"]
    sheet = Sheet(f"{case}: wear of the stack, medians", columns, numbers=columns[1:])
    for row in rows:
        if row[keys[0]] is not None:
            sheet.add(row["method"], *(_marked(row, key) for key in keys))
    return sheet


def _share(row: Row, name: str) -> str:
    low, high = (100.0 * row[f"{name}_{key}"] for key in ("low", "high"))
    return f"{_marked(row, f'{name}_share', 100.0, '.4g')} ({low:.3g} to {high:.3g})"


def _marked(row: Row, key: str, factor: float = 1.0, digits: str = ".3g") -> str:
    """Give a number, with a mark where it is the best of its column."""
    if row[key] is None:
        return "none"
    best = BEST if key in str(row["best"]).split(";") else ""
    value = row[key] * factor
    return f"{value:,.0f}{best}" if abs(value) >= 1000.0 else f"{value:{digits}}{best}"
