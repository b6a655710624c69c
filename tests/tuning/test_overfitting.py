"""The gap between training and unseen parts is told in words."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.studies.statistics import clopper_pearson
from breakaway.ask.tuning.scores import Score, score_kind
from breakaway.ask.tuning.summary import verdict


@pytest.mark.usefixtures("no_figures")
def test_few_parts_are_overfitted(feed, tmp_path):
    """Tuned on one part alone: the summary says what is worth to believe."""
    done = bk.tune(feed(objectives=["strict_share"], training_runs=1, evaluations=4), out=tmp_path)
    (row,) = done.summary["overfitting"]
    assert (row["score"], row["training"]) == ("strict_share", 1.0)
    unseen = bk.run_trial(
        done.tuning.population, done.best, runs=done.tuning.test_runs.numbers, seed=0
    )
    events = int(unseen.within(unseen.population.strict).sum())
    assert row["unseen"] == events / 24
    assert (row["unseen_low"], row["unseen_high"]) == clopper_pearson(events, 24, 0.95)
    assert row["lost"] == 1.0 - row["unseen"]
    said = done.summary["result"][1]
    assert f"strict_share: 1 on 1 training parts, {row['unseen']:.4g} (95 %: " in said
    assert (row["verdict"], "no overfitting is shown" in said) == ("not shown", True)  # by one part


@pytest.mark.parametrize(
    ("name", "training", "unseen", "expected"),
    [
        ("strict_share", (0.9, 0.8, 0.95), (0.7, 0.6, 0.75), "overfitted"),
        ("strict_share", (0.9, 0.8, 0.95), (0.78, 0.75, 0.85), "perhaps overfitted"),
        ("strict_share", (0.9, 0.8, 0.95), (0.99, 0.98, 1.0), "not shown"),
        ("median_impacts", (10.0, 9.0, 12.0), (14.0, 13.0, 15.0), "overfitted"),
        ("median_impacts", (10.0, 9.0, 12.0), (12.5, 11.0, 15.0), "perhaps overfitted"),
        ("median_impacts", (10.0, 9.0, 12.0), (5.0, 4.0, 6.0), "not shown"),
        ("median_impacts", (10.0, 9.0, 12.0), (11.5, 11.0, 15.0), "not shown"),
        ("p99_impacts", (10.0, 9.0, np.inf), (np.inf, 11.0, np.inf), "not shown"),
        ("p99_impacts", (10.0, 9.0, 11.0), (np.inf, 12.0, np.inf), "overfitted"),
    ],
)
def test_verdicts(name, training, unseen, expected):
    assert verdict(score_kind(name), Score(*training), Score(*unseen)) == expected
