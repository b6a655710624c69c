"""Files of columns, numbered in the order in which they are computed."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from breakaway.ask.studies.pieces import MISSING, Pieces
from breakaway.base.reading import is_folder

PARTS = "parts"
"""Folder of the parts within that of a study."""
PART = re.compile(r"part-\d{6,}\.parquet")
"""Names of parts in it."""


def part_name(number: int) -> str:
    """Give the place of a part in the folder of its study."""
    return f"{PARTS}/part-{number:06d}.parquet"


def parts_in(folder: Path) -> list[str]:
    """Give the places of all files in a study's folder that are named as parts."""
    inside = folder / PARTS
    names = [path.name for path in inside.iterdir()] if is_folder(inside) else []
    return [f"{PARTS}/{name}" for name in sorted(names) if PART.fullmatch(name)]


def as_bytes(table: Any) -> bytes:  # noqa: ANN401 - pyarrow has no type stubs
    """Give a table of pyarrow as a Parquet file, with checksums of its pages."""
    sink: Any = import_module("pyarrow").BufferOutputStream()
    parquet: Any = import_module("pyarrow.parquet")
    parquet.write_table(table.combine_chunks(), sink, write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def found(pieces: Pieces, number: int, lost: str, say: Callable[[str], None]) -> bool:
    """Whether a part is there as it was written; of another one, say what is computed again."""
    name = part_name(number)
    flaw = pieces.flaw(name)
    if flaw not in (None, MISSING):
        say(f"{Path(name).name} {flaw}; its {lost} are computed again")
    return flaw is None


def remove_beyond(pieces: Pieces, count: int, called: str, say: Callable[[str], None]) -> None:
    """Remove the parts whose number is not below ``count``, and say so.

    Raises
    ------
    OutputError
        One can not be removed.

    """
    kept = {part_name(number) for number in range(count)}
    for name in parts_in(pieces.folder):
        if name not in kept:
            pieces.remove(name)
            say(f"{Path(name).name} does not belong to the {called} and was removed")
