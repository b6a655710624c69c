"""Whatever ends a study, what was finished stays, and going on gives the same bytes."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from breakaway.ask.durable.journal import DIGESTS, Journal
from breakaway.ask.durable.manifest import identity_of
from breakaway.ask.studies import load_study, open_study, run_study
from breakaway.ask.studies.files import parse_study
from breakaway.errors import OutputError, StudyError

SCRIPT = """
import resource, sys
from breakaway.ask.studies import load_study, run_study
full_at = int(sys.argv[3])
def progress(at):
    if full_at and at.runs_done >= full_at:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
run_study(load_study(sys.argv[1]), out=sys.argv[2], resume=True, threads=1, progress=progress)
"""
FIGURES = (".png", ".svg")
SPREAD = {"distribution": "normal", "mean": 550.0, "std": 6.25}


@pytest.fixture(scope="module")
def robustness(pushed):
    """Give a study of many small pieces, whose levels depend on what was found."""
    return parse_study(
        {
            "kind": "robustness",
            "scenario": pushed,
            "runs": 100,
            "runs_per_piece": 10,
            "metrics": ["peak_force_n"],
            "vary": {"joint.stiction_n": SPREAD},
            "robustness": {
                "over": "part_scale",
                "low": 0.5,
                "high": 8.0,
                "resolution": 0.5,
                "failure_probability_max": 0.1,
            },
        }
    )


@pytest.fixture(scope="module")
def whole(robustness, tmp_path_factory):
    """Give the folder of the study that nothing interrupted."""
    folder = tmp_path_factory.mktemp("studies") / "whole"
    run_study(robustness, out=folder)
    return folder


@pytest.fixture(autouse=True)
def no_figures(monkeypatch):
    """Leave figures out, which take longer than the studies; processes of their own draw them."""
    monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def assert_same(folder: Path, whole: Path, figures: bool = False) -> None:
    """Assert that folders have the same files with the same bytes."""
    found, expected = contents(folder), contents(whole)
    if not figures:
        found, expected = without_figures(found), without_figures(expected)
    assert set(found) == set(expected)
    assert [name for name in expected if found[name] != expected[name]] == []


def without_figures(content: dict[str, bytes]) -> dict[str, bytes]:
    """Leave out figures, and their digests."""
    kept = {name: data for name, data in content.items() if name[-4:] not in FIGURES}
    lines = kept[DIGESTS].decode().splitlines()
    return kept | {DIGESTS: "\n".join(line for line in lines if line[-4:] not in FIGURES).encode()}


def begin(study_file: Path, folder: Path, full_at: int = 0) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(study_file), str(folder), str(full_at)],
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def study_file(whole, tmp_path):
    return shutil.copy(whole / "study.toml", tmp_path / "study.toml")


@pytest.mark.slow
def test_the_folder_says_all(whole, robustness):
    manifest = json.loads((whole / "manifest.json").read_text())
    assert manifest["seed"] == 0
    assert manifest["scenario"]["controller"]["gains"]["kind"] == "given"
    assert manifest["columns"][0] == {"name": "point", "type": "int32", "unit": "1"}
    assert {"numpy", "scipy"} <= set(manifest["libraries"])
    done = open_study(whole)
    assert done.finished
    assert done.study == robustness
    assert {path.name for path in whole.iterdir()} == {
        ".lock", "digests.txt", "manifest.json", "pieces", "robustness.png", "robustness.svg",
        "study.toml", "summary.json", "trail.csv",
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_kill_9_at_random_moments_loses_no_finished_piece(study_file, whole, tmp_path):
    folder, moments = tmp_path / "killed", random.Random(5)
    total = len(open_study(whole).piece_files)
    seen = []
    for target in sorted(moments.sample(range(total), 3)):
        process = begin(study_file, folder)
        while len(list((folder / "pieces").glob("piece-*"))) < target:
            assert process.poll() is None, process.communicate()
            time.sleep(0.004)
        time.sleep(0.01 * moments.random())
        process.send_signal(signal.SIGKILL)
        process.communicate()
        after = contents(folder)
        kept = {name: data for name, data in after.items() if name.startswith("pieces/piece-")}
        assert kept.items() <= contents(whole).items()  # nothing is half there
        seen.append(len(kept))
        assert open_study(folder).dataset.count_rows() == 10 * len(kept)
    assert seen == sorted(seen)
    assert seen[-1] > 0
    times = {path: path.stat().st_mtime_ns for path in (folder / "pieces").glob("piece-*")}
    process = begin(study_file, folder)
    assert (process.communicate()[1], process.returncode) == ("", 0)
    assert_same(folder, whole, figures=True)
    assert {path: path.stat().st_mtime_ns for path in times} == times  # not computed again


def test_ctrl_c_keeps_finished_pieces(robustness, whole, tmp_path):
    folder = tmp_path / "interrupted"

    def stop(at):
        if at.runs_done >= 105:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(robustness, out=folder, progress=stop)
    done = open_study(folder)
    assert (done.finished, len(done.piece_files)) == (False, 10)
    assert repr(done) == "<study 'study', robustness, not finished, 10 pieces>"
    assert done.dataset.count_rows() == 100
    with pytest.raises(StudyError, match=r"is not finished \(10 pieces are\); go on with --resume"):
        _ = done.summary
    found = []
    run_study(robustness, out=folder, resume=True, progress=lambda at: found.append(at.runs_found))
    assert found[-1] == 100
    assert_same(folder, whole)


def test_a_finished_study_computes_nothing(robustness, whole, tmp_path, monkeypatch):
    folder = shutil.copytree(whole, tmp_path / "done")
    monkeypatch.setattr(
        "breakaway.ask.studies.points.simulate_many", lambda *_, **__: pytest.fail("simulated")
    )
    run_study(robustness, out=folder, resume=True)
    assert_same(folder, whole)


def test_without_resume_a_study_is_left_alone(robustness, whole):
    before = contents(whole)
    with pytest.raises(StudyError, match=r"already holds this study; go on with --resume"):
        run_study(robustness, out=whole)
    assert contents(whole) == before


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"runs": 400}, "study.runs is 100 there and 400 now"),
        ({"seed": 3}, "study.seed is null there and 3 now"),
        ({"runs_per_piece": 20}, "study.runs_per_piece is 10 there and 20 now"),
    ],
)
def test_another_study_is_refused(robustness, whole, changes, words):
    other = robustness.model_copy(update=changes)
    for resume in (True, False):
        with pytest.raises(StudyError, match="holds another study: ") as error:
            run_study(other, out=whole, resume=resume)
        assert words in str(error.value)


def test_another_version_is_refused(robustness, whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "old")
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text())
    manifest["breakaway_version"] = "0.0.1"
    manifest["identity"] = identity_of(manifest)
    path.write_text(json.dumps(manifest))
    with pytest.raises(StudyError, match=r'breakaway_version is "0\.0\.1" there and'):
        run_study(robustness, out=folder, resume=True)


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"format": 4, "identity": 1, "asked": {}}'])
def test_a_broken_manifest_is_no_crash(robustness, tmp_path, text):
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(StudyError, match=r"manifest\.json"):
        run_study(robustness, out=tmp_path, resume=True)


def test_a_description_may_change(robustness, whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "renamed")
    run_study(robustness.model_copy(update={"description": "new"}), out=folder, resume=True)


def test_damaged_pieces_are_computed_again_and_said(robustness, whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "damaged")
    cut, flipped, empty, swapped, gone = (
        folder / "pieces" / f"piece-{number:06d}.parquet" for number in range(1, 6)
    )
    cut.write_bytes(cut.read_bytes()[:-20])
    content = bytearray(flipped.read_bytes())
    content[len(content) // 8] ^= 0x10
    flipped.write_bytes(content)
    empty.write_bytes(b"")
    shutil.copy(folder / "pieces" / "piece-000000.parquet", swapped)
    gone.unlink()
    said = []
    run_study(robustness, out=folder, resume=True, notice=said.append)
    assert_same(folder, whole)
    assert [sentence.split()[0] for sentence in said] == [
        path.name for path in (cut, flipped, empty, swapped)
    ]
    assert all(sentence.endswith("its 10 runs are computed again") for sentence in said)


@pytest.mark.parametrize("place", range(0, 4000, 97))
def test_no_flipped_bit_goes_unseen(whole, tmp_path, place):
    """In the data, their headers, the statistics or the footer."""
    name = "pieces/piece-000000.parquet"
    (tmp_path / "pieces").mkdir()
    content = bytearray((whole / name).read_bytes())
    pieces = Journal(tmp_path, "identity")
    pieces.write(name, bytes(content))
    content[place % len(content)] ^= 0x04
    (tmp_path / name).write_bytes(content)
    assert "is not the one that was written" in str(Journal(tmp_path, "identity").flaw(name))
    assert "is not the one that was written" in str(pieces.flaw(name))


def test_leftovers_are_removed(robustness, whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "left")
    (folder / "pieces" / ".piece-000099.parquet.0123456789abcdef").write_text("half")
    (folder / ".writing.abcd_123").mkdir()
    (folder / ".writing.abcd_123" / "figure.png").write_text("half")
    shutil.copy(
        folder / "pieces" / "piece-000000.parquet", folder / "pieces" / "piece-000999.parquet"
    )
    said = []
    run_study(robustness, out=folder, resume=True, notice=said.append)
    assert said == ["piece-000999.parquet does not belong to the study and was removed"]
    assert_same(folder, whole)


@pytest.mark.skipif(sys.platform == "win32", reason="locks of POSIX")
def test_one_process_at_a_time(robustness, whole, tmp_path):
    folder = tmp_path / "shared"
    refused = []

    def also(at):
        if not refused:
            with pytest.raises(StudyError, match="another process is running this study"):
                run_study(robustness, out=folder, resume=True)
            refused.append(at)

    run_study(robustness, out=folder, progress=also)
    assert refused
    assert_same(folder, whole)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize("full_at", [1, 205])
def test_a_full_disk_keeps_what_is_finished(study_file, whole, tmp_path, full_at):
    """The limit on the size of files stands for the disk: both fail in the midst of a write."""
    folder = tmp_path / "full"
    process = begin(study_file, folder, full_at)
    _, stderr = process.communicate()
    assert process.returncode != 0
    last = stderr.strip().splitlines()[-1]
    assert last.startswith("breakaway.errors.OutputError: ")
    assert "cannot be written" in last
    assert last.endswith("what is finished stays: resume it to go on")
    kept = contents(folder)
    digests = set(kept.pop(DIGESTS).split(b"\n"))
    assert digests <= set(contents(whole)[DIGESTS].split(b"\n"))
    assert kept.items() <= contents(whole).items()
    assert 1 < len(kept) <= 1 + full_at // 10 if full_at > 1 else len(kept) == 1
    run_study(load_study(study_file), out=folder, resume=True)
    assert_same(folder, whole)


def test_a_folder_that_can_not_take_the_manifest_is_not_left_behind(
    robustness, tmp_path, monkeypatch
):
    def full(*_):
        raise OutputError("full")

    monkeypatch.setattr("breakaway.ask.durable.resume.write_inside", full)
    with pytest.raises(OutputError, match="full"):
        run_study(robustness, out=tmp_path / "new")
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_is_no_folder_is_refused(robustness, tmp_path):
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / "file" / "out"):
        with pytest.raises(OutputError, match=r"cannot be written: (is a file|Not a dir)"):
            run_study(robustness, out=place)
    assert (tmp_path / "file").read_text() == ""


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes all")
def test_a_read_only_folder_is_refused(robustness, tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    with pytest.raises(OutputError, match="cannot be written: Permission denied"):
        run_study(robustness, out=folder)
    assert list(folder.iterdir()) == []


def test_a_folder_of_others_is_refused(robustness, tmp_path):
    (tmp_path / "pieces").mkdir()
    (tmp_path / "pieces" / "mine.parquet").write_text("")
    with pytest.raises(
        StudyError, match=r"holds pieces/mine.parquet but no manifest\.json; a study starts"
    ):
        run_study(robustness, out=tmp_path)
