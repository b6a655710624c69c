"""What is no regular file, or no name, ends every command with a line, whatever it was given as."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow

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
    "identify --rig": ("identify", "motor.csv", "--law", "coulomb", "--rig", "FILE"),
    "events": ("events", "FILE"),
    "events --rig": ("events", "motor.csv", "--rig", "FILE"),
    "rig-from-blank": ("rig-from-blank", "FILE", "--out", "out"),
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


@pytest.mark.parametrize("command", COMMANDS)
def test_a_name_longer_than_names_may_be(
    call: Call, log_csv: Path, command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    if log_csv != Path("motor.csv").resolve():
        shutil.copy(log_csv, "motor.csv")
    failed = call(*("x" * 300 if word == "FILE" else word for word in COMMANDS[command]))
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith("error: ") and "name too long" in failed.stderr
    assert failed.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "command", ["run", "design", "export c", "export fmu", "init", "reproduce"]
)
def test_a_result_whose_name_is_longer_than_names_may_be(call: Call, command: str) -> None:
    place = Path("x" * 300) / "loop.fmu"
    scenario = [] if command == "reproduce" else ["paper_as_computed"]
    told = [place] if command == "init" else [*scenario, "--out", place]
    failed = call(*command.split(), *told)
    assert failed.exit_code == 3
    assert failed.stderr.startswith("error: ") and "name too long" in failed.stderr
    assert failed.stderr.count("\n") == 1


def test_a_study_whose_scenario_is_no_name(call: Call, tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    study.write_text(f'kind = "sweep"\nscenario = "{"x" * 300}"\n')
    failed = call("study", study, "--out", tmp_path / "out")
    assert failed.exit_code == 2 and "Traceback" not in failed.stderr
