"""`breakaway identify` shows both fits and writes a joint file that runs."""

import inspect
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from breakaway.cli.identify import LogFormat
from breakaway.identification import NOT_IDENTIFIED, JointFile, identify_inertia_friction
from breakaway.logs import FORMATS

Call = Callable[..., Any]


def test_shows_both_fits_and_writes_the_joint_file(
    call: Call, log_csv: Path, tmp_path: Path
) -> None:
    out = tmp_path / "joint.toml"
    shown = call("identify", log_csv, "--out", out)
    assert shown.exit_code == 0
    words = " ".join(shown.stdout.split())
    for text in ("Symmetric", "Asymmetric", "Coulomb negative", "std. error", f"wrote {out}"):
        assert text in words
    assert all(field in words for field in NOT_IDENTIFIED)
    assert re.search(r"relative force error +0\.\d\d +%", shown.stdout)
    assert JointFile.load(out).joint.coulomb_n == pytest.approx(300.0, rel=1e-3)
    assert call("run", "paper_as_computed", "--joint", out).exit_code == 0


def test_json_is_one_document(call: Call, log_csv: Path, tmp_path: Path) -> None:
    out = tmp_path / "joint.toml"
    args = ("--out", out, "--json", "--decimation", 5, "--lowpass-hz", 150)
    content = json.loads(call("identify", log_csv, *args).stdout)
    assert (content["decimation"], content["lowpass_hz"]) == (5, 150.0)
    assert content["symmetric"]["mass_kg"] == pytest.approx(3.0, rel=1e-2)
    assert content["symmetric"]["standard_error"]["mass_kg"] > 0.0
    assert content["asymmetric"]["coulomb_positive_n"] == pytest.approx(302.0, rel=1e-2)
    assert content["file"] == str(out)
    assert out.is_file()


def test_without_out_nothing_is_written(call: Call, log_csv: Path) -> None:
    assert call("identify", log_csv).exit_code == 0
    assert list(log_csv.parent.iterdir()) == [log_csv]


def test_negative_friction_is_shown_but_not_written(call: Call, tmp_path: Path) -> None:
    t_s = np.arange(5000) / 1000.0
    v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    force = np.gradient(3 * v, t_s) - 20 * v + 50 * np.sign(v)
    x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    log, out = tmp_path / "log.csv", tmp_path / "joint.toml"
    table = np.column_stack([t_s, x, force])
    np.savetxt(log, table, delimiter=",", header="t_s,x_m,force_N", comments="", fmt="%.17g")
    failed = call("identify", log, "--out", out)
    assert failed.exit_code == 2
    assert "Symmetric" in failed.stdout
    assert "viscous_n_s_per_m comes out as -" in failed.stderr
    failed = call("identify", log, "--out", out, "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert not out.exists()


def test_what_the_command_line_repeats_is_what_the_api_says(call: Call) -> None:
    assert [format.value for format in LogFormat] == list(FORMATS)
    defaults = inspect.signature(identify_inertia_friction).parameters
    words = call("identify", "--help").stdout
    for name in ("lowpass_hz", "decimation"):
        assert f"[default: ({defaults[name].default:g})]" in words
