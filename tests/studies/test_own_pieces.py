"""A study believes its own pieces only: none of another study, edited, swapped or stale."""

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow as arrow
import pyarrow.parquet as parquet
import pytest

from breakaway.ask.durable.journal import DIGESTS, Journal, digest_of
from breakaway.ask.durable.manifest import FORMAT, identity_of
from breakaway.ask.studies import open_study, run_study
from breakaway.ask.studies.files import parse_study
from breakaway.errors import StudyError

PIECE = "pieces/piece-000001.parquet"


@pytest.fixture(scope="module")
def asked(quick):
    """Give a study whose runs differ in what is drawn."""
    spread = {"distribution": "uniform", "low": 400.0, "high": 500.0}
    return parse_study(
        {
            "kind": "sweep",
            "scenario": quick,
            "runs": 30,
            "runs_per_piece": 10,
            "metrics": ["peak_force_n"],
            "vary": {"joint.stiction_n": spread},
        }
    )


@pytest.fixture(autouse=True)
def no_figures(monkeypatch):
    """Leave figures out, which take longer than the studies."""
    monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)


@pytest.fixture
def whole(asked, tmp_path):
    run_study(asked, out=tmp_path / "whole")
    return tmp_path / "whole"


@pytest.fixture
def other(asked, tmp_path):
    """Give the same study of another seed: same columns, same numbers of runs."""
    run_study(
        parse_study(asked.model_dump(exclude_none=True) | {"seed": 7}), out=tmp_path / "other"
    )
    return tmp_path / "other"


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def median(folder: Path) -> float:
    """Give the median peak force, from the files alone."""
    found = [parquet.read_table(path)["peak_force_n"] for path in (folder / "pieces").iterdir()]
    return float(np.median(arrow.chunked_array([c for column in found for c in column.chunks])))


def from_another(folder: Path, other: Path) -> None:
    shutil.copy(other / PIECE, folder / PIECE)


def with_its_digest(folder: Path, other: Path) -> None:
    shutil.copy(other / PIECE, folder / PIECE)
    lines = (folder / DIGESTS).read_text().splitlines(keepends=True)
    theirs = next(line for line in (other / DIGESTS).read_text().splitlines(True) if PIECE in line)
    (folder / DIGESTS).write_text("".join(theirs if PIECE in line else line for line in lines))


def edited(folder: Path, _: Path) -> None:
    """Rewritten by pyarrow, so that all checksums of the format hold."""
    table = parquet.read_table(folder / PIECE)
    place = table.schema.get_field_index("peak_force_n")
    moved = arrow.array(table["peak_force_n"].to_numpy() + 1.0)
    table = table.set_column(place, table.schema.field(place), moved)
    parquet.write_table(table, folder / PIECE, write_page_checksum=True)


def swapped(folder: Path, _: Path) -> None:
    shutil.copy(folder / "pieces" / "piece-000002.parquet", folder / PIECE)


def without_digest(folder: Path, _: Path) -> None:
    lines = (folder / DIGESTS).read_text().splitlines(keepends=True)
    (folder / DIGESTS).write_text("".join(line for line in lines if PIECE not in line))


FOREIGN = [from_another, with_its_digest, edited, swapped, without_digest]


@pytest.mark.slow
@pytest.mark.parametrize("put", FOREIGN)
def test_a_foreign_piece_is_computed_again_with_a_word(asked, whole, other, put):
    before, right = contents(whole), median(whole)
    put(whole, other)
    said = []
    done = run_study(asked, out=whole, resume=True, notice=said.append)
    assert len(said) == 1
    assert said[0].startswith("piece-000001.parquet ")
    assert said[0].endswith("; its 10 runs are computed again")
    assert contents(whole) == before
    assert median(whole) == right
    assert done.summary["tables"]["points"][0]["peak_force_n_median"] == right


def test_a_foreign_piece_would_have_moved_the_median(whole, other):
    """So that the test above can fail."""
    right = median(whole)
    from_another(whole, other)
    assert median(whole) != right


@pytest.mark.parametrize("put", FOREIGN)
def test_a_foreign_piece_is_not_read(whole, other, put):
    put(whole, other)
    done = open_study(whole)
    assert not done.finished
    for read in (done.scan, lambda: done.dataset, lambda: done.replay(0, 0)):
        with pytest.raises(StudyError, match=r"piece-000001\.parquet: .*; go on with --resume"):
            read()
    with pytest.raises(StudyError, match=r"piece-000001\.parquet: "):
        _ = done.summary


def test_a_piece_that_was_read_once_is_looked_at_again(whole, other):
    done = open_study(whole)
    assert done.scan().num_rows == 30
    from_another(whole, other)
    with pytest.raises(StudyError, match=r"piece-000001\.parquet: is not the one"):
        done.scan()


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_missing_piece_is_not_finished(asked, whole, number):
    before = contents(whole)
    (whole / "pieces" / f"piece-00000{number}.parquet").unlink()
    done = open_study(whole)
    assert not done.finished
    with pytest.raises(StudyError, match=rf"piece-00000{number}\.parquet: is missing; go on with"):
        done.scan()
    run_study(asked, out=whole, resume=True)
    assert contents(whole) == before


def test_a_piece_too_many_is_not_read(whole):
    shutil.copy(whole / PIECE, whole / "pieces" / "piece-000003.parquet")
    with pytest.raises(StudyError, match=r"piece-000003\.parquet: has no digest"):
        open_study(whole).scan()


