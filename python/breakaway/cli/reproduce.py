"""``breakaway reproduce``: the paper's figures and tables again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from breakaway.cli.show import Sheet, say


def reproduce(
    out: Annotated[
        Path, typer.Option(help="Folder for the report, its figures and tables.", metavar="DIR")
    ] = Path("reproduction"),
) -> None:
    """Reproduce the paper's results, and tell where they differ from what it prints.

    The last line of the output is the path of the report.
    """
    from breakaway.report.reproduction import reproduce as reproduce_paper

    done = reproduce_paper(out, _progress)
    header = [str(name) for name in done.header]
    shown = Sheet("", header, prose=header[:-1])
    for row in done.table:
        shown.add(*row)
    say(shown, str(done.report_path))


def _progress(step: str) -> None:
    typer.echo(step, err=True)
