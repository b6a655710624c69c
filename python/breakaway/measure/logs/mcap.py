"""Read a log from an MCAP file with JSON messages."""

from __future__ import annotations

import json
from array import array
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.base.reading import open_regular
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mcap_records import Message, messages
from breakaway.measure.logs.raw import LONGEST_NAME, RawFile, check_names, guarded

BYTES_PER_NUMBER = 27
"""A number and its two stamps, and the room that they keep to grow."""

BYTES_PER_JSON_BYTE = 40
"""Most memory that a byte of JSON takes as objects: {} in lists take 70 bytes for 3."""


@dataclass
class _Field:
    """The numbers of a field so far, and when they were published and logged, in ns."""

    published: array[int] = field(default_factory=lambda: array("Q"))
    logged: array[int] = field(default_factory=lambda: array("Q"))
    values: array[float] = field(default_factory=lambda: array("d"))


@guarded("an MCAP file")
def open_mcap(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open an MCAP file, whose channels are the numbers in its JSON messages.

    Their names are ``topic/field``, or ``topic/field.member`` for nested ones. The stamps are
    the times of publishing, in s after the first message; those of logging where a message of the
    field has none, 0, because clocks are not mixed within a channel.

    Raises
    ------
    LogError
        The file is damaged, takes more memory than it may, or no message is encoded as JSON.

    """
    raw, fields = RawFile(path), dict[str, _Field]()
    with open_regular(path) as stream:
        for message in messages(stream, budget):
            name = message.topic.name.strip("/")
            if message.topic.encoding != "json":
                encoding = message.topic.encoding[:40]
                if name not in raw:
                    raw.refuse(name, f"its messages are encoded as '{encoding}'; only json is read")
                continue
            numbers = _numbers(path, budget, name, message)
            budget.take("its messages", BYTES_PER_NUMBER * len(numbers))
            for key, value in numbers:
                one = fields.setdefault(f"{name}/{key}" if key else name, _Field())
                one.published.append(message.published_ns)
                one.logged.append(message.logged_ns)
                one.values.append(value)
            check_names(path, len(fields) + len(raw.unreadable))
    if raw.unreadable and not fields:
        name, reason = next(iter(raw.unreadable.items()))
        raise LogError(f"{path.name}: topic '{name}': {reason}; convert them, or export as CSV")
    _add(raw, fields)
    yield raw


def _numbers(path: Path, budget: Budget, name: str, message: Message) -> list[tuple[str, float]]:
    """Return the numbers in a message by their paths; texts and lists are left out."""
    budget.take("a message", 0, BYTES_PER_JSON_BYTE * len(message.data))
    try:
        # As floats, whose digits are not limited; JSON makes no other difference between them.
        value = json.loads(bytes(message.data), parse_int=float)
        found: list[tuple[str, float]] = []
        _collect(found, "", value)
    except (ValueError, RecursionError) as error:
        reason = "is nested too deeply" if isinstance(error, RecursionError) else str(error)[:80]
        raise LogError(
            f"{path.name}: topic '{name[:80]}': a message is not readable JSON ({reason}); "
            "export the log again"
        ) from None
    return found


def _collect(found: list[tuple[str, float]], name: str, value: Any) -> None:  # noqa: ANN401
    if len(name) > LONGEST_NAME:
        raise ValueError(f"the path of a field has more than {LONGEST_NAME:,} characters")
    if isinstance(value, dict):
        for key, member in value.items():
            _collect(found, f"{name}.{key}" if name else str(key), member)
    elif isinstance(value, float):
        found.append((name, value))


def _add(raw: RawFile, fields: dict[str, _Field]) -> None:
    stamps = {name: _stamps(one) for name, one in fields.items()}
    zero = min((int(one[0]) for one in stamps.values()), default=0)
    for name, one in fields.items():
        # Whole numbers, which wrap around to what is negative.
        after = (stamps[name] - np.uint64(zero)).view(np.int64)
        raw.give(name, np.frombuffer(one.values), 1e-9 * after.astype(np.float64))


def _stamps(one: _Field) -> np.ndarray:
    """Return the stamps of a field by one clock for all of them."""
    published = np.frombuffer(one.published, np.uint64)
    return published if published.all() else np.frombuffer(one.logged, np.uint64)
