"""What is in a log file, as its format tells it."""

from __future__ import annotations

from collections.abc import Mapping as Keys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine, counted
from breakaway.base.text import shown
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.detect import detect
from breakaway.measure.logs.digest import digested
from breakaway.measure.logs.guess import mapping_text
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.mapping import load_mapping
from breakaway.measure.logs.raw import RawFile
from breakaway.measure.logs.read import open_log


@dataclass(frozen=True)
class Listing(OneLine):
    """The channels of a log file, of which no numbers were read.

    Parameters
    ----------
    path : Path
        The file.
    format : str
        One of `breakaway.measure.logs.FORMATS`.
    channels : tuple of ListedChannel
        All channels, in the order of the file.
    findings : tuple of str
        What is odd about the file as a whole.
    csv : mapping
        How a CSV file is laid out, by the keys of the table ``csv`` of a mapping.

    """

    path: Path
    format: str
    channels: tuple[ListedChannel, ...]
    findings: tuple[str, ...] = ()
    csv: Keys[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        count = counted(len(self.channels), "channel")
        return f"<{self.format} file {shown(self.path.name)}: {count}>"

    def mapping_text(self) -> str:
        """Return a mapping in TOML, guessed from names and units, to be corrected by hand.

        Names are known in English and German: Time (sec), Force/N, Kraft in N, Weg, Load. What
        the guess does not take is listed in a comment.
        """
        return mapping_text(self.path.name, self.channels, self.csv)


def list_channels(
    path: str | Path,
    mapping: str | Path | Keys[str, Any] | None = None,
    format: str | None = None,
    *,
    memory_bytes: float | None = None,
) -> Listing:
    r"""List the channels of a log file, and read none.

    Parameters
    ----------
    path : str or Path
        The file.
    mapping : str, Path or mapping, optional
        As `read_log` takes it; only the tables that say how the file is laid out count.
    format : str, optional
        One of `FORMATS`; by default as the file's first bytes, else its suffix, say.
    memory_bytes : float, optional
        Most memory that it may take; by default half of what is free.

    Returns
    -------
    Listing

    Raises
    ------
    LogError
        The file or the mapping is missing or damaged, a package for the format is missing, or
        the file goes beyond a limit.

    Notes
    -----
    Not checked: the numbers. A channel that is listed may still hold what is none.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "motor.csv"
    ...     _ = path.write_text("Zeit [s],Weg [mm],Kraft in N\n" + "0,0,0\n" * 20)
    ...     found = list_channels(path)
    >>> [one.name for one in found.channels]
    ['Zeit [s]', 'Weg [mm]', 'Kraft in N']
    >>> print(found.mapping_text())
    # Guessed from the names and units in 'motor.csv': correct it by hand.
    <BLANKLINE>
    [time]
    from = "Zeit [s]"
    unit = "s"
    <BLANKLINE>
    [channels.force_n]
    from = "Kraft in N"
    unit = "N"
    <BLANKLINE>
    [channels.position_m]
    from = "Weg [mm]"
    unit = "mm"
    <BLANKLINE>

    """
    check_arguments(list_channels, locals(), LogError)
    path = Path(path)
    budget = Budget.of(path, memory_bytes)
    with digested(path):
        rules, _ = load_mapping(mapping, path)
        kind = format or rules.format or detect(path)
        with open_log(path, kind, rules, budget) as raw:
            channels = tuple(_listed(raw, name) for name in raw.names)
            findings = tuple(map(str, raw.findings))
    csv = rules.csv.model_dump(exclude_defaults=True) if kind == "csv" else {}
    return Listing(path, kind, channels, findings, csv)


def _listed(raw: RawFile, name: str) -> ListedChannel:
    found = raw.listed.get(name, ListedChannel(name))
    return replace(found, unreadable=raw.unreadable.get(name, ""))
