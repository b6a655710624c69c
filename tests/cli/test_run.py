"""`breakaway run` shows and writes a run whole, and reruns it bit for bit."""

import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet
import pytest
from tests.cli.written import written_to

import breakaway as bk

Call = Callable[..., Any]
FILES = {
    "scenario.toml",
    "metrics.json",
    "trace.parquet",
    "trace.csv",
    "figure.png",
    "figure.svg",
}


def save(path: Path, changes: dict[str, Any], preset: str = "paper_as_computed") -> Path:
    bk.save_scenario(bk.load_scenario(preset).with_(changes), path)
    return path


def test_shows_every_metric_with_its_unit(call: Call) -> None:
    shown = call("run", "paper_as_computed")
    assert shown.exit_code == 0
    assert "\x1b" not in shown.stdout
    lines = {" ".join(line.split()) for line in shown.stdout.splitlines()}
    assert {"peak force 601.38 N", "IAE 3.0361 µm s", "impacts 1"} <= lines
    assert shown.stdout.startswith("paper_as_computed: released")


def test_json_is_one_document_with_null_for_what_did_not_happen(call: Call, tmp_path: Path) -> None:
    short = save(tmp_path / "short.toml", {"timing.duration_s": 0.01})
    content = json.loads(call("run", short, "--json", "--seed", 5).stdout)
    assert (content["outcome"], content["seed"], content["files"]) == ("not_released", 5, [])
    assert content["metrics"]["time_to_release_s"] is None
    assert "none" in call("run", short).stdout


@pytest.mark.slow
def test_writes_a_folder_that_reruns_to_the_same_bits(call: Call, tmp_path: Path) -> None:
    first, second = tmp_path / "deep" / "first", tmp_path / "second"
    noisy = save(
        tmp_path / "noisy.toml", {"disturbance.var": 0.05, "seed": 3, "timing.duration_s": 0.1}
    )
    shown = call("run", noisy, "--out", first, "--seed", 2**62)
    assert shown.exit_code == 0
    assert {path.name for path in first.iterdir()} == FILES
    assert written_to(first, shown.stdout) == FILES
    assert call("run", first / "scenario.toml", "--out", second).exit_code == 0
    for name in FILES:
        assert (first / name).read_bytes() == (second / name).read_bytes(), name


@pytest.mark.slow
def test_what_is_written_is_what_ran(call: Call, tmp_path: Path) -> None:
    call("run", "paper_as_computed", "--out", tmp_path / "out")
    run = bk.simulate(bk.load_scenario("paper_as_computed"))
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["metrics"] == run.metrics.to_dict()
    assert metrics["breakaway_version"] == bk.__version__
    trace = parquet.read_table(tmp_path / "out" / "trace.parquet")
    assert trace.schema.field("applied_force_n").metadata == {b"unit": b"N"}
    header, *rows = (tmp_path / "out" / "trace.csv").read_text().splitlines()
    assert header.split(",") == list(run.trace) == trace.column_names
    for place, name in enumerate(run.trace):
        assert trace[name].to_numpy().tobytes() == run.trace[name].tobytes()
        assert [float(row.split(",")[place]) for row in rows] == run.trace[name].tolist()
    scenario = tomllib.loads((tmp_path / "out" / "scenario.toml").read_text())
    assert scenario["breakaway_version"] == bk.__version__
    assert scenario["controller"]["gains"]["kind"] == "given"
    assert scenario["joint"]["residual_n"] == 9.81


@pytest.mark.slow
def test_a_run_without_trace_leaves_no_trace_of_an_earlier_one(call: Call, tmp_path: Path) -> None:
    out = tmp_path / "out"
    call("run", "paper_as_computed", "--out", out)
    (out / "mine.txt").write_text("kept")
    silent = save(tmp_path / "silent.toml", {"trace.every_samples": 0})
    shown = call("run", silent, "--out", out)
    assert "no trace and no figure: trace.every_samples is 0" in shown.stdout
    assert {path.name for path in out.iterdir()} == {"scenario.toml", "metrics.json", "mine.txt"}


