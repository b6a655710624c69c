"""A measured log: what every reader returns and every identification takes."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

import numpy.typing as npt

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.base.text import brief, shown, visible
from breakaway.errors import LogError
from breakaway.measure.logs import changes
from breakaway.measure.logs.channel import Array, Channel, checked, named
from breakaway.measure.logs.findings import Finding, find
from breakaway.measure.logs.units import dimension_of

__all__ = ["Array", "Log"]

MOTION = ("position_m", "force_n", "reference_m", "velocity_m_per_s")
"""Channels that the attributes of a `Log` give; these need one common time base."""


@dataclass(frozen=True, init=False, eq=False)
class Log(OneLine):
    """Position and force of one moving part over time, as they were measured.

    Nothing is repaired, converted or resampled unless it is asked for; ``history`` says what
    was. The arrays are copied and made read-only. Rows count from 1, which is the first sample.

    Parameters
    ----------
    t_s : array of shape (n,)
        Time in s, n ≥ 10. Stamps may repeat, go back, or be unevenly spaced: `findings` says
        so, and what needs better ones checks it.
    position_m : array of shape (n,), optional
        Measured position in m.
    force_n : array of shape (n,), optional
        Applied force in N, positive where it drives the position up.
    reference_m : array of shape (n,), optional
        Reference position in m.
    velocity_m_per_s : array of shape (n,), optional
        Measured velocity in m/s.
    channels : mapping of str to array of shape (n,) or Channel, optional
        Further channels by names that end with their unit, such as ``pressure_pa``;
        ``outside_force_n`` is a known force on the part beside ``force_n``. A `Channel`
        keeps its stamps unless ``t_s`` is given, so `dataclasses.replace` changes a log.
    source : Path, optional
        The file that the log was read from.
    sha256 : str, optional
        Hexadecimal digest of that file's bytes.
    ignored_columns : tuple of str
        Columns of the file that were not read.
    history : tuple of str
        What was done to the numbers of the file, in order.
    noticed : iterable of Finding, optional
        What was odd about the file; `findings` begins with it.

    Attributes
    ----------
    channels : mapping of str to Channel
        All channels but time, each with its stamps.

    Raises
    ------
    LogError
        An array is not one-dimensional, lengths differ, there are too few rows, a value is not
        finite or beyond 1e12 in magnitude, or the name of a channel does not end with a unit.

    See Also
    --------
    Log.from_channels : a log whose channels have time stamps of their own.

    Notes
    -----
    Not checked: the units (a position in mm looks like a long stroke in m) and the sign of the
    force, which the identification notices.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(100) / 50.0
    >>> log = Log(t_s=t_s, position_m=np.sin(t_s), force_n=np.cos(t_s))
    >>> log.rows, log.sample_rate_hz, log.name, list(log.channels)
    (100, 50.0, 'log', ['position_m', 'force_n'])

    """

    channels: Mapping[str, Channel]
    source: Path | None
    sha256: str | None
    ignored_columns: tuple[str, ...]
    history: tuple[str, ...]
    noticed: tuple[Finding, ...]

    def __init__(
        self,
        t_s: npt.ArrayLike | None = None,
        position_m: npt.ArrayLike | None = None,
        force_n: npt.ArrayLike | None = None,
        reference_m: npt.ArrayLike | None = None,
        velocity_m_per_s: npt.ArrayLike | None = None,
        *,
        channels: Mapping[str, npt.ArrayLike | Channel] | None = None,
        source: Path | None = None,
        sha256: str | None = None,
        ignored_columns: Iterable[str] = (),
        history: Iterable[str] = (),
        noticed: Iterable[Finding] = (),
    ) -> None:
        check_arguments(Log.__init__, locals(), LogError)
        named_arrays = (position_m, force_n, reference_m, velocity_m_per_s)
        given = {name: a for name, a in zip(MOTION, named_arrays, strict=True) if a is not None}
        with named("log" if source is None else source.name):
            built = _built(t_s, given, channels or {})
        self._fill(built, source, sha256, ignored_columns, history, noticed)

    @classmethod
    def from_channels(
        cls,
        channels: Iterable[Channel],
        *,
        source: Path | None = None,
        sha256: str | None = None,
        ignored_columns: Iterable[str] = (),
        history: Iterable[str] = (),
        noticed: Iterable[Finding] = (),
    ) -> Log:
        """Build a log of channels that may have different time stamps.

        Parameters
        ----------
        channels : iterable of Channel
            At least one; their names differ.
        source : Path, optional
            The file that they come from.
        sha256 : str, optional
            Digest of its bytes.
        ignored_columns : iterable of str
            Columns of the file that were not read.
        history : iterable of str
            What was done so far.
        noticed : iterable of Finding
            What was odd about the file.

        Raises
        ------
        LogError
            There is no channel, two have one name, or a name does not end with its unit.

        Examples
        --------
        >>> import numpy as np
        >>> fast, slow = np.arange(300) / 100.0, np.arange(30) / 10.0
        >>> log = Log.from_channels(
        ...     [Channel("position_m", fast, fast), Channel("force_n", slow, slow)]
        ... )
        >>> log.resampled(rate_hz=50.0).rows
        146

        """
        check_arguments(Log.from_channels, locals(), LogError)
        log = cls.__new__(cls)
        log._fill(channels, source, sha256, ignored_columns, history, noticed)
        return log

    def _fill(
        self,
        channels: Iterable[Channel],
        source: Path | None,
        sha256: str | None,
        ignored_columns: Iterable[str],
        history: Iterable[str],
        noticed: Iterable[Finding],
    ) -> None:
        found: dict[str, Channel] = {}
        with named("log" if source is None else source.name):
            for channel in channels:
                if channel.name in found:
                    raise LogError(f"channel '{channel.name}' is given twice; give it once")
                dimension_of(channel.name)
                found[channel.name] = channel
            if not found:
                raise LogError("there is no channel besides time; give position_m and force_n")
        object.__setattr__(self, "channels", MappingProxyType(found))
        object.__setattr__(self, "source", source)
        object.__setattr__(self, "sha256", sha256)
        object.__setattr__(self, "ignored_columns", tuple(ignored_columns))
        object.__setattr__(self, "history", tuple(history))
        object.__setattr__(self, "noticed", tuple(noticed))

    def __repr__(self) -> str:
        channels = ", ".join(
            f"{name} ({counted(one.rows, 'row')})" for name, one in self.channels.items()
        )
        return f"<log {shown(self.name)}: {brief(channels)}>"

    @property
    def name(self) -> str:
        """File name of the source as it can be shown, or ``log`` for what never was in a file."""
        return "log" if self.source is None else visible(self.source.name)

    @property
    def t_s(self) -> Array:
        """Time stamps in s of position and force (of all channels where it has neither).

        Raises
        ------
        LogError
            These channels have different stamps.

        """
        return self._base.t_s

    @property
    def position_m(self) -> Array:
        """Measured position in m; `LogError` where the log has none."""
        return self._common("position_m")

    @property
    def force_n(self) -> Array:
        """Applied force in N; `LogError` where the log has none."""
        return self._common("force_n")

    @property
    def reference_m(self) -> Array | None:
        """Reference position in m, or None."""
        return self._common("reference_m") if "reference_m" in self.channels else None

    @property
    def velocity_m_per_s(self) -> Array | None:
        """Measured velocity in m/s, or None."""
        return self._common("velocity_m_per_s") if "velocity_m_per_s" in self.channels else None

    @property
    def outside_force_n(self) -> Array | None:
        """Known force in N on the part beside ``force_n``, such as added pulses, or None.

        It is positive where it drives the position up.
        """
        return self._common("outside_force_n") if "outside_force_n" in self.channels else None

    @property
    def driving_force_n(self) -> Array:
        """All that drives the part in N: ``force_n`` and any ``outside_force_n``."""
        outside = self.outside_force_n
        return self.force_n if outside is None else self.force_n + outside

    @property
    def rows(self) -> int:
        """Number of samples of the common time base."""
        return len(self.t_s)

    @property
    def sample_rate_hz(self) -> float:
        """Mean sample rate in Hz of the common time base, (n - 1) / (t_n - t_1)."""
        with named(self.name):
            return self._base.sample_rate_hz

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is odd about the stamps and values; see `breakaway.measure.logs.findings`."""
        return (*self.noticed, *find(self.channels.values()))

    def __getitem__(self, name: str) -> Array:
        """Return the values of a channel; `channels` gives its stamps."""
        return self.channel(name).values

    def channel(self, name: str) -> Channel:
        """Return a channel.

        Parameters
        ----------
        name : str
            Its name, with the unit.

        Raises
        ------
        LogError
            There is no channel of this name; the message names those present and the remedy.

        """
        check_arguments(Log.channel, locals(), LogError)
        if name in self.channels:
            return self.channels[name]
        near = difflib.get_close_matches(name, self.channels, n=1)
        other = near[0] if near else next(iter(self.channels))
        ignored = ", ".join(map(brief, self.ignored_columns[:20]))
        raise LogError(
            f"{self.name}: there is no channel '{brief(name)}'; present are "
            f"{', '.join(self.channels)}{f' (columns not read: {ignored})' if ignored else ''}; "
            f"name its column in a mapping, or take another channel for it with "
            f"--use {brief(name)}={other} (log.using)"
        )

    def check_increasing(self) -> None:
        """Raise `LogError` where a time stamp is not later than the one before.

        The message names the row and the repairs, `sorted_by_time` and
        `without_repeated_stamps`, neither of which happens by itself.
        """
        with named(self.name):
            self._base.check_increasing()

    def using(self, **channels: str) -> Log:
        """Return a log that has a channel under another name.

        Parameters
        ----------
        **channels : str
            New name = name of a channel of the same dimension; it keeps its old name too.

        Raises
        ------
        LogError
            There is no such channel, or it has another dimension.

        Examples
        --------
        >>> import numpy as np
        >>> log = Log(t_s=np.arange(10.0), channels={"friction_n": np.ones(10)})
        >>> log.using(force_n="friction_n").history
        ("force_n is the channel 'friction_n'",)

        """
        found = dict(self.channels)
        for new, old in channels.items():
            channel = self.channel(old)
            with named(self.name):
                if dimension_of(new) != dimension_of(old):
                    raise LogError(
                        f"channel '{old}' is a {dimension_of(old)}, and '{new}' is a "
                        f"{dimension_of(new)}; they must have the same dimension: choose another"
                    )
            found[new] = Channel(new, channel.t_s, channel.values, channel.from_name, channel.unit)
        notes = [f"{new} is the channel '{old}'" for new, old in channels.items()]
        return self._with(found.values(), *notes)

    def between(self, start_s: float, end_s: float) -> Log:
        """Return the samples whose stamps lie from ``start_s`` to ``end_s``, both included.

        Parameters
        ----------
        start_s : float
            First time on the log's own clock, in s; the stamps stay as they are.
        end_s : float
            Last time, in s.

        Raises
        ------
        LogError
            Too few samples of a channel lie there.

        """
        check_arguments(Log.between, locals(), LogError)
        with named(self.name):
            cut = changes.between(self.channels.values(), start_s, end_s)
        return self._with(cut, f"cut to {start_s:.9g} s to {end_s:.9g} s")

    def resampled(
        self, rate_hz: float | None = None, like: str | None = None, across_gaps: bool = False
    ) -> Log:
        """Return a log with one time base, interpolated linearly where all channels overlap.

        Parameters
        ----------
        rate_hz : float, optional
            Sample rate of the new stamps in Hz.
        like : str, optional
            The channel whose stamps are kept. Give this or ``rate_hz``.
        across_gaps : bool
            Whether to draw a straight line through gaps of the log.

        Raises
        ------
        LogError
            Stamps do not increase, the channels do not overlap, or there is a gap.

        Notes
        -----
        Not checked: aliasing. A lower rate keeps no more than every so many samples; the
        content above half of the new rate folds down.

        """
        check_arguments(Log.resampled, locals(), LogError)
        if like is not None:
            self.channel(like)
        with named(self.name):
            new, note = changes.resampled(self.channels, rate_hz, like, across_gaps)
        return self._with(new, note)

    def sorted_by_time(self) -> Log:
        """Return a log with the samples of each channel in the order of their stamps."""
        sorted_channels = [changes.sorted_by_time(c) for c in self.channels.values()]
        return self._with(sorted_channels, "samples sorted by time")

    def without_repeated_stamps(self) -> Log:
        """Return a log without the samples whose stamp repeats that of the sample before.

        Raises
        ------
        LogError
            Too few samples are left.

        """
        with named(self.name):
            kept = [changes.without_repeated_stamps(c) for c in self.channels.values()]
        dropped = sum(c.rows for c in self.channels.values()) - sum(c.rows for c in kept)
        return self._with(kept, f"{dropped} samples with repeated stamps left out")

    def noted(self, note: str) -> Log:
        """Return the same log with one more line in its history.

        Parameters
        ----------
        note : str
            The line.

        """
        check_arguments(Log.noted, locals(), LogError)
        return self._with(self.channels.values(), note)

    def _with(self, channels: Iterable[Channel], *notes: str) -> Log:
        return Log.from_channels(
            channels,
            source=self.source,
            sha256=self.sha256,
            ignored_columns=self.ignored_columns,
            history=(*self.history, *notes),
            noticed=self.noticed,
        )

    @cached_property
    def _base(self) -> Channel:
        """A channel with the common stamps."""
        main = [c for c in self.channels.values() if c.name in ("position_m", "force_n")]
        first, *others = main or self.channels.values()
        for other in others:
            self._check_common(first, other)
        return first

    def _common(self, name: str) -> Array:
        channel = self.channel(name)
        self._check_common(self._base, channel)
        return channel.values

    def _check_common(self, first: Channel, other: Channel) -> None:
        if not changes.same_stamps(first, other):
            raise LogError(f"{self.name}: {changes.difference(first, other)}")


def _built(
    t_s: npt.ArrayLike | None,
    arrays: Mapping[str, npt.ArrayLike],
    channels: Mapping[str, npt.ArrayLike | Channel],
) -> list[Channel]:
    """Return the channels of a new log; `Channel` members keep what is not given anew."""
    old = {name: c for name, c in channels.items() if isinstance(c, Channel)}
    further = {name: a for name, a in channels.items() if not isinstance(a, Channel)}
    if twice := arrays.keys() & further.keys():
        raise LogError(f"channel '{min(twice)}' is given twice; give it once")
    if t_s is None and not old:
        raise LogError("column 't_s' is missing; give the time of each sample in s")
    stamps = checked("t_s", next(iter(old.values())).t_s if t_s is None else t_s)
    new = {name: checked(name, values) for name, values in {**arrays, **further}.items()}
    built = [Channel(name, stamps, values) for name, values in new.items() if name not in old]
    for name, c in old.items():
        kept = c.t_s if t_s is None else stamps
        built.append(Channel(name, kept, new.get(name, c.values), c.from_name, c.unit))
    return built
