"""One measured quantity over time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.base.text import shown, visible
from breakaway.errors import LogError

Array = npt.NDArray[np.float64]

MINIMUM_ROWS = 10
"""A channel with fewer samples is refused: nothing can be learned from it."""

LARGEST_VALUE = 1e12
"""Larger magnitudes (in SI units) are refused: they mark missing data, they measure nothing."""


@dataclass(frozen=True, eq=False)
class Channel(OneLine):
    """A measured quantity with its own time stamps.

    The arrays are copied and made read-only. Rows count from 1, which is the first sample.

    Parameters
    ----------
    name : str
        What it is, ending with its unit: ``force_n``.
    t_s : array of shape (n,)
        Time in s, n ≥ 10, as it was recorded: stamps may repeat or go back.
    values : array of shape (n,)
        The quantity, in the unit that the name states.
    from_name : str
        Its name in the file, where it came from one.
    unit : str
        The unit of its numbers in the file.

    Raises
    ------
    LogError
        An array is not one-dimensional, lengths differ, there are too few rows, or a value is
        not finite or beyond 1e12 in magnitude.

    Notes
    -----
    Not checked: whether the numbers are in the unit that the name states.

    Examples
    --------
    >>> channel = Channel("force_n", np.arange(10) / 100.0, np.zeros(10))
    >>> channel.rows, round(channel.sample_rate_hz)
    (10, 100)

    """

    name: str
    t_s: Array
    values: Array
    from_name: str = ""
    unit: str = ""

    def __post_init__(self) -> None:
        texts = {"name": self.name, "from_name": self.from_name, "unit": self.unit}
        check_arguments(Channel.__init__, texts, LogError)
        object.__setattr__(self, "t_s", checked("t_s", self.t_s))
        object.__setattr__(self, "values", checked(self.name, self.values))
        if len(self.t_s) != len(self.values):
            raise LogError(
                f"column '{self.name}' has {len(self.values)} rows and 't_s' has "
                f"{len(self.t_s)}; they must have equally many: export them together"
            )

    def __repr__(self) -> str:
        return f"<channel {shown(self.name)}: {counted(self.rows, 'row')}>"

    @property
    def rows(self) -> int:
        """Number of samples."""
        return len(self.t_s)

    @property
    def sample_rate_hz(self) -> float:
        """Mean sample rate in Hz, (n - 1) / (t_n - t_1).

        Raises
        ------
        LogError
            The last stamp is not after the first.

        """
        duration = float(self.t_s[-1] - self.t_s[0])
        if not duration > 0.0:
            raise LogError(
                f"column 't_s' of '{self.name}' ends {-duration:g} s before it starts; a sample "
                "rate needs a last stamp after the first: export it in the order of time, or "
                "sort it in Python with log.sorted_by_time()"
            )
        return (self.rows - 1) / duration

    def check_increasing(self) -> None:
        """Raise `LogError` where a time stamp is not later than the one before."""
        stuck = np.flatnonzero(np.diff(self.t_s) <= 0.0)
        if stuck.size:
            row = int(stuck[0]) + 2
            before, now = self.t_s[row - 2], self.t_s[row - 1]
            what = "repeats" if now == before else "goes back from"
            raise LogError(
                f"column 't_s', row {row}: {now:.9g} s {what} {before:.9g} s of the row before "
                f"({stuck.size} such rows); time must increase in every row: export it with more "
                "digits, cut it where the clock restarts with --between (log.between), leave out "
                "stamps that repeat with --drop-bad-rows (log.without_repeated_stamps), or sort it "
                "in Python with log.sorted_by_time()"
            )


def checked(name: str, values: object) -> Array:
    """Return a read-only copy of a column, or raise `LogError`."""
    try:
        array = np.array(values, dtype=np.float64, copy=not _is_frozen(values))
    except (TypeError, ValueError):
        raise LogError(
            f"column '{name}' is not an array of numbers; pass one real number per sample"
        ) from None
    if array.ndim != 1:
        raise LogError(
            f"column '{name}' has shape {array.shape}; it must be one value per sample: pass a "
            "one-dimensional array"
        )
    if len(array) < MINIMUM_ROWS:
        raise LogError(f"{len(array)} rows; a log needs at least {MINIMUM_ROWS}: record for longer")
    bad = np.flatnonzero(~(np.abs(array) <= LARGEST_VALUE))
    if bad.size:
        raise LogError(
            f"column '{name}', row {bad[0] + 1}: {array[bad[0]]:g} is not a measurement; values "
            f"must be finite and within ±{LARGEST_VALUE:g} ({bad.size} such rows): leave out those "
            "that are not finite with --drop-bad-rows (drop_bad_rows=True), or export the column "
            "again"
        )
    array.setflags(write=False)
    return array


def _is_frozen(values: object) -> bool:
    """Whether an array is one of ours, which channels may share."""
    return (
        isinstance(values, np.ndarray)
        and values.dtype == np.float64
        and values.base is None
        and not values.flags.writeable
    )


@contextmanager
def named(source: str) -> Iterator[None]:
    """Put the name of a file before the message of every `LogError`."""
    try:
        yield
    except LogError as error:
        raise LogError(f"{visible(source)}: {error}") from None
