"""Failures that are counted are those that are known to happen."""

import numpy as np
import pytest
from scipy import stats

import breakaway as bk

FORCE_MAX_N = 600.0
LENGTH_M = 2e-3
STIFFNESS = 3.6e7
WEIGHT_N = 9.81
STICTION = bk.Normal(mean=560.0, std=60.0, low=450.0, high=760.0)
# F_s falls linearly over the guide to the weight at its end; a stuck joint under F_max is at
# x = F_max / k_e and breaks loose if its F_s(x) is less than F_max.
SHARE = FORCE_MAX_N / STIFFNESS / LENGTH_M
LARGEST_STICTION_N = (FORCE_MAX_N - SHARE * WEIGHT_N) / (1.0 - SHARE)
P_FAILURE = float(stats.truncnorm(-110.0 / 60.0, 200.0 / 60.0, 560.0, 60.0).sf(LARGEST_STICTION_N))


@pytest.fixture(scope="module")
def pushed():
    """Give a part that is released exactly where its stiction is within what can be pushed."""
    scenario = bk.load_scenario("paper_as_computed").with_(
        joint=bk.TwoRegion(
            stiction_n=500.0,
            coulomb_n=100.0,
            stiffness_n_per_m=STIFFNESS,
            damping_n_s_per_m=13_000.0,  # no overshoot
            engagement_length_m=LENGTH_M,
        ),
        reference=bk.MinimumJerk(distance_m=2.1e-3, duration_s=0.004),
        actuator=bk.PushOnlyActuator(force_max_n=FORCE_MAX_N),
        timing={"duration_s": 0.014},
        limits={"diverged_error_m": 1.0, "diverged_force_n": 1e6},
    )
    return scenario.with_({"controller.anti_windup": "conditional"})


def fails(scenario, runs, **options):
    batch = bk.simulate_many(
        scenario, runs, vary={"joint.stiction_n": STICTION}, metrics=["outcome"], **options
    )
    assert set(batch["outcome"]) <= {"released", "not_released"}
    return batch, batch["outcome"] == "not_released"


def test_failures_are_as_many_as_there_should_be(pushed):
    """Within what a binomial number exceeds once in a million times."""
    runs = 6000
    assert 0.1 < P_FAILURE < 0.5
    batch, failed = fails(pushed, runs)
    stiction = batch["joint.stiction_n"]
    np.testing.assert_array_equal(failed, stiction > LARGEST_STICTION_N)
    low, high = stats.binom(runs, P_FAILURE).interval(1.0 - 1e-6)
    assert low <= failed.sum() <= high


@pytest.mark.parametrize("design", ["sobol", "latin_hypercube"])
def test_even_designs_are_nearer(pushed, design):
    """A share of one number has to be right to one run and a half either side."""
    _, failed = fails(pushed, 512, design=design)
    assert abs(failed.sum() - 512 * P_FAILURE) <= 2.0


@pytest.mark.slow
def test_intervals_cover_the_truth(pushed):
    """Clopper-Pearson, over small batches each with a seed of its own."""
    batches, runs, confidence = 100, 24, 0.9
    missed = 0
    for seed in range(batches):
        _, failed = fails(pushed.with_(seed=seed), runs)
        found = stats.binomtest(int(failed.sum()), runs).proportion_ci(confidence, "exact")
        missed += not found.low <= P_FAILURE <= found.high
    assert missed <= stats.binom(batches, 1.0 - confidence).ppf(1.0 - 1e-6)
    assert missed >= 1  # or the intervals would say nothing
