"""A copy of the sources in which the guides are followed, compiled and run."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

from tests.guides.applying import Files

ROOT = Path(__file__).parents[2]
TARGET = ROOT / "target"
TREE = TARGET / "guides"
SETTINGS = ("Cargo.toml", "Cargo.lock", "rustfmt.toml", "pyproject.toml")
SOURCES = (*SETTINGS, "crates", "python", "tests")
BUILT = ("__pycache__", "_core.abi3.so")
"""What arises in the tree and stays there."""
PROGRAMS = {
    "breakaway": str(Path(sys.executable).with_name("breakaway")),
    "python": sys.executable,
    "ruff": str(Path(sys.executable).with_name("ruff")),
}
STACK_KIB = 64 << 10
"""Of every thread: what is not optimized needs more than is usual."""
IN_LARGE_STACK = ("sh", "-c", f'ulimit -s {STACK_KIB} && exec "$@"', "sh")
# Quick to compile, slow to run. Packages of others are compiled once for all trees.
ENVIRONMENT = {
    **os.environ,
    "CARGO_TARGET_DIR": str(TARGET),
    "CARGO_PROFILE_DEV_OPT_LEVEL": "0",
    "CARGO_PROFILE_DEV_DEBUG": "0",
    "CARGO_NET_OFFLINE": "true",
    "RUST_MIN_STACK": str(STACK_KIB << 10),
    "PYO3_PYTHON": sys.executable,
    "PYTHONPATH": str(TREE / "python"),
}


def sources() -> Files:
    """Give the files that the copy begins with."""
    return {path: (ROOT / path).read_bytes() for path in _paths(ROOT)}


def lay_out(files: Files) -> None:
    """Make the tree these files. What is the same stays as old as it is, so that cargo sees it."""
    TREE.mkdir(parents=True, exist_ok=True)
    for path in set(_paths(TREE)) - set(files):
        (TREE / path).unlink()
    for path, content in files.items():
        target = TREE / path
        if not target.is_file() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)


def build() -> None:
    """Check that all of Rust compiles, tests too, and put the extension into its place."""
    rust = "--workspace --exclude breakaway-python --all-targets --features serde"
    run(f"cargo check -q --locked {rust}")
    run("cargo build -q --locked -p breakaway-python")
    extension = (TARGET / "debug/lib_core.so").read_bytes()
    (TREE / "python/breakaway/_core.abi3.so").write_bytes(extension)


def run(command: str) -> None:
    """Run a command in the tree; where it fails, what it said is the error."""
    program, *arguments = shlex.split(command, comments=True)
    done = subprocess.run(
        [*IN_LARGE_STACK, PROGRAMS.get(program, program), *arguments],
        cwd=TREE,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


def _paths(root: Path) -> list[str]:
    """Give the paths of all sources in a tree, from its root; all but what is built there."""
    tops = [root / name for name in SOURCES] if root == ROOT else list(root.iterdir())
    found = [path for top in tops for path in ([top] if top.is_file() else top.rglob("*"))]
    return [
        str(path.relative_to(root))
        for path in found
        if path.is_file() and not set(BUILT) & set(path.relative_to(root).parts)
    ]
