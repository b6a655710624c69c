"""What runs long work: it counts, tells how far it is, and computes what is not on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from breakaway.ask.durable.journal import MISSING, Journal
from breakaway.ask.durable.pieces import piece_name, pieces_in
from breakaway.ask.durable.progress import Progress


class Runner:
    """Counts runs, and numbers pieces as they come; one that is on disk is not computed again.

    Examples
    --------
    >>> runner = Runner(None, "study", runs_max=20, progress=lambda at: print(at.runs_done))
    >>> name = runner.next_piece()
    >>> if not runner.found(name, 10, "10 runs"):
    ...     runner.keep(name, 10, lambda: b"")
    10

    """

    def __init__(
        self,
        journal: Journal | None,
        called: str,
        *,
        runs_max: int,
        progress: Callable[[Progress], None] | None = None,
        notice: Callable[[str], None] | None = None,
    ) -> None:
        self.runs_max = runs_max
        """The most runs that it may take."""
        self.runs_done = 0
        """Runs that are done, including those found on disk."""
        self.runs_found = 0
        """Runs that were found on disk."""
        self.doing = ""
        """What is done, in words."""
        self._journal, self._called = journal, called
        self._progress, self._notice = progress, notice
        self._pieces = 0

    def next_piece(self) -> str:
        """Give the place of the next piece in the folder."""
        self._pieces += 1
        return piece_name(self._pieces - 1)

    def found(self, name: str, runs: int, lost: str) -> bool:
        """Whether a piece is there as it was written; of another one, say what is computed again.

        Its runs are counted then. Without a folder nothing is found.
        """
        flaw = MISSING if self._journal is None else self._journal.flaw(name)
        if flaw is None:
            self.count(runs, found=True)
        elif flaw != MISSING:
            self.say(f"{Path(name).name} {flaw}; its {lost} are computed again")
        return flaw is None

    def keep(self, name: str, runs: int, content: Callable[[], bytes]) -> None:
        """Write a piece, whole or not at all, and count its runs. Without a folder, count alone.

        Raises
        ------
        OutputError
            The folder cannot be written, or the disk is full.

        """
        if self._journal is not None:
            self._journal.write(name, content())
        self.count(runs)

    def pieces_alone(self) -> list[str]:
        """Remove pieces that do not belong to the work, and give the names of those that do.

        Raises
        ------
        OutputError
            One cannot be removed.

        """
        kept = [piece_name(number) for number in range(self._pieces)]
        if self._journal is not None:
            known = set(kept)
            for name in pieces_in(self._journal.folder):
                if name not in known:
                    self._journal.remove(name)
                    self.say(
                        f"{Path(name).name} does not belong to the {self._called} and was removed"
                    )
        return kept

    def count(self, runs: int, *, found: bool = False) -> None:
        """Count runs that are done, and tell so."""
        self.runs_done += runs
        self.runs_found += runs if found else 0
        self.report()

    def report(self, under_way: int = 0) -> None:
        """Tell how far it is, with the runs that are done of what is under way."""
        if self._progress:
            self._progress(
                Progress(
                    runs_done=self.runs_done + under_way,
                    runs_found=self.runs_found,
                    runs_max=self.runs_max,
                    doing=self.doing,
                )
            )

    def say(self, sentence: str) -> None:
        """Tell what is no progress."""
        if self._notice:
            self._notice(sentence)
