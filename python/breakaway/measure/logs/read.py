"""Read a log file of any format."""

from __future__ import annotations

from collections.abc import Mapping as Keys
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.logs.assemble import assemble
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.csv import open_csv
from breakaway.measure.logs.detect import detect
from breakaway.measure.logs.digest import digested
from breakaway.measure.logs.emps import emps_layout, is_emps
from breakaway.measure.logs.hdf5 import open_hdf5
from breakaway.measure.logs.log import Log
from breakaway.measure.logs.mapping import Mapping, load_mapping
from breakaway.measure.logs.mat import open_mat
from breakaway.measure.logs.mcap import open_mcap
from breakaway.measure.logs.mdf import open_mdf
from breakaway.measure.logs.parquet import open_parquet
from breakaway.measure.logs.raw import Opener, RawFile
from breakaway.measure.logs.tdms import open_tdms

OPENERS: dict[str, Opener] = {
    "parquet": open_parquet,
    "mat": open_mat,
    "hdf5": open_hdf5,
    "tdms": open_tdms,
    "mdf": open_mdf,
    "mcap": open_mcap,
    "emps": open_mat,
}

FORMATS = ("csv", *OPENERS)
"""Names of the file formats. ``emps`` is the MATLAB file of the EMPS benchmark."""


def read_log(
    path: str | Path,
    mapping: str | Path | Keys[str, Any] | None = None,
    format: str | None = None,
    *,
    memory_bytes: float | None = None,
    drop_bad_rows: bool = False,
) -> Log:
    r"""Read a measured log.

    Columns whose header states what they are, with the unit, need no mapping: ``t_s``, ``x_m``,
    ``Force [kN]``, ``time_ms``. Others are left out and listed in ``ignored_columns``. Values
    are converted to the units of the channels; ``history`` lists each conversion.

    A mapping names the columns and their units. In a TOML file beside the log, which is found
    by itself (``motor.toml`` for ``motor.tdms``)::

        [channels.position_m]
        from = "Rig/Encoder"  # name in the file
        unit = "mm"           # of the numbers in the file, unless file or name state it
        sign = -1             # optional

        [channels.force_n]
        from = "vir"
        unit = "V"
        scale = 35.15         # optional: N per V; the unit is then free text

        [time]                # where the channels have no stamps of their own
        from = "t"
        unit = "ms"

    and optionally ``format = "tdms"``, ``time = "..."`` in a channel with a time column of its
    own, ``rate_hz`` or ``scale`` in ``[time]`` in place of a unit, and a table ``[csv]`` with
    ``delimiter``, ``decimal``, ``skip_rows``, ``header``, ``units_row``, ``encoding``. What is
    missing there is seen from the file where it can be read in one way only, and told in
    ``history``.

    Parameters
    ----------
    path : str or Path
        The file.
    mapping : str, Path or mapping, optional
        A TOML file, or its content as nested dictionaries; an empty one stands for none. By
        default the file of the same name with the suffix ``.toml``, if it has a table
        ``channels``, ``csv`` or ``time``.
    format : str, optional
        One of `FORMATS`; by default as the file's first bytes, else its suffix, say.
    memory_bytes : float, optional
        Most memory that the content of the file may take; by default half of what is free. The
        log takes up to as much again.
    drop_bad_rows : bool
        Whether to leave out rows with a cell that is no finite number, rows of a text file with
        more or fewer cells, and rows whose stamp repeats the one before. A finding counts them.

    Returns
    -------
    Log

    Raises
    ------
    LogError
        The file or the mapping is missing or damaged, a package for the format is missing, a
        channel is missing, has no unit or no stamps; without a mapping also, where time,
        position or force are not found; the file takes more memory than it may, goes beyond
        another limit, or changes while it is read. And as `Log` says.

    Notes
    -----
    Not checked: whether the numbers are in the unit that header or mapping state. A MATLAB
    file that holds ``t``, ``qm``, ``vir`` and ``gtau`` is read as one of the EMPS benchmark.

    Examples
    --------
    >>> import tempfile
    >>> rows = "".join(f"{k / 100},{k / 10},2.5,ok\n" for k in range(20))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "motor.csv"
    ...     _ = path.write_text("t_s,position_mm,force_N,remark\n" + rows)
    ...     log = read_log(path)
    >>> log.rows, float(log.position_m[10]), log.ignored_columns, log.history
    (20, 0.001, ('remark',), ("position_m = 0.001 * 'position_mm' (in mm)",))
    >>> read_log("missing.csv")
    Traceback (most recent call last):
        ...
    breakaway.errors.LogError: missing.csv: there is no such file; check the path

    """
    check_arguments(read_log, locals(), LogError)
    path = Path(path)
    budget = Budget.of(path, memory_bytes)
    with digested(path) as digest:
        rules, origin = load_mapping(mapping, path)
        kind = format or rules.format or detect(path)
        with open_log(path, kind, rules, budget) as raw:
            if kind == "emps" or (kind == "mat" and not rules.channels and is_emps(raw)):
                rules, origin = emps_layout(raw), ""
            raw.keeps_bad = drop_bad_rows
            log = assemble(raw, rules, digest)
    return log.noted(f"channels as {origin} says") if origin else log


def open_log(
    path: Path, kind: str, rules: Mapping, budget: Budget
) -> AbstractContextManager[RawFile]:
    """Open a log file of a format.

    Raises
    ------
    LogError
        There is no such format, or the file cannot be opened.

    """
    if kind not in FORMATS:
        raise LogError(f"format '{kind}' is unknown; it must be one of {', '.join(FORMATS)}")
    return open_csv(path, budget, rules.csv) if kind == "csv" else OPENERS[kind](path, budget)
