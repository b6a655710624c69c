"""What a reader finds in a file, before names and units are given to it."""

from __future__ import annotations

import functools
import importlib
import io
import logging
import math
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.channel import Array

DEFLATE_RATIO = 1032
"""The most that zlib compresses; a file that claims more numbers than this allows is damaged."""

MOST_NAMES = 16_384
"""Most channels of a file, those that cannot be read included; as many as a spreadsheet has."""

LONGEST_NAME = 1000
"""Most characters of the name of a channel."""


@dataclass(frozen=True, eq=False)
class RawChannel:
    """The numbers of a channel as they are in a file, with its own time stamps if it has them."""

    values: Array
    t_s: Array | None = None
    unit: str = ""


@dataclass(frozen=True, eq=False)
class RawFile:
    """The channels of a file by their names there.

    ``unreadable`` says why a channel cannot be read; this matters only if it is wanted.
    """

    path: Path
    channels: dict[str, RawChannel] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)
    history: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """All names in the file."""
        return [*self.channels, *(name for name in self.unreadable if name not in self.channels)]

    def __contains__(self, name: str) -> bool:
        return name in self.channels or name in self.unreadable

    def add(self, name: str, values: npt.ArrayLike, t_s: Array | None, unit: str = "") -> None:
        """Add a channel, or note why it is none; an array of its own is taken over, not copied."""
        if name in self:
            self.refuse(name, "")
            return
        array = np.asarray(values)
        if reason := no_vector(array.dtype, array.shape):
            self.refuse(name, reason)
            return
        self._check_name(name)
        stamps = None if t_s is None else frozen(t_s)
        self.channels[name] = RawChannel(frozen(array), stamps, unit)

    def refuse(self, name: str, reason: str) -> None:
        """Note why a channel cannot be read."""
        if name in self:
            self.channels.pop(name, None)
            reason = "there are several of this name; rename all but one"
        self._check_name(name)
        self.unreadable[name] = reason

    def _check_name(self, name: str) -> None:
        """Refuse a file with a name too long, or with too many.

        Raises
        ------
        LogError
            It goes beyond `LONGEST_NAME` or `MOST_NAMES`.

        """
        check_names(self.path, len(self.channels) + len(self.unreadable), len(name))


def no_vector(kind: np.dtype[Any], shape: tuple[int, ...]) -> str:
    """Say why an array is no vector of real numbers, or nothing."""
    if kind.kind not in "fiub":
        return f"is of type {kind}; it must be real numbers"
    size = math.prod(shape)
    if size == 0 or max(shape, default=1) != size:
        return f"is an array of shape {shape}; it must be a vector of real numbers"
    return ""


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


Reader = Callable[[Path, Budget], RawFile]


def need(module: str, package: str, extra: str, path: Path, what: str) -> Any:  # noqa: ANN401
    """Import an optional package, or say how to install it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise LogError(
            f"{path.name}: reading {what} needs {package}; install it with: "
            f"pip install 'breakaway[{extra}]'"
        ) from None


def guarded(what: str) -> Callable[[Reader], Reader]:
    """Turn whatever a file library raises in a reader into a `LogError`, and keep it quiet."""

    def guard(reader: Reader) -> Reader:
        @functools.wraps(reader)
        def read(path: Path, budget: Budget) -> RawFile:
            with _quiet():
                try:
                    return reader(path, budget)
                except LogError:
                    raise
                except Exception as error:  # a damaged file raises dozens of unrelated types
                    reason = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
            raise LogError(
                f"{path.name}: is damaged, or is not {what} ({reason}); export the log again, or "
                "name another format"
            )

        return read

    return guard


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
