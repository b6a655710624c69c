"""What a command says it wrote."""

import os
import re
from pathlib import Path


def written_to(folder: Path, stdout: str) -> set[str]:
    """Names of the files that a command says it wrote to a folder."""
    place = re.escape(f"{folder}{os.sep}")
    found = re.search(rf"^wrote (\d+) files to {place}: (.*)$", stdout, re.M)
    assert found, stdout
    names = found[2].split(", ")
    assert len(names) == int(found[1])
    return set(names)
