"""What a folder holds, finished or not; only what is asked for is read."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from breakaway.ask.durable.journal import PIECES, Journal
from breakaway.ask.durable.manifest import Checked, Kind, manifest_of_kind
from breakaway.ask.durable.pieces import pieces_in
from breakaway.base.arguments import check_arguments
from breakaway.base.reading import is_file, read_json
from breakaway.errors import StudyError

SUMMARY = "summary.json"
MOST_SUMMARY_BYTES = 2**30
"""Most bytes of a summary; nothing is read that has no digest."""


class DurableFolder(ABC):
    """A folder of long work, finished or not; only its manifest is read at once."""

    _kind: ClassVar[Kind]
    _manifest_model: ClassVar[type[Checked]] = Checked

    def __init__(self, folder: str | Path) -> None:
        check_arguments(DurableFolder.__init__, locals(), StudyError)
        self.folder = Path(folder)
        """Where it is."""
        self.manifest: Mapping[str, Any] = manifest_of_kind(
            self.folder, self._kind, self._manifest_model
        )
        """What determines it: what was asked, seed, versions, columns."""
        self._journal = Journal(self.folder, self.manifest["identity"])

    @property
    def finished(self) -> bool:
        """Whether it is finished, and all pieces and the summary are as they were written."""
        return all(self._journal.flaw(name) is None for name in finished_names(self._journal))

    @property
    def summary(self) -> dict[str, Any]:
        """What it shows: result, notes and tables.

        Raises
        ------
        StudyError
            It is not finished, or a piece or the summary is not as it was written.

        """
        path = self.folder / SUMMARY
        if not is_file(path):
            raise StudyError(
                f"{self.folder}: is not finished ({self._kept} are); go on with --resume"
            )
        for name in finished_names(self._journal):
            self._journal.refuse_flawed(name)
        summary = read_json(path, MOST_SUMMARY_BYTES)
        if not isinstance(summary, dict):
            raise StudyError(f"{path}: is not a table; go on with --resume to write it again")
        return summary

    @property
    @abstractmethod
    def _kept(self) -> str:
        """How much is finished, in words."""


def finished_names(journal: Journal) -> list[str]:
    """Give the names of the summary and of all pieces, where no piece is to come any more."""
    there = pieces_in(journal.folder)  # before the digests, which come first
    journal.reread()
    return [*sorted({*there, *journal.names(f"{PIECES}/")}), SUMMARY]
