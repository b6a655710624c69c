"""Each kind of study answers its question, where the answer is known."""

import json
import re
from dataclasses import dataclass

import numpy as np
import pyarrow.dataset as dataset
import pytest
from scipy.stats import norm

import breakaway as bk
from breakaway._core import OUTCOMES
from breakaway.ask.studies import open_study, run_study
from breakaway.ask.studies.files import parse_study
from breakaway.ask.studies.robustness import RobustnessPlan, largest_true
from breakaway.ask.studies.statistics import clopper_pearson
from breakaway.errors import StudyError
from breakaway.run.batch import simulate_many

NORMAL = {"distribution": "normal", "mean": 550.0, "std": 40.0}
SPREAD = {"distribution": "uniform", "low": 540.0, "high": 560.0}
NARROW = {"distribution": "normal", "mean": 550.0, "std": 6.25}


def study_of(kind, scenario, **values):
    return parse_study({"kind": kind, "scenario": scenario, **values})


@pytest.fixture(autouse=True)
def no_figures(monkeypatch):
    """Leave figures out; tests/cli and tests/plots draw them."""
    monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)


# Sweep


def test_a_known_failure_probability_is_recovered(tmp_path, pushed, largest_stiction_n):
    """A part fails exactly where its stiction is above what can be pushed, so P is known."""
    study = study_of(
        "sweep", pushed, runs=3000, vary={"joint.stiction_n": NORMAL}, metrics=["peak_force_n"]
    )
    done = run_study(study, out=tmp_path)
    stiction = done.scan(["joint.stiction_n"])["joint.stiction_n"].to_numpy()
    released = np.array(done.scan(["outcome"])["outcome"].to_pylist()) == "released"
    np.testing.assert_array_equal(released, stiction <= largest_stiction_n)
    known = norm.cdf(largest_stiction_n, 550.0, 40.0)
    row = done.summary["tables"]["points"][0]
    assert row["released"] == released.sum()
    assert row["released_low"] <= known <= row["released_high"]
    assert row["peak_force_n_median"] == np.median(done.scan(["peak_force_n"])["peak_force_n"])


@pytest.mark.slow
def test_the_interval_covers_a_known_probability_as_often_as_it_says(pushed, largest_stiction_n):
    """400 studies of 50 parts each: at least 95 % of their intervals hold the truth."""
    law = bk.Normal(mean=550.0, std=40.0)
    batch = simulate_many(pushed, 20_000, vary={"joint.stiction_n": law}, metrics=["outcome"])
    failures = (batch["outcome"] != "released").reshape(400, 50).sum(axis=1)
    known = norm.sf(largest_stiction_n, 550.0, 40.0)
    intervals = [clopper_pearson(int(k), 50, 0.95) for k in failures]
    covered = np.mean([low <= known <= high for low, high in intervals])
    assert covered >= 0.93  # 0.95 and more; three standard errors are 0.03


@pytest.mark.slow
def test_a_grid_has_every_combination_and_the_same_draws(tmp_path, quick):
    grid = {"joint.stiction_n": [400.0, 500.0], "disturbance.law": ["uniform", "gaussian"]}
    study = study_of("sweep", quick, runs=5, runs_per_piece=7, sweep={"grid": grid})
    done = run_study(study, out=tmp_path)
    assert [len(file.read_bytes()) > 0 for file in done.piece_files] == [True] * 3
    table = done.scan().to_pandas()
    assert table.groupby("point").run_index.apply(list).tolist() == [[0, 1, 2, 3, 4]] * 4
    for point, (stiction, law) in enumerate(
        (s, law) for s in grid["joint.stiction_n"] for law in grid["disturbance.law"]
    ):
        rows = table[table.point == point]
        assert set(rows["joint.stiction_n"]) == {stiction}
        assert set(rows["disturbance.law"]) == {law}
        alone = simulate_many(
            quick.with_({"joint.stiction_n": stiction, "disturbance.law": law}), 5
        )
        for name in ("iae_m_s", "peak_force_n", "final_position_m"):
            np.testing.assert_array_equal(rows[name], alone[name])


@pytest.mark.parametrize("design", ["random", "sobol", "latin_hypercube"])
def test_parts_do_not_change_the_draws(tmp_path, quick, design):
    values = {"runs": 64, "design": design, "vary": {"joint.stiction_n": SPREAD}}
    tables = []
    for size in (64, 9):
        study = study_of("sweep", quick, runs_per_piece=size, metrics=["peak_force_n"], **values)
        tables.append(run_study(study, out=tmp_path / str(size), threads=1).scan())
    assert tables[0].equals(tables[1])
    stiction = tables[0]["joint.stiction_n"].to_numpy()
    if design != "random":
        assert set(((stiction - 540.0) / 20.0 * 64).astype(int)) == set(range(64))


