"""A study that contradicts itself is refused in words, before anything runs."""

import tomllib

import numpy as np
import pytest
import tomli_w

import breakaway as bk
from breakaway.ask.studies import load_study, run_study
from breakaway.ask.studies.files import parse_study
from breakaway.ask.studies.plans import plan_of
from breakaway.ask.studies.points import Point
from breakaway.errors import StudyError

SWEEP = """
kind = "sweep"
scenario = "paper_as_computed"
runs = 1
[sweep.grid]
"joint.stiction_n" = [400.0, 500.0]
"""
ROBUSTNESS = """
kind = "robustness"
scenario = "paper_as_computed"
runs = 100
[robustness]
over = "disturbance.var"
low = 0.1
high = 0.5
resolution = 0.1
failure_probability_max = 0.1
"""
SENSITIVITY = """
kind = "sensitivity"
scenario = "paper_as_computed"
runs = 16
[vary]
"joint.stiction_n" = { distribution = "uniform", low = 400.0, high = 500.0 }
"""
COMPARE = """
kind = "compare"
scenario = "paper_as_computed"
runs = 10
changes = { "disturbance.var" = 0.1 }
[[compare.controllers]]
name = "one"
[[compare.controllers]]
name = "two"
changes = { "controller.gains.settling_time_s" = 1e-3 }
"""
STICTION = '"joint.stiction_n"'
WRONG = [
    (SWEEP, 'kind = "sweep"', "", "kind: is missing; give one of 'sweep'"),
    (SWEEP, '"sweep"', '"sweeep"', "did you mean 'sweep'?"),
    (SWEEP, '"paper_as_computed"', '"paper_as_computd"', "did you mean paper_as_computed?"),
    (SWEEP, "runs = 1", "", "runs: is missing; give a whole number >= 1"),
    (SWEEP, "runs = 1", "runs = 0", "runs: 0 is not >= 1"),
    (SWEEP, "runs = 1", "runs = 1.5", "runs: 1.5 is not a whole number"),
    (SWEEP, "runs = 1", "runs = 1\nrunz = 2", "runz: is not a known key; did you mean runs?"),
    (SWEEP, "runs = 1", "runs = 9", "runs: 9 runs of each point would all be the same"),
    (SWEEP, "runs = 1", "runs = 1\nmetrics = ['peak_forc_n']", "did you mean peak_force_n?"),
    (SWEEP, "runs = 1", "runs = 1\nmetrics = ['iae_m_s', 'iae_m_s']", "is named twice"),
    (SWEEP, "runs = 1", "runs = 1\nmetrics = []", "metrics: "),
    (SWEEP, "runs = 1", "runs = 1\nseed = -1", "seed: -1 is not >= 0"),
    (SWEEP, "runs = 1", "runs = 1\ndesign = 'grid'", "design: 'grid' is not one of"),
    (SWEEP, "[400.0, 500.0]", "[]", "sweep.grid.joint.stiction_n: [] holds no values"),
    (SWEEP, "[400.0, 500.0]", "[400.0, 400]", "400.0 is given twice"),
    (SWEEP, "[400.0, 500.0]", "[400.0, 'a']", "mixes kinds of values"),
    (SWEEP, "[400.0, 500.0]", "[400.0, inf]", "inf is not a finite number"),
    (SWEEP, "[400.0, 500.0]", "[400.0, -5.0]", "joint.stiction_n: -5.0 is not > 0"),
    (SWEEP, "[400.0, 500.0]", "{ from = 5, to = 4, count = 3 }", "from: 5.0 is not < to = 4.0"),
    (SWEEP, "[400.0, 500.0]", "{ from = 1, to = 4, count = 1 }", "count: 1 is not within 2 to"),
    (SWEEP, "[400.0, 500.0]", "{ from = 1, to = 4 }", "joint.stiction_n.count: is missing"),
    (SWEEP, "[400.0, 500.0]", "{ from = 1, two = 4 }", "stiction_n.two: is not a known key"),
    (
        SWEEP,
        "[400.0, 500.0]",
        "{ from = 0, to = 4, count = 3, spacing = 'log' }",
        "from: 0.0 is not > 0; a logarithmic scale needs that",
    ),
    (SWEEP, STICTION, '"joint.stictoin_n"', "did you mean stiction_n?"),
    (SWEEP, "[sweep.grid]", "[sweep.grdi]", "sweep.grdi: is not a known key; did you mean grid?"),
    (SWEEP, '[sweep.grid]\n"joint.stiction_n" = [400.0, 500.0]', "", "nothing differs"),
    (
        SWEEP,
        "[sweep.grid]",
        f"[vary]\n{STICTION} = {{ distribution = 'uniform', low = 1.0, high = 2.0 }}\n[sweep.grid]",
        "sweep.grid.joint.stiction_n: is also in vary",
    ),
    (SWEEP, "[sweep.grid]", "[robustness]\nlow = 1\n[sweep.grid]", "robustness: is a table of ano"),
    (ROBUSTNESS, "runs = 100", "runs = 28", "give 29 or more"),
    (ROBUSTNESS, "low = 0.1", "low = 0.5", "robustness.low: 0.5 is not < high = 0.5"),
    (ROBUSTNESS, "high = 0.5", "high = 1.5", "robustness.high: disturbance.var: 1.5 is not < 1"),
    (ROBUSTNESS, "resolution = 0.1", "resolution = 0.6", "resolution: 0.6 is not <= high - low"),
    (ROBUSTNESS, "resolution = 0.1", "resolution = 1e-9", "makes more than 1e6 levels"),
    (ROBUSTNESS, "max = 0.1", "max = 1.0", "failure_probability_max: 1.0 is not < 1"),
    (ROBUSTNESS, "low = 0.1", "low = 0.1\nfailure = ['released']", "robustness.failure"),
    (ROBUSTNESS, "low = 0.1", "low = 0.1\nfailure = []", "robustness.failure"),
    (ROBUSTNESS, "low = 0.1", "low = 0.1\nfailure = ['diverged', 'diverged']", "twice"),
    (ROBUSTNESS, "disturbance.var", "disturbance.vra", "robustness.over: disturbance.vra: is not"),
    (ROBUSTNESS, "disturbance.var", "joint.law", "robustness.over: joint.law: is not a number"),
    (ROBUSTNESS, "disturbance.var", "timing.duration_s", "robustness.over: timing.duration_s: all"),
    (ROBUSTNESS, "disturbance.var", "joint.stiction_n", "would all be the same"),
    (ROBUSTNESS, "disturbance.var", "part_scale", "is 'part_scale', but vary is empty"),
    (SENSITIVITY, "runs = 16", "runs = 20", "runs: 20 is not a power of 2 and >= 8"),
    (SENSITIVITY, "runs = 16", "runs = 16\ndesign = 'sobol'", "'sobol' does not apply here"),
    (SENSITIVITY, "low = 400.0", "low = 600.0", "low: 600.0 is not <= high = 500.0"),
    (SENSITIVITY, "low = 400.0, ", "", "vary.joint.stiction_n.low: is missing"),
    (SENSITIVITY, '"uniform"', '"unifrom"', "distribution: 'unifrom' is not one of 'uniform'"),
    (SENSITIVITY, 'distribution = "uniform", ', "", "is not a distribution; give a table with"),
    (SENSITIVITY, STICTION, '"joint.law"', "vary.joint.law: is not a number"),
    (SENSITIVITY, STICTION, '"timing.duration_s"', "all runs of a batch share it"),
    (SENSITIVITY, '[vary]\n"joint.stiction_n"', "nothing", "nothing: is not a known key"),
    (
        SENSITIVITY,
        'distribution = "uniform", low = 400.0, high = 500.0',
        'distribution = "samples", values = [1.0], rows = "shared"',
        "rows: 'shared' ties numbers to each other",
    ),
    (COMPARE, 'name = "two"', 'name = "one"', "two are named 'one'"),
    (COMPARE, "{ \"controller.gains.settling_time_s\" = 1e-3 }", "{}", "are the same"),
    (COMPARE, "controller.gains.settling", "joint.stiction_n\" = 1e-3, \"controller.gains.settl",
     "all controllers meet the same parts"),
    (COMPARE, "gains.settling_time_s", "gains.settlnig_time_s", "did you mean settling_time_s?"),
    (COMPARE, "runs = 10\nchanges = { \"disturbance.var\" = 0.1 }", "runs = 10", "be the same"),
    (COMPARE, "changes = { \"disturbance.var\" = 0.1 }", "changes = { \"disturbance.vra\" = 0.1 }",
     "changes: disturbance.vra: is not a known key; did you mean var?"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "old", "new", "words"), WRONG, ids=[w[3] for w in WRONG])
