"""From the channels of a file to a log: names, units, signs and time stamps."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.bad_rows import without_bad_rows
from breakaway.measure.logs.channel import Array, Channel, named
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.log import Log
from breakaway.measure.logs.mapping import ChannelMapping, Mapping
from breakaway.measure.logs.names import file_unit, nearest, read_header, read_headers
from breakaway.measure.logs.raw import RawChannel, RawFile, ends
from breakaway.measure.logs.units import FileUnit, si_symbol, stated, unit_named

REQUIRED = {"position_m": "mm", "force_n": "N"}
"""What a file without a mapping must state -> the unit that the remedy shows."""


NONE = ListedChannel("")


@dataclass(frozen=True)
class Pick:
    """A channel to build: its column, SI value = factor * value + offset, its own time column."""

    channel: str
    column: str
    unit: str
    factor: float
    offset: float = 0.0
    time: str | None = None


def assemble(raw: RawFile, mapping: Mapping, digest: str) -> Log:
    """Build the log of a file.

    Raises
    ------
    LogError
        A channel is missing, has no unit or no time stamps, or cannot be read.

    """
    # Channel refuses what is not finite, by its row.
    with named(raw.path.name), np.errstate(over="ignore", invalid="ignore"):
        picks = _mapped(raw, mapping) if mapping.channels else _stated(raw)
        times = _Times(raw, mapping)
        raw.load([*(pick.column for pick in picks), *times.needed(picks)])
        built = [_build(raw, pick, times) for pick in picks]
        if raw.keeps_bad:
            built = without_bad_rows(raw, built)
        channels = [
            Channel(p.channel, t_s, values, from_name=p.column, unit=p.unit)
            for p, (t_s, values) in zip(picks, built, strict=True)
        ]
    used = {pick.column for pick in picks} | times.used
    return Log.from_channels(
        channels,
        source=raw.path,
        sha256=digest,
        ignored_columns=tuple(name for name in raw.names if name not in used),
        history=(*raw.history, *(text for pick in picks for text in _notes(pick, raw))),
        noticed=raw.findings,
    )


def _build(raw: RawFile, pick: Pick, times: _Times) -> tuple[Array, Array]:
    """Return the stamps and the values of a channel."""
    found = column(raw, pick.column)
    values = converted(found.values, pick.factor, pick.offset)
    stamps = times.of(found, pick)
    if found.rows is not None:
        if found.rows[-1] >= len(stamps):
            raise LogError(
                f"column '{brief(pick.column)}' goes on to row {found.rows[-1] + 1}, and its time "
                f"ends in row {len(stamps)}; give its own time column, such as: "
                f'channels.{pick.channel}.time = "..."'
            )
        stamps = stamps[found.rows]
    return stamps, values


def converted(values: npt.NDArray[Any], factor: float, offset: float = 0.0) -> Array:
    """Return factor * values + offset, read-only; the same array where nothing changes."""
    if (factor, offset) == (1.0, 0.0) and values.dtype == np.float64:
        return values
    result = factor * values
    result += offset
    result.setflags(write=False)
    return result


def _notes(pick: Pick, raw: RawFile) -> list[str]:
    """Say what was done to a channel beyond reading it."""
    notes = []
    if (pick.factor, pick.offset) != (1.0, 0.0):
        offset = f" {pick.offset:+g}" if pick.offset else ""
        unit = f" (in {brief(pick.unit)})" if pick.unit else ""
        notes.append(f"{pick.channel} = {pick.factor:.9g} * '{brief(pick.column)}'{unit}{offset}")
    word = read_header(pick.column, file_unit(raw, pick.column))
    if word is not None and word.word == "friction_force" and pick.channel == "force_n":
        notes.append(f"column '{brief(pick.column)}' is read as force_n")
    return notes


def _stated(raw: RawFile) -> list[Pick]:
    """Choose the columns whose headers state channel and unit."""
    picks: dict[str, Pick] = {}
    for item in read_headers(raw):
        if item.channel == "t_s":
            continue
        if item.channel in picks:
            raise LogError(
                f"columns '{brief(picks[item.channel].column)}' and '{brief(item.name)}' both give "
                f"'{item.channel}'; only one may: delete or rename the other, or write a mapping"
            )
        picks[item.channel] = Pick(
            item.channel, item.name, item.unit.symbol, item.unit.factor, item.unit.offset
        )
    for channel, unit in REQUIRED.items():
        if channel not in picks:
            raise _missing(raw, channel, f"channels.{channel}", unit)
    return list(picks.values())


def _mapped(raw: RawFile, mapping: Mapping) -> list[Pick]:
    """Choose the columns that a mapping names."""
    picks = []
    for channel, keys in mapping.channels.items():
        name = place(raw, keys.from_)
        if keys.scale is not None:
            picks.append(
                Pick(channel, name, keys.unit or "", keys.sign * keys.scale, time=keys.time)
            )
            continue
        unit = _unit(raw, name, channel, keys)
        factor = keys.sign * unit.factor
        picks.append(
            Pick(channel, name, unit.symbol, factor, keys.sign * unit.offset, time=keys.time)
        )
    return picks if any(pick.time for pick in picks) else picks + _left_to_headers(raw, picks)


def _left_to_headers(raw: RawFile, picks: list[Pick]) -> list[Pick]:
    """Choose position and force by their headers where a mapping does not name them."""
    taken = {pick.column for pick in picks}
    missing = REQUIRED.keys() - {pick.channel for pick in picks}
    found = [one for one in read_headers(raw) if one.channel in missing and one.name not in taken]
    count = Counter(one.channel for one in found)
    return [
        Pick(one.channel, one.name, one.unit.symbol, one.unit.factor, one.unit.offset)
        for one in found
        if count[one.channel] == 1
    ]


def _unit(raw: RawFile, name: str, channel: str, keys: ChannelMapping) -> FileUnit:
    """Return the unit of a mapped column: of the mapping, else the file, else its name."""
    symbol = file_unit(raw, name)
    if keys.unit is not None:
        unit = unit_named(keys.unit, channel)
        told = stated(symbol, channel) if symbol else None
        if symbol and told != unit:
            raw.notice(
                "unit",
                name,
                1,
                f"the file states the unit '{brief(symbol)}', the mapping '{brief(keys.unit)}', "
                "which is taken",
            )
        return unit
    if symbol:
        return unit_named(symbol, channel)
    header = read_header(name)
    if header is not None and header.unit.symbol and stated(header.unit.symbol, channel):
        return header.unit
    raise LogError(
        f"channel '{channel}': neither the file nor the name '{brief(name)}' states a unit; add it "
        f'to the mapping, such as unit = "{si_symbol(channel)}"'
    )


class _Times:
    """The time stamps of the channels; each time column is converted once and shared."""

    def __init__(self, raw: RawFile, mapping: Mapping) -> None:
        self.raw, self.mapping = raw, mapping
        self.used: set[str] = set()
        self.zero: Fraction | None = None
        self.shared: dict[str, Array] = {}
        self.headers: list[str] | None = None

    def needed(self, picks: list[Pick]) -> list[str]:
        """Return the time columns of channels, as far as they are known before these are read."""
        time = self.mapping.time
        named_ones = {pick.time or time.from_ for pick in picks} - {None}
        needed = [place(self.raw, str(one)) for one in named_ones]
        own = [pick.time or self.raw.listed.get(pick.column, NONE).has_stamps for pick in picks]
        if time.from_ is None and time.rate_hz is None and not all(own):
            needed += self._headers()[:1]
        return needed

    def of(self, found: RawChannel, pick: Pick) -> Array:
        """Return the stamps of a channel: of its mapping, else its own, else the file's."""
        name = pick.time or self.mapping.time.from_
        if name is None and found.t_s is not None:
            return found.t_s
        if name is None and self.mapping.time.rate_hz is not None:
            count = found.values.size if found.rows is None else int(found.rows[-1]) + 1
            return self._counted(count)
        return self._column(place(self.raw, name) if name is not None else self._header())

    def _column(self, name: str) -> Array:
        if name not in self.shared:
            self.used.add(name)
            found = column(self.raw, name)
            if found.rows is not None and not ends(found.rows):
                raise LogError(f"column '{brief(name)}' has blank cells; every row needs its stamp")
            self.shared[name] = self._seconds(found.values, self._time_unit(name))
        return self.shared[name]

    def _time_unit(self, name: str) -> FileUnit:
        """Return the unit of a time column: by its rate or scale, else as of any channel."""
        time = self.mapping.time
        factor = 1.0 / time.rate_hz if time.rate_hz is not None else time.scale
        if factor is not None:
            return FileUnit("", "time", factor)
        return _unit(self.raw, name, "t_s", ChannelMapping.parse({"from": name, "unit": time.unit}))

    def _counted(self, count: int) -> Array:
        """Return stamps at the rate of the mapping, from 0, shared by channels of one length."""
        key = f"{count} rows"
        if key not in self.shared:
            period_s = 1.0 / (self.mapping.time.rate_hz or 1.0)
            self.shared[key] = converted(np.arange(float(count)), period_s)
        return self.shared[key]

    def _seconds(self, values: npt.NDArray[Any], unit: FileUnit) -> Array:
        """Convert stamps; integers that float64 would round count from the first of any column."""
        if values.dtype == np.float64:
            return converted(values, unit.factor)
        if self.zero is None:
            self.zero = Fraction(int(values[0])) * Fraction(unit.factor).limit_denominator(10**9)
        late = Fraction(int(values[0])) * Fraction(unit.factor).limit_denominator(10**9) - self.zero
        seconds: Array = float(late) + unit.factor * (values - values[0])
        seconds.setflags(write=False)
        return seconds

    def _headers(self) -> list[str]:
        if self.headers is None:
            self.headers = [one.name for one in read_headers(self.raw) if one.channel == "t_s"]
        return self.headers

    def _header(self) -> str:
        names = self._headers()
        if not names:
            raise _missing(self.raw, "t_s", "time", "ms")
        if len(names) > 1:
            first, second = map(brief, names[:2])
            raise LogError(
                f"columns '{first}' and '{second}' both give 't_s'; only one may: delete or "
                f'rename the other, or write a mapping with time.from = "{first}"'
            )
        return names[0]


