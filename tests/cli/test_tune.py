"""`breakaway tune` tunes, goes on, and explains itself."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.cli.written import written_to

import breakaway as bk

Call = Callable[..., Any]
COMMAND = [sys.executable, "-m", "breakaway.cli.main"]
EXAMPLE = Path(__file__).parents[2] / "examples" / "08_gentle_tuning"
TUNING = f"""
name = "feed"
population = "{EXAMPLE / "quick_parts.toml"}"
method = "steady_feed"
objectives = ["strict_share", "median_time_to_release_s"]
training_runs = 8
test_runs = {{ first = 100, runs = 16 }}
evaluations = 6
[constraints]
released_share = {{ at_least = 0.5 }}
[tune.controller]
speed_m_per_s = {{ low = 0.01, high = 0.04 }}
"""
FIGURES = {
    f"{name}.{kind}"
    for name in ("history", "pareto", "slices_strict_share", "slices_median_time_to_release_s")
    for kind in ("png", "svg")
}


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave figures out, which take longer than the evaluations."""
    monkeypatch.setattr("breakaway.ask.tuning.writing._draw", lambda *_: None)


def write(tmp_path: Path, **changes: str) -> Path:
    text = TUNING
    for old, new in changes.items():
        text = text.replace(f"{old} = ", f"{new}  # ", 1)
    path = tmp_path / "feed.toml"
    path.write_text(text)
    return path


@pytest.mark.slow
def test_a_tuning_says_its_result_and_lists_its_files(call: Call, tmp_path: Path) -> None:
    path, out = write(tmp_path), tmp_path / "out"
    shown = call("tune", path, "--out", out)
    assert (shown.exit_code, shown.stderr) == (0, "")
    summary = json.loads((out / "summary.json").read_text())
    for sentence in [*summary["result"], *(f"note: {note}" for note in summary["notes"])]:
        assert sentence in shown.stdout
    tables = {
        "digests.txt",
        "manifest.json",
        "summary.json",
        "evaluations.csv",
        "pareto.csv",
        "best.toml",
    }
    points = {row["file"] for row in summary["front"]}
    assert {p.name for p in out.iterdir()} == tables | points | FIGURES | {"pieces", ".lock"}
    assert written_to(out, shown.stdout) == tables | points | FIGURES
    method = bk.load_method(out / "best.toml")
    assert method.name == "steady_feed_tuned"
    speed = summary["recommended"]["numbers"]["controller.speed_m_per_s"]
    assert method.controller.speed_m_per_s == speed
    again = call("tune", path, "--out", tmp_path / "again", "--json", "--threads", "1")
    content = json.loads(again.stdout)
    files = content.pop("files")
    assert content == summary
    for file in files:
        assert Path(file).read_bytes() == (out / Path(file).name).read_bytes(), file


@pytest.mark.usefixtures("no_figures")
def test_one_objective_has_one_method(call: Call, tmp_path: Path) -> None:
    path = write(tmp_path, objectives='objectives = ["strict_share"]')
    shown = call("tune", path, "--out", tmp_path / "out", "--evaluations", "2")
    assert "as it was" in shown.stdout and "best.toml, recommended" in shown.stdout
    assert not list((tmp_path / "out").glob("pareto_*.toml"))


@pytest.mark.usefixtures("no_figures")
def test_a_folder_that_holds_a_tuning_wants_resume(call: Call, tmp_path: Path) -> None:
    path, out = write(tmp_path), tmp_path / "out"
    call("tune", path, "--out", out, "--evaluations", "2")
    refused = call("tune", path, "--out", out)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "already holds this tuning; go on with --resume" in refused.stderr
    more = call("tune", path, "--out", out, "--resume", "--json")
    assert json.loads(more.stdout)["evaluations"] == 6
    fewer = call("tune", path, "--out", out, "--resume", "--evaluations", "3")
    assert (fewer.exit_code, "give at least 6" in fewer.stderr) == (2, True)


@pytest.mark.usefixtures("no_figures")
def test_nothing_feasible_is_a_finding(call: Call, tmp_path: Path) -> None:
    path = write(tmp_path, released_share="p99_peak_over_breakaway = { at_most = 0.001 }")
    shown = call("tune", path, "--out", tmp_path / "out", "--evaluations", "2")
    assert shown.exit_code == 0
    assert "none of 2 evaluations met all constraints" in shown.stdout


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"evaluations": "evaluations = 0"}, "evaluations: 0 is not >= 1"),
        (
            {"test_runs": "test_runs = { first = 7, runs = 9 }"},
            "parts 7 to 7 would be tuned on and",
        ),
        ({"speed_m_per_s": "speed = { low = 1.0, high = 2.0 }"}, "did you mean controller.speed_m"),
        ({"method": 'method = "steady_fed"'}, "did you mean steady_feed?"),
    ],
)
def test_a_wrong_tuning_exits_with_2(
    call: Call, tmp_path: Path, changes: dict[str, str], words: str
) -> None:
    path = write(tmp_path, **changes)
    failed = call("tune", path, "--out", tmp_path / "out", "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith(f"error: {path}: ")
    assert words in failed.stderr
    assert not (tmp_path / "out").exists()


def test_a_missing_file_a_missing_extra_and_an_unwritable_place(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = call("tune", tmp_path / "none.toml", "--out", tmp_path / "out")
    assert (missing.exit_code, "there is no such file" in missing.stderr) == (2, True)
    (tmp_path / "file").write_text("")
    failed = call("tune", write(tmp_path), "--out", tmp_path / "file" / "out")
    assert (failed.exit_code, "cannot be written" in failed.stderr) == (3, True)
    monkeypatch.setitem(sys.modules, "optuna", None)
    failed = call("tune", write(tmp_path), "--out", tmp_path / "out")
    assert (failed.exit_code, "pip install 'breakaway[tune]'" in failed.stderr) == (2, True)


def test_a_tuning_does_not_write_over_its_file(call: Call, tmp_path: Path) -> None:
    path = write(tmp_path).rename(tmp_path / "best.toml")
    failed = call("tune", path, "--out", tmp_path)
    assert (failed.exit_code, "is the file that was read" in failed.stderr) == (3, True)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_says_how_to_go_on(tmp_path: Path) -> None:
    path, out = write(tmp_path, evaluations="evaluations = 10000"), tmp_path / "out"
    process = subprocess.Popen(
        [*COMMAND, "tune", str(path), "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "100"},
    )
    evaluations = out / "pieces" / "evaluations.jsonl"
    try:
        while not evaluations.exists() or evaluations.read_bytes().count(b"\n") < 3:
            assert process.poll() is None, process.communicate()
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, stdout) == (130, "")
    assert stderr == (
        f"what is finished is kept; go on with: breakaway tune {path} --out {out} --resume\n"
        "interrupted\n"
    )


def test_the_example_is_a_tuning() -> None:
    tuning = bk.load_tuning(EXAMPLE / "timed_impacts.toml")
    assert tuning.start is not None
    assert tuning.training_runs == 256
