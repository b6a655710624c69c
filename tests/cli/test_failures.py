"""Every failure is a message and an exit code, without a traceback or a half-written file."""

import importlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import breakaway as bk
from breakaway.measure.identification import JointFile

Call = Callable[..., Any]
COMMAND = [sys.executable, "-m", "breakaway.cli.main"]
BASE = bk.resolve(bk.load_scenario("paper_as_computed"))


def scenario_text(tmp_path: Path) -> str:
    bk.save_scenario(BASE, tmp_path / "base.toml")
    return (tmp_path / "base.toml").read_text()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("stiction_n = ", "stictoin_n = ", "did you mean stiction_n?"),
        ("mass_kg = 1.0", "mass_kg = nan", "part.mass_kg: nan is not"),
        ("mass_kg = 1.0", "mass_kg = -1.0", "part.mass_kg: -1.0 is not > 0"),
        ("mass_kg = 1.0", "mass_kg = inf", "part.mass_kg: inf is not finite"),
        ("mass_kg = 1.0", 'mass_kg = "1 kg"', "part.mass_kg: '1 kg' is not a number"),
        ("mass_kg = 1.0", "mass_kg = ", "is not TOML"),
        ('law = "lugre"', 'law = "lugr"', "did you mean 'lugre'?"),
    ],
)
@pytest.mark.parametrize("command", ["run", "design"])
def test_a_wrong_scenario_is_explained(
    call: Call, tmp_path: Path, command: str, old: str, new: str, words: str
) -> None:
    text = scenario_text(tmp_path)
    assert old in text
    path = tmp_path / "wrong.toml"
    path.write_text(text.replace(old, new))
    failed = call(command, path, "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith(f"error: {path}:")
    assert words in failed.stderr
    assert "Traceback" not in failed.stderr


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("run", "paper_as_computd"), "did you mean paper_as_computed?"),
        (("run", "paper_as_computed", "--seed", "-1"), "seed: -1 is not >= 0"),
        (("run", "paper_as_computed", "--seed", "x"), "--seed"),
        (("run", "paper_as_computed", "--joint", "none.toml"), "there is no such file"),
        (("run", "."), "cannot be read as text"),
        (("run",), "Missing argument"),
        (("runn", "paper_as_computed"), "No such command"),
        (("identify", "none.csv"), "none.csv: there is no such file"),
        (("identify", "none.csv", "--format", "xls"), "--format"),
        (("identify", "none.mat", "--format", "mat"), "none.mat: there is no such file"),
        (("identify", "none"), "none: there is no such file"),
        (("init", "x.toml", "--preset", "paper_as_print"), "did you mean paper_as_printed?"),
    ],
)
def test_a_wrong_command_line_exits_with_2(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, args: Any, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    failed = call(*args)
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert words in failed.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["", "no toml", "[part]\nmass_kg = -1.0\n", "\0"])
def test_a_broken_joint_file_exits_with_2(call: Call, tmp_path: Path, text: str) -> None:
    path = tmp_path / "joint.toml"
    path.write_text(text)
    failed = call("run", "paper_as_computed", "--joint", path)
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert failed.stderr.startswith("error: joint.toml:")


@pytest.mark.parametrize("place", ["file/out", "/dev/null/x"])
def test_an_unwritable_place_exits_with_3(
    call: Call, tmp_path: Path, log_csv: Path, place: str
) -> None:
    (tmp_path / "file").write_text("")
    target = tmp_path / place  # which is /dev/null/x for that
    for args in (
        ("run", "paper_as_computed", "--out", target),
        ("init", target),
        ("schema", "--out", target),
        ("identify", log_csv, "--out", target),
    ):
        failed = call(*args)
        assert failed.exit_code == 3, args
        assert f"{target}: cannot be written: Not a directory" in failed.stderr
    assert (tmp_path / "file").read_text() == ""


def test_an_unwritable_folder_is_found_before_the_simulation(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = importlib.import_module("breakaway.run.simulation")
    monkeypatch.setattr(home, "simulate", lambda *_: pytest.fail("simulated"))
    (tmp_path / "file").write_text("")
    assert call("run", "paper_as_computed", "--out", tmp_path / "file").exit_code == 3


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize(
    "args",
    [
        ["presets"],
        ["run", "paper_as_computed", "--json"],
        ["schema"],
        ["--help"],
        ["run", "--help"],
        ["--version"],
    ],
)
def test_a_full_disk_behind_the_output_exits_with_3(args: list[str]) -> None:
    with Path("/dev/full").open("wb") as full:
        failed = subprocess.run(
            [*COMMAND, *args], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert failed.returncode == 3
    assert failed.stderr == ("error: standard output: cannot be written: No space left on device\n")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize("args", [["run", "none.toml"], ["run", "--none"], ["none"]])
def test_a_full_disk_behind_the_error_output_keeps_the_exit_code(args: list[str]) -> None:
    with Path("/dev/full").open("wb") as full:
        failed = subprocess.run([*COMMAND, *args], stderr=full, check=False)
    assert failed.returncode == 2


@pytest.mark.slow
@pytest.mark.parametrize("args", [["schema"], ["--help"], ["study", "--help"], ["--version"]])
def test_a_reader_that_stops_is_no_crash(args: list[str]) -> None:
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(
        [*COMMAND, *args], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert (ended.returncode, ended.stderr) == (3, "")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_leaves_nothing_behind(tmp_path: Path) -> None:
    scenario, out = tmp_path / "long.toml", tmp_path / "out"
    changes = {"timing.duration_s": 20_000.0, "trace.every_samples": 1000}
    bk.save_scenario(BASE.with_(changes), scenario)
    process = subprocess.Popen(
        [*COMMAND, "run", str(scenario), "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not list(out.glob(".writing.*")):  # made right before the simulation
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout, stderr) == (130, "", "interrupted\n")
    assert not out.exists()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_ends_a_fit_with_the_best_so_far(tmp_path: Path) -> None:
    t_s = np.arange(4000) / 500.0
    x = 0.02 * np.sin(5 * t_s) + 0.01 * np.sin(13 * t_s + 1)
    v = 0.1 * np.cos(5 * t_s) + 0.13 * np.cos(13 * t_s + 1)
    log, out = tmp_path / "log.csv", tmp_path / "joint.toml"
    table = np.column_stack([t_s, x, 30.0 * np.tanh(v / 0.01) + 40.0 * v])
    np.savetxt(log, table, "%.9g", ",", header="t_s,position_m,force_n", comments="")
    script = (  # says when the fit is under way
        "import importlib, sys\n"
        "home = importlib.import_module('breakaway.measure.identification.output_error')\n"
        "plain = home.minimize\n"
        "def minimize(*args):\n"
        "    print('fitting', file=sys.stderr, flush=True)\n"
        "    return plain(*args)\n"
        "home.minimize = minimize\n"
        "from breakaway.cli.main import main\n"
        "main()\n"
    )
    args = ["identify", str(log), "--law", "lugre", "--starts", "200", "--json", "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", script, *args],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "fitting\n"
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 0, stderr[-2000:]
    assert stderr.replace("fitting", "").strip() == ""
    content = json.loads(stdout)
    assert content["complete"] is False
    assert "stopped before it finished" in content["notes"][0]
    fit = JointFile.load(out).provenance.fit
    assert fit is not None and not fit.complete
