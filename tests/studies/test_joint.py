"""A study of an identified joint: its values lie over the scenario, its draws are its parts."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.studies import load_study, run_study
from breakaway.ask.studies.files import parse_study
from breakaway.errors import ScenarioError, StudyError
from breakaway.measure.identification import JointFile, identify
from breakaway.measure.logs import Log
from breakaway.model.scenario.distribution import Samples

PATHS = {"joint.coulomb_n", "joint.viscous_n_s_per_m"}
TEXT = """
kind = "sweep"
scenario = "quick.toml"
joint = "parts/joint.toml"
runs = 20
metrics = ["peak_force_n"]
"""
ROBUSTNESS = """
kind = "robustness"
scenario = "quick.toml"
joint = "parts/joint.toml"
runs = 30
metrics = ["peak_force_n"]
[robustness]
over = "part_scale"
low = 0.5
high = 2.0
resolution = 0.5
failure_probability_max = 0.2
failure = ["diverged"]
"""


@pytest.fixture(scope="module")
def joint() -> JointFile:
    """Give a joint of 300 N that a log told."""
    t_s = np.arange(1000) / 500.0
    x = 0.02 * np.sin(5 * t_s) + 0.01 * np.sin(13 * t_s + 1)
    v = 0.1 * np.cos(5 * t_s) + 0.13 * np.cos(13 * t_s + 1)
    noise = 2.0 * np.random.default_rng(0).standard_normal(len(v))
    log = Log(t_s=t_s, position_m=x, force_n=300.0 * np.sign(v) + 400.0 * v + noise)
    return JointFile.from_identification(identify(log, law="coulomb", starts=1))


@pytest.fixture
def folder(tmp_path: Path, quick: bk.Scenario, joint: JointFile) -> Path:
    """Give a folder with a scenario and, in another folder, a joint."""
    (tmp_path / "parts").mkdir()
    joint.save(tmp_path / "parts" / "joint.toml")
    bk.save_scenario(quick, tmp_path / "quick.toml")
    return tmp_path


@pytest.fixture(autouse=True)
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)


def load(folder: Path, text: str) -> Any:
    (folder / "study.toml").write_text(text)
    return load_study(folder / "study.toml")


def test_values_are_laid_over_and_draws_vary(
    folder: Path, joint: JointFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")  # paths start at the study's folder, not here
    study = load(folder, TEXT)
    assert study.joint == joint
    assert study.base.joint.coulomb_n == joint.joint.coulomb_n
    assert set(study.vary) == PATHS
    for path in PATHS:
        law = study.vary[path]
        assert isinstance(law, Samples)
        assert (law.rows, len(law.values)) == ("shared", 200)


def test_what_the_study_changes_is_not_drawn(folder: Path) -> None:
    study = load(folder, TEXT + '[changes]\n"joint.coulomb_n" = 250.0\n')
    assert study.base.joint.coulomb_n == 250.0
    assert set(study.vary) == PATHS - {"joint.coulomb_n"}


def test_what_the_study_varies_is_drawn_as_it_says(folder: Path) -> None:
    own = '[vary]\n"joint.coulomb_n" = { distribution = "uniform", low = 1.0, high = 2.0 }\n'
    study = load(folder, TEXT + own)
    assert study.vary["joint.coulomb_n"] == bk.Uniform(low=1.0, high=2.0)
    assert isinstance(study.vary["joint.viscous_n_s_per_m"], Samples)


def test_rows_of_the_draws_meet_in_one_run(folder: Path, joint: JointFile) -> None:
    assert joint.draws is not None
    pairs = set(zip(*(joint.draws.values[path] for path in sorted(PATHS)), strict=True))
    study = load(folder, TEXT)
    drawn = bk.draw_columns(study.vary, range(50), seed=1)
    rows = np.column_stack([drawn[path] for path in sorted(PATHS)])
    assert {tuple(row) for row in rows.tolist()} <= pairs


@pytest.mark.parametrize("text", [TEXT, ROBUSTNESS], ids=["sweep", "robustness"])
def test_a_study_that_was_run_runs_again_without_the_joint_file(folder: Path, text: str) -> None:
    run_study(load(folder, text), out=folder / "one")
    (folder / "parts" / "joint.toml").unlink()
    again = load_study(folder / "one" / "study.toml")
    run_study(again, out=folder / "two")
    first, second = (
        json.loads((folder / name / "summary.json").read_text())["result"]
        for name in ("one", "two")
    )
    assert first == second
    assert again.vary == load_study(folder / "two" / "study.toml").vary


def test_a_joint_file_object_will_do(joint: JointFile, quick: bk.Scenario) -> None:
    study = parse_study({"kind": "sweep", "scenario": quick, "joint": joint, "runs": 5})
    assert set(study.vary) == PATHS


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, r"joint\.toml: there is no such file"),
        ("kind = 3", r"joint\.toml"),
        ("[part", r"joint\.toml.*is not TOML"),
    ],
    ids=["missing", "wrong", "no toml"],
)
def test_a_wrong_joint_file_is_named(folder: Path, content: str | None, words: str) -> None:
    path = folder / "parts" / "joint.toml"
    path.unlink()
    if content is not None:
        path.write_text(content)
    with pytest.raises((StudyError, ScenarioError), match=rf"(?s)study\.toml:.*{words}"):
        load(folder, TEXT)


def test_a_joint_file_without_draws_is_refused(folder: Path, joint: JointFile) -> None:
    joint.model_copy(update={"draws": None}).save(folder / "parts" / "joint.toml")
    with pytest.raises((StudyError, ScenarioError), match="has no draws, so its spread is not"):
        load(folder, TEXT)


def test_what_is_swept_is_not_drawn(folder: Path) -> None:
    with pytest.raises(StudyError, match=r"sweep\.grid\.joint\.coulomb_n: is also in vary"):
        load(folder, TEXT + '[sweep.grid]\n"joint.coulomb_n" = [200.0, 300.0]\n')


def test_a_joint_that_the_law_has_no_place_for_is_refused(folder: Path) -> None:
    law = bk.TwoRegion(
        stiction_n=450.0,
        coulomb_n=100.0,
        stiffness_n_per_m=3.6e7,
        damping_n_s_per_m=2e4,
        engagement_length_m=0.01,
    )
    scenario = bk.load_scenario("paper_as_computed").with_(joint=law)
    bk.save_scenario(scenario, folder / "quick.toml")
    with pytest.raises(StudyError, match=r"joint.*viscous_n_s_per_m"):
        load(folder, TEXT)


def test_indices_of_tied_draws_are_refused(folder: Path) -> None:
    with pytest.raises(StudyError, match="'shared' ties numbers to each other"):
        load(folder, TEXT.replace('"sweep"', '"sensitivity"').replace("runs = 20", "runs = 16"))
