"""`breakaway compare` runs, goes on, and explains itself."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.cli.written import written_to

from breakaway.ask.comparison.asked import ask

Call = Callable[..., Any]
COMMAND = [sys.executable, "-m", "breakaway.cli.main"]
POPULATION = """
name = "short"
duration_s = 0.2

[parts]
stiction_n = { distribution = "log_uniform", low = 200.0, high = 400.0 }
stiction_ratio = { distribution = "uniform", low = 1.2, high = 2.0 }
presliding_m = { distribution = "uniform", low = 20e-6, high = 30e-6 }
bristle_damping_ratio = { distribution = "uniform", low = 0.3, high = 1.0 }
stribeck_velocity_m_per_s = { distribution = "uniform", low = 0.02, high = 0.2 }
mass_kg = { distribution = "uniform", low = 0.8, high = 1.2 }
engagement_length_m = { distribution = "uniform", low = 1e-3, high = 2e-3 }
var = { distribution = "uniform", low = 0.0, high = 0.3 }
hold_s = { distribution = "uniform", low = 1e-3, high = 1e-2 }
correlation_length_m = { distribution = "log_uniform", low = 1e-5, high = 1e-3 }
"""
RAMP = """
name = "{name}"
[actuator]
kind = "force"
force_max_n = 8000.0
bandwidth_hz = 1000.0
force_rate_max_n_per_s = 1e8
[controller]
kind = "force_ramp"
rate_n_per_s = {rate}
travel_m = 0.0015
"""


@pytest.fixture
def given(tmp_path: Path) -> list[str]:
    """Give the words of a small comparison, without its folder."""
    (tmp_path / "short.toml").write_text(POPULATION)
    words = ["compare", str(tmp_path / "short.toml")]
    for name, rate in (("slow", 2e3), ("fast", 1e4)):
        (tmp_path / f"{name}.toml").write_text(RAMP.format(name=name, rate=rate))
        words += ["--method", str(tmp_path / f"{name}.toml")]
    return [*words, "--laws", "lugre,two_region", "--runs", "6", "--seed", "3"]


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("breakaway.ask.comparison.comparing.write_end", lambda *_: None)


@pytest.mark.slow
def test_it_says_the_table_and_lists_its_files(
    call: Call, given: list[str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shown = call(*given, "--out", out)
    assert (shown.exit_code, shown.stderr) == (0, "")
    summary = json.loads((out / "summary.json").read_text())
    for sentence in summary["result"]:
        assert sentence in shown.stdout
    for name in ("index.html", "table.csv", "comparison.toml", "shares.svg"):
        assert name in written_to(out, shown.stdout)
    assert "lugre, field: shares of 6 parts" in shown.stdout
    assert "two_region, field: median, and 99 %" in shown.stdout
    assert re.search(r"slow +100 \(54.1 to 100\)", shown.stdout)
    assert "stack cycles" not in shown.stdout
    refused = call(*given, "--out", out)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "already holds this comparison; go on with --resume" in refused.stderr
    again = call(*given, "--out", out, "--resume", "--threads", "1", "--json")
    content = json.loads(again.stdout)
    assert content["table"] == summary["table"]
    assert str(out / "index.html") in content["files"]


@pytest.mark.slow
def test_a_comparison_runs_again_from_its_file(
    call: Call, given: list[str], tmp_path: Path
) -> None:
    first = call(*given, "--out", tmp_path / "out", "--json")
    file = tmp_path / "out" / "comparison.toml"
    again = call("compare", file, "--out", tmp_path / "again", "--json")
    one, other = (json.loads(shown.stdout) for shown in (first, again))
    assert one.pop("files") != other.pop("files")
    assert one == other
    for path in (tmp_path / "out").glob("*.*"):
        assert path.read_bytes() == (tmp_path / "again" / path.name).read_bytes(), path.name


@pytest.mark.usefixtures("no_figures")
def test_a_file_is_no_folder(call: Call, given: list[str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    failed = call(*given, "--out", str(tmp_path / "file"), "--json")
    assert (failed.exit_code, failed.stdout) == (3, "")
    assert "is a file, not a folder; give a folder" in failed.stderr
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--laws", "lugr"], "laws: 'lugr' is not one of"),
        (["--variations", "field,nine"], "variations: 'nine' is not one of field, part, none, "),
        (["--method", "steady_fed"], "did you mean steady_feed"),
        (["--runs", "0"], "runs: 0 is not >= 1"),
        (["--baseline", "none"], "baselines: 'none' is not one of slow, fast"),
    ],
)
def test_what_makes_no_sense_exits_with_2(
    call: Call, given: list[str], tmp_path: Path, words: list[str], said: str
) -> None:
    failed = call(*given, *words, "--out", str(tmp_path / "out"), "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith("error: ")
    assert said in failed.stderr
    assert "Traceback" not in failed.stderr
    assert not (tmp_path / "out").exists()


def test_an_unknown_population_exits_with_2(call: Call, tmp_path: Path) -> None:
    failed = call("compare", "seized_part", "--out", tmp_path / "out")
    assert failed.exit_code == 2
    assert "did you mean seized_parts?" in failed.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_says_how_to_go_on(given: list[str], tmp_path: Path) -> None:
    out, file = tmp_path / "my out", tmp_path / "comparison.toml"
    asked = ask(given[1], [given[3], given[5]]).model_copy(update={"runs_per_piece": 50})
    file.write_text(asked.toml())
    words = ["compare", str(file), "--out", str(out), "--runs", "100000"]
    process = subprocess.Popen(
        [*COMMAND, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "100"},
    )
    while len(list(out.glob("pieces/piece-*"))) < 1:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout) == (130, "")
    first, last = stderr.splitlines()
    assert first.startswith("what is finished is kept; go on with: breakaway compare ")
    assert first.endswith(f"--out '{out}' --runs 100000 --resume")
    assert last == "interrupted"
    assert not list(out.glob("pieces/.piece-*"))
