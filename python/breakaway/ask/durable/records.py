"""Records: lines of JSON, each of which is on the disk before the next thing is begun."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from breakaway.ask.durable.journal import digest_of
from breakaway.base.output import append_inside, write_inside
from breakaway.base.reading import open_regular
from breakaway.errors import StudyError

MOST_BYTES = 2**28
"""Most bytes of a file: 10,000 evaluations of a tuning have 40 MB."""
END = ', "sha256": "{}"}}'
"""End of each line: the digest of the identity, the place of the line, and all before it."""
END_BYTES = len(END.format("0" * 64))


class Records:
    """A file that records are appended to, after those in it were read."""

    def __init__(self, folder: Path, name: str, identity: str) -> None:
        self.path = folder / name
        """Where it is."""
        self._name, self._identity = name, identity
        self._count = 0

    def read(self) -> list[dict[str, Any]]:
        """Give the records up to the first line that is not as it was written.

        Nothing of a line is parsed before its digest was looked at.

        Raises
        ------
        StudyError
            The file cannot be read.

        """
        found: list[dict[str, Any]] = []
        for line in self._content().split(b"\n")[:-1]:  # what follows the last one is half
            if line != self._closed(line[:-END_BYTES], len(found)):
                break
            found.append(json.loads(line[:-END_BYTES] + b"}"))
        self._count = len(found)
        return found

    def read_whole(self) -> list[dict[str, Any]]:
        """Give the records, but for a last line that is not finished.

        Raises
        ------
        StudyError
            The file cannot be read, or a line is not as it was written.

        """
        found = self.read()
        if len(found) < self._content().count(b"\n"):
            raise StudyError(
                f"{self.path}: line {len(found) + 1} is not as it was written; go on with --resume "
                "to compute it and all that follow again"
            )
        return found

    def intact(self, say: Callable[[str], None]) -> list[dict[str, Any]]:
        """Give the records, after what is damaged was taken off the file; say what was.

        Raises
        ------
        StudyError
            The file cannot be read.
        OutputError
            It cannot be written.

        """
        kept = self.read()
        if len(kept) < len(self._content().splitlines()):
            say(
                f"{self.path.name}: line {len(kept) + 1} was not finished, or is not as it was "
                "written; it and all that follow are computed again"
            )
            self.replace(kept)
        return kept

    def append(self, record: Mapping[str, Any]) -> None:
        """Write a record to the disk.

        Raises
        ------
        OutputError
            The disk is full, or the file cannot be written; it is as it was before.

        """
        append_inside(self.path, self._line(record, self._count))
        self._count += 1

    def replace(self, records: Iterable[Mapping[str, Any]]) -> None:
        """Write all records again, whole or not at all, unless they are there already."""
        lines = [self._line(record, number) for number, record in enumerate(records)]
        self._count, content = len(lines), b"".join(lines)
        if not self.path.exists() or self._content() != content:
            write_inside(self.path, content)

    def _content(self) -> bytes:
        try:
            with open_regular(self.path) as file:
                content = file.read(MOST_BYTES + 1)
        except FileNotFoundError:
            return b""
        except OSError as error:
            raise StudyError(f"{self.path}: cannot be read: {error.strerror or error}") from None
        if len(content) > MOST_BYTES:
            raise StudyError(f"{self.path}: has more than {MOST_BYTES} bytes; it is not ours")
        return content

    def _line(self, record: Mapping[str, Any], number: int) -> bytes:
        text = json.dumps(record, allow_nan=False)
        return self._closed(text[:-1].encode(), number) + b"\n"

    def _closed(self, begun: bytes, number: int) -> bytes:
        digest = digest_of(self._identity, f"{self._name} {number}", begun)
        return begun + END.format(digest).encode()
