"""Scores and their intervals."""

from math import inf

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.tuning.scores import METRICS, Score, quantile_score, score_kind


@pytest.mark.parametrize("metric", METRICS)
def test_every_metric_has_quantiles(metric):
    assert score_kind(f"median_{metric}").quantile == 0.5
    assert score_kind(f"p99.5_{metric}").quantile == 0.995
    assert not score_kind(f"p1_{metric}").more_is_better


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("strict", "did you mean strict_share"),
        ("p99_largest_jmp_m", "did you mean p99_largest_jump_m"),
        ("time_to_release_s", "did you mean median_time_to_release_s"),
        ("p0_largest_jump_m", "give p1 to p100"),
        ("p101_largest_jump_m", "give p1 to p100"),
        ("?", "give one of released_share, gentle_share, strict_share, or a quantile"),
        ("median_stop_reason", "is not a score"),
    ],
)
def test_what_is_no_score(name, words):
    with pytest.raises(bk.StudyError, match="is not a score") as error:
        score_kind(name)
    assert words in str(error.value)


@pytest.mark.parametrize(("quantile", "place"), [(0.01, 1), (0.5, 50), (0.99, 99), (1.0, 100)])
def test_a_quantile_is_one_of_the_values(quantile, place):
    values = np.random.default_rng(1).permutation(np.arange(1.0, 101.0))
    assert quantile_score(values, quantile, 0.95).value == place


@pytest.mark.parametrize("quantile", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("count", [20, 101])
def test_intervals_hold_the_quantile_as_often_as_they_say(quantile, count):
    rng = np.random.default_rng(7)
    held = 0
    for _ in range(2000):
        score = quantile_score(rng.random(count), quantile, 0.9)
        assert score.low <= score.value <= score.high
        held += score.low <= quantile <= score.high
    assert held / 2000 > 0.9 - 3 * np.sqrt(0.09 / 2000)


def test_too_few_values_have_no_upper_end():
    assert quantile_score(np.arange(100.0), 0.99, 0.95).high == inf
    assert quantile_score(np.arange(100.0), 0.01, 0.95).low == 0.0


def test_scores_survive_json():
    score = Score(0.1, 0.0, inf)
    assert Score.of_json(score.as_json()) == score