def test_names_the_limit_that_was_exceeded(call: Call, tmp_path: Path) -> None:
    gentle = save(tmp_path / "gentle.toml", {"limits.peak_force_max_n": 500.0})
    shown = call("run", gentle)
    assert shown.exit_code == 0
    assert "limit_exceeded" in shown.stdout
    assert "500 N exceeded" in shown.stdout


@pytest.mark.slow
def test_a_diverged_run_is_a_finding(call: Call, tmp_path: Path) -> None:
    wild = save(tmp_path / "wild.toml", {"limits.diverged_force_n": 400.0})
    shown = call("run", wild, "--out", tmp_path / "out")
    assert shown.exit_code == 0
    assert "diverged" in shown.stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES


def test_joint_tells_where_each_value_came_from(call: Call, joint_toml: Path) -> None:
    content = json.loads(call("run", "paper_as_computed", "--joint", joint_toml, "--json").stdout)[
        "joint"
    ]
    assert math.isclose(content["from_log"]["joint.coulomb_n"], 300.0, rel_tol=1e-3)
    assert content["from_scenario"]["joint.stiction_n"]["value"] == 450.0
    assert "breakaway from rest" in content["from_scenario"]["joint.stiction_n"]["reason"]
    assert {"rig.offset_n", "asymmetric.coulomb_positive_n"} <= set(content["not_used"])
    assert math.isclose(content["residual_n"]["value"], 9.81 / 360.0 * 300.0, rel_tol=1e-3)
    assert content["residual_n"]["reason"].startswith("2.73 % of the identified coulomb_n, as in ")
    assert content["law"]["value"] == "lugre"
    assert content["gains"] == "gains: redesigned for the identified joint"
    shown = call("run", "paper_as_computed", "--joint", joint_toml).stdout
    for words in ("motor.csv", "not used", "belongs to the rig", "redesigned", "of the identified"):
        assert words in shown
    assert "weight of the identified mass" not in shown


@pytest.mark.slow
def test_joint_changes_the_run_and_reruns_without_the_joint_file(
    call: Call, joint_toml: Path, tmp_path: Path
) -> None:
    out, again = tmp_path / "out", tmp_path / "again"
    call("run", "paper_as_computed", "--joint", joint_toml, "--out", out)
    joint_toml.unlink()
    call("run", out / "scenario.toml", "--out", again)
    assert (out / "trace.csv").read_bytes() == (again / "trace.csv").read_bytes()
    assert bk.load_scenario(out / "scenario.toml").part.mass_kg == pytest.approx(3.0, rel=1e-3)


def test_joint_keeps_given_gains_and_warns_of_low_stiction(
    call: Call, joint_toml: Path, tmp_path: Path
) -> None:
    given = tmp_path / "given.toml"
    scenario = bk.resolve(bk.load_scenario("paper_as_computed"))
    bk.save_scenario(scenario.with_({"joint.stiction_n": 200.0}), given)
    shown = call("run", given, "--joint", joint_toml)
    assert shown.exit_code == 0
    assert "not designed for the identified joint" in shown.stdout
    assert "joint.stiction_n = 200 N is below joint.coulomb_n = 300 N" in shown.stdout


def test_joint_needs_a_law_that_has_its_fields(
    call: Call, joint_toml: Path, tmp_path: Path
) -> None:
    joint = bk.load_scenario("paper_as_computed").joint.model_dump()
    two_region = bk.TwoRegion(
        **{key: joint[key] for key in bk.TwoRegion.model_fields if key != "law"}
    )
    path = tmp_path / "two_region.toml"
    bk.save_scenario(bk.load_scenario("paper_as_computed").with_(joint=two_region), path)
    failed = call("run", path, "--joint", joint_toml)
    assert failed.exit_code == 2
    assert "joint.viscous_n_s_per_m, which the scenario's law = 'two_region'" in failed.stderr


def test_joint_that_can_not_be_designed_for_is_named(
    call: Call, joint_toml: Path, tmp_path: Path
) -> None:
    stated = save(tmp_path / "stated.toml", {"joint.residual_n": 350.0})
    failed = call("run", stated, "--joint", joint_toml, "--out", tmp_path / "out")
    assert failed.exit_code == 2
    assert f"{joint_toml} laid over paper_as_computed: joint.coulomb_n" in failed.stderr
    assert not (tmp_path / "out").exists()
