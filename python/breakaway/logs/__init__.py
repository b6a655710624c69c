"""Read and check measured logs. Nothing in a log is repaired, converted or resampled."""

from __future__ import annotations

from pathlib import Path

from breakaway.errors import LogError
from breakaway.logs.csv import read_csv
from breakaway.logs.emps import read_emps
from breakaway.logs.log import Log

__all__ = ["FORMATS", "Log", "read_csv", "read_emps", "read_log"]

FORMATS = {"csv": read_csv, "emps": read_emps}
"""Name of a file format -> its reader."""


def read_log(path: str | Path, format: str = "csv") -> Log:
    """Read a measured log.

    Parameters
    ----------
    path : str or Path
        The file.
    format : {'csv', 'emps'}
        ``csv``: a header of column names with units, see `read_csv`. ``emps``: the MATLAB file
        of the EMPS benchmark, see `read_emps`. The format is never guessed.

    Returns
    -------
    Log

    Raises
    ------
    LogError
        The format is unknown, or as the format's reader says.

    Examples
    --------
    >>> read_log("missing.csv")
    Traceback (most recent call last):
        ...
    breakaway.errors.LogError: missing.csv: there is no such file; check the path

    """
    reader = FORMATS.get(format)
    if reader is None:
        raise LogError(f"format '{format}' is unknown; it must be one of {', '.join(FORMATS)}")
    return reader(Path(path))
