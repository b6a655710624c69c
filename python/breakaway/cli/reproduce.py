"""``breakaway reproduce``: the paper's figures and tables again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.reading import is_there
from breakaway.cli.progress import shown_progress
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import say, say_aside
from breakaway.errors import OutputError

if TYPE_CHECKING:
    from breakaway.ask.reproduction.report import Reproduction


def reproduce(
    out: Annotated[
        Path, typer.Option(help="Folder for report, figures and tables.", metavar="DIR")
    ] = Path("reproduction"),
    full: Annotated[
        bool,
        typer.Option(
            "--full", help="Figure 10 from 10,000 runs at each of 20 levels; takes minutes."
        ),
    ] = False,
) -> None:
    """Reproduce the paper's results, and say where they differ from the printed ones.

    The last line of the output is the path of the report. With --full, levels
    of figure 10 are saved in DIR/figure_10 as they finish. After Ctrl-C the
    same command continues there.
    """
    from breakaway.ask.reproduction.report import reproduce as reproduce_paper

    done = _in_full(out) if full else reproduce_paper(out, say_aside)
    header = [str(name) for name in done.header]
    shown = Sheet("", header, prose=header[:-1])
    for row in done.table:
        shown.add(*row)
    say(shown, str(done.report_path))


def _in_full(out: Path) -> Reproduction:
    from breakaway.ask.reproduction.report import reproduce as reproduce_paper
    from breakaway.ask.reproduction.survey import FullSurvey

    try:
        with shown_progress() as report:
            full = FullSurvey(progress=report, notice=say_aside)
            return reproduce_paper(out, say_aside, full)
    except (KeyboardInterrupt, OutputError):
        if is_there(out / "figure_10"):
            say_aside(
                f"finished levels are kept; go on with: breakaway reproduce --full --out {out}"
            )
        raise
