"""Pulls to slip from a solver that shares nothing with the package: that of an example."""

from collections.abc import Callable
from pathlib import Path
from runpy import run_path
from typing import Any

from breakaway.measure.logs import Log

_EXAMPLE: dict[str, Any] = run_path(
    str(Path(__file__).parents[2] / "examples/10_from_pull_to_report/pulls.py")
)
pulled: Callable[..., Log] = _EXAMPLE["pulled"]
written: Callable[[Log, Path], Path] = _EXAMPLE["written"]
