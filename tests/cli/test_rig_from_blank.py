"""`breakaway rig-from-blank` writes a rig file that `breakaway identify` takes."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from breakaway.measure.identification import RigFile


@pytest.fixture
def held(tmp_path: Path) -> str:
    """A pull to 1 kN against a held part, by a rig of 2e6 N/m."""
    t_s = np.arange(2000) / 1000.0
    rng = np.random.default_rng(0)
    load = 500.0 * t_s
    columns = [t_s, load / 2e6 + 1e-7 * rng.standard_normal(2000), load + rng.standard_normal(2000)]
    path = tmp_path / "held.csv"
    header = "t_s,position_m,force_n"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    return str(path)


def test_writes_a_rig_file(call: Callable[..., Any], held: str, tmp_path: Path) -> None:
    out = tmp_path / "rig.toml"
    done = call("rig-from-blank", held, "--out", str(out))
    assert done.exit_code == 0, done.stderr
    rig = RigFile.load(out)
    assert rig.stiffness_n_per_m == pytest.approx(2e6, rel=1e-2)
    assert 0.0 < rig.stiffness_error_n_per_m < 2e4
    assert "a pull against a held part" in done.stdout
    assert "write them into the file by hand: filter_hz" in done.stdout
    again = call("rig-from-blank", held, "--out", str(out), "--json")
    (figure,) = json.loads(again.stdout)["figures"]
    assert figure["name"] == "stiffness_n_per_m"
    assert figure["low"] < rig.stiffness_n_per_m < figure["high"]


def test_overwrites_nothing_but_a_rig_file(
    call: Callable[..., Any], held: str, tmp_path: Path
) -> None:
    other = tmp_path / "notes.toml"
    other.write_text("mine = 1")
    done = call("rig-from-blank", held, "--out", str(other))
    assert done.exit_code == 3
    assert "exists and is not a rig file; give another name" in done.stderr
    assert other.read_text() == "mine = 1"
    assert call("rig-from-blank", held, "--out", held).exit_code == 3
