"""What is no regular file ends every command with one line, whatever it was given as."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Call = Callable[..., Any]

COMMANDS = {
    "run": ("run", "FILE"),
    "run --joint": ("run", "paper_as_computed", "--joint", "FILE"),
    "design": ("design", "FILE"),
    "study": ("study", "FILE", "--out", "out"),
    "tune": ("tune", "FILE", "--out", "out"),
    "compare": ("compare", "FILE", "--out", "out"),
    "compare --method": ("compare", "--method", "FILE", "--out", "out"),
    "export": ("export", "c", "FILE", "--out", "out"),
    "init": ("init", "mine.toml", "--preset", "FILE"),
    "identify": ("identify", "FILE"),
    "identify --mapping": ("identify", "motor.csv", "--mapping", "FILE"),
    "identify --controller": (
        *("identify", "motor.csv", "--law", "coulomb", "--motion", "closed_loop"),
        *("--controller", "FILE"),
    ),
    "events": ("events", "FILE"),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_takes_regular_files_only(
    call: Call, no_file: tuple[Path, str], log_csv: Path, command: str
) -> None:
    path, words = no_file
    if log_csv != Path("motor.csv").resolve():
        shutil.copy(log_csv, "motor.csv")
    failed = call(*(path if word == "FILE" else word for word in COMMANDS[command]))
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith("error: ") and words in failed.stderr
    assert failed.stderr.count("\n") == 1
    assert not Path("out").exists()
