"""Check that lock files name no host but the public ones, and pin by hash."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
OTHERS = [ROOT / "bench/peers/requirements.lock", ROOT / "fuzz/requirements.lock"]
PUBLIC = {"github.com", "pypi.org", "files.pythonhosted.org"}


def faults() -> list[str]:
    """Every line that should not be there."""
    found = []
    for path in [ROOT / "Cargo.lock", *sorted(ROOT.glob("requirements/*.lock")), *OTHERS]:
        text = path.read_text(encoding="utf-8")
        for number, line in enumerate(text.splitlines(), start=1):
            for host in re.findall(r"://([^/\s\"#]+)", line):
                if host not in PUBLIC:
                    found.append(f"{path.name}:{number}: names the host {host}")
        if path.suffix == ".lock" and path.name != "Cargo.lock" and "--hash=" not in text:
            found.append(f"{path.name}: pins nothing by hash")
    return found


if __name__ == "__main__":
    print("\n".join(faults()), end="")
    sys.exit(bool(faults()))
