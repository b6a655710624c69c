"""Arguments that all long work takes, looked at before anything runs."""

from __future__ import annotations

from pathlib import Path

from breakaway.base.text import shown
from breakaway.base.threads import thread_count
from breakaway.errors import BreakawayError, OutputError, StudyError


def as_folder(name: str, given: object, error: type[BreakawayError] = OutputError) -> Path:
    """Give the path of a folder.

    Raises
    ------
    BreakawayError
        It is no path; the error is of the given type.

    Examples
    --------
    >>> as_folder("out", 5)
    Traceback (most recent call last):
        ...
    breakaway.errors.OutputError: out: 5 is not a path; give the path of a folder

    """
    if not isinstance(given, str | Path):
        raise error(f"{name}: {shown(given)} is not a path; give the path of a folder")
    return Path(given)


def check_options(*, resume: object, threads: int | None, progress: object, notice: object) -> None:
    """Raise unless the options of a run are of their types.

    Raises
    ------
    StudyError
        The message names the option.

    """
    thread_count(threads)
    if not isinstance(resume, bool):
        raise StudyError(f"resume: {shown(resume)} is not True or False; give one of them")
    for name, given in (("progress", progress), ("notice", notice)):
        if given is not None and not callable(given):
            raise StudyError(f"{name}: {shown(given)} can not be called; give a function, or None")
