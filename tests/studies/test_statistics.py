"""Intervals hold what they promise."""

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from breakaway.ask.studies.statistics import (
    clopper_pearson,
    mcnemar,
    median_interval,
    runs_needed,
    upper_bound,
)

COUNTS = [(0, 1), (1, 1), (0, 50), (3, 50), (50, 50), (7, 10_000), (999_999, 1_000_000)]


@pytest.mark.parametrize(("events", "runs"), COUNTS)
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_intervals_are_those_of_scipy(events, runs, confidence):
    expected = binomtest(events, runs).proportion_ci(confidence, method="exact")
    assert clopper_pearson(events, runs, confidence) == pytest.approx(expected, abs=1e-9)
    one_sided = binomtest(events, runs, alternative="less").proportion_ci(confidence, "exact")
    assert upper_bound(events, runs, confidence) == pytest.approx(one_sided.high, abs=1e-9)


@pytest.mark.parametrize("runs", [5, 30, 400])
@pytest.mark.parametrize("confidence", [0.9, 0.95])
def test_intervals_cover_at_least_as_often_as_they_say(runs, confidence):
    """Exactly so: over all numbers of events, each with its probability."""
    events = np.arange(runs + 1)
    intervals = np.array([clopper_pearson(k, runs, confidence) for k in events])
    bounds = np.array([upper_bound(k, runs, confidence) for k in events])
    for probability in np.linspace(0.001, 0.999, 101):
        weight = binom.pmf(events, runs, probability)
        within = (intervals[:, 0] <= probability) & (probability <= intervals[:, 1])
        assert weight[within].sum() >= confidence - 1e-9
        assert weight[probability <= bounds].sum() >= confidence - 1e-9


@pytest.mark.parametrize(("probability", "confidence"), [(0.001, 0.95), (0.1, 0.99), (0.5, 0.5)])
def test_the_fewest_runs_that_can_show_a_probability(probability, confidence):
    needed = runs_needed(probability, confidence)
    assert upper_bound(0, needed, confidence) <= probability * (1 + 1e-12)
    if needed > 1:
        assert upper_bound(0, needed - 1, confidence) > probability


@pytest.mark.parametrize("pair", [(0, 0), (0, 1), (3, 9), (40, 12), (500, 600)])
def test_mcnemar_is_the_binomial_test(pair):
    expected = 1.0 if sum(pair) == 0 else binomtest(pair[0], sum(pair), 0.5).pvalue
    assert mcnemar(*pair) == pytest.approx(expected)


@pytest.mark.parametrize("count", [6, 7, 25, 1000])
def test_intervals_of_medians_cover(count):
    """Values outside on either side are binomial with 1/2."""
    found = median_interval(np.arange(1.0, count + 1.0), 0.95)
    below = int(found.low)
    assert 2 * binom.cdf(below - 1, count, 0.5) <= 0.05 < 2 * binom.cdf(below, count, 0.5)
    assert found.high == count + 1 - below
    draws = np.random.default_rng(1).standard_exponential((2000, count))
    covered = [
        found.low <= np.log(2.0) <= found.high
        for found in (median_interval(row, 0.95) for row in draws[:500])
    ]
    assert np.mean(covered) > 0.93


def test_too_few_values_have_no_interval():
    assert median_interval(np.arange(5.0), 0.95).low is None
    assert median_interval(np.arange(6.0), 0.95).low == 0.0
