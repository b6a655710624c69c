"""Pieces: files of columns, numbered in the order in which they are computed."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

from breakaway.ask.durable.journal import PIECES
from breakaway.base.reading import is_folder

PIECE = re.compile(r"piece-\d{6,}\.parquet")
"""Names of pieces in their folder."""


def piece_name(number: int) -> str:
    """Give the place of a piece in the folder of its work.

    Examples
    --------
    >>> piece_name(3)
    'pieces/piece-000003.parquet'

    """
    return f"{PIECES}/piece-{number:06d}.parquet"


def pieces_in(folder: Path) -> list[str]:
    """Give the places of all files in a folder that are named as pieces."""
    inside = folder / PIECES
    names = [path.name for path in inside.iterdir()] if is_folder(inside) else []
    return [f"{PIECES}/{name}" for name in sorted(names) if PIECE.fullmatch(name)]


def as_bytes(table: Any) -> bytes:  # noqa: ANN401 - pyarrow has no type stubs
    """Give a table of pyarrow as a Parquet file, with checksums of its pages."""
    sink: Any = import_module("pyarrow").BufferOutputStream()
    parquet: Any = import_module("pyarrow.parquet")
    parquet.write_table(table.combine_chunks(), sink, write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content
