"""One pull gives a joint file, several a population, and every command takes the joint."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.identification.pulls import pulled, written

import breakaway as bk
from breakaway.measure.identification import JointFile
from breakaway.measure.logs import Log

Call = Callable[..., Any]


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return written(pulled(3000.0, 1500.0), tmp_path / "part.csv")


@pytest.fixture
def joint(call: Call, log: Path, tmp_path: Path) -> Path:
    out = tmp_path / "joint.toml"
    done = call("events", log, "--out", out, "--mass-kg", 1.5)
    assert done.exit_code == 0, done.stderr
    return out


def test_one_log_becomes_a_joint_that_says_what_is_assumed(call: Call, log: Path) -> None:
    out = log.with_name("joint.toml")
    done = call("events", log, "--out", out)
    assert done.exit_code == 0, done.stderr
    file = JointFile.load(out)
    assert file.joint.stiction_n == pytest.approx(3000.0, rel=0.01)
    assert file.joint.coulomb_n == pytest.approx(1500.0, rel=0.01)
    shown = done.stdout
    assert "Not told by the log: assumed" in shown and "joint.stribeck_velocity_m_per_s" in shown
    assert any("stiffness_n_per_m" in line and "at least" in line for line in shown.splitlines())
    assert f"wrote {out}" in shown


def test_json_names_the_file(call: Call, log: Path) -> None:
    out = log.with_name("joint.toml")
    done = call("events", log, "--out", out, "--json")
    assert json.loads(done.stdout)["file"] == str(out) and out.is_file()


def test_several_logs_become_a_population_that_compare_reads(call: Call, tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    logs = []
    for part in range(5):
        stiction_n = float(np.exp(rng.normal(np.log(2000.0), 0.3)))
        log = pulled(stiction_n, stiction_n / rng.uniform(1.4, 2.0), seed=part)
        logs.append(written(log, tmp_path / f"part_{part}.csv"))
    out = tmp_path / "parts.toml"
    done = call("events", *logs, "--out", out, "--mass-kg", 2)
    assert done.exit_code == 0, done.stderr
    parts = bk.load_population(out)
    assert parts.parts.mass_kg.values == (2.0,)
    assert {"stribeck_velocity_m_per_s", "engagement_length_m", "var"} <= parts.assumed.keys()
    assert not {"stiction_n", "stiction_ratio", "mass_kg"} & parts.assumed.keys()
    done = call(
        *("compare", out, "--runs", 2, "--method", "paper_pid", "--laws", "lugre"),
        *("--out", tmp_path / "compared"),
    )
    assert done.exit_code == 0, done.stderr


def test_a_joint_replaces_no_other_file_and_no_log(call: Call, log: Path) -> None:
    other = log.with_name("notes.toml")
    other.write_text("mine = true\n")
    done = call("events", log, "--out", other)
    assert done.exit_code == 3 and "is not a joint file" in done.stderr
    assert other.read_text() == "mine = true\n"
    done = call("events", log, "--out", log)
    assert done.exit_code == 3 and log.read_text().startswith("t_s,")


def test_a_mass_without_a_file_is_refused(call: Call, log: Path) -> None:
    done = call("events", log, "--mass-kg", 2)
    assert done.exit_code == 2
    assert "--mass-kg: is for --out" in done.stderr


def test_two_logs_are_too_few_for_a_population(call: Call, log: Path) -> None:
    done = call("events", log, log, "--out", log.with_name("parts.toml"))
    assert done.exit_code == 2 and "at least 3 are needed" in done.stderr
    assert not log.with_name("parts.toml").exists()


def test_run_says_what_is_known_how(call: Call, joint: Path) -> None:
    done = call("run", "paper_as_computed", "--joint", joint, "--json")
    found = json.loads(done.stdout)["joint"]
    assert found["origin"]["joint.stiction_n"] == "identified"
    assert found["origin"]["part.mass_kg"] == "given"
    assert found["origin"]["joint.stiffness_n_per_m"].startswith("at least: ")


def test_design_judges_the_joint_of_the_log(call: Call, joint: Path) -> None:
    own = json.loads(call("design", "paper_as_computed", "--json").stdout)
    done = json.loads(call("design", "paper_as_computed", "--joint", joint, "--json").stdout)
    assert done["joint"]["from_log"]["part.mass_kg"] == 1.5
    assert done["gain_sets"] != own["gain_sets"]
    shown = call("design", "paper_as_computed", "--joint", joint)
    assert "Joint from" in shown.stdout and "at least" in shown.stdout


def test_an_exported_plant_has_the_joint_of_the_log(
    call: Call, joint: Path, tmp_path: Path
) -> None:
    args = ("export", "c", "paper_as_computed", "--what", "plant", "--joint", joint)
    done = call(*args, "--out", tmp_path / "rig", "--json")
    assert done.exit_code == 0, done.stderr
    stiction_n = JointFile.load(joint).joint.stiction_n
    assert json.loads(done.stdout)["joint"]["from_log"]["joint.stiction_n"] == stiction_n
    source = "".join(path.read_text() for path in (tmp_path / "rig").glob("*.[ch]"))
    assert repr(stiction_n)[:12] in source


def test_an_exported_fmu_has_the_joint_of_the_log(call: Call, joint: Path, tmp_path: Path) -> None:
    args = ("export", "fmu", "paper_as_computed", "--joint", joint, "--json")
    done = call(*args, "--out", tmp_path / "rig.fmu")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["joint"]["from_log"]["part.mass_kg"] == 1.5


def test_compare_tries_the_joints_that_the_log_leaves_open(
    call: Call, joint: Path, tmp_path: Path
) -> None:
    out = tmp_path / "compared"
    args = ("compare", "--joint", joint, "--runs", 4, "--method", "paper_pid", "--laws", "lugre")
    done = call(*args, "--out", out)
    assert done.exit_code == 0, done.stderr
    again = call(*args, "--out", out, "--resume")
    assert again.exit_code == 0, again.stderr
    text = (out / "comparison.toml").read_text()
    assert 'rows = "shared"' in text and "part.csv" in text


def test_a_study_draws_from_the_joint(call: Call, joint: Path, tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    study.write_text(
        'kind = "sweep"\nscenario = "paper_as_computed"\nruns = 4\n'
        '[sweep.grid]\n"reference.duration_s" = [0.4]\n'
    )
    out = tmp_path / "out"
    done = call("study", study, "--joint", joint, "--out", out)
    assert done.exit_code == 0, done.stderr
    manifest = json.loads((out / "manifest.json").read_text())
    assert set(JointFile.load(joint).vary()) == set(manifest["varied"])
    again = call("study", out / "study.toml", "--out", out, "--resume")
    assert again.exit_code == 0, again.stderr


def test_tune_draws_its_parts_from_the_joint(call: Call, joint: Path, tmp_path: Path) -> None:
    tuning = tmp_path / "tuning.toml"
    tuning.write_text(
        'population = "seized_parts"\nmethod = "paper_pid"\nobjectives = ["strict_share"]\n'
        "training_runs = 2\nevaluations = 2\n[test_runs]\nfirst = 100\nruns = 2\n"
        '[tune]\n"controller.gains.kp_n_per_m" = { low = 1e6, high = 5e6 }\n'
    )
    asked = bk.load_tuning(tuning, joint=joint)
    mass = asked.population.parts.mass_kg
    assert set(mass.values) == {1.5}
    done = call("tune", tuning, "--joint", joint, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.stderr


@pytest.mark.parametrize("command", ["run", "design", "compare"])
def test_a_missing_joint_is_one_line(call: Call, tmp_path: Path, command: str) -> None:
    scenario = "seized_parts" if command == "compare" else "paper_as_computed"
    out = ("--out", tmp_path / "out")
    done = call(command, scenario, "--joint", tmp_path / "no.toml", *out)
    assert done.exit_code == 2
    assert "no.toml" in done.stderr and "Traceback" not in done.stderr


def test_identify_gives_the_joint_of_a_pull_and_its_page(call: Call, log: Path) -> None:
    out = log.with_name("identified.toml")
    done = call("identify", log, "--out", out, "--report")
    assert done.exit_code == 0, done.stderr
    assert "one pull from rest to slip" in done.stdout
    by_events = log.with_name("joint.toml")
    call("events", log, "--out", by_events)
    assert JointFile.load(out) == JointFile.load(by_events)
    page = out.with_suffix(".html").read_text()
    assert "The joint held" in page and "<svg" in page and "Stribeck velocity" in page


def test_a_law_that_tells_no_joint_leaves_that_of_the_pull(call: Call, log: Path) -> None:
    out = log.with_name("identified.toml")
    done = call("identify", log, "--law", "coulomb", "--starts", 1, "--out", out, "--report")
    assert done.exit_code == 0, done.stderr
    assert "the joint is that of the pull" in done.stderr
    assert JointFile.load(out).provenance.method == "breakaway event"
    assert "friction identified" in out.with_suffix(".html").read_text()


def test_the_page_is_written_also_where_no_joint_comes_out(call: Call, tmp_path: Path) -> None:
    t_s = np.arange(400) / 100.0
    even = np.r_[t_s[:200], t_s[200:] + 0.005]  # a step and a half: no derivative across it
    log = Log(t_s=even, position_m=0.1 * np.sin(5 * even), force_n=20.0 * np.sign(np.cos(5 * even)))
    path = written(log, tmp_path / "uneven.csv")
    done = call("identify", path, "--out", tmp_path / "joint.toml", "--report")
    assert done.exit_code == 2 and not (tmp_path / "joint.toml").exists()
    page = (tmp_path / "joint.html").read_text()
    assert "no joint identified" in page and "median step" in page


def test_a_rig_is_for_a_law_or_a_pull(call: Call, log: Path, log_csv: Path) -> None:
    rig = log.with_name("rig.toml")
    rig.write_text('position_sensor = "part"\n')
    out = log.with_name("identified.toml")
    done = call("identify", log, "--rig", rig, "--out", out)
    assert done.exit_code == 0, done.stderr
    assert math.isfinite(JointFile.load(out).interval["stiffness_n_per_m"][1])
    done = call("identify", log_csv, "--rig", rig)
    assert done.exit_code == 2 and "--rig: only for --law" in done.stderr
