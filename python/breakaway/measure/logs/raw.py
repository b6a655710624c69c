"""What a reader finds in a file, before names and units are given to it."""

from __future__ import annotations

import functools
import importlib
import io
import logging
import math
import sys
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array
from breakaway.measure.logs.findings import Finding, Kind
from breakaway.measure.logs.listed import ListedChannel

DEFLATE_RATIO = 1032
"""The most that zlib compresses; a file that claims more numbers than this allows is damaged."""

MOST_NAMES = 16_384
"""Most channels of a file, those that cannot be read included; as many as a spreadsheet has."""

EXACT = 2**53
"""Integers up to this are exact as float64."""

MOST_COLUMNS = 256
"""Most channels of a matrix."""

LONGEST_NAME = 1000
"""Most characters of the name of a channel."""


@dataclass(frozen=True, eq=False)
class RawChannel:
    """The numbers of a channel as they are in a file, with its own time stamps if it has them.

    ``values`` are float64, or int64 where float64 would round them, as it does stamps in ns.
    """

    values: npt.NDArray[Any]
    t_s: Array | None = None
    rows: npt.NDArray[np.intp] | None = None
    """The rows that the values stand in, where the channel is slower than its table, or ends."""


@dataclass(eq=False)
class RawFile:
    """The channels of an open file by their names there, and the values of those that were loaded.

    ``unreadable`` says why a channel cannot be read; this matters only if it is wanted.
    ``findings`` say what is odd about the file.
    """

    path: Path
    listed: dict[str, ListedChannel] = field(default_factory=dict)
    channels: dict[str, RawChannel] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)
    history: tuple[str, ...] = ()
    findings: list[Finding] = field(default_factory=list)
    read: Callable[[list[str]], None] = lambda _: None
    """Reads channels that are listed, by `add` or `refuse` for each."""
    keeps_bad: bool = False
    """Whether NaN stands for what is no number, because bad rows will be dropped."""
    dropped: int = 0
    """Bad rows that the reader has dropped itself."""

    @property
    def names(self) -> list[str]:
        """All names in the file."""
        return [*self.listed, *(name for name in self.unreadable if name not in self.listed)]

    def __contains__(self, name: str) -> bool:
        return name in self.listed or name in self.unreadable

    def list(self, channel: ListedChannel) -> None:
        """Note a channel that can be loaded; of several of one name none can."""
        if channel.name in self:
            self.refuse(channel.name, "")
            return
        self._check_name(channel.name)
        self.listed[channel.name] = channel

    def load(self, wanted: Iterable[str]) -> None:
        """Read channels that are listed and not read yet."""
        missing = [name for name in dict.fromkeys(wanted) if name in self.listed]
        missing = [n for n in missing if n not in self.channels and n not in self.unreadable]
        if missing:
            self.read(missing)

    def give(self, name: str, values: npt.ArrayLike, t_s: Array | None, unit: str = "") -> None:
        """List a channel that is read already, or note why it is none; of a matrix, several."""
        array = np.asarray(values)
        if side := channel_side(array.dtype, array.shape):
            for place in range(array.shape[side.axis]):
                self.give(side.name(name, place), array.take(place, side.axis), t_s, unit)
            return
        if name in self:
            self.channels.pop(name, None)
        elif reason := no_vector(array.dtype, array.shape):
            self.refuse(name, reason)
            return
        self.list(
            ListedChannel(name, unit, str(array.dtype), array.size, has_stamps=t_s is not None)
        )
        if name in self.listed:
            self.add(name, array, t_s)

    def add(self, name: str, values: npt.ArrayLike, t_s: Array | None) -> None:
        """Keep what was read of a channel; an array of its own is taken over, not copied."""
        array = np.asarray(values)
        if reason := no_vector(array.dtype, array.shape):
            self.give_up(name, reason)
            return
        stamps = None if t_s is None else frozen(t_s)
        values = whole(array) if rounds(array) else frozen(array)
        self.channels[name] = RawChannel(values, stamps)

    def notice(self, kind: Kind, name: str, count: int, message: str) -> None:
        """Note what is odd about a channel, or about the file where the name is empty."""
        about = f"'{brief(name)}': {message}" if name else message
        self.findings.append(Finding(kind, name, 0.0, count, about))

    def give_up(self, name: str, reason: str) -> None:
        """Note why the values of a channel that is listed cannot be read."""
        self.unreadable[name] = reason

    def refuse(self, name: str, reason: str, unit: str = "") -> None:
        """Note why a channel cannot be read; its unit says which one it is all the same."""
        if name in self:
            self.listed.pop(name, None)
            reason = "there are several of this name; rename all but one"
        self._check_name(name)
        self.unreadable[name] = reason
        if unit:
            self.listed[name] = ListedChannel(name, unit)

    def _check_name(self, name: str) -> None:
        """Refuse a file with a name too long, or with too many.

        Raises
        ------
        LogError
            It goes beyond `LONGEST_NAME` or `MOST_NAMES`.

        """
        check_names(self.path, len(self.listed) + len(self.unreadable), len(name))


def ends(rows: npt.NDArray[np.intp]) -> bool:
    """Whether values stand in all rows up to some."""
    return len(rows) > 0 and int(rows[-1]) == len(rows) - 1


