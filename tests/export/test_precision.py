"""The documented distance of float from double."""

from __future__ import annotations

import re
from pathlib import Path

import breakaway as bk
from breakaway.export.precision import float_differences

PAGE = (Path(__file__).parents[2] / "docs/export.md").read_text()


def test_float_is_as_close_as_documented() -> None:
    found = {
        one.output: one.largest for one in float_differences(bk.load_scenario("paper_as_computed"))
    }
    rows = re.findall(r"^\| `(\w+)` \| ([0-9.e-]+) \| [0-9.]+ \|$", PAGE, re.MULTILINE)
    assert len(rows) == 5
    for output, documented in rows:
        assert 0.5 * float(documented) < found[output] < 2.0 * float(documented), output