def test_files_of_others_among_the_pieces_are_left_alone(asked, whole):
    for name in ("part-mine.parquet", "notes.txt"):
        (whole / "pieces" / name).write_text("mine")
    assert open_study(whole).scan().num_rows == 30
    run_study(asked, out=whole, resume=True, notice=lambda said: pytest.fail(said))
    assert (whole / "pieces" / "part-mine.parquet").read_text() == "mine"


def test_an_edited_summary_is_refused_and_written_anew(asked, whole):
    before = contents(whole)
    path = whole / "summary.json"
    path.write_text(path.read_text().replace('"runs": 30', '"runs": 31'))
    done = open_study(whole)
    assert not done.finished
    with pytest.raises(StudyError, match=r"summary\.json: is not the one that was written"):
        _ = done.summary
    run_study(asked, out=whole, resume=True)
    assert contents(whole) == before


@pytest.mark.parametrize("damage", [b"", b"\xff\xfe\n", b"no digest\n", b"0" * 70])
def test_a_damaged_list_of_digests_costs_time_only(asked, whole, damage):
    before = contents(whole)
    (whole / DIGESTS).write_bytes(damage)
    said = []
    run_study(asked, out=whole, resume=True, notice=said.append)
    assert [sentence.partition(";")[0] for sentence in said] == [
        f"piece-00000{number}.parquet has no digest in digests.txt" for number in range(3)
    ]
    assert contents(whole) == before


@pytest.mark.parametrize("name", ["../note", "pieces/../../note", "/note", ".", "pieces/.."])
def test_a_digest_names_no_file_beyond_its_folder(asked, whole, name):
    before = contents(whole)
    (whole.parent / "note").write_text("of somebody else")
    with (whole / DIGESTS).open("a") as file:
        file.write(f"{'0' * 64}  {name}\n")
    assert name not in Journal(whole, "identity").names()
    _ = open_study(whole).summary
    run_study(asked, out=whole, resume=True, notice=lambda sentence: pytest.fail(sentence))
    assert contents(whole) == before


def test_a_line_that_was_not_finished_does_not_spoil_the_next(tmp_path):
    pieces = Journal(tmp_path, "identity")
    pieces.write("a", b"content")
    with (tmp_path / DIGESTS).open("ab") as file:
        file.write(b"0123")
    pieces = Journal(tmp_path, "identity")
    pieces.settle(pieces.names())
    pieces.write("b", b"content")
    assert Journal(tmp_path, "identity").names() == ["a", "b"]


def test_a_digest_is_there_before_its_file(tmp_path, monkeypatch):
    def killed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("breakaway.ask.durable.journal.write_inside", killed)
    with pytest.raises(KeyboardInterrupt):
        Journal(tmp_path, "identity").write("a", b"content")
    again = Journal(tmp_path, "identity")
    assert (again.names(), again.flaw("a")) == (["a"], "is missing")


def test_a_digest_covers_identity_name_and_content():
    digests = {
        digest_of(*values)
        for values in (("a", "b", b"c"), ("x", "b", b"c"), ("a", "x", b"c"), ("a", "b", b"x"))
    }
    assert len(digests) == 4


def with_identity(manifest: dict) -> dict:
    return manifest | {"identity": identity_of(manifest)}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"libraries": []}, "libraries: Input should be a valid dictionary"),
        ({"identity": 5}, "identity: Input should be a valid string"),
        ({"format": "2"}, "format: Input should be a valid integer"),
        ({"seed": 1}, "was changed: its identity does not match its content"),
        ({"asked": {"kind": "sweep", "name": 1}}, "asked.name: Input should be a valid string"),
    ],
)
def test_a_manifest_of_other_types_is_no_crash(asked, whole, changes, words):
    path = whole / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    for use in (lambda: open_study(whole), lambda: run_study(asked, out=whole, resume=True)):
        with pytest.raises(StudyError, match=r"manifest\.json: ") as error:
            use()
        assert words in str(error.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"labels": 3}, "labels: Input should be a valid dictionary"),
        ({"labels": {"x": "nonsense"}}, "labels.x: Input should be"),
        ({"varied": [1]}, "varied.0: Input should be a valid string"),
        ({"columns": [{"name": "x"}]}, "columns.0.type: Field required"),
    ],
)
def test_a_study_of_other_types_is_no_crash(asked, whole, changes, words):
    path = whole / "manifest.json"
    path.write_text(json.dumps(with_identity(json.loads(path.read_text()) | changes)))
    with pytest.raises(StudyError, match=r"manifest\.json: ") as error:
        open_study(whole)
    assert words in str(error.value)
    with pytest.raises(StudyError, match=f"holds another study: {next(iter(changes))}"):
        run_study(asked, out=whole, resume=True)


@pytest.mark.parametrize("text", ["[]", "3", "null", "[" * 50_000, "not JSON", '{"asked": []}'])
def test_what_is_no_manifest_is_no_crash(whole, text):
    (whole / "manifest.json").write_text(text)
    with pytest.raises(StudyError, match=r"manifest\.json: cannot be read as a manifest: "):
        open_study(whole)


def test_another_format_is_refused(asked, whole):
    """Before anything else is asked of it: an older one has other keys and other places."""
    path = whole / "manifest.json"
    older = {"format": FORMAT - 1, "breakaway_version": "0.0.1", "study": {"kind": "sweep"}}
    path.write_text(json.dumps(older))
    for use in (lambda: open_study(whole), lambda: run_study(asked, out=whole, resume=True)):
        with pytest.raises(
            StudyError,
            match=rf"has the format {FORMAT - 1}, not {FORMAT}; open it with breakaway 0\.0\.1, "
            r"which wrote it, or start again in another folder",
        ):
            use()