@dataclass(frozen=True)
class Side:
    """The side of a matrix along which its channels stand."""

    axis: int

    @staticmethod
    def name(matrix: str, place: int) -> str:
        """Name a channel by its place from 1, as columns of one name in a text file."""
        return f"{matrix}#{place + 1}"


def channel_side(kind: np.dtype[Any], shape: tuple[int, ...]) -> Side | None:
    """Find out along which side a matrix of real numbers has its channels: the shorter one.

    None for what is no matrix, for a square one, which does not tell, and for one with more than
    `MOST_COLUMNS` channels, which is rather a picture.
    """
    if len(shape) != 2 or kind.kind not in "fiub" or not 1 < min(shape) <= MOST_COLUMNS:
        return None
    return None if shape[0] == shape[1] else Side(int(shape[1] < shape[0]))


def no_vector(kind: np.dtype[Any], shape: tuple[int, ...]) -> str:
    """Say why an array is no vector of real numbers, or nothing."""
    if kind.kind not in "fiub":
        return f"is of type {kind}; it must be real numbers"
    size = math.prod(shape)
    if size == 0 or max(shape, default=1) != size:
        return (
            f"is an array of shape {shape}; it must be a vector of real numbers, or a matrix that "
            f"is longer than wide, of at most {MOST_COLUMNS} channels"
        )
    return ""


def rounds(array: npt.NDArray[Any]) -> bool:
    """Whether float64 would round the integers of an array, which int64 holds."""
    if array.dtype.kind not in "iu" or array.dtype.itemsize < 8:
        return False
    low, high = int(array.min()), int(array.max())
    return max(-low, high) > EXACT and high < 2**63


def whole(array: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Return a read-only vector of integers."""
    flat = array.reshape(-1).astype(np.int64)
    flat.setflags(write=False)
    return flat


def frozen(array: npt.NDArray[Any]) -> Array:
    """Return a read-only vector of the numbers; the array itself where it can be."""
    flat = array if array.ndim == 1 else array.reshape(-1)
    if flat.dtype != np.float64 or flat.base is not None or not flat.flags.c_contiguous:
        flat = flat.astype(np.float64)
    flat.setflags(write=False)
    return flat


def check_names(path: Path, count: int, longest: int = 0) -> None:
    """Refuse a file with too many channels, or too long a name.

    Raises
    ------
    LogError
        ``count`` is above `MOST_NAMES`, or ``longest`` above `LONGEST_NAME`.

    """
    if count > MOST_NAMES:
        raise LogError(
            f"{path.name}: has more than {MOST_NAMES:,} channels, the limit: export fewer"
        )
    if longest > LONGEST_NAME:
        raise LogError(
            f"{path.name}: the name of a channel has {longest:,} characters; it must have at most "
            f"{LONGEST_NAME:,}: rename it"
        )


Opening = Callable[[Path, Budget], Generator[RawFile, None, None]]
Opener = Callable[[Path, Budget], AbstractContextManager[RawFile]]
"""Opens a file, lists its channels, and reads them on request until it is closed."""


def need(module: str, package: str, extra: str, path: Path, what: str) -> Any:  # noqa: ANN401
    """Import an optional package, or say how to install it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise LogError(
            f"{path.name}: reading {what} needs {package}; install it with: "
            f"pip install 'breakaway[{extra}]'"
        ) from None


def guarded(what: str) -> Callable[[Opening], Opener]:
    """Turn whatever a file library raises into a `LogError`, and keep it quiet.

    It stands before a generator that gives the open file once.
    """

    def guard(opened: Opening) -> Opener:
        @contextmanager
        @functools.wraps(opened)
        def opener(path: Path, budget: Budget) -> Iterator[RawFile]:
            steps = opened(path, budget)
            with _as_log_error(path, what):
                raw = next(steps)
            unguarded = raw.read

            def read(wanted: list[str]) -> None:
                with _as_log_error(path, what):
                    unguarded(wanted)

            raw.read = read
            try:
                yield raw
            finally:
                with _quiet():
                    steps.close()

        return opener

    return guard


@contextmanager
def _as_log_error(path: Path, what: str) -> Iterator[None]:
    with _quiet():
        try:
            yield
        except LogError:
            raise
        except Exception as error:  # a damaged file raises dozens of unrelated types
            reason = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        else:
            return
    raise LogError(
        f"{path.name}: is damaged, or is not {what} ({reason}); export the log again, or "
        "name another format"
    )


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence prints, warnings, logging, and errors where half-built objects are taken down."""
    level, hook = logging.root.manager.disable, sys.unraisablehook
    logging.disable(logging.CRITICAL)
    sys.unraisablehook = lambda _: None
    try:
        with warnings.catch_warnings(), redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(level)
        sys.unraisablehook = hook


def check_claim(path: Path, what: str, claimed_bytes: float, most_bytes: float) -> None:
    """Refuse a claim of more than the file can hold, before memory is taken for it.

    Raises
    ------
    LogError
        More is claimed, or less than nothing.

    """
    if not 0 <= claimed_bytes <= most_bytes:
        raise LogError(
            f"{path.name}: {what} claims {claimed_bytes:.6g} bytes; a file of "
            f"{path.stat().st_size} bytes can hold at most {most_bytes:.6g} of it: it is damaged; "
            "export the log again"
        )
