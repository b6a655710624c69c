"""What tuning finds is what is known to be best."""

from dataclasses import replace

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.tuning import Evaluation, Score
from breakaway.ask.tuning.evaluation import (
    is_feasible,
    pareto_front,
    recommended,
    values_of,
    violations_of,
)

SPEED = "controller.speed_m_per_s"
pytestmark = pytest.mark.usefixtures("no_figures")


def test_the_fastest_feed_takes_the_least_time(feed, tmp_path):
    done = bk.tune(feed(evaluations=25), out=tmp_path)
    assert done.best_numbers[SPEED] > 0.038
    assert done.best.controller.speed_m_per_s == done.best_numbers[SPEED]
    slower = [e for e in done.evaluations if e.numbers[SPEED] < 0.9 * done.best_numbers[SPEED]]
    best = min(e.worst["median_time_to_release_s"].value for e in done.evaluations)
    assert all(e.worst["median_time_to_release_s"].value > best for e in slower)
    assert done.summary["recommended"]["file"] == "best.toml"


def test_a_constraint_holds_the_feed_back(feed, tmp_path):
    """A part leaves at about the speed of the feed: the best is as fast as the limit."""
    limit = 0.02
    tuning = feed(constraints={"p100_release_velocity_m_per_s": {"at_most": limit}}, evaluations=30)
    done = bk.tune(tuning, out=tmp_path)
    assert 0.85 * limit < done.best_numbers[SPEED] < 1.05 * limit
    trial = bk.run_trial(tuning.population, done.best, runs=tuning.training, seed=tuning.seed)
    assert trial.metrics["release_velocity_m_per_s"].max() <= limit
    assert "release_velocity_m_per_s <= 0.02: " in done.summary["result"][-1]


