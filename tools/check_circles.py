"""Refuse circles between the modules of a crate.

A module is a file of `src`, or a folder with all that is in it. It depends on the modules that its
paths `crate::...` name, comments and unit tests left out.
"""

import re
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

CRATES = Path(__file__).parents[1] / "crates"


def modules(crate: Path) -> dict[str, set[str]]:
    """Give what each module of a crate depends on."""
    code = {path: _code(path) for path in sorted((crate / "src").rglob("*.rs"))}
    root = code.pop(crate / "src" / "lib.rs")
    known = {_module(crate, path) for path in code}
    exported = {
        name: module
        for module, names in re.findall(r"pub use (\w+)::(\{[^}]*\}|\w+);", root)
        for name in re.findall(r"\w+", names)
    }
    found: dict[str, set[str]] = {module: set() for module in known}
    for path, text in code.items():
        module = _module(crate, path)
        named = {name if name in known else exported.get(name, name) for name in _named(text)}
        found[module] |= named - {module}
        if unknown := sorted(found[module] - known):
            sys.exit(f"{path}: `crate::{unknown[0]}` is no module of {crate.name}, nor one's item")
    return found


def _module(crate: Path, path: Path) -> str:
    return path.relative_to(crate / "src").parts[0].removesuffix(".rs")


def _code(path: Path) -> str:
    lines = path.read_text(encoding="utf-8").partition("#[cfg(test)]\nmod ")[0].splitlines()
    return "\n".join(line.partition("//")[0] for line in lines)


def _named(text: str) -> set[str]:
    """Give the first names of all paths that begin with `crate::`."""
    names = set(re.findall(r"\bcrate::(\w+)", text))
    for group in re.findall(r"\bcrate::\{((?:[^{}]|\{[^{}]*\})*)\}", text):
        names |= set(re.findall(r"(?:^|,)\s*(\w+)", re.sub(r"\{[^{}]*\}", "", group)))
    return names


def main() -> None:
    """End with a message where there is a circle."""
    for crate in sorted(CRATES.iterdir()):
        try:
            TopologicalSorter(modules(crate)).prepare()
        except CycleError as error:
            sys.exit(f"{crate.name}: circle of modules: {' -> '.join(error.args[1])}")


if __name__ == "__main__":
    main()
