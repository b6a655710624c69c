"""Results never take the place of what they came from, nor arrive in part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import breakaway as bk
from breakaway.base.output import output_folder, write_atomically
from breakaway.base.ownership import RUN
from breakaway.errors import OutputError


@pytest.fixture
def log(tmp_path: Path) -> Path:
    t = np.arange(5000) / 1000.0
    v = 0.3 * np.cos(5 * t) + 0.2 * np.cos(2 * t)
    x = 0.06 * np.sin(5 * t) + 0.1 * np.sin(2 * t)
    force = np.gradient(4 * v, t) + 30 * v + 6 * np.sign(v)
    path = tmp_path / "log.csv"
    rows = np.column_stack([t, x, force])
    np.savetxt(path, rows, delimiter=",", header="t_s,position_m,force_n", comments="")
    return path


def test_identify_does_not_write_over_its_log(log, call):
    before = log.read_bytes()
    done = call("identify", str(log), "--out", str(log))
    assert done.exit_code == 3
    assert "is the file that was read" in done.stderr
    assert log.read_bytes() == before


def test_identify_does_not_write_over_anything_but_a_joint_file(log, tmp_path, call):
    other = tmp_path / "notes.toml"
    other.write_text("precious = true\n")
    done = call("identify", str(log), "--out", str(other))
    assert (done.exit_code, other.read_text()) == (3, "precious = true\n")
    joint = tmp_path / "joint.toml"
    for _ in range(2):  # the second time over the first one's file
        assert call("identify", str(log), "--out", str(joint)).exit_code == 0


def test_run_does_not_write_over_its_scenario(tmp_path, call):
    scenario = tmp_path / "scenario.toml"
    bk.save_scenario(bk.load_scenario("paper_as_computed"), scenario)
    before = scenario.read_bytes()
    done = call("run", str(scenario), "--out", str(tmp_path))
    assert done.exit_code == 3
    assert scenario.read_bytes() == before


def test_a_folder_in_the_way_stops_all_files(tmp_path, call):
    (tmp_path / "trace.csv").mkdir()
    done = call("run", "paper_as_computed", "--out", str(tmp_path))
    assert done.exit_code == 3
    assert "trace.csv: is a folder" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["trace.csv"]


def test_a_folder_made_for_nothing_is_taken_away(tmp_path):
    with pytest.raises(KeyboardInterrupt), output_folder(tmp_path / "new" / "out", RUN):
        raise KeyboardInterrupt
    assert not (tmp_path / "new" / "out").exists()


def test_a_link_stays_a_link_and_permissions_stay(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_bytes(b"old")
    target.chmod(0o640)
    link.symlink_to(target)
    write_atomically(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    assert target.stat().st_mode & 0o777 == 0o640


def test_a_file_where_a_folder_has_to_be(tmp_path):
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(OutputError, match="is a file, not a folder"),
        output_folder(tmp_path / "file", RUN),
    ):
        pass


@pytest.mark.parametrize("text", ["\ufeffname = 'x'", "a = " + "[" * 5000, "seed = " + "1" * 5000])
def test_odd_toml_is_refused_in_words(tmp_path, text, call):
    path = tmp_path / "odd.toml"
    path.write_text(text, encoding="utf-8")
    done = call("run", str(path))
    assert done.exit_code == 2
    assert "Traceback" not in done.stderr
    assert "odd.toml" in done.stderr