def test_a_contradiction_is_explained(tmp_path, text, old, new, words):
    assert old in text
    path = tmp_path / "study.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(StudyError) as error:
        plan_of(load_study(path))
    assert str(error.value).startswith((f"{path}:", "sweep.grid: "))
    assert words in str(error.value)


def test_every_wrong_field_is_named(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(SWEEP.replace("runs = 1", "runs = -1\nseed = -2"))
    with pytest.raises(StudyError, match=r"(?s)seed: -2.*runs: -1"):
        load_study(path)


@pytest.mark.parametrize("text", ["\ufeffkind = 'sweep'", "kind = ", "a = " + "[" * 5000])
def test_odd_files_are_refused(tmp_path, text):
    path = tmp_path / "odd.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StudyError, match=r"odd\.toml"):
        load_study(path)
    with pytest.raises(StudyError, match="there is no such file"):
        load_study(tmp_path / "none.toml")


@pytest.mark.parametrize("text", [SWEEP, ROBUSTNESS, SENSITIVITY, COMPARE])
def test_a_study_survives_being_written_out(text):
    study = parse_study(tomllib.loads(text))
    again = parse_study(tomllib.loads(tomli_w.dumps(study.model_dump(exclude_none=True))))
    assert again == study
    assert parse_study(study.model_dump(mode="json")) == study


def test_paths_start_at_the_study(tmp_path, quick, monkeypatch):
    (tmp_path / "inner").mkdir()
    bk.save_scenario(quick, tmp_path / "inner" / "mine.toml")
    path = tmp_path / "inner" / "study.toml"
    path.write_text(SWEEP.replace("paper_as_computed", "mine.toml"))
    monkeypatch.chdir(tmp_path)
    assert load_study("inner/study.toml").base == quick


def test_tables_within_tables_are_dotted_paths(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(SWEEP.replace('"joint.stiction_n"', "joint.stiction_n"))
    assert load_study(path).sweep.grid == {"joint.stiction_n": [400.0, 500.0]}
    path.write_text(SENSITIVITY.replace('"joint.stiction_n"', "joint.stiction_n"))
    assert list(load_study(path).vary) == ["joint.stiction_n"]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"distribution": "normal", "mean": 450.0, "std": 200.0}, "joint.coulomb_n: 100.0 is not"),
        ({"distribution": "uniform", "low": 10.0, "high": 200.0}, "joint.coulomb_n: 100.0 is not"),
    ],
)
def test_draws_out_of_range_are_found_before_anything_runs(tmp_path, pushed, table, words):
    values = {
        "kind": "sweep",
        "runs": 1000,
        "scenario": pushed,
        "vary": {"joint.stiction_n": table},
    }
    with pytest.raises(StudyError, match=r"run \d+: ") as error:
        run_study(parse_study(values), out=tmp_path / "out")
    assert words in str(error.value)
    assert not (tmp_path / "out").exists()


def test_an_invalid_run_is_named_by_its_own_number(monkeypatch):
    """Runs are checked in slices; the number is that of the run and not of its place there."""
    monkeypatch.setattr("breakaway.ask.studies.points.CHECKED_TOGETHER", 10)
    scenario = bk.load_scenario("paper_as_computed")
    mass_kg = np.ones(40)
    mass_kg[37] = -1.0
    point = Point(
        {}, scenario, range(40), lambda runs: {"part.mass_kg": mass_kg[runs.start :][:10]}
    )
    with pytest.raises(StudyError, match=r"^run 37: part\.mass_kg: -1\.0 is not > 0"):
        point.check()
