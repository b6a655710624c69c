"""Files are there whole or not at all."""

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

import breakaway as bk
from breakaway.base.output import (
    append_inside,
    output_folder,
    remove_inside,
    remove_leftovers,
    write_atomically,
    write_inside,
)
from breakaway.base.ownership import RUN
from breakaway.errors import OutputError
from breakaway.show.run_files import run_summary, write_run


def test_write_replaces_the_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    for content in (b"long content", b"short"):
        write_atomically(path, content)
        assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]
    umask = os.umask(0o022)
    os.umask(umask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~umask


@pytest.mark.parametrize("place", ["file/a.txt", "file/none/a.txt", "folder", "/dev/null/x"])
def test_write_names_the_place_it_can_not_write(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OutputError, match="cannot be written"):
        write_atomically(tmp_path / place, b"content")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


@pytest.mark.parametrize("name", ["around", "nu\0ll", "nu\0ll/inner"])
def test_a_place_that_can_not_be_is_an_output_error(tmp_path: Path, name: str) -> None:
    (tmp_path / "around").symlink_to(tmp_path / "around")
    parts = bk.load_population("seized_parts").model_copy(update={"duration_s": 0.01})
    study = bk.SweepStudy(scenario="paper_as_computed", changes={"disturbance.var": 0.1}, runs=2)
    for write in (
        lambda place: write_atomically(place, b""),
        lambda place: bk.run_study(study, out=place),
        lambda place: bk.compare_methods(parts, ["paper_pid"], runs=2, out=place),
        lambda place: write_run(bk.simulate(study.base), place),
    ):
        with pytest.raises(OutputError, match="cannot be written"):
            write(tmp_path / name)


def test_write_makes_missing_folders(tmp_path: Path) -> None:
    write_atomically(tmp_path / "deep" / "down" / "a.txt", b"content")
    assert [path.read_bytes() for path in (tmp_path / "deep" / "down").iterdir()] == [b"content"]


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_a_failed_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    def fail(*_: object) -> None:
        raise error

    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises((OutputError, KeyboardInterrupt)):
        write_atomically(path, b"new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_devices_and_pipes_stay_what_they_are(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    write_atomically(pipe, b"content")
    reader.join()
    assert (read, pipe.is_fifo()) == ([b"content"], True)


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
def test_a_full_device_is_an_output_error() -> None:
    with pytest.raises(OutputError, match="No space left on device"):
        write_atomically(Path("/dev/full"), b"content")
    assert Path("/dev/full").is_char_device()


def test_a_folder_is_filled_at_the_end(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "out"
    with output_folder(folder, RUN) as staging:
        (staging / "a.txt").write_text("a")
        assert not (folder / "a.txt").exists()
    assert [path.name for path in folder.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_a_folder_stays_as_it_was_when_its_block_fails(
    tmp_path: Path, error: type[BaseException]
) -> None:
    (tmp_path / "a.txt").write_text("old")

    def fail_halfway() -> None:
        with output_folder(tmp_path, RUN) as staging:
            (staging / "a.txt").write_text("new")
            raise error

    with pytest.raises(error):
        fail_halfway()
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


@pytest.mark.parametrize("leads", ["file", "folder", "nowhere"])
def test_a_folder_is_not_filled_over_a_link(tmp_path: Path, leads: str) -> None:
    target, link = tmp_path / leads, tmp_path / "out" / "b.txt"
    if leads == "file":
        target.write_text("mine")
    if leads == "folder":
        target.mkdir()
    link.parent.mkdir()
    link.symlink_to(target)
    with (
        pytest.raises(OutputError, match=r"b\.txt: is a symbolic link, and nothing is written"),
        output_folder(tmp_path / "out", RUN) as staging,
    ):
        (staging / "b.txt").write_text("new")
    assert list(link.parent.iterdir()) == [link]
    assert leads != "file" or target.read_text() == "mine"


def test_a_folder_is_not_filled_over_files_of_others(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("mine")
    with (
        pytest.raises(
            OutputError, match=r"a\.txt: already exists, and there is no metrics\.json of a run"
        ),
        output_folder(tmp_path, RUN) as staging,
    ):
        (staging / "a.txt").write_text("new")
    assert (tmp_path / "a.txt").read_text() == "mine"


@pytest.mark.parametrize(
    "write", [write_inside, append_inside, lambda path, _: remove_inside(path)]
)
def test_within_a_folder_no_link_is_followed(
    tmp_path: Path, write: Callable[[Path, bytes], None]
) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("mine")
    link.symlink_to(target)
    with pytest.raises(OutputError, match="link: is a symbolic link"):
        write(link, b"new\n")
    assert link.is_symlink()
    assert target.read_text() == "mine"


def test_only_our_leftovers_are_removed(tmp_path: Path) -> None:
    others = tmp_path / "others"
    others.mkdir()
    (others / "mine.txt").write_text("mine")
    folder = tmp_path / "folder"
    (folder / ".writing.abcd_123").mkdir(parents=True)
    (folder / ".writing.abcd_123" / "inner").symlink_to(others)
    (folder / ".a.txt.0123456789abcdef").write_text("half")
    (folder / ".writing.linked00").symlink_to(others)
    (folder / ".writing.mine").mkdir()
    (folder / ".a.txt.mine").write_text("mine")
    remove_leftovers(folder)
    assert sorted(path.name for path in folder.iterdir()) == [
        ".a.txt.mine", ".writing.linked00", ".writing.mine"
    ]  # fmt: skip
    assert (others / "mine.txt").read_text() == "mine"


def test_a_run_is_summarized_without_nan() -> None:
    short = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 0.01})
    summary = run_summary(bk.simulate(short, run_index=7))
    assert summary["run_index"] == 7
    assert summary["metrics"]["time_to_release_s"] is None


@pytest.mark.slow
def test_a_numbered_run_says_how_it_runs_again(tmp_path: Path) -> None:
    noisy = bk.load_scenario("paper_as_computed").with_(
        {"disturbance.var": 0.05, "timing.duration_s": 0.02}
    )
    write_run(bk.simulate(noisy, run_index=7), tmp_path)
    text = (tmp_path / "scenario.toml").read_text()
    assert "run_index=7" in text.splitlines()[0]
    again = bk.simulate(bk.load_scenario(tmp_path / "scenario.toml"), run_index=7)
    write_run(again, tmp_path / "again")
    first, second = (folder / "trace.parquet" for folder in (tmp_path, tmp_path / "again"))
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize("limit", [100, 30_000, 300_000])
def test_a_disk_that_fills_up_leaves_an_earlier_run_whole(tmp_path: Path, limit: int) -> None:
    run = bk.simulate(bk.load_scenario("paper_as_computed"))
    write_run(run, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    script = (
        "import resource, sys\n"
        "import matplotlib.font_manager\n"  # which may write its cache
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))\n"
        "from breakaway.cli.main import main\n"
        "main()\n"
    )
    args = ["run", "paper_as_computed", "--seed", "1", "--out", str(tmp_path)]
    failed = subprocess.run(
        [sys.executable, "-c", script, *args], capture_output=True, text=True, check=False
    )
    assert (failed.returncode, failed.stdout) == (3, "")
    assert failed.stderr.startswith(f"error: {tmp_path}: cannot be written: ")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