def test_reading_is_lazy_and_selective(tmp_path, pushed):
    study = study_of("sweep", pushed, runs=200, vary={"joint.stiction_n": NORMAL})
    run_study(study, out=tmp_path)
    done = open_study(tmp_path)
    stuck = done.scan(["run_index", "peak_force_n"], dataset.field("outcome") == "not_released")
    assert 0 < stuck.num_rows < 100
    assert stuck.schema.field("peak_force_n").metadata == {b"unit": b"N"}
    assert done.dataset.count_rows() == len(done.to_pandas()) == 200
    assert done.study == study
    assert repr(done) == "<study 'study', sweep, finished>"
    with pytest.raises(StudyError, match="nothing: is not a column; the columns are point"):
        done.scan(["nothing"])


def test_a_run_replays_to_the_same_bits(tmp_path, quick):
    grid = {"disturbance.hold_s": [1e-4, 2e-4]}
    study = study_of(
        "sweep", quick, runs=4, vary={"joint.stiction_n": SPREAD}, sweep={"grid": grid}
    )
    done = run_study(study, out=tmp_path)
    for row in done.scan().to_pylist():
        again = done.replay(row["point"], row["run_index"])
        assert again.metrics.iae_m_s == row["iae_m_s"]
        assert again.scenario.disturbance.hold_s == row["disturbance.hold_s"]
    with pytest.raises(StudyError, match="point 0, run 4: is not among the finished runs"):
        done.replay(0, 4)


# Robustness


def robust(scenario, **values):
    asked = {
        "over": "part_scale",
        "low": 0.5,
        "high": 8.0,
        "resolution": 0.5,
        "failure_probability_max": 0.1,
    }
    asked |= values.pop("asked", {})
    return study_of(
        "robustness",
        scenario,
        **{"runs": 200, "vary": {"joint.stiction_n": NARROW}, "robustness": asked, **values},
    )


@dataclass
class InMemory:
    """Runs of a point, without a folder."""

    point: object

    def outcomes(self):
        batch = self.point.simulate(
            range(len(self.point.runs)), metrics=(), threads=1, progress=lambda *_: None
        )
        return batch.outcome_codes.astype(np.int8)


def conducted(study):
    return RobustnessPlan(study).conduct(lambda points, _: [InMemory(point) for point in points])


@pytest.mark.slow
def test_the_level_that_is_claimed_is_right_as_often_as_it_says(pushed, largest_stiction_n):
    """550 N +- 6.25 N times the scale fails above the limit: the largest scale is known."""
    known = (largest_stiction_n - 550.0) / (6.25 * norm.isf(0.1))  # where a tenth is above
    assert 6.3 < known < 6.4
    claims = [
        conducted(robust(pushed, seed=seed, asked={"resolution": 0.1})).facts["survived"]
        for seed in range(25)
    ]
    assert np.mean([claim <= known for claim in claims]) >= 0.85  # 0.95 but for chance
    assert min(claims) > 4.5  # and it does not claim little to be safe


def test_the_result_says_what_it_means(tmp_path, pushed):
    done = run_study(robust(pushed), out=tmp_path)
    summary = done.summary
    assert re.fullmatch(
        r"part_scale = 5 survived with failure probability <= 0\.1 at 95 % confidence "
        r"\(\d+ failures? in 200 runs; failure: diverged, not_released, limit_exceeded; "
        r"no disturbance\)",
        summary["result"][0],
    )
    trail = summary["tables"]["trail"]
    assert [row["part_scale"] for row in trail[:3]] == [0.5, 8.0, 4.0]
    for row in trail:
        bound = clopper_pearson(row["failures"], row["runs"], 0.9)[1]  # one-sided at 95 %
        assert row["upper_bound"] == pytest.approx(bound)
        assert row["survived"] == (bound <= 0.1)
        assert row["failures"] == row["not_released"]
    assert summary["survived"] == max(row["part_scale"] for row in trail if row["survived"])
    assert summary["runs_against_the_presumption"] == 0
    assert summary["runs"] == 200 * len(trail) == done.dataset.count_rows()


