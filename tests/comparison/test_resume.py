"""Whatever ends a comparison, what was finished stays, and going on gives the same bytes."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as arrow
import pyarrow.parquet as parquet
import pytest

import breakaway as bk
from breakaway.ask.comparison.asked import Asked

SCRIPT = """
import sys
import breakaway as bk
bk.compare_methods(sys.argv[1], out=sys.argv[2], resume=True, threads=1)
"""


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave figures and page out, which take longer than the trials."""
    monkeypatch.setattr("breakaway.ask.comparison.comparing.write_end", lambda *_: None)


@pytest.fixture(scope="module")
def small(whole: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a comparison in many files, as TOML."""
    asked = Asked.parse(
        bk.compare_methods(whole / "comparison.toml", runs=1).asked.model_dump()
        | {"runs": 24, "runs_per_piece": 2}
    )
    path = tmp_path_factory.mktemp("small") / "small.toml"
    path.write_text(asked.toml())
    return path


@pytest.mark.slow
def test_threads_do_not_matter(inputs, whole, tmp_path):
    population, methods = inputs
    bk.compare_methods(
        population, methods, laws=["lugre", "elasto_plastic"], runs=24, out=tmp_path, threads=1
    )
    assert contents(tmp_path) == contents(whole)


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_killed_process_loses_no_finished_part(small, tmp_path):
    undisturbed, folder = tmp_path / "undisturbed", tmp_path / "killed"
    bk.compare_methods(small, out=undisturbed)
    process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(small), str(folder)])
    while len(list((folder / "pieces").glob("piece-*"))) < 5:
        assert process.poll() is None
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    kept = {p: p.stat().st_mtime_ns for p in (folder / "pieces").glob("piece-*")}
    assert 5 <= len(kept) < 72
    assert not (folder / "summary.json").exists()
    found = []
    bk.compare_methods(
        small, out=folder, resume=True, progress=lambda at: found.append(at.runs_found)
    )
    assert found[-1] == 2 * len(kept)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept  # not computed again
    assert contents(folder) == contents(undisturbed)


@pytest.mark.usefixtures("no_figures")
def test_ctrl_c_keeps_finished_pieces(small, tmp_path):
    def stop(at):
        if at.runs_done >= 31:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bk.compare_methods(small, out=tmp_path / "out", progress=stop)
    assert len(list((tmp_path / "out" / "pieces").iterdir())) == 15


def test_a_finished_comparison_computes_and_draws_nothing(whole, tmp_path, monkeypatch):
    folder = shutil.copytree(whole, tmp_path / "done")
    for name in ("run_trial", "write_end"):
        monkeypatch.setattr(
            f"breakaway.ask.comparison.comparing.{name}", lambda *_, **__: pytest.fail("again")
        )
    bk.compare_methods(folder / "comparison.toml", out=folder, resume=True)
    assert contents(folder) == contents(whole)


@pytest.mark.slow
def test_a_missing_file_of_the_end_is_made_again(whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "done")
    (folder / "course_2_lugre_field.svg").unlink()
    bk.compare_methods(folder / "comparison.toml", out=folder, resume=True)
    assert contents(folder) == contents(whole)


@pytest.mark.usefixtures("no_figures")
def test_damaged_pieces_are_computed_again_and_said(whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "damaged")
    files = sorted((folder / "pieces").iterdir())
    files[0].write_bytes(files[0].read_bytes()[:-20])
    content = bytearray(files[1].read_bytes())
    content[len(content) // 3] ^= 0x10
    files[1].write_bytes(content)
    shutil.copy(files[3], files[2])  # the same parts under another law
    (folder / "pieces" / "piece-000099.parquet").write_bytes(b"")
    said = []
    bk.compare_methods(folder / "comparison.toml", out=folder, resume=True, notice=said.append)
    assert contents(folder) == contents(whole)
    assert [sentence.split()[0] for sentence in said[:3]] == [path.name for path in files[:3]]
    assert all(sentence.endswith("its 24 parts are computed again") for sentence in said[:3])
    assert said[3] == "piece-000099.parquet does not belong to the comparison and was removed"


@pytest.mark.usefixtures("no_figures")
def test_a_foreign_piece_is_computed_again_and_said(whole, tmp_path):
    """The same parts and columns, but for what became of them."""
    folder = shutil.copytree(whole, tmp_path / "mixed")
    path = folder / "pieces" / "piece-000001.parquet"
    table = parquet.read_table(path)
    place = table.schema.get_field_index("largest_jump_m")
    moved = arrow.array(table["largest_jump_m"].to_numpy() * 2.0)
    table = table.set_column(place, table.schema.field(place), moved)
    parquet.write_table(table, path, write_page_checksum=True)
    said = []
    done = bk.compare_methods(
        folder / "comparison.toml", out=folder, resume=True, notice=said.append
    )
    assert len(said) == 1 and said[0].startswith("piece-000001.parquet is not the one that was ")
    assert contents(folder) == contents(whole)
    assert done.table == bk.compare_methods(whole / "comparison.toml").table


@pytest.mark.slow
def test_an_edited_table_is_written_anew(whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "edited")
    (folder / "table.csv").write_text("mine")
    bk.compare_methods(folder / "comparison.toml", out=folder, resume=True)
    assert contents(folder) == contents(whole)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"runs": 23}, "comparison.runs is 24 there and 23 now"),
        ({"seed": 1}, "comparison.seed is 0 there and 1 now"),
        ({"laws": ["lugre"]}, "comparison.laws is "),
        ({"methods": ["steady_feed", "paper_pid", "paper_fm"]}, "comparison.methods."),
    ],
)
def test_another_comparison_is_refused(whole, changes, words):
    before = contents(whole)
    for resume in (True, False):
        with pytest.raises(bk.StudyError, match="holds another comparison: ") as error:
            bk.compare_methods(whole / "comparison.toml", out=whole, resume=resume, **changes)
        assert words in str(error.value)
    assert contents(whole) == before


def test_without_resume_a_comparison_is_left_alone(whole):
    with pytest.raises(bk.StudyError, match="already holds this comparison; go on with --resume"):
        bk.compare_methods(whole / "comparison.toml", out=whole)


def test_a_place_that_is_no_folder_is_refused(inputs, tmp_path):
    population, methods = inputs
    (tmp_path / "file").write_text("mine")
    with pytest.raises(bk.OutputError, match="is a file, not a folder; give a folder"):
        bk.compare_methods(population, methods, out=tmp_path / "file")
    with pytest.raises(bk.OutputError, match="cannot be written"):
        bk.compare_methods(population, methods, out=tmp_path / "file" / "out")
    assert (tmp_path / "file").read_text() == "mine"
