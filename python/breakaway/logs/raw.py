"""What a reader finds in a file, before names and units are given to it."""

from __future__ import annotations

import functools
import gc
import hashlib
import importlib
import io
import logging
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
from breakaway.logs.budget import Budget
from breakaway.logs.channel import Array

DEFLATE_RATIO = 1032
"""The most that zlib compresses; a file that claims more numbers than this allows is damaged."""

MOST_SAMPLES = 2**28
"""A channel with more samples (2 GiB of numbers) is refused."""


@dataclass(frozen=True, eq=False)
class RawChannel:
    """The numbers of a channel as they are in a file, with its own time stamps if it has them."""

    values: Array
    t_s: Array | None = None
    unit: str = ""


@dataclass(frozen=True, eq=False)
class RawFile:
    """The channels of a file by their names there.

    ``unreadable`` says why a channel can not be read; this matters only if it is wanted.
    """

    path: Path
    channels: dict[str, RawChannel] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)
    history: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """All names in the file."""
        return [*self.channels, *(name for name in self.unreadable if name not in self.channels)]

    def add(self, name: str, values: npt.ArrayLike, t_s: Array | None, unit: str = "") -> None:
        """Add a channel, or note why it is none."""
        if name in self.channels or name in self.unreadable:
            self.channels.pop(name, None)
            self.unreadable[name] = "there are several of this name; rename all but one"
            return
        array = np.asarray(values)
        if array.dtype.kind not in "fiub":
            self.unreadable[name] = f"is of type {array.dtype}; it must be real numbers"
        elif array.size == 0 or max(array.shape, default=1) != array.size:
            self.unreadable[name] = (
                f"is an array of shape {array.shape}; it must be a vector of real numbers"
            )
        else:
            self.channels[name] = RawChannel(array.reshape(-1).astype(np.float64), t_s, unit)


Reader = Callable[[Path, Budget], RawFile]


def file_digest(path: Path) -> str:
    """Return the SHA-256 of a log file.

    Raises
    ------
    LogError
        The file is missing, can not be read, or is empty.

    """
    try:
        if path.exists() and not path.is_file():
            raise LogError(f"{path}: can not be read (it is no file); give the path of a log file")
        with path.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            size = file.tell()
    except FileNotFoundError:
        raise LogError(f"{path}: there is no such file; check the path") from None
    except (OSError, ValueError) as error:
        raise LogError(f"{path}: can not be read ({error}); give the path of a log file") from None
    if not size:
        raise LogError(f"{path.name}: the file is empty; export the log again")
    return digest


def need(module: str, package: str, extra: str, path: Path, what: str) -> Any:  # noqa: ANN401
    """Import an optional package, or say how to install it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise LogError(
            f"{path.name}: reading {what} needs {package}; install it with: "
            f"pip install 'breakaway[{extra}]'"
        ) from None


def guarded(what: str, rings: bool = False) -> Callable[[Reader], Reader]:
    """Turn whatever a file library raises in a reader into a `LogError`, and keep it quiet.

    ``rings``: the library's half-built objects hold each other, and must be collected.
    """

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
                if rings:
                    gc.collect()
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


def check_size(path: Path, name: str, samples: int, most: float = MOST_SAMPLES) -> None:
    """Refuse a number of samples that the file can not hold, before memory is taken for it."""
    if not 0 <= samples <= min(most, MOST_SAMPLES):
        raise LogError(
            f"{path.name}: '{name}' claims {samples:.6g} samples; a file of "
            f"{path.stat().st_size} bytes can hold at most {min(most, MOST_SAMPLES):.6g}: it is "
            "damaged or too large; export the log again, or in parts"
        )
