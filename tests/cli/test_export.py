"""`breakaway export` writes C and FMUs, and says what it wrote."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.cli.written import written_to

Call = Callable[..., Any]


@pytest.mark.parametrize("what", ["controller", "plant", "loop"])
def test_writes_every_file(call: Call, tmp_path: Path, what: str) -> None:
    out = tmp_path / "rig"
    done = call("export", "c", "paper_as_computed", "--what", what, "--out", out, "--real", "float")
    assert done.exit_code == 0
    names = sorted(path.name for path in out.iterdir())
    assert names == sorted(
        [
            f"{what}.c",
            f"{what}.h",
            f"test_{what}.c",
            "CMakeLists.txt",
            "README.md",
            "interface.json",
        ]
    )
    assert written_to(out, done.stdout) == set(names)


def test_prints_one_document(call: Call, tmp_path: Path) -> None:
    done = call("export", "c", "paper_as_computed", "--out", tmp_path, "--json")
    told = json.loads(done.stdout)
    assert (told["what"], told["real"]) == ("controller", "double")
    assert str(tmp_path / "controller.c") in told["files"]


def test_a_typo_is_named(call: Call, tmp_path: Path) -> None:
    done = call("export", "c", "paper_as_computed", "--what", "motor", "--out", tmp_path)
    assert done.exit_code == 2
    assert "'controller', 'plant', 'loop'" in done.stderr
    done = call("export", "c", "paper_as_computet", "--out", tmp_path)
    assert done.exit_code == 2
    assert "paper_as_computed" in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_folder_that_can_not_be_written_is_named(call: Call, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = call("export", "c", "paper_as_computed", "--out", tmp_path / "file")
    assert done.exit_code == 3
    assert "is a file, not a folder" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("fmi", ["2", "3"])
def test_writes_a_unit(call: Call, tmp_path: Path, fmi: str) -> None:
    out = tmp_path / "rig.fmu"
    done = call("export", "fmu", "paper_as_computed", "--fmi", fmi, "--out", out, "--json")
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    assert (told["what"], told["fmi"], told["file"]) == ("controller", fmi, str(out))
    assert (told["binary"] is None) == (told["note"] != "")
    done = call("export", "fmu", "paper_as_computed", "--fmi", fmi, "--out", out)
    assert "rig.fmu" in done.stdout


@pytest.mark.slow
def test_a_unit_that_can_not_be_written_is_named(call: Call, tmp_path: Path) -> None:
    done = call("export", "fmu", "paper_as_computed", "--fmi", "1", "--out", tmp_path / "rig.fmu")
    assert done.exit_code == 2
    assert "'2', '3'" in done.stderr
    (tmp_path / "file").write_text("")
    done = call("export", "fmu", "paper_as_computed", "--out", tmp_path / "file" / "rig.fmu")
    assert done.exit_code == 3
    assert "give a folder that you can write to" in done.stderr.replace("\n", " ")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [("c", "out"), ("fmu", "out/rig.fmu")])
def test_missing_folders_are_made(call: Call, tmp_path: Path, arguments: tuple[str, str]) -> None:
    kind, place = arguments
    out = tmp_path / "deep" / place
    assert call("export", kind, "paper_as_computed", "--out", out).exit_code == 0
    assert out.exists()
