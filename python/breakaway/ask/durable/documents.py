"""Documents of a finished folder: the same bytes for the same content."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from io import StringIO
from typing import Any

from breakaway.base.text import csv_cell


def as_json(content: object) -> bytes:
    """Give a JSON document, the same for the same content."""
    return (json.dumps(content, indent=2, allow_nan=False) + "\n").encode()


def as_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """Give rows as a table with all their columns; what is None is empty, no text a formula."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(csv_cell, names))
    writer.writerows([csv_cell(row.get(name)) for name in names] for row in rows)
    return text.getvalue()
