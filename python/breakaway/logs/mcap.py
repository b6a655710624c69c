"""Read a log from an MCAP file with JSON messages."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.errors import LogError
from breakaway.logs.budget import Budget
from breakaway.logs.raw import RawFile, check_size, guarded, need


@dataclass
class _Topic:
    """The messages of a topic so far; ``values`` holds each field with its times."""

    times: dict[str, list[int]] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=dict)


@guarded("an MCAP file")
def read_mcap(path: Path, budget: Budget) -> RawFile:
    """Read the numbers in the JSON messages of an MCAP file.

    Their names are ``topic/field``, or ``topic/field.member`` for nested ones. The stamps are
    the times of publishing (of logging where these are 0), in s after the first message.

    Raises
    ------
    LogError
        mcap is missing, the file is damaged, or no message is encoded as JSON.

    """
    reader = need("mcap.reader", "mcap", "mcap", path, "MCAP")
    raw, topics = RawFile(path), dict[str, _Topic]()
    stream = io.BytesIO(path.read_bytes())
    source = reader.make_reader(stream, validate_crcs=True)
    for _, channel, message in source.iter_messages(log_time_order=False):
        name = channel.topic.strip("/")
        if channel.message_encoding != "json":
            raw.unreadable[name] = (
                f"its messages are encoded as '{channel.message_encoding}'; only json is read"
            )
            continue
        stamp = message.publish_time or message.log_time
        _collect(topics.setdefault(name, _Topic()), "", json.loads(message.data), stamp)
    if raw.unreadable and not topics:
        name, reason = next(iter(raw.unreadable.items()))
        raise LogError(f"{path.name}: topic '{name}': {reason}; convert them, or export as CSV")
    _add(raw, topics)
    return raw


def _collect(topic: _Topic, name: str, value: Any, stamp: int) -> None:  # noqa: ANN401
    """Gather the numbers of a message; texts and lists are left out."""
    if isinstance(value, dict):
        for key, member in value.items():
            _collect(topic, f"{name}.{key}" if name else str(key), member, stamp)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        topic.times.setdefault(name, []).append(stamp)
        topic.values.setdefault(name, []).append(float(value))


def _add(raw: RawFile, topics: dict[str, _Topic]) -> None:
    firsts = [times[0] for topic in topics.values() for times in topic.times.values()]
    zero = min(firsts, default=0)
    for name, topic in topics.items():
        for key, values in topic.values.items():
            check_size(raw.path, key, len(values))
            t_s = np.array([stamp - zero for stamp in topic.times[key]], dtype=np.float64) * 1e-9
            raw.add(f"{name}/{key}" if key else name, values, t_s)
