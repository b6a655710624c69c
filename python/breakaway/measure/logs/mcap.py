"""Read a log from an MCAP file with JSON messages."""

from __future__ import annotations

import json
from array import array
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.base.one_line import counted
from breakaway.base.reading import open_regular
from breakaway.base.text import brief
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mcap_records import CutOffError, Message, messages
from breakaway.measure.logs.raw import (
    LONGEST_NAME,
    MOST_COLUMNS,
    RawFile,
    check_names,
    guarded,
)

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

    Their names are ``topic/field``, ``topic/field.member`` for nested ones, and
    ``topic/field[0]`` for those of a list. A message that cannot be read is left out with a
    finding; a file that is cut off is read up to there. The stamps are
    the times of publishing, in s after the first message; those of logging where a message of the
    field has none, 0, because clocks are not mixed within a channel.

    Raises
    ------
    LogError
        The file is damaged, takes more memory than it may, or no message is encoded as JSON.

    """
    raw, found = RawFile(path), _Found(path, budget)
    with open_regular(path) as stream:
        try:
            for message in messages(stream, budget):
                found.take(message)
        except CutOffError:
            if not found.fields:
                raise
            words = "the recording is cut off within a record; what is whole before it is read"
            raw.notice("cut_off", "", 1, words)
    found.tell(raw)
    _add(raw, found.fields)
    yield raw


@dataclass
class _Found:
    """The fields of all messages so far, and what could not be read."""

    path: Path
    budget: Budget
    fields: dict[str, _Field] = field(default_factory=dict)
    encodings: dict[str, str] = field(default_factory=dict)
    """Topic -> encoding of its messages, where that is not read."""
    bad: dict[str, list[str]] = field(default_factory=dict)
    """Topic -> why a message of it is left out, for each."""

    def take(self, message: Message) -> None:
        """Take the numbers of a message, or note why there are none."""
        topic = message.topic.name.strip("/")
        if message.topic.encoding != "json":
            self.encodings[topic] = message.topic.encoding[:40]
            return
        numbers = _numbers(self.budget, message)
        if isinstance(numbers, str):
            self.bad.setdefault(topic, []).append(numbers)
            return
        self.budget.take("its messages", BYTES_PER_NUMBER * len(numbers))
        for key, value in numbers:
            one = self.fields.setdefault(f"{topic}/{key}" if key else topic, _Field())
            one.published.append(message.published_ns)
            one.logged.append(message.logged_ns)
            one.values.append(value)
        check_names(self.path, len(self.fields) + len(self.encodings))

    def tell(self, raw: RawFile) -> None:
        """Note topics that are not read, and messages that are left out.

        Raises
        ------
        LogError
            There is nothing else.

        """
        for topic, encoding in self.encodings.items():
            raw.refuse(topic, f"its messages are encoded as '{encoding}'; only json is read")
        for topic, reasons in self.bad.items():
            what = f"{counted(len(reasons), 'message')} {reasons[0]}"
            raw.notice("invalid", topic, len(reasons), f"{what}: left out")
        if self.fields:
            return
        none = dict(raw.unreadable) | {t: f"a message {one[0]}" for t, one in self.bad.items()}
        for topic, reason in none.items():
            raise LogError(
                f"{self.path.name}: topic '{brief(topic)}': {reason}; convert them, or export the "
                "log again"
            )


def _numbers(budget: Budget, message: Message) -> list[tuple[str, float]] | str:
    """Return the numbers in a message by their paths, or why it cannot be read.

    Texts are left out, and lists longer than `MOST_COLUMNS`, which are rather pictures.
    """
    budget.take("a message", 0, BYTES_PER_JSON_BYTE * len(message.data))
    try:
        # As floats, whose digits are not limited; JSON makes no other difference between them.
        value = json.loads(bytes(message.data), parse_int=float)
        found: list[tuple[str, float]] = []
        _collect(found, "", value)
    except (ValueError, RecursionError) as error:
        reason = "is nested too deeply" if isinstance(error, RecursionError) else str(error)[:80]
        return f"is not readable JSON ({reason})"
    return found


def _collect(found: list[tuple[str, float]], name: str, value: Any) -> None:  # noqa: ANN401
    if len(name) > LONGEST_NAME:
        raise ValueError(f"the path of a field has more than {LONGEST_NAME:,} characters")
    if isinstance(value, dict):
        for key, member in value.items():
            _collect(found, f"{name}.{key}" if name else str(key), member)
    elif isinstance(value, list) and len(value) <= MOST_COLUMNS:
        for place, member in enumerate(value):
            _collect(found, f"{name}[{place}]", member)
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
