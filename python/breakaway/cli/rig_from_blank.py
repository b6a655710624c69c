"""``breakaway rig-from-blank``: a rig file from pulls without a joint."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.base.reading import is_file
from breakaway.cli.measured import measured
from breakaway.cli.options import (
    Between,
    DropBadRows,
    Json,
    MappingFile,
    MemoryGib,
    ResampleHz,
    Use,
)
from breakaway.cli.quantity import show_uncertain, split_unit
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.measure.identification import Blank

BY_HAND = (
    "not told by a blank pull, write them into the file by hand: filter_hz, "
    "force_calibration_percent, position_sensor"
)


def rig_from_blank(
    logs: Annotated[
        list[Path],
        typer.Argument(
            help="A pull against a held part, a pull without a part, or both.", metavar="LOG..."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="Rig file to write, for --rig of identify and events.", metavar="FILE"),
    ] = None,
    use: Use = None,
    mapping: MappingFile = None,
    memory_gib: MemoryGib = None,
    drop_bad_rows: DropBadRows = False,
    between: Between = None,
    resample_hz: ResampleHz = None,
    json: Json = False,
) -> None:
    """Find the stiffness and the mass of a rig in pulls without a joint.

    A pull against a held part tells the stiffness between position sensor and
    part; a pull without a part tells the mass behind the load cell.
    """
    from breakaway.measure.identification import rig_from_blank as derive

    if out is not None:
        _check_target(logs, out)
    with busy("reading the pulls ..."):
        read = [
            measured(
                path,
                mapping=mapping,
                memory_gib=memory_gib,
                drop_bad_rows=drop_bad_rows,
                between=between,
                resample_hz=resample_hz,
                use=use,
            )
            for path in logs
        ]
        blank = derive(read)
    if out is not None:
        blank.rig.save(out)
    if json:
        figures = [asdict(one) for one in blank.figures]
        file = None if out is None else str(out)
        say_json({"figures": figures, "notes": list(blank.notes), "file": file})
        return
    say(_table(blank))
    for note in (*blank.notes, BY_HAND):
        say(f"- {note}")
    say_written([out] if out is not None else [])


def _table(blank: Blank) -> Sheet:
    columns = ["figure", "value", "std. error", "95 % interval", "unit"]
    shown = Sheet("Rig", columns, numbers=columns[1:4])
    for one in blank.figures:
        words, unit = split_unit(one.name)
        error = one.standard_error
        low, high = (show_uncertain(end, error)[0] for end in (one.low, one.high))
        shown.add(words, *show_uncertain(one.value, error), f"{low} to {high}", unit)
    return shown


def _check_target(logs: list[Path], out: Path) -> None:
    """Refuse to write over a log, or over anything but another rig file."""
    from breakaway.base.output import refuse_to_overwrite
    from breakaway.errors import OutputError, ScenarioError
    from breakaway.measure.identification import RigFile

    for log in logs:
        refuse_to_overwrite(log, out)
    if is_file(out):
        try:
            RigFile.load(out)
        except ScenarioError:
            raise OutputError(f"{out}: exists and is not a rig file; give another name") from None
