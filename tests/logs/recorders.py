"""The mappings that docs/recorders.md prints."""

import re
import tomllib
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2] / "docs" / "recorders.md"


def printed_mapping(heading: str) -> dict[str, Any]:
    """Return the mapping that a section prints."""
    section = DOCS.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]
    (text,) = re.findall(r"```toml\n(.*?)```", section, re.DOTALL)
    return tomllib.loads(text)
