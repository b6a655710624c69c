"""No folder of a result takes over another one, or files of others, or writes through links."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import breakaway as bk

pytestmark = pytest.mark.slow

Call = Callable[..., Any]
SWEEP = """
kind = "sweep"
scenario = "quick.toml"
runs = 4
metrics = ["peak_force_n"]
[sweep.grid]
"joint.stiction_n" = [400.0, 500.0]
"""
TUNE = """
population = "seized_parts"
method = "steady_feed"
objectives = ["strict_share"]
training_runs = 2
evaluations = 2
test_runs = { first = 100, runs = 2 }
[tune]
"controller.speed_m_per_s" = { low = 0.01, high = 0.03 }
"""
COMMANDS = ("run", "study", "tune", "compare", "design", "export", "reproduce")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    changes = {"disturbance.var": 0.2, "timing.duration_s": 0.002}
    bk.save_scenario(bk.load_scenario("paper_as_computed").with_(changes), folder / "quick.toml")
    (folder / "sweep.toml").write_text(SWEEP)
    (folder / "tune.toml").write_text(TUNE)
    return folder


def line(command: str, inputs: Path, out: Path) -> list[object]:
    """Give the command line that writes a result of each kind."""
    given: dict[str, list[object]] = {
        "run": [inputs / "quick.toml"],
        "study": [inputs / "sweep.toml"],
        "tune": [inputs / "tune.toml"],
        "compare": ["seized_parts", "--method", "steady_feed", "--laws", "lugre", "--runs", "2"],
        "design": ["paper_as_computed"],
        "export": ["c", "paper_as_computed"],
        "reproduce": [],
    }
    return [command, *given[command], "--out", out]


MARKED = {
    "a run": ("metrics.json", '{"outcome": 1, "metrics": 1, "breakaway_version": 1}'),
    "a study, tuning or comparison": (
        "manifest.json",
        '{"format": 4, "identity": "", "breakaway_version": "", "asked": {"kind": "sweep"}}',
    ),
    "a design": ("design.json", '{"scenario": 1, "controller": 1, "gain_sets": 1}'),
    "exported C": ("interface.json", '{"breakaway_version": 1, "what": 1}'),
    "a reproduction of the paper": ("reproduction.json", '{"findings": 1, "figures": 1}'),
}
KIND_OF = {
    "run": "a run",
    "design": "a design",
    "export": "exported C",
    "reproduce": "a reproduction of the paper",
}


def listed(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize("held", MARKED)
@pytest.mark.parametrize("command", COMMANDS)
def test_another_kind_of_result_is_not_taken_over(
    call: Call, inputs: Path, tmp_path: Path, command: str, held: str
) -> None:
    if KIND_OF.get(command, "a study, tuning or comparison") == held:
        return
    name, content = MARKED[held]
    (tmp_path / name).write_text(content)
    failed = call(*line(command, inputs, tmp_path))
    assert failed.exit_code in (2, 3)
    assert failed.stderr.startswith(f"error: {tmp_path}: holds ")
    assert name in failed.stderr
    assert listed(tmp_path) == {name: content.encode()}


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("run", "scenario.toml"),
        ("run", "metrics.json"),
        ("run", "figure.png"),
        ("study", "study.toml"),
        ("study", "notes.txt"),
        ("tune", "best.toml"),
        ("compare", "index.html"),
        ("design", "design.json"),
        ("export", "CMakeLists.txt"),
        ("export", "README.md"),
        ("reproduce", "report.html"),
    ],
)
def test_files_of_others_are_not_replaced(
    call: Call, inputs: Path, tmp_path: Path, command: str, name: str
) -> None:
    (tmp_path / name).write_text("mine")
    failed = call(*line(command, inputs, tmp_path))
    assert failed.exit_code in (2, 3)
    assert name in failed.stderr
    assert "give " in failed.stderr
    assert listed(tmp_path) == {name: b"mine"}


@pytest.mark.parametrize("command", ["run", "export"])
def test_other_files_of_others_stay(call: Call, inputs: Path, tmp_path: Path, command: str) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    for _ in range(2):  # the second time over the first one's files
        assert call(*line(command, inputs, tmp_path)).exit_code == 0
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize(("command", "other"), [("study", "tuning"), ("tune", "study")])
def test_a_study_and_a_tuning_are_told_apart(
    call: Call, inputs: Path, tmp_path: Path, command: str, other: str
) -> None:
    held = {"tuning": "tune", "study": "study"}[other]
    assert call(*line(held, inputs, tmp_path / "out")).exit_code == 0
    before = listed(tmp_path)
    for more in ([], ["--resume"]):
        failed = call(*line(command, inputs, tmp_path / "out"), *more)
        assert failed.exit_code == 2
        assert f"holds a {other}, and this is a " in failed.stderr
    assert listed(tmp_path) == before


LINKS = [
    ("run", "trace.parquet"),
    ("run", "metrics.json"),
    ("design", "design.json"),
    ("export", "controller.c"),
    ("reproduce", "report.html"),
    ("study", "manifest.json"),
    ("study", ".lock"),
    ("study", "digests.txt"),
    ("study", "summary.json"),
    ("study", "pieces"),
    ("study", ".writing.abcd_123"),
    ("tune", "best.toml"),
    ("compare", "index.html"),
]


@pytest.mark.parametrize("leads", ["file", "folder", "nowhere"])
@pytest.mark.parametrize(("command", "name"), LINKS)
def test_nothing_is_written_through_a_link(
    call: Call, inputs: Path, tmp_path: Path, command: str, name: str, leads: str
) -> None:
    target, out = tmp_path / "target", tmp_path / "out"
    out.mkdir()
    if leads == "file":
        target.write_text("mine")
    if leads == "folder":
        target.mkdir()
        (target / "piece-000000.parquet").write_text("mine")
    (out / name).symlink_to(target)
    before = listed(tmp_path)
    what = line(command, inputs, out)
    if command == "export":
        what += ["--what", "controller"]
    failed = call(*what)
    assert failed.exit_code in (2, 3)
    assert failed.stderr.startswith(f"error: {out / name}: is a symbolic link")
    assert (out / name).is_symlink()
    assert [path.name for path in out.iterdir()] == [name]
    assert target.exists() == (leads != "nowhere")
    assert listed(tmp_path) == before


def linked_part(out: Path, target: Path) -> Path:
    part = out / "pieces" / "piece-000000.parquet"
    shutil.move(part, target)
    part.symlink_to(target)
    return part


def linked_summary(out: Path, target: Path) -> Path:
    shutil.move(out / "summary.json", target)
    (out / "summary.json").symlink_to(target)
    return out / "summary.json"


def linked_leftover(out: Path, target: Path) -> Path:
    target.mkdir()
    (target / "mine.txt").write_text("mine")
    leftover = out / "pieces" / ".piece-000000.parquet.0123456789abcdef"
    leftover.symlink_to(target)
    return leftover


@pytest.mark.parametrize("link", [linked_part, linked_summary, linked_leftover])
def test_resume_refuses_links_by_name(
    call: Call, inputs: Path, tmp_path: Path, link: Callable[[Path, Path], Path]
) -> None:
    out, target = tmp_path / "out", tmp_path / "target"
    assert call(*line("study", inputs, out)).exit_code == 0
    path = link(out, target)
    before = listed(tmp_path)
    failed = call(*line("study", inputs, out), "--resume")
    assert (failed.exit_code, path.is_symlink()) == (2, True)
    assert failed.stderr.startswith(f"error: {path}: is a symbolic link")
    assert listed(tmp_path) == before


@pytest.mark.parametrize("command", ["run", "study"])
def test_the_folder_itself_may_be_a_link(
    call: Call, inputs: Path, tmp_path: Path, command: str
) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "results").symlink_to(tmp_path / "disk")
    assert call(*line(command, inputs, tmp_path / "results")).exit_code == 0
    assert (tmp_path / "results").is_symlink()
    assert len(list((tmp_path / "disk").iterdir())) > 4


def test_an_earlier_run_is_replaced_whole(call: Call, inputs: Path, tmp_path: Path) -> None:
    """A trace of the earlier one does not stay, and a link in its place is not removed."""
    bk.save_scenario(
        bk.load_scenario(inputs / "quick.toml").with_({"trace.every_samples": 0}),
        tmp_path / "bare.toml",
    )
    out, target = tmp_path / "out", tmp_path / "target"
    assert call(*line("run", inputs, out)).exit_code == 0
    shutil.copytree(out, tmp_path / "linked")
    assert call("run", tmp_path / "bare.toml", "--out", out).exit_code == 0
    assert {path.name for path in out.iterdir()} == {"scenario.toml", "metrics.json"}
    link = tmp_path / "linked" / "trace.csv"
    link.rename(target)
    link.symlink_to(target)
    assert call("run", tmp_path / "bare.toml", "--out", tmp_path / "linked").exit_code == 3
    assert link.is_symlink() and target.exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize("name", [".lock", "digests.txt", "manifest.json", "summary.json"])
def test_a_pipe_in_a_folder_is_not_waited_for(
    call: Call, inputs: Path, tmp_path: Path, name: str
) -> None:
    out = tmp_path / "out"
    assert call(*line("study", inputs, out)).exit_code == 0
    (out / name).unlink()
    os.mkfifo(out / name)
    ended = call(*line("study", inputs, out), "--resume")
    assert ended.exit_code == {"summary.json": 0, ".lock": 3}.get(name, 2)
    assert name == "summary.json" or f"error: {out / name}: " in ended.stderr
