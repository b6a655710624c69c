"""Check the locked packages against databases of known faults.

Exits with 1 where a package has a known fault. What cannot be checked, because a tool or its
database is not to be had, is said aloud and does not fail: a check that was left out is no pass.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
LOCKS = (
    "requirements/installer.lock",
    "requirements/dev.lock",
    "bench/peers/requirements.lock",
    "fuzz/requirements.lock",
)


def main() -> int:
    """Check everything; give the exit code."""
    faults: list[str] = []
    for lock in LOCKS:
        faults += python_faults(lock)
    faults += rust_faults()
    print("\n".join(faults), end="\n" if faults else "")
    return bool(faults)


def python_faults(lock: str) -> list[str]:
    """Known faults of the packages in a lock file."""
    options = ["--disable-pip", "--require-hashes", "--progress-spinner", "off", "--format", "json"]
    found = _json_of([sys.executable, "-m", "pip_audit", *options, "--requirement", lock])
    if found is None:
        return []
    packages = found["dependencies"]
    unknown = [package["name"] for package in packages if "skip_reason" in package]
    if unknown:
        _skip(f"{lock}: {len(unknown)} of {len(packages)} packages are not in the database")
    return [
        f"{lock}: {package['name']} {package['version']}: {fault['id']}, mended in "
        f"{', '.join(fault['fix_versions']) or 'no version yet'}"
        for package in packages
        for fault in package.get("vulns", ())
    ]


def rust_faults() -> list[str]:
    """Known faults of the crates in Cargo.lock."""
    if shutil.which("cargo-audit") is None:
        _skip("Cargo.lock: cargo-audit is missing; install it with: cargo install cargo-audit")
        return []
    found = _json_of(["cargo", "audit", "--json"])
    if found is None:
        return []
    return [
        f"Cargo.lock: {one['package']['name']} {one['package']['version']}: {one['advisory']['id']}"
        for one in found["vulnerabilities"]["list"]
    ]


def _json_of(command: list[str]) -> dict[str, Any] | None:
    """Run a check; both tools exit with 1 for a fault and for no database, so its output counts."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    try:
        found: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        reason = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()[-1]
        _skip(f"{' '.join(command[:3])}: {reason[:200]}")
        return None
    return found


def _skip(reason: str) -> None:
    print(f"NOT CHECKED for known faults: {reason}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
