"""``breakaway logs`` lists what is in a file, and writes a mapping that reads it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from breakaway.measure.logs import read_log

Call = Callable[..., Any]


def rig_csv(folder: Path) -> Path:
    path = folder / "rig.csv"
    path.write_text("Zeit [s],Weg [mm],Kraft in N\n" + "".join(f"{k},1,2\n" for k in range(20)))
    return path


def test_lists_channels(call: Call, tmp_path: Path) -> None:
    shown = call("logs", rig_csv(tmp_path))
    assert shown.exit_code == 0
    assert all(name in shown.stdout for name in ("rig.csv (csv)", "Weg [mm]", "Kraft in N"))


def test_gives_the_same_as_json(call: Call, tmp_path: Path) -> None:
    found = json.loads(call("logs", rig_csv(tmp_path), "--json").stdout)
    assert (found["format"], found["mapping"]) == ("csv", None)
    assert [one["name"] for one in found["channels"]] == ["Zeit [s]", "Weg [mm]", "Kraft in N"]


def test_writes_a_mapping_that_reads_the_log(call: Call, tmp_path: Path) -> None:
    path, mapping = rig_csv(tmp_path), tmp_path / "rig.toml"
    assert f"wrote {mapping}" in call("logs", path, "--write-mapping", mapping).stdout
    log = read_log(path)
    assert (log.position_m[0], log.force_n[0]) == (0.001, 2.0)


def test_a_mapping_is_not_written_over_a_file(call: Call, tmp_path: Path) -> None:
    path = rig_csv(tmp_path)
    refused = call("logs", path, "--write-mapping", path)
    assert refused.exit_code == 3
    assert "rig.csv: exists; give --write-mapping another name" in refused.stderr
    assert path.read_text().startswith("Zeit")


def test_what_is_no_log_is_told(call: Call, tmp_path: Path) -> None:
    failed = call("logs", tmp_path / "none.csv")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert "there is no such file" in failed.stderr


def test_a_picture_is_drawn_before_anything_is_fitted(call: Call, tmp_path: Path) -> None:
    path = tmp_path / "gap.csv"
    times = [*(k / 100 for k in range(40)), *(1.0 + k / 100 for k in range(40))]
    path.write_text("t_s,position_m,force_n\n" + "".join(f"{t},{t},{2 * t}\n" for t in times))
    shown = call("logs", path, "--plot", tmp_path / "log.svg")
    assert shown.exit_code == 0, shown.stderr
    assert "- t_s: 1 gap" in shown.stdout and f"wrote {tmp_path / 'log.svg'}" in shown.stdout
    assert (tmp_path / "log.svg").read_text().startswith("<?xml")
    cut = call("logs", path, "--plot", tmp_path / "cut.png", "--between", 0, 0.3, "--json")
    assert not any("gap" in one for one in json.loads(cut.stdout)["odd"])
    assert (tmp_path / "cut.png").read_bytes().startswith(b"\x89PNG")


def test_a_picture_of_an_unknown_kind_is_refused(call: Call, tmp_path: Path) -> None:
    refused = call("logs", rig_csv(tmp_path), "--plot", tmp_path / "log.bmp")
    assert refused.exit_code == 3 and "'log.bmp' does not end in .png" in refused.stderr
    assert not (tmp_path / "log.bmp").exists()
