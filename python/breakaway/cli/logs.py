"""``breakaway logs``: what is in a log file, before anything is read or fitted."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.reading import is_there
from breakaway.cli.identify_options import Format
from breakaway.cli.options import Json, MappingFile, MemoryGib
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.measure.logs import ListedChannel, Listing


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
    json: Json = False,
) -> None:
    """List the channels of a log: names, units, rates, and what cannot be read.

    No channel is read. The names are those that a mapping takes.
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
    if json:
        say_json(_plain(found, write_mapping))
        return
    say(_table(found), *(f"- {finding}" for finding in found.findings))
    if write_mapping is not None:
        say_written([write_mapping])


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
