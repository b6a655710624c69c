"""Compile a unit for this host."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

_PLATFORMS = {
    ("Linux", "x86_64"): ("linux64", "x86_64-linux", ".so"),
    ("Linux", "aarch64"): (None, "aarch64-linux", ".so"),
    ("Darwin", "x86_64"): ("darwin64", "x86_64-darwin", ".dylib"),
    ("Darwin", "arm64"): (None, "aarch64-darwin", ".dylib"),
}
"""System and machine -> folder of FMI 2, of FMI 3, and suffix."""

_FLAGS = (
    "-std=c99",
    "-O2",
    "-fPIC",
    "-shared",
    "-ffp-contract=off",
    "-fvisibility=hidden",
)


@dataclass(frozen=True)
class Built:
    """What compiling came to."""

    place: str | None
    """Where the library goes in the unit; None where there is none."""
    library: bytes
    note: str
    """Why there is no library."""


def build(sources: dict[str, str], identifier: str, fmi: str) -> Built:
    """Compile the sources into a shared library, where this host can."""
    found = _PLATFORMS.get((platform.system(), platform.machine()))
    folder = found[0 if fmi == "2" else 1] if found else None
    if found is None or folder is None:
        host = f"{platform.system()} on {platform.machine()}"
        return Built(None, b"", f"no binary: FMI {fmi} has no platform name for {host}")
    compiler = _compiler()
    if compiler is None:
        return Built(None, b"", "no binary: no C compiler found; install gcc or clang, or set CC")
    with tempfile.TemporaryDirectory() as name:
        for source, text in sources.items():
            (Path(name) / source).write_text(text, encoding="utf-8", newline="\n")
        files = sorted(one for one in sources if one.endswith(".c"))
        command = [*compiler, *_FLAGS, *files, "-lm", "-o", "library"]
        try:
            done = subprocess.run(command, cwd=name, capture_output=True, text=True, check=False)
        except OSError as error:
            return Built(None, b"", f"no binary: {compiler[0]} does not run: {error.strerror}")
        if done.returncode != 0:
            said = (done.stderr.strip().splitlines() or ["without a message"])[0]
            return Built(None, b"", f"no binary: {compiler[0]} failed: {said}")
        library = (Path(name) / "library").read_bytes()
    return Built(f"binaries/{folder}/{identifier}{found[2]}", library, "")


def _compiler() -> list[str] | None:
    """The C compiler as a command: ``$CC``, or the first that is found."""
    asked = shlex.split(os.environ.get("CC", ""))
    if asked:
        return asked
    found = (shutil.which(one) for one in ("cc", "gcc", "clang"))
    return next(([one] for one in found if one), None)
