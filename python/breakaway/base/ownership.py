"""Whose a folder is: no result takes over that of another kind, or files of others.

Each kind of result has a file that tells it, its marker. What is in a folder with the marker of a
kind may be replaced by that kind; in any other folder only new names are written.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from breakaway.base.reading import is_link, is_there, read_json
from breakaway.errors import OutputError

MOST_MARKER_BYTES = 64 * 2**20
"""Most bytes of a marker: that of the paper's reproduction has 2 MB."""


@dataclass(frozen=True)
class Kind:
    """A kind of result."""

    name: str
    """What it is, with its article."""
    marker: str
    """The file that tells it."""
    keys: frozenset[str]
    """Keys that its marker has."""

    def is_in(self, folder: Path) -> bool:
        """Whether a folder holds a result of this kind."""
        try:
            content = read_json(folder / self.marker, MOST_MARKER_BYTES)
        except (OSError, ValueError):
            return False
        return isinstance(content, dict) and content.keys() >= self.keys


RUN = Kind("a run", "metrics.json", frozenset({"outcome", "metrics", "breakaway_version"}))
STUDY = Kind(
    "a study, tuning or comparison",
    "manifest.json",
    frozenset({"format", "identity", "breakaway_version"}),
)
DESIGN = Kind("a design", "design.json", frozenset({"scenario", "controller", "gain_sets"}))
C_SOURCES = Kind("exported C", "interface.json", frozenset({"breakaway_version", "what"}))
REPRODUCTION = Kind(
    "a reproduction of the paper", "reproduction.json", frozenset({"findings", "figures"})
)
ADVICE = Kind("an advice", "advice.json", frozenset({"ranking", "sentences", "rests_on"}))
KINDS = (RUN, STUDY, DESIGN, C_SOURCES, REPRODUCTION, ADVICE)


def refuse_other_kinds(folder: Path, kind: Kind) -> None:
    """Refuse a folder that holds a result of another kind.

    Raises
    ------
    OutputError
        It does; the message names what tells so.

    """
    for other in KINDS:
        if other != kind and other.is_in(folder):
            raise OutputError(
                f"{folder}: holds {other.name} ({other.marker}), and this is {kind.name}; give "
                "another folder"
            )


def refuse_files_of_others(folder: Path, kind: Kind, names: Iterable[str]) -> None:
    """Refuse to replace files in a folder that holds no result of this kind.

    Raises
    ------
    OutputError
        One of the names is taken there.

    """
    taken = [name for name in names if is_there(folder / name)]
    if taken and not kind.is_in(folder):
        raise OutputError(
            f"{folder / taken[0]}: already exists, and there is no {kind.marker} of {kind.name} "
            "beside it, so it is not replaced; move it away, or give another folder"
        )


def refuse_links(*paths: Path) -> None:
    """Refuse symbolic links within a result's folder; the folder itself may be one.

    Raises
    ------
    OutputError
        A path is a link.

    """
    for path in paths:
        if is_link(path):
            raise OutputError(
                f"{path}: is a symbolic link, and nothing is written, renamed or deleted through "
                "one; remove it, or give another folder"
            )
