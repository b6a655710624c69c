"""``breakaway logs``: what is in a log file, before anything is read or fitted."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.reading import is_there
from breakaway.cli.identify_options import Format
from breakaway.cli.measured import measured
from breakaway.cli.options import Between, DropBadRows, Json, MappingFile, MemoryGib
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.measure.logs import ListedChannel, Listing, Log

PICTURES = (".png", ".svg", ".pdf")
"""How the name of a picture may end."""


def logs(
    file: Annotated[Path, typer.Argument(help="The measured log.")],
    mapping: MappingFile = None,
    format: Format = None,
    memory_gib: MemoryGib = None,
    write_mapping: Annotated[
        Path | None,
        typer.Option(
            help="Write a mapping that is guessed from names and units, to correct by hand.",
            metavar="FILE",
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(
            help="Read the log and draw it with its findings: a PNG, SVG or PDF file.",
            metavar="FILE",
        ),
    ] = None,
    drop_bad_rows: DropBadRows = False,
    between: Between = None,
    json: Json = False,
) -> None:
    """List the channels of a log: names, units, rates, and what cannot be read.

    No channel is read, unless --plot asks for a picture before anything is
    fitted. The names are those that a mapping takes.
    """
    from breakaway.measure.logs import list_channels

    with busy("listing channels ..."):
        found = list_channels(
            file,
            mapping,
            format.value if format else None,
            memory_bytes=None if memory_gib is None else memory_gib * 2**30,
        )
    if write_mapping is not None:
        _write(found, write_mapping)
    odd: list[str] = []
    if plot is not None:
        check_picture(plot)
        log = measured(
            file,
            mapping=mapping,
            format=format.value if format else None,
            memory_gib=memory_gib,
            drop_bad_rows=drop_bad_rows,
            between=between,
            resample_hz=None,
            use=None,
        )
        odd = [str(one) for one in log.findings if str(one) not in found.findings]
        _plot(log, plot)
    if json:
        say_json({**_plain(found, write_mapping), "odd": odd, "plot": plot and str(plot)})
        return
    say(_table(found), *(f"- {finding}" for finding in (*found.findings, *odd)))
    if written := [path for path in (write_mapping, plot) if path is not None]:
        say_written(written)


def check_picture(target: Path) -> None:
    """Refuse a file that no picture is written to.

    Raises
    ------
    OutputError
        Its name does not end in .png, .svg or .pdf.

    """
    from breakaway.errors import OutputError

    if target.suffix not in PICTURES:
        raise OutputError(
            f"--plot: {target.name!r} does not end in {', '.join(PICTURES)}; name the picture so"
        )


def _plot(log: Log, target: Path) -> None:
    """Draw a log and what was found odd about it, whole or not at all."""
    from breakaway.base.output import write_atomically
    from breakaway.drawing.style import save_figure
    from breakaway.show.plots.log import plot_log

    with TemporaryDirectory() as folder:
        drawn = Path(folder) / f"log{target.suffix}"
        save_figure(plot_log(log), drawn)
        write_atomically(target, drawn.read_bytes())


def _write(found: Listing, target: Path) -> None:
    from breakaway.base.output import write_atomically
    from breakaway.errors import OutputError

    if is_there(target):
        raise OutputError(f"{target}: exists; give --write-mapping another name")
    write_atomically(target, found.mapping_text().encode())


def _table(found: Listing) -> Sheet:
    columns = ["channel", "unit", "type", "samples", "rate", "start", "finding"]
    numbers = ["samples", "rate", "start"]
    shown = Sheet(f"{found.path.name} ({found.format})", columns, numbers=numbers, labels=1)
    for one in found.channels:
        shown.add(one.name, one.unit, one.type, *_figures(one), one.unreadable)
    return shown


def _figures(one: ListedChannel) -> tuple[str, str, str]:
    return (
        "" if one.samples is None else f"{one.samples}",
        "" if one.rate_hz is None else f"{one.rate_hz:.6g} Hz",
        "" if one.start_s is None else f"{one.start_s:.6g} s",
    )


def _plain(found: Listing, written: Path | None) -> dict[str, object]:
    from dataclasses import asdict

    return {
        "file": str(found.path),
        "format": found.format,
        "channels": [asdict(one) for one in found.channels],
        "findings": found.findings,
        "csv": dict(found.csv),
        "mapping": None if written is None else str(written),
    }
