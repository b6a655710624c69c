"""From raw values to physical ones, as MDF 4 defines it, or a reason why there are none.

A raw value is never given for a physical one. Source: ASAM MDF 4.1, the block CC.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from breakaway.measure.logs.channel import Array

Raw = npt.NDArray[Any]
"""Raw values: integers of any width, or floating-point numbers."""

Conversion = Callable[[Raw], Array]
"""Raises `NoNumber` where a raw value does not stand for a number."""

DEEPEST = 8
"""Most conversions that lead on to each other."""


class ConversionError(ValueError):
    """A conversion gives no numbers, whatever the raw values are."""


class NoNumber(ValueError):  # noqa: N818 - the values are as the file means them
    """A sample does not stand for a number."""

    def __init__(self, place: int, why: str) -> None:
        super().__init__(why)
        self.place, self.why = place, why


def identity(raw: Raw) -> Array:
    """Return raw values that are physical ones already."""
    return raw.astype(np.float64, copy=False)


@dataclass(frozen=True)
class Linear:
    """``offset + factor * raw``."""

    offset: float
    factor: float

    def __call__(self, raw: Raw) -> Array:
        """Return the values."""
        return self.offset + self.factor * identity(raw)


@dataclass(frozen=True)
class Rational:
    """``(p1 x² + p2 x + p3) / (p4 x² + p5 x + p6)``; not finite where the divisor is 0."""

    p1: float
    p2: float
    p3: float
    p4: float
    p5: float
    p6: float

    def __call__(self, raw: Raw) -> Array:
        """Return the values."""
        x = identity(raw)
        with np.errstate(all="ignore"):
            above = (self.p1 * x + self.p2) * x + self.p3
            below = (self.p4 * x + self.p5) * x + self.p6
            values: Array = above / below
        return values


@dataclass(frozen=True, eq=False)
class Table:
    """Values by keys, interpolated or of the nearest key: the lower of two as near.

    Beyond the first and the last key their values hold, as the standard has it.
    """

    keys: Array
    values: Array
    interpolated: bool

    def __post_init__(self) -> None:
        """Check the keys."""
        check_ascending(self.keys)

    def __call__(self, raw: Raw) -> Array:
        """Return the values."""
        x = identity(raw)
        if self.interpolated:
            return np.interp(x, self.keys, self.values)
        above = np.clip(np.searchsorted(self.keys, x), 0, len(self.keys) - 1)
        below = np.maximum(above - 1, 0)
        nearest = np.where(self.keys[above] - x < x - self.keys[below], above, below)
        values: Array = np.where(np.isnan(x), np.nan, self.values[nearest])
        return values


@dataclass(frozen=True, eq=False)
class Ranges:
    """Ranges of raw values: with both ends for integers, without the upper end for others."""

    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        """Check the ends."""
        check_ascending(self.lower)
        check_ascending(self.upper)
        if np.any(self.lower > self.upper) or np.any(self.lower[1:] < self.upper[:-1]):
            raise ConversionError("the ranges of its table overlap")

    def __call__(self, raw: Raw) -> npt.NDArray[np.intp]:
        """Return the place of the range of each raw value; as many as there are for none."""
        x, none = _numbers(raw), len(self.lower)
        last = np.searchsorted(self.lower, x, side="right") - 1
        if raw.dtype.kind == "f":
            within = (last >= 0) & (x < self.upper[last])
            doubtful = (last >= 0) & (x == self.upper[last])
            doubtful &= self.lower[last] == self.upper[last]
        else:
            first = np.searchsorted(self.upper, x)
            within, doubtful = first == last, first < last
        _refuse(raw, doubtful, "is at the end of a range, and may count as inside or outside")
        return np.where(within, last, none)


@dataclass(frozen=True, eq=False)
class Keys:
    """Single raw values."""

    keys: Array

    def __post_init__(self) -> None:
        """Check the keys."""
        if len(np.unique(self.keys)) < len(self.keys):
            raise ConversionError("its table holds the same key twice")

    def __call__(self, raw: Raw) -> npt.NDArray[np.intp]:
        """Return the place of the key of each raw value; as many as there are for none."""
        x, none = _numbers(raw), len(self.keys)
        if not none:
            return np.zeros(len(x), np.intp)
        order = np.argsort(self.keys)
        place = np.searchsorted(self.keys, x, sorter=order)
        found = order[np.minimum(place, none - 1)]
        return np.where(self.keys[found] == x, found, none)


@dataclass(frozen=True, eq=False)
class RangeTable:
    """A value for each range, and one for raw values in none."""

    ranges: Ranges
    values: Array

    def __call__(self, raw: Raw) -> Array:
        """Return the values."""
        return self.values[self.ranges(raw)]


@dataclass(frozen=True, eq=False)
class Choice:
    """A text or a further conversion for each key or range, and one for the others.

    Only a further conversion gives numbers, those of the same raw values.
    """

    place_of: Keys | Ranges
    row: Callable[[int], Conversion | str]
    """The text or the conversion of a place."""

    def __call__(self, raw: Raw) -> Array:
        """Return the values."""
        places = self.place_of(raw)
        order = np.argsort(places, kind="stable")
        starts = np.flatnonzero(np.diff(places[order], prepend=-1))
        values = np.empty(len(raw))
        for samples in np.split(order, starts[1:]):
            if not samples.size:
                continue
            found = self.row(int(places[samples[0]]))
            if isinstance(found, str):
                why = f"its raw value {raw[samples[0]]} stands for {found}, which is not a number"
                raise NoNumber(int(samples[0]), why)
            try:
                values[samples] = found(raw[samples])
            except NoNumber as error:
                raise NoNumber(int(samples[error.place]), error.why) from None
        return values


def _numbers(raw: Raw) -> Array:
    x = identity(raw)
    _refuse(raw, np.isnan(x), "is not a number")
    return x


def _refuse(raw: Raw, samples: npt.NDArray[np.bool_], why: str) -> None:
    """Raise `NoNumber` for the first of these samples, if there is one."""
    if np.any(samples):
        place = int(np.argmax(samples))
        raise NoNumber(place, f"its raw value {raw[place]} {why}")


def check_ascending(keys: Array) -> None:
    """Raise `ConversionError` unless there are keys, and each is larger than the one before."""
    if not keys.size:
        raise ConversionError("its table is empty")
    if not np.all(np.isfinite(keys)) or not np.all(np.diff(keys) > 0.0):
        raise ConversionError("the keys of its table do not ascend")