def test_scores_are_those_of_a_trial(feed, tmp_path):
    """On training and unseen parts, under the law where each is worst."""
    laws = ["lugre", "coulomb_stiction"]
    tuning = feed(laws=laws, evaluations=3, objectives=["strict_share", "median_time_to_release_s"])
    done = bk.tune(tuning, out=tmp_path)
    for runs, on in ((tuning.training, "training"), (tuning.test_runs.numbers, "unseen")):
        for method, of in ((done.best, done.summary["recommended"]["evaluation"]), (None, None)):
            trials = {
                law: bk.run_trial(
                    tuning.population, method or tuning.method, law=law, runs=runs, seed=0
                )
                for law in laws
            }
            shares = {law: t.within(t.population.strict).mean() for law, t in trials.items()}
            times = {
                law: np.sort(t.metrics["time_to_release_s"])[len(runs) // 2 - 1]
                for law, t in trials.items()
            }
            name = "start" if of is None else f"evaluation {of}"
            rows = [r for r in done.summary["scores"] if (r["of"], r["on"]) == (name, on)]
            found = {(row["score"], row["law"]): row["value"] for row in rows}
            for law in laws:
                assert found["strict_share", law] == shares[law]
                assert found["median_time_to_release_s", law] == times[law]
            assert found["strict_share", "worst"] == min(shares.values())
            assert found["median_time_to_release_s", "worst"] == max(times.values())


@pytest.mark.usefixtures("no_figures")
def test_scores_are_those_of_the_variation(feed, tmp_path):
    assert feed().variation == feed().population.variation == "field"
    tuning = feed(variation="part", evaluations=1)
    done = bk.tune(tuning, out=tmp_path)
    trial = bk.run_trial(
        tuning.population, tuning.method, variation="part", runs=tuning.training, seed=0
    )
    times = trial.metrics["time_to_release_s"]
    assert done.evaluations[0].worst["median_time_to_release_s"].value == np.sort(times)[5]
    assert done.summary["variation"] == "part"
    assert "friction varies from part to part (part)" in done.summary["notes"]
    assert "friction varies from part to part" in (tmp_path / "best.toml").read_text()


def test_the_method_as_it_is_comes_first(feed, tmp_path):
    tuning = feed(evaluations=2)
    done = bk.tune(tuning, out=tmp_path)
    assert done.evaluations[0].numbers == tuning.start == {SPEED: 0.0125}
    outside = feed(evaluations=2, tune={SPEED: {"low": 0.02, "high": 0.04}})
    assert outside.start is None
    done = bk.tune(outside, out=tmp_path / "outside")
    assert "is outside the ranges" in " ".join(done.summary["notes"])
    assert [r["value"] for r in done.summary["scores"] if r["of"] == "start"]


def test_what_does_not_free_is_not_gentle(feed, tmp_path):
    """A feed that is too slow to free any part suffers no force, and is infinitely bad."""
    tuning = feed(
        tune={SPEED: {"low": 1e-5, "high": 1e-4}},
        objectives=["median_largest_jump_m"],
        evaluations=3,
    )
    done = bk.tune(tuning, out=tmp_path)
    assert not any(is_feasible(tuning, evaluation) for evaluation in done.evaluations)
    for evaluation in done.evaluations:
        assert violations_of(tuning, evaluation) == {"median_largest_jump_m is finite": 1.5}
    assert done.summary["recommended"] is None
    assert "none of 3 evaluations met all constraints" in done.summary["result"][0]
    assert not (tmp_path / "best.toml").exists()
    with pytest.raises(bk.StudyError, match="none of 3 evaluations met all constraints"):
        _ = done.best
    assert done.front == []


def test_two_objectives_trade(feed, tmp_path):
    tuning = feed(objectives=["p100_release_velocity_m_per_s", "median_time_to_release_s"])
    done = bk.tune(tuning, out=tmp_path)
    front = pareto_front(tuning, done.evaluations)
    values = np.array([values_of(tuning, evaluation) for evaluation in front])
    assert len(values) > 4
    assert (np.diff(values[:, 0]) > 0).all() and (np.diff(values[:, 1]) < 0).all()
    for evaluation in done.evaluations:
        better = (values <= values_of(tuning, evaluation)).all(axis=1)
        assert better.any()
    rows = done.summary["front"]
    assert [row["file"] for row in rows] == [
        f"pareto_{i:02d}.toml" for i in range(1, 1 + len(rows))
    ]
    for method, row in zip(done.front, rows, strict=True):
        assert method.controller.speed_m_per_s == row[SPEED]
    assert sum(row["recommended"] for row in rows) == 1
    assert done.best.controller.speed_m_per_s in [row[SPEED] for row in rows]


def made(number, share, time, freed=1.0):
    """Give an evaluation whose intervals reach 0.15 to both sides."""
    scores = {"strict_share": share, "median_time_to_release_s": time, "released_share": freed}
    made = {name: Score(value, value - 0.15, value + 0.15) for name, value in scores.items()}
    return Evaluation(number, {}, {"lugre": made})


def test_front_and_recommendation_by_hand(feed):
    tuning = feed(
        objectives=["strict_share", "median_time_to_release_s"],
        constraints={"released_share": {"at_least": 0.9}},
    )
    tried = [
        made(0, 0.5, 1.0),
        made(1, 1.0, 5.0),
        made(2, 0.9, 2.0),
        made(3, 0.9, 2.0),  # the same again
        made(4, 0.9, 3.0),  # worse than 2
        made(5, 1.0, 0.1, freed=0.8),  # violates
        replace(made(6, 1.0, 0.1), laws=None, refused="no"),
    ]
    front = pareto_front(tuning, tried)
    assert [evaluation.number for evaluation in front] == [1, 2, 0]
    assert recommended(tuning, front).number == 2  # 0.9 is within 0.85 to 1.15, and faster
    assert recommended(tuning, front[2:]).number == 0
    swapped = tuning.model_copy(update={"objectives": tuning.objectives[::-1]})
    swapped = bk.Tuning.parse(swapped.model_dump())
    assert recommended(swapped, pareto_front(swapped, tried)).number == 0  # fastest by far
    assert violations_of(tuning, tried[5])["released_share"] == pytest.approx(1 / 10)
    assert pareto_front(tuning, tried[5:]) == []
