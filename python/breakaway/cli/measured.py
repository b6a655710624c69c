"""Reading a measured log as the options of a command say."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from breakaway.measure.identification import RigFile
    from breakaway.measure.logs import Log


def measured(
    path: Path,
    *,
    mapping: Path | None,
    format: str | None = None,
    memory_gib: float | None,
    drop_bad_rows: bool = False,
    between: tuple[float, float] | None = None,
    resample_hz: float | None,
    use: list[str] | None,
) -> Log:
    """Read a log, cut it, bring it to one rate, and take other channels where that is asked.

    Raises
    ------
    LogError
        The log cannot be read, or does not fit the options.

    """
    from breakaway.measure.logs import read_log

    memory_bytes = None if memory_gib is None else memory_gib * 2**30
    log = read_log(path, mapping, format, memory_bytes=memory_bytes, drop_bad_rows=drop_bad_rows)
    if between is not None:
        log = log.between(*between)
    if resample_hz is not None:
        log = log.resampled(rate_hz=resample_hz)
    for given in use or []:
        channel, other = pair(given, "--use", "CHANNEL=OTHER")
        log = log.using(**{channel: other})
    return log


def rig_of(path: Path | None) -> RigFile | None:
    """Read the rig file that an option names, if it names one."""
    if path is None:
        return None
    from breakaway.measure.identification import RigFile

    return RigFile.load(path)


def pair(text: str, option: str, form: str) -> tuple[str, str]:
    """Split what an option gives at its first ``=``.

    Raises
    ------
    LogError
        It has no ``=``, or nothing beside it; the message shows the ``form``.

    Examples
    --------
    >>> pair("force_n=friction_n", "--use", "CHANNEL=OTHER")
    ('force_n', 'friction_n')

    """
    from breakaway.errors import LogError

    left, sign, right = text.partition("=")
    if not (left and sign and right):
        raise LogError(f"{option}: {text!r} is not of the form {form}")
    return left, right