def place(raw: RawFile, name: str) -> str:
    """Return the full name of a column, which may be given without its group.

    Raises
    ------
    LogError
        There is no such column, or there are several.

    """
    if name in raw:
        return name
    ends = [full for full in raw.names if full.endswith((f"/{name}", f".{name}"))]
    if len(ends) == 1:
        return ends[0]
    if f"{name}#1" in raw:
        raise LogError(
            f"there are several columns '{brief(name)}'; name one by its number, such as "
            f"'{brief(name)}#2'"
        )
    if ends:
        raise LogError(
            f"'{brief(name)}' may be {' or '.join(map(brief, ends[:5]))}; give the whole name"
        )
    raise LogError(f"column '{brief(name)}' is missing; {present(raw, name)}; correct `from`")


def column(raw: RawFile, name: str) -> RawChannel:
    """Return a column, read where it is not yet, or raise `LogError` with why it cannot be."""
    raw.load([name])
    if name in raw.unreadable:
        raise LogError(f"column '{brief(name)}'{_joint(raw.unreadable[name])}")
    return raw.channels[name]


def _joint(reason: str) -> str:
    return f", {reason}" if reason.startswith("row ") else f": {reason}"


def present(raw: RawFile, name: str) -> str:
    """Name the columns of a file, and the one nearest to ``name``."""
    near = nearest(name, raw.names)
    found = f"the nearest present is '{brief(near)}', of " if near else "present are "
    names = [brief(other) for other in raw.names[:20]]
    more = ", ..." if len(raw.names) > 20 else ""
    return found + (", ".join(names) + more if names else "none")


def _missing(raw: RawFile, channel: str, key: str, unit: str) -> LogError:
    mapping = raw.path.with_suffix(".toml").name
    return LogError(
        f"column '{channel}' is missing; {present(raw, channel)}; name the column so, or write "
        f"its name and unit into {mapping}, such as: "
        f'{key} = {{ from = "...", unit = "{unit}" }}; breakaway logs {raw.path.name} '
        f"--write-mapping {mapping} guesses one"
    )
