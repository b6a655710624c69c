"""Files that a command may write over: of its own kind, and never a log."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from breakaway.base.reading import is_file, is_folder, is_there


def check_target(
    logs: Iterable[Path], out: Path, load: Callable[[Path], object], what: str
) -> None:
    """Refuse to write over a log, or over anything but another file that ``load`` reads.

    Raises
    ------
    OutputError
        The file cannot be written, or is something else than ``what``.

    """
    from breakaway.base.output import refuse_to_overwrite
    from breakaway.errors import OutputError, ScenarioError

    for log in logs:
        refuse_to_overwrite(log, out)
    if not is_folder(out.parent):
        reason = "Not a directory" if is_there(out.parent) else "its folder is missing"
        raise OutputError(f"{out}: cannot be written: {reason}")
    if is_file(out):
        try:
            load(out)
        except ScenarioError:
            raise OutputError(f"{out}: exists and is not a {what}; give another name") from None
