"""A measured log: what every reader returns and every identification takes."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from breakaway.errors import LogError

Array = npt.NDArray[np.float64]

MINIMUM_ROWS = 10
"""A log with fewer samples is refused: nothing can be learned from it."""

LARGEST_VALUE = 1e12
"""Larger magnitudes (in s, m or N) are refused: they mark missing data, they measure nothing."""


@dataclass(frozen=True, eq=False)
class Log:
    """Position and force of one moving part over time, as they were measured.

    The arrays are copied and made read-only. Rows count from 1, which is the first sample.

    Parameters
    ----------
    t_s : array of shape (n,)
        Time in s, strictly increasing, n ≥ 10. The spacing may vary: what needs a uniform
        spacing checks it, and no reader resamples.
    position_m : array of shape (n,)
        Measured position in m.
    force_n : array of shape (n,)
        Applied force in N, positive where it drives the position up.
    reference_m : array of shape (n,), optional
        Reference position in m, where the log has one.
    source : Path, optional
        The file that the log was read from.
    sha256 : str, optional
        Hexadecimal digest of that file's bytes.
    ignored_columns : tuple of str
        Columns of the file that were not read.

    Raises
    ------
    LogError
        An array is not one-dimensional, lengths differ, there are too few rows, a value is not
        finite or beyond 1e12 in magnitude, or time does not increase.

    Notes
    -----
    Not checked: the units (a position in mm looks like a long stroke in m) and the sign of the
    force, which the identification notices.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(100) / 50.0
    >>> log = Log(t_s=t_s, position_m=np.sin(t_s), force_n=np.cos(t_s))
    >>> log.rows, log.sample_rate_hz, log.name
    (100, 50.0, 'log')

    """

    t_s: Array
    position_m: Array
    force_n: Array
    reference_m: Array | None = None
    source: Path | None = None
    sha256: str | None = None
    ignored_columns: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for column in ("t_s", "position_m", "force_n", "reference_m"):
            values = getattr(self, column)
            if values is not None:
                object.__setattr__(self, column, self._checked(column, values))
        self._check_time()

    @property
    def name(self) -> str:
        """File name of the source, or ``log`` for arrays that never were in a file."""
        return "log" if self.source is None else self.source.name

    @property
    def rows(self) -> int:
        """Number of samples."""
        return len(self.t_s)

    @property
    def sample_rate_hz(self) -> float:
        """Mean sample rate in Hz, (n - 1) / (t_n - t_1)."""
        return float((self.rows - 1) / (self.t_s[-1] - self.t_s[0]))

    def _checked(self, column: str, values: Array) -> Array:
        array = np.array(values, dtype=np.float64)
        if array.ndim != 1:
            raise LogError(
                f"{self.name}: column '{column}' has shape {array.shape}; it must be one "
                "value per sample: pass a one-dimensional array"
            )
        if len(array) != np.size(self.t_s):
            raise LogError(
                f"{self.name}: column '{column}' has {len(array)} rows and 't_s' has "
                f"{np.size(self.t_s)}; they must have equally many: export them together"
            )
        if len(array) < MINIMUM_ROWS:
            raise LogError(
                f"{self.name}: {len(array)} rows; a log needs at least {MINIMUM_ROWS}: "
                "record for longer"
            )
        bad = np.flatnonzero(~(np.abs(array) <= LARGEST_VALUE))
        if bad.size:
            raise LogError(
                f"{self.name}: column '{column}', row {bad[0] + 1}: {array[bad[0]]:g} is not a "
                f"measurement; values must be finite and within ±{LARGEST_VALUE:g} ({bad.size} "
                "such rows): cut them out, or export the column again"
            )
        array.setflags(write=False)
        return array

    def _check_time(self) -> None:
        stuck = np.flatnonzero(np.diff(self.t_s) <= 0.0)
        if stuck.size:
            row = int(stuck[0]) + 2
            before, now = self.t_s[row - 2], self.t_s[row - 1]
            what = "repeats" if now == before else "goes back from"
            raise LogError(
                f"{self.name}: column 't_s', row {row}: {now:.9g} s {what} {before:.9g} s of the "
                f"row before ({stuck.size} such rows); time must increase in every row: export "
                "it with more digits, or split the log where the clock restarts"
            )


def read_bytes(path: Path) -> bytes:
    """Return the bytes of a log file.

    Raises
    ------
    LogError
        The file is missing, can not be read, or is empty.

    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise LogError(f"{path}: there is no such file; check the path") from None
    except (OSError, ValueError) as error:
        raise LogError(f"{path}: can not be read ({error}); give the path of a log file") from None
    if not data:
        raise LogError(f"{path.name}: the file is empty; export the log again")
    return data


def missing(path: Path, kind: str, name: str, present: Iterable[str]) -> LogError:
    """Return the error for a column or variable that a file lacks, naming the nearest one.

    >>> print(missing(Path("a.csv"), "column", "position_m", ["t_s", "position_mm"]))
    a.csv: column 'position_m' is missing; the nearest present is 'position_mm', of t_s, \
position_mm; give the file a column of exactly this name, in the unit that the name states \
(nothing is converted)
    """
    names = list(present)
    lower = {other.lower(): other for other in names}
    near = difflib.get_close_matches(name.lower(), lower, n=1)
    nearest = f"the nearest present is '{lower[near[0]]}', of " if near else "present are "
    listed = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "") if names else "none"
    return LogError(
        f"{path.name}: {kind} '{name}' is missing; {nearest}{listed}; give the file a {kind} of "
        "exactly this name, in the unit that the name states (nothing is converted)"
    )
