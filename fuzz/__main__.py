"""Fuzz one target, or all one after the other.

``python -m fuzz TARGET [options of libFuzzer]``; options are ``-max_total_time=7200`` and so on.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["breakaway", "nptdms"]):
    from fuzz.targets import TARGETS, run

from fuzz.seeds import write_seeds

OPTIONS = ("-timeout=5", "-rss_limit_mb=3000", "-max_len=65536", "-print_final_stats=1")
"""A hang is 5 s; 3 GB is what the process needs beside the budget of one log."""


def main() -> None:
    """Fuzz until an option of libFuzzer ends it, or a fault is found."""
    name, options = (sys.argv[1] if len(sys.argv) > 1 else ""), sys.argv[2:]
    if name == "all":
        command = [sys.executable, "-m", "fuzz"]
        codes = [
            subprocess.run([*command, one, *options], check=False).returncode for one in TARGETS
        ]
        sys.exit(max(map(abs, codes)))
    if name not in TARGETS:
        sys.exit(f"give all or one of {', '.join(TARGETS)}, then options of libFuzzer")
    fuzz(name, options)


def fuzz(name: str, options: list[str]) -> None:
    """Fuzz a target; what was found and the inputs that reach new code stay in a folder."""
    home = Path(tempfile.mkdtemp(prefix=f"fuzz_{name}_"))
    seeds, corpus = write_seeds(name, home / "seeds"), home / "corpus"
    corpus.mkdir()
    print(f"{name}: corpus and faults go to {home}", flush=True)
    atheris.Setup(
        ["fuzz", *OPTIONS, f"-artifact_prefix={home}/", *options, str(corpus), str(seeds)],
        lambda content: run(TARGETS[name], content, home),
    )
    atheris.Fuzz()


if __name__ == "__main__":
    main()