@pytest.mark.parametrize(("kind", "other"), [("uniform", "normal"), ("log_uniform", "log_normal")])
def test_a_law_that_fills_its_range_is_not_widened(pushed, kind, other):
    vary = {"joint.stiction_n": {**SPREAD, "distribution": kind}}
    with pytest.raises(StudyError) as no:
        robust(pushed, vary=vary)
    assert str(no.value) == (
        f"robustness.high: vary.joint.stiction_n: factor: 8.0 is not <= 1, because the "
        f"distribution {kind!r} fills its range; give at most 1, or the distribution {other!r} "
        "with the same low and high"
    )
    narrowed = robust(pushed, vary=vary, asked={"low": 0.1, "high": 1.0, "resolution": 0.1})
    assert narrowed.robustness.high == 1.0


def test_parts_of_every_scale_stay_within_their_range(pushed):
    bounded = bk.Normal(mean=550.0, std=10.0, low=500.0, high=570.0)
    study = robust(pushed, runs=500, vary={"joint.stiction_n": bounded.model_dump()})
    drawn = RobustnessPlan(study).points[-1].draw(range(500))["joint.stiction_n"]
    assert 500.0 <= drawn.min() < 505.0 and 565.0 < drawn.max() <= 570.0


def test_a_disturbance_is_named_with_the_result(tmp_path, quick):
    asked = {"over": "disturbance.var", "low": 0.1, "high": 0.31, "resolution": 0.01}
    study = robust(quick, runs=50, vary={}, asked=asked | {"failure": ["diverged"]})
    result = run_study(study, out=tmp_path).summary["result"][0]
    assert result == (
        "disturbance.var = 0.31 at least, the highest level tried, survived with failure "
        "probability <= 0.1 at 95 % confidence (0 failures in 50 runs; failure: diverged; uniform "
        "disturbance of the joint force, held 0.1 ms)"
    )


def test_a_lowest_level_that_is_not_survived_is_no_number(pushed):
    found = conducted(robust(pushed, asked={"low": 7.5}))
    assert found.facts["survived"] is None
    assert found.result[0].startswith("part_scale = 7.5, the lowest level, was not shown to be")
    assert len(found.tables["trail"]) == 1


def test_the_controller_does_not_know_the_level(quick):
    """Gains are designed for the scenario as it stands, not for the level that is tried."""
    asked = {"over": "joint.stiffness_n_per_m", "low": 1e7, "high": 3e7, "resolution": 1e6}
    plan = RobustnessPlan(robust(quick, vary={}, asked=asked))
    gains = {plan.scenario_at(p.labels).controller.gains.kp_n_per_m for p in plan.points}
    assert gains == {bk.resolve(quick).controller.gains.kp_n_per_m}


@pytest.mark.parametrize("count", [1, 2, 3, 10, 37])
def test_bisection_finds_the_last_place(count):
    for last in range(-1, count):
        tried = []

        def passes(place, last=last, tried=tried):
            tried.append(place)
            return place <= last

        assert largest_true(count, passes) == (last if last >= 0 else None)
        assert len(set(tried)) == len(tried) or count == 1
        assert len(tried) <= 2 + np.ceil(np.log2(max(count - 1, 1)))


def test_runs_that_fail_and_survive_a_higher_level_are_told(pushed):
    """Three runs that fail at the lower levels only, as no part of a real one does."""
    plan = RobustnessPlan(robust(pushed, asked={"low": 1.0, "high": 2.0, "resolution": 0.5}))

    class Odd:
        def __init__(self, point):
            self.fails = point.labels["part_scale"] != 2.0

        def outcomes(self):
            codes = np.zeros(200, dtype=np.int8)
            codes[:3] = OUTCOMES.index("diverged") if self.fails else 0
            return codes

    found = plan.conduct(lambda points, _: [Odd(point) for point in points])
    assert found.facts["runs_against_the_presumption"] == 3
    assert "holds for each level by itself" in found.notes[1]


# Sensitivity


