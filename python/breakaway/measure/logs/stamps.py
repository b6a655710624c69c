"""Time stamps that are written as texts: dates with a time of day, or times of day alone."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

TIME = r"(\d{1,2}):(\d\d):(\d\d)([.,]\d{1,9})?"
FORMS = (
    re.compile(rf"^\s*(\d{{4}})-(\d\d)-(\d\d)[T ]{TIME}Z?\s*$"),
    re.compile(rf"^\s*(\d\d)\.(\d\d)\.(\d{{4}})[T ]{TIME}\s*$"),
    re.compile(rf"^\s*{TIME}\s*$"),
)
"""ISO 8601, of no zone or of UTC; day.month.year as in German; a time of day."""

LOST = np.iinfo(np.int64).min
"""Stands for no stamp."""

CLEANED = (
    (r"^\s*(.*?)Z?\s*$", r"\1"),
    (r"^(\d\d)\.(\d\d)\.(\d{4})[T ]", r"\3-\2-\1 "),
    (r"^(\d{1,2}:)", r"1970-01-01 \1"),
    (r" (\d:)", r" 0\1"),
    (r",(\d+)$", r".\1"),
)
"""What makes an ISO stamp of each, in turn."""


def is_stamp(cell: str) -> bool:
    """Whether a text is a time stamp.

    Examples
    --------
    >>> texts = "2026-11-30T08:00:00.5", "30.11.2026 8:00:00,5", "8:00:00", "8"
    >>> [is_stamp(text) for text in texts]
    [True, True, True, False]

    """
    return any(form.match(cell) for form in FORMS)


def nanoseconds(column: Any, *, lost: bool = False) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return texts as ns, of the first day of 1970 where there is no date; None where one is none.

    With ``lost``, what is no stamp is `LOST`.

    Examples
    --------
    >>> nanoseconds(pa.chunked_array([["8:00:00,5", "08:00:01.25"]])).tolist()
    [28800500000000, 28801250000000]

    """
    cleaned = column
    if lost:
        forms = "|".join(form.pattern for form in FORMS)
        cleaned = pc.if_else(pc.match_substring_regex(column, forms), column, None)
    for pattern, replacement in CLEANED:
        cleaned = pc.replace_substring_regex(cleaned, pattern, replacement)
    try:
        stamps = cleaned.cast(pa.timestamp("ns"))
    except pa.ArrowInvalid:
        return None
    if stamps.null_count and not lost:
        return None
    return pc.fill_null(stamps.cast(pa.int64()), LOST).to_numpy()
