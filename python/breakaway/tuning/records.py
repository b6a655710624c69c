"""Lines of JSON that outlive a kill: each is on the disk before the next thing is begun."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from zlib import crc32

from breakaway.output import write_atomically
from breakaway.studies.folder import not_written

CHECK = "crc32"
"""Last key of each line: the check sum of all before it."""


class Records:
    """A file that records are appended to."""

    def __init__(self, path: Path) -> None:
        self.path = path
        """Where it is."""

    def read(self) -> list[dict[str, Any]]:
        """Give the records up to the first line that is damaged, or that was not finished."""
        try:
            lines = self.path.read_bytes().split(b"\n")[:-1]  # what follows the last one is half
        except FileNotFoundError:
            return []
        found: list[dict[str, Any]] = []
        for line in lines:
            record = _record(line)
            if record is None:
                break
            found.append(record)
        return found

    def lines(self) -> int:
        """Count the lines, damaged and unfinished ones among them."""
        try:
            return len(self.path.read_bytes().splitlines())
        except FileNotFoundError:
            return 0

    def append(self, record: Mapping[str, Any]) -> None:
        """Write a record to the disk.

        Raises
        ------
        OutputError
            The disk is full, or the file can not be written; it is as it was before.

        """
        before = self.path.stat().st_size if self.path.exists() else 0
        try:
            with self.path.open("ab", buffering=0) as file:
                content = _line(record)
                if file.write(content) != len(content):
                    raise OSError("is full")  # noqa: TRY301 - handled as all that fails here
                os.fsync(file.fileno())
        except BaseException as error:
            with suppress(OSError):
                os.truncate(self.path, before)
            if isinstance(error, OSError):
                raise not_written(self.path, error) from None
            raise

    def replace(self, records: Iterable[Mapping[str, Any]]) -> None:
        """Write all records anew, whole or not at all, unless that is what is there."""
        content = b"".join(_line(record) for record in records)
        if not self.path.exists() or self.path.read_bytes() != content:
            write_atomically(self.path, content)


def _line(record: Mapping[str, Any]) -> bytes:
    text = json.dumps(record, allow_nan=False)
    return f'{text[:-1]}, "{CHECK}": {crc32(text.encode())}}}\n'.encode()


def _record(line: bytes) -> dict[str, Any] | None:
    """Read a line, None where it is damaged."""
    try:
        record: dict[str, Any] = json.loads(line)
        record.pop(CHECK)
    except (ValueError, KeyError, TypeError, AttributeError):
        return None
    return record if _line(record) == line + b"\n" else None