def test_indices_of_a_known_function(pushed):
    """The metric is replaced by a sum whose indices are known: 4/5 and 1/5 of the variance."""
    pytest.importorskip("SALib")
    vary = {
        "joint.stiction_n": {"distribution": "uniform", "low": 400.0, "high": 402.0},
        "part.mass_kg": {"distribution": "uniform", "low": 1.0, "high": 2.0},
    }
    study = study_of("sensitivity", pushed, runs=512, vary=vary, metrics=["peak_force_n"])
    from breakaway.ask.studies.sensitivity import SensitivityPlan

    plan = SensitivityPlan(study)

    class Known:
        def __init__(self, point):
            columns = point.draw(point.runs)
            self.value = columns["joint.stiction_n"] - 400.0 + columns["part.mass_kg"]

        def outcomes(self):
            return np.zeros(512, dtype=np.int8)

        def column(self, _):
            return self.value

    rows = plan.conduct(lambda points, _: [Known(p) for p in points]).tables["indices"]
    assert [row["input"] for row in rows] == ["joint.stiction_n", "part.mass_kg"]
    for row, share in zip(rows, (0.8, 0.2), strict=True):
        assert row["first_order"] == pytest.approx(share, abs=0.01)
        assert row["total_order"] == pytest.approx(share, abs=0.01)


def test_draws_of_the_disturbance_are_an_input(tmp_path, quick):
    """What the disturbance does is told apart from what a part does that hardly matters."""
    pytest.importorskip("SALib")
    vary = {"part.mass_kg": {"distribution": "uniform", "low": 1.0, "high": 1.0001}}
    metrics = ["peak_force_n", "time_to_release_s", "impacts"]
    study = study_of("sensitivity", quick, runs=64, vary=vary, metrics=metrics)
    done = run_study(study, out=tmp_path)
    summary = done.summary
    found = {row["input"]: row for row in summary["tables"]["indices"]}
    assert found["disturbance draws"]["total_order"] > 0.7
    assert abs(found["part.mass_kg"]["total_order"]) < 0.01
    assert summary["without_indices"] == {
        "time_to_release_s": "missing in 256 of 256 runs",
        "impacts": "the same in all runs",
    }
    runs = {b: set(done.scan(["run_index"], dataset.field("block") == b)["run_index"].to_pylist())
            for b in ("A", "B", "part.mass_kg", "disturbance draws")}  # fmt: skip
    assert runs["A"] == runs["part.mass_kg"] == set(range(64))
    assert runs["B"] == runs["disturbance draws"] == set(range(64, 128))


def test_a_missing_salib_is_named(tmp_path, quick, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "SALib.analyze.sobol", None)
    study = study_of("sensitivity", quick, runs=8, vary={"joint.stiction_n": SPREAD})
    with pytest.raises(StudyError, match=r"pip install 'breakaway\[sensitivity\]'"):
        run_study(study, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


# Compare


def test_controllers_are_compared_pair_by_pair(tmp_path, pushed, largest_stiction_n):
    controllers = [
        {"name": "weak"},
        {"name": "strong", "changes": {"actuator.force_max_n": 640.0}},
        {"name": "other", "scenario": "paper_as_computed_vibration_bounded"},
    ]
    study = study_of(
        "compare",
        pushed,
        runs=300,
        runs_per_piece=128,
        vary={"joint.stiction_n": NORMAL},
        metrics=["peak_force_n", "time_to_release_s"],
        compare={"controllers": controllers},
    )
    done = run_study(study, out=tmp_path)
    table = done.to_pandas()
    by_name = {name: rows.set_index("run_index") for name, rows in table.groupby("controller")}
    weak, strong = by_name["weak"], by_name["strong"]
    np.testing.assert_array_equal(weak["joint.stiction_n"], strong["joint.stiction_n"])
    row = done.summary["tables"]["outcomes"][1]
    between = (weak["joint.stiction_n"] > largest_stiction_n) & (strong.outcome == "released")
    assert row["only_this_released"] == between.sum() > 0
    assert row["only_first_released"] == 0
    assert row["p"] == pytest.approx(2.0 ** (1 - int(between.sum())))
    paired = done.summary["tables"]["differences"][0]
    expected = strong.peak_force_n - weak.peak_force_n
    assert paired["pairs"] == 300
    assert paired["difference"] == pytest.approx(expected.median())
    assert paired["difference_low"] <= expected.median() <= paired["difference_high"]
    assert paired["lower_share"] == (expected < 0).mean()
    assert done.replay(2, 7).metrics.peak_force_n == by_name["other"].peak_force_n[7]


@pytest.mark.parametrize("name", ["manifest.json", "summary.json"])
def test_json_is_strict(tmp_path, pushed, name):
    run_study(study_of("sweep", pushed, runs=2, vary={"joint.stiction_n": NORMAL}), out=tmp_path)

    def refuse(word):
        raise AssertionError(word)

    json.loads((tmp_path / name).read_text(), parse_constant=refuse)
