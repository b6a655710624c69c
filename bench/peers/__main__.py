"""Measure every peer, print the table, write bench/peers/results.json and results.md.

    python -m bench.peers              all of them, about four minutes on two cores
    python -m bench.peers numba jax    some of them, beside ours

Call it at the root of the repository, with the requirements of this folder and `breakaway`.
"""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from . import report, workers

HERE = Path(__file__).parent
TIMEOUT_S = 180.0

DISTRIBUTIONS = {
    "ours": "breakaway",
    "scipy": "scipy",
    "control": "control",
    "numba": "numba",
    "jax": "jax",
    "diffrax": "diffrax",
    "casadi": "casadi",
    "drake": "drake",
    "pathsim": "pathsim",
    "pydiffsol": "pydiffsol",
}
"""Modules of this folder, without their underscore, and what they need."""


def version(peer: str) -> str:
    try:
        return importlib.metadata.version(DISTRIBUTIONS[peer])
    except importlib.metadata.PackageNotFoundError:
        return "this checkout" if peer == "ours" else "not installed"


def measured(peer: str, threads: int) -> list[dict[str, Any]]:
    """What a process of its own measured; where it failed, one measurement that says why."""
    command = [sys.executable, "-m", "bench.peers.measure", f"{peer}_", str(threads)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=TIMEOUT_S, check=True
        )
        return json.loads(done.stdout.splitlines()[-1])
    except subprocess.TimeoutExpired:
        why = f"took more than {TIMEOUT_S:g} s"
    except subprocess.CalledProcessError as error:
        why = (error.stderr.splitlines() or [f"ended with {error.returncode}"])[-1]
    about = {"name": DISTRIBUTIONS[peer], "integrates": "-", "settings": "-", "rule": None}
    work = {"mode": "single", "threads": threads, "runs": 0, "duration_s": 0.0}
    return [{**about, **work, "why": why}]


def measure_all(peers: list[str], threads: int, console: Console) -> list[dict[str, Any]]:
    """One thread first, then all cores; ours once more at the end, since all compare with it."""
    found = []
    for peer in [*peers, "ours"]:
        for count in sorted({1, threads}):
            console.print(f"[dim]{peer} {version(peer)}, threads: {count}[/dim]")
            found += measured(peer, count)
    return found


def markdown(rows: list[report.Row], machine: dict[str, Any]) -> str:
    """All tables and settings."""
    versions = ", ".join(f"{peer} {v}" for peer, v in machine["versions"].items())
    parts = [
        "Wall seconds per simulated second and run; the fastest of at least three.",
        report.markdown_table(report.main_table(rows, machine["threads"])),
        "Lead (`÷ ours` above) = rule x code, for rules that exist in more than one code.",
        report.markdown_table(report.split_table(rows)),
        "\n".join(f"* {line}" for line in report.settings_lines(rows)),
        f"{machine['threads']} cores, load {machine['load']:.1f} before. {versions}.",
    ]
    return "\n\n".join(parts) + "\n"


def main(chosen: list[str]) -> None:
    """Measure the chosen peers, or all."""
    if not set(chosen) <= set(DISTRIBUTIONS):
        sys.exit(f"choose from: {' '.join(DISTRIBUTIONS)}")
    console, threads = Console(), len(workers.cores())
    peers = ["ours", *chosen] if chosen else list(DISTRIBUTIONS)
    machine = {
        "processor": platform.processor() or platform.machine(),
        "threads": threads,
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0,
        "versions": {peer: version(peer) for peer in peers},
    }
    found = measure_all(peers, threads, console)
    results = {"machine": machine, "measurements": found}
    (HERE / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    rows = report.rows(found)
    wide = Console(width=max(console.width, 180))
    title = "Wall seconds per simulated second and run"
    report.print_table(wide, title, report.main_table(rows, threads))
    report.print_table(wide, "Lead = rule x code", report.split_table(rows))
    for line in report.settings_lines(rows):
        console.print(f"[dim]{line}[/dim]", highlight=False)
    (HERE / "results.md").write_text(markdown(rows, machine), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
