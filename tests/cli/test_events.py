"""`breakaway events` shows what was found, what is only a bound, and what was refused."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest


@pytest.fixture
def logs(tmp_path: Path) -> list[str]:
    """Parts that break loose at 20 to 22 N and slide at 10 N; the last log begins moving."""
    paths = []
    for part in range(4):
        t_s = np.arange(3000) / 1000.0
        stuck = np.clip((t_s - 0.5) / 0.5, 0.0, 1.0)
        peak = 20.0 + part
        sliding = t_s > 1.0
        force = np.where(sliding, 10.0 + (peak - 10.0) * np.exp(-(t_s - 1.0) / 0.02), peak * stuck)
        x = np.where(sliding, 1e-4 + 5e-3 * (t_s - 1.0), 1e-4 * stuck)
        first = 1500 if part == 3 else 0
        noise = 0.01 * np.random.default_rng(part).standard_normal(3000)
        rows = zip(t_s[first:], x[first:], (force + noise)[first:], strict=True)
        path = tmp_path / f"part_{part}.csv"
        lines = ["t_s,position_m,force_n", *(",".join(f"{v:.9g}" for v in row) for row in rows)]
        path.write_text("\n".join(lines))
        paths.append(str(path))
    return paths


def test_shows_forces_and_refusals(call: Callable[..., Any], logs: list[str]) -> None:
    done = call("events", *logs, "--population")
    assert done.exit_code == 0, done.stderr
    for part in range(3):
        row = next(line for line in done.stdout.splitlines() if f"part_{part}.csv" in line)
        assert float(row.split()[3]) == pytest.approx(20.0 + part, rel=0.02)
    assert "part_3.csv: is already moving" in done.stdout
    assert "breakaway_force_n" in done.stdout


def test_gives_the_same_as_json(call: Callable[..., Any], logs: list[str]) -> None:
    done = call("events", *logs, "--json")
    found = json.loads(done.stdout)["logs"]
    assert [len(one["events"]) for one in found] == [1, 1, 1, 0]
    assert found[1]["events"][0]["breakaway_force_n"] == pytest.approx(21.0, rel=0.02)


def test_names_samples_that_stand_alone(call: Callable[..., Any], logs: list[str]) -> None:
    lines = Path(logs[0]).read_text().splitlines()
    lines[700] = ",".join([*lines[700].split(",")[:2], "9999"])
    Path(logs[0]).write_text("\n".join(lines))
    done = call("events", logs[0])
    row = next(line for line in done.stdout.splitlines() if "part_0.csv" in line)
    assert float(row.split()[3]) == pytest.approx(20.0, rel=0.02)
    assert (
        "- part_0.csv: 1 single sample of the force stands alone, the first of 9.999 kN at 0.699 s;"
    ) in done.stdout


def test_takes_a_rig(call: Callable[..., Any], logs: list[str], tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text("force_calibration_percent = 5.0\n")
    shown = call("events", logs[0], "--rig", str(rig), "--json")
    (report,) = json.loads(shown.stdout)["logs"]
    assert report["rig"]["force_calibration_percent"] == 5.0
    assert report["events"][0]["breakaway_error_n"] == pytest.approx(1.0, rel=0.02)


def test_refuses_a_bad_option(call: Callable[..., Any], logs: list[str]) -> None:
    done = call("events", logs[0], "--use", "friction_n")
    assert done.exit_code == 2
    assert "CHANNEL=OTHER" in done.stderr and "Traceback" not in done.stderr


def test_a_log_is_cut_and_bad_rows_dropped_before_anything_else(
    call: Callable[..., Any], logs: list[str]
) -> None:
    path = Path(logs[0])
    rows = path.read_text().splitlines()
    rows[200], rows[2900] = "0.199,OVL,1", f"{rows[2899]}"
    path.write_text("\n".join(rows))
    refused = call("events", path)
    assert refused.exit_code == 2
    assert "'OVL' is not a number" in refused.stderr and "--drop-bad-rows" in refused.stderr
    found = json.loads(call("events", path, "--drop-bad-rows", "--json").stdout)["logs"][0]
    assert found["events"][0]["breakaway_force_n"] == pytest.approx(20.0, abs=0.1)
    kept = call("events", path, "--drop-bad-rows", "--between", 0.3, 2.5, "--json")
    assert json.loads(kept.stdout)["logs"][0]["events"][0]["time_s"] == found["events"][0]["time_s"]
    short = call("events", path, "--drop-bad-rows", "--between", 7, 8)
    assert "from 7 s to 8 s 'position_m' has 0 samples" in short.stderr
