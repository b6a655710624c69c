"""`breakaway study` runs, goes on, and explains itself."""

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
from breakaway.ask.durable.progress import Progress
from breakaway.cli.progress import progress_in_words

Call = Callable[..., Any]
COMMAND = [sys.executable, "-m", "breakaway.cli.main"]
COMMON = 'scenario = "quick.toml"\nruns = 30\nmetrics = ["peak_force_n", "time_to_release_s"]\n'
STUDIES = {
    "sweep": '[sweep.grid]\n"joint.stiction_n" = { from = 400.0, to = 500.0, count = 50 }\n',
    "robustness": '[robustness]\nover = "disturbance.var"\nlow = 0.1\nhigh = 0.5\n'
    'resolution = 0.1\nfailure_probability_max = 0.1\nfailure = ["diverged"]\n',
    "sensitivity": "[vary]\n"
    'joint.stiction_n = { distribution = "uniform", low = 400.0, high = 500.0 }\n',
    "compare": '[[compare.controllers]]\nname = "one"\n[[compare.controllers]]\nname = "two"\n'
    "changes = { controller.gains.settling_time_s = 1e-3 }\n",
}
TABLES = {
    "sweep": {"points.csv", "sweep.png", "sweep.svg"},
    "robustness": {"trail.csv", "robustness.png", "robustness.svg"},
    "sensitivity": {"indices.csv", "sensitivity.png", "sensitivity.svg"},
    "compare": {"outcomes.csv", "differences.csv", "compare.png", "compare.svg"},
}
ALWAYS = {"digests.txt", "manifest.json", "summary.json", "study.toml"}


def write(tmp_path: Path, kind: str, /, **changes: str) -> Path:
    quick = {"disturbance.var": 0.2, "timing.duration_s": 0.002}
    bk.save_scenario(bk.load_scenario("paper_as_computed").with_(quick), tmp_path / "quick.toml")
    text = f'kind = "{kind}"\n{COMMON}{STUDIES[kind]}'
    if kind == "sensitivity":
        text = text.replace("runs = 30", "runs = 32")
    for old, new in changes.items():
        text = text.replace(f"{old} = ", f"{new}  # ", 1)
    path = tmp_path / f"{kind}.toml"
    path.write_text(text)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kind", STUDIES)
def test_every_kind_says_its_result_and_lists_its_files(
    call: Call, tmp_path: Path, kind: str
) -> None:
    if kind == "sensitivity":
        pytest.importorskip("SALib")
    out = tmp_path / "out"
    shown = call("study", write(tmp_path, kind), "--out", out)
    assert (shown.exit_code, shown.stderr) == (0, "")
    summary = json.loads((out / "summary.json").read_text())
    for sentence in summary["result"]:
        assert sentence in shown.stdout
    names = ALWAYS | TABLES[kind]
    assert {path.name for path in out.iterdir()} == names | {"pieces", ".lock"}
    assert written_to(out, shown.stdout) == names
    again = call("study", out / "study.toml", "--out", tmp_path / "again", "--json")
    content = json.loads(again.stdout)
    assert content.pop("files") == [str(tmp_path / "again" / name) for name in sorted(names)]
    assert content == summary
    for name in sorted(names):
        assert (out / name).read_bytes() == (tmp_path / "again" / name).read_bytes(), name


@pytest.mark.slow
def test_long_tables_say_where_the_rest_is(call: Call, tmp_path: Path) -> None:
    shown = call("study", write(tmp_path, "sweep"), "--out", tmp_path / "out")
    assert "the first 40 rows; points.csv has all" in shown.stdout
    assert len((tmp_path / "out" / "points.csv").read_text().splitlines()) == 51


@pytest.mark.slow
def test_a_folder_that_holds_a_study_wants_resume(call: Call, tmp_path: Path) -> None:
    path, out = write(tmp_path, "compare"), tmp_path / "out"
    first = call("study", path, "--out", out)
    refused = call("study", path, "--out", out)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "already holds this study; go on with --resume" in refused.stderr
    assert call("study", path, "--out", out, "--resume", "--threads", "1").stdout == first.stdout


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"runs": "runs = 0"}, "runs: 0 is not >= 1"),
        ({"scenario": 'scenario = "quik.toml"'}, "quik.toml: is neither a file nor a preset"),
        ({"kind": 'kind = "swep"'}, "did you mean 'sweep'?"),
    ],
)
def test_a_wrong_study_exits_with_2(
    call: Call, tmp_path: Path, changes: dict[str, str], words: str
) -> None:
    path = write(tmp_path, "sweep", **changes)
    failed = call("study", path, "--out", tmp_path / "out", "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith(f"error: {path}: ")
    assert words in failed.stderr
    assert not (tmp_path / "out").exists()


def test_a_missing_file_and_an_unwritable_place(call: Call, tmp_path: Path) -> None:
    missing = call("study", tmp_path / "none.toml", "--out", tmp_path / "out")
    assert (missing.exit_code, "there is no such file" in missing.stderr) == (2, True)
    (tmp_path / "file").write_text("")
    failed = call("study", write(tmp_path, "sweep"), "--out", tmp_path / "file" / "out")
    assert (failed.exit_code, "cannot be written" in failed.stderr) == (3, True)


def test_a_study_does_not_write_over_its_file(call: Call, tmp_path: Path) -> None:
    path = write(tmp_path, "sweep").rename(tmp_path / "study.toml")
    failed = call("study", path, "--out", tmp_path)
    assert (failed.exit_code, "is the file that was read" in failed.stderr) == (3, True)
    failed = call("study", path, "--out", tmp_path, "--resume")
    assert (failed.exit_code, "but no manifest.json" in failed.stderr) == (2, True)


@pytest.mark.slow
def test_a_study_goes_on_by_its_own_file(call: Call, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert call("study", write(tmp_path, "sweep"), "--out", out).exit_code == 0
    before = (out / "study.toml").read_bytes()
    (out / "summary.json").unlink()
    assert call("study", out / "study.toml", "--out", out, "--resume").exit_code == 0
    assert (out / "summary.json").exists()
    assert (out / "study.toml").read_bytes() == before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_says_how_to_go_on(tmp_path: Path) -> None:
    path, out = write(tmp_path, "sweep"), tmp_path / "out"
    path.write_text(path.read_text().replace("runs = 30", "runs = 100000\nruns_per_piece = 100"))
    process = subprocess.Popen(
        [*COMMAND, "study", str(path), "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "100"},
    )
    while len(list(out.glob("pieces/piece-*"))) < 3:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout) == (130, "")
    assert stderr == (
        f"what is finished is kept; go on with: breakaway study {path} --out {out} --resume\n"
        "interrupted\n"
    )
    assert not list(out.glob("pieces/.piece-*"))


@pytest.mark.parametrize(
    ("done", "elapsed_s", "words"),
    [
        (1000, 5.0, "1000 of 9000 runs"),
        (3000, 20.0, "3000 of 9000 runs, 100 runs/s, 1 min 00 s left"),
        (3000, 0.2, "3000 of 9000 runs, 10,000 runs/s, 1 s left"),
        (1001, 10.0, "1001 of 9000 runs, 0.1 runs/s, 22 h 13 min left"),
    ],
)
def test_progress_tells_rate_and_time_left(done: int, elapsed_s: float, words: str) -> None:
    at = Progress(runs_done=done, runs_found=1000, runs_max=9000, doing="grid")
    assert progress_in_words(at, elapsed_s) == words
