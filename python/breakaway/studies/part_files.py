"""Files of columns that outlive a kill: the same columns give the same bytes; flaws are found."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def as_bytes(table: Any) -> bytes:  # noqa: ANN401 - pyarrow has no type stubs
    """Give a table of pyarrow as a Parquet file, with checksums of its pages."""
    sink: Any = import_module("pyarrow").BufferOutputStream()
    parquet: Any = import_module("pyarrow.parquet")
    parquet.write_table(table.combine_chunks(), sink, write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def flaw_of(path: Path, schema: Any, holds_its_runs: Callable[[Any], bool]) -> str | None:  # noqa: ANN401
    """Say what is wrong with a file of columns, None where nothing is.

    Every page is read against its checksum. What no checksum covers is compared with what
    the same columns would be written as, where the same version of pyarrow wrote it.
    """
    parquet: Any = import_module("pyarrow.parquet")
    try:
        content = path.read_bytes()
        source = import_module("pyarrow").BufferReader(content)
        reader = parquet.ParquetFile(source, page_checksum_verification=True)
        table = reader.read(use_threads=False)
    except Exception as error:  # a damaged file may make anything of its reader
        return f"can not be read ({_first_line(error)})"
    if not table.schema.equals(schema):
        return "has other columns"
    if not holds_its_runs(table):
        return "has other runs"
    ours = as_bytes(table)
    if _writer_of(content) == _writer_of(ours) and content != ours:
        return "is damaged"
    return None


def _writer_of(content: bytes) -> str:
    source = import_module("pyarrow").BufferReader(content)
    return str(import_module("pyarrow.parquet").read_metadata(source).created_by)


def _first_line(error: Exception) -> str:
    return str(error).strip().split("\n")[0].rstrip(".")
