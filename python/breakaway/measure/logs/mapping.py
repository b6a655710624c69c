"""Mappings: which channel of a file is which, in which unit, written as TOML."""

from __future__ import annotations

from collections.abc import Mapping as Keys
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field

from breakaway.base.reading import is_file, table_of, text_of
from breakaway.errors import LogError, ScenarioError
from breakaway.measure.logs.units import dimension_of, unit_named
from breakaway.model.scenario.model import Model, Name, Text

AnyModel = TypeVar("AnyModel", bound=Model)


class ChannelMapping(Model):
    """Where a channel comes from."""

    from_: Annotated[Text, Field(alias="from")]
    """Name of the channel in the file."""

    unit: Name | None = None
    """Unit of the numbers in the file; needed unless the file or the name there states it."""

    scale: float | None = None
    """SI unit of the channel per unit of the file; `unit` is then free text."""

    sign: Literal[1, -1] = 1
    """-1 turns the channel around."""

    time: Text | None = None
    """Name of the time channel of this channel, where it has one of its own."""


class TimeMapping(Model):
    """The time channel of all channels that state none of their own."""

    from_: Annotated[Text | None, Field(alias="from")] = None
    """Name of the time channel in the file."""

    unit: Name | None = None
    """Unit of the time channels in the file."""

    rate_hz: Annotated[float | None, Field(gt=0.0)] = None
    """Rate of a file without stamps; with `from_`, of the numbers of samples in that channel."""

    scale: Annotated[float | None, Field(gt=0.0)] = None
    """Seconds in 1 of the time channels, where they are in a unit of their own."""


class CsvMapping(Model):
    """How a text file is laid out; what is not given is seen from the file where it is certain."""

    delimiter: Annotated[str, Field(min_length=1, max_length=1)] = ","
    """The mark between cells; a blank stands for a run of blanks."""

    decimal: Literal[".", ","] = "."
    """The decimal mark."""

    skip_rows: Annotated[int, Field(ge=0)] = 0
    """Lines above the header."""

    header: bool = True
    """Whether there is a header; without one columns are named ``column_1`` and so on."""

    units_row: bool = False
    """Whether the row below the header holds the units."""

    encoding: Literal["utf-8", "cp1252", "latin-1", "utf-16"] | None = None
    """Encoding of the text; by default what its first bytes tell for certain, else UTF-8."""


class Mapping(Model):
    """The mapping of a log file."""

    format: Name | None = None
    """Format of the file, as `read_log` takes it."""

    channels: dict[str, ChannelMapping] = Field(default_factory=dict)
    """Name of a channel, ending with its unit -> where it comes from."""

    time: TimeMapping = TimeMapping()
    """The time channel."""

    csv: CsvMapping = CsvMapping()
    """How a CSV file is laid out."""


def load_mapping(given: str | Path | Keys[str, Any] | None, log: Path) -> tuple[Mapping, str]:
    """Return the mapping of a log, and where it came from (nothing where there is none).

    Without a given one, the TOML file of the log's name beside it counts if it has a table
    ``channels``, ``csv`` or ``time``.

    Raises
    ------
    LogError
        There is no such file, it is not TOML, or a value is not valid.

    """
    if isinstance(given, Keys):
        return parse_mapping(given, "mapping"), "the mapping given" if given else ""
    if given is not None:
        path = Path(given)
        return parse_mapping(_toml(path), path.name), path.name
    beside = log.with_suffix(".toml")
    if beside != log and is_file(beside):
        values = _toml(beside)
        if any(isinstance(values.get(key), dict) for key in ("channels", "csv", "time")):
            return parse_mapping(values, beside.name), beside.name
    return Mapping(), ""


def parse_mapping(values: Keys[str, Any], source: str) -> Mapping:
    """Check nested plain values; ``source`` names them in errors."""
    tables = values.get("channels", {})
    if not isinstance(tables, Keys):
        raise LogError(f"{source}: channels: is not a table; give [channels.position_m] and so on")
    channels = {}
    for name, keys in tables.items():
        where = f"{source}: channels.{name}"
        if not isinstance(keys, Keys):
            raise LogError(f'{where}: is not a table; give from = "..." and unit = "..."')
        channels[name] = _parse(ChannelMapping, keys, where)
        _check_unit(name, channels[name], where)
    rest = {key: value for key, value in values.items() if key != "channels"}
    mapping = _parse(Mapping, rest | {"channels": channels}, source)
    time = mapping.time
    if sum(one is not None for one in (time.unit, time.rate_hz, time.scale)) > 1:
        raise LogError(
            f"{source}: time: has several of unit, rate_hz and scale; one alone says what 1 of its "
            "numbers is: delete the others"
        )
    return mapping


def _check_unit(name: str, channel: ChannelMapping, where: str) -> None:
    try:
        dimension_of(name)
        if channel.unit is not None and channel.scale is None:
            unit_named(channel.unit, name)
    except LogError as error:
        raise LogError(f"{where}: {error}") from None
    if name == "t_s":
        raise LogError(f"{where}: time has a table of its own; write [time] instead")
    if channel.scale == 0.0:
        raise LogError(f"{where}: scale is 0; it must be the SI value of 1 in the file")


def _parse(model: type[AnyModel], values: Keys[str, Any], where: str) -> AnyModel:
    try:
        return model.parse(values)
    except ScenarioError as error:
        text = str(error).replace("from_", "from")
        raise LogError(f"{where}: {text}") from None


def _toml(path: Path) -> dict[str, Any]:
    text = text_of(path, LogError, "there is no such mapping file; check the path")
    return table_of(text, path.name, LogError)
