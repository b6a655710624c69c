"""Distributions are what they say: against scipy, and whatever their numbers."""

import math
import sys

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy import stats

import breakaway as bk

RUNS = 20_000


def truncated(law, low=-np.inf, high=np.inf):
    """Give the distribution function of a law restricted to a range, from that of the whole law."""

    def cdf(x):
        below = law.cdf(low)
        return np.clip((law.cdf(x) - below) / (law.cdf(high) - below), 0.0, 1.0)

    return cdf


NORMAL = stats.norm(450.0, 50.0)
LOG_NORMAL = stats.lognorm(s=0.3, scale=450.0)
LAWS = {
    "uniform": (bk.Uniform(low=-2.0, high=5.0), stats.uniform(-2.0, 7.0).cdf),
    "log_uniform": (bk.LogUniform(low=1e-3, high=1e4), stats.loguniform(1e-3, 1e4).cdf),
    "normal": (bk.Normal(mean=450.0, std=50.0), NORMAL.cdf),
    "normal_low": (bk.Normal(mean=450.0, std=50.0, low=430.0), truncated(NORMAL, 430.0)),
    "normal_high": (bk.Normal(mean=450.0, std=50.0, high=400.0), truncated(NORMAL, high=400.0)),
    "normal_tail": (bk.Normal(mean=450.0, std=50.0, low=600.0), truncated(NORMAL, 600.0)),
    "normal_both": (
        bk.Normal(mean=450.0, std=50.0, low=440.0, high=520.0),
        truncated(NORMAL, 440.0, 520.0),
    ),
    "log_normal": (bk.LogNormal(median=450.0, sigma=0.3), LOG_NORMAL.cdf),
    "log_normal_low": (
        bk.LogNormal(median=450.0, sigma=0.3, low=300.0),
        truncated(LOG_NORMAL, 300.0),
    ),
    "log_normal_both": (
        bk.LogNormal(median=450.0, sigma=0.3, low=420.0, high=900.0),
        truncated(LOG_NORMAL, 420.0, 900.0),
    ),
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("design", ["random", "latin_hypercube", "sobol"])
def test_draws_have_their_distribution(name, design):
    """Kolmogorov-Smirnov; points that are spread evenly are nearer than random ones."""
    distribution, cdf = LAWS[name]
    values = bk.draw_columns({"x": distribution}, range(RUNS), seed=5, design=design)["x"]
    found = stats.kstest(values, cdf)
    assert found.pvalue > 1e-6
    if design != "random":
        assert found.statistic <= 5.0 / RUNS
    assert not np.isin(values, [distribution.model_dump().get(k) for k in ("low", "high")]).any()


U = np.array([2.0**-53, 0.1, 0.5, 0.9, 1.0 - 2.0**-53])


@pytest.mark.parametrize("low", [0.0, 1.0, 5.0, 9.0, 30.0])
def test_upper_tails_are_as_good_as_lower_ones(low):
    """A normal law is symmetric."""
    above = bk.Normal(mean=0.0, std=1.0, low=low).quantile(U)
    below = bk.Normal(mean=0.0, std=1.0, high=-low).quantile(1.0 - U)
    assert np.isfinite(above).all()
    np.testing.assert_allclose(above, -below, rtol=1e-9)


@pytest.mark.parametrize(
    "distribution", [bk.Normal(mean=2.0, std=1.0, low=1.0), bk.LogNormal(median=2.0, sigma=1.0)]
)
def test_scaling_a_normal_law_by_nothing_leaves_its_middle(distribution):
    np.testing.assert_allclose(distribution.scaled(0.0).quantile(U), 2.0)


def test_samples_are_equally_likely():
    values = [3.0, -1.0, 7.0, 7.5, 100.0]
    drawn = bk.draw_columns({"x": bk.Samples(values=values)}, range(RUNS), seed=1)["x"]
    counts = [(drawn == value).sum() for value in values]
    assert sum(counts) == RUNS
    assert stats.chisquare(counts).pvalue > 1e-6


SIZE = st.floats(-1e6, 1e6)
ABOVE_ZERO = st.floats(1e-6, 1e6)
SHARE = st.floats(1e-6, 1.0 - 1e-6)
OPTIONAL = st.none() | st.floats(-3.0, 3.0)


@st.composite
def distributions(draw):
    """Give any distribution; bounds of a truncated one are within three standard deviations."""
    kind = draw(st.sampled_from(["uniform", "log_uniform", "normal", "log_normal", "samples"]))
    if kind == "uniform":
        return bk.Uniform(
            **dict(zip(("low", "high"), sorted([draw(SIZE), draw(SIZE)]), strict=True))
        )
    if kind == "log_uniform":
        low, high = sorted([draw(ABOVE_ZERO), draw(ABOVE_ZERO)])
        return bk.LogUniform(low=low, high=high)
    if kind == "samples":
        return bk.Samples(values=draw(st.lists(SIZE, min_size=1, max_size=20)))
    low, high = draw(OPTIONAL), draw(OPTIONAL)
    if low is not None and high is not None:
        low, high = sorted([low, high])
        assume(high - low > 1e-3)
    if kind == "normal":
        mean, std = draw(SIZE), draw(ABOVE_ZERO)
        at = lambda z: None if z is None else mean + std * z  # noqa: E731
        return bk.Normal(mean=mean, std=std, low=at(low), high=at(high))
    median, sigma = draw(ABOVE_ZERO), draw(st.floats(1e-3, 3.0))
    at = lambda z: None if z is None else float(median * np.exp(sigma * z))  # noqa: E731
    return bk.LogNormal(median=median, sigma=sigma, low=at(low), high=at(high))


def range_of(distribution):
    if isinstance(distribution, bk.Samples):
        return min(distribution.values), max(distribution.values)
    low = -np.inf if distribution.low is None else distribution.low
    return low, np.inf if distribution.high is None else distribution.high


@given(distribution=distributions(), shares=st.lists(SHARE, min_size=2, max_size=10))
def test_quantiles_rise_within_the_range(distribution, shares):
    u = np.sort(np.array(shares))
    values = distribution.quantile(u)
    assert (values.shape, values.dtype) == (u.shape, np.float64)
    assert np.isfinite(values).all()
    low, high = range_of(distribution)
    size = max(abs(v) for v in (*values, 1.0))
    assert (values >= low - 1e-12 * size).all() and (values <= high + 1e-12 * size).all()
    if isinstance(distribution, bk.Samples):
        assert set(values) <= set(distribution.values)
    else:
        assert (np.diff(values) >= -1e-12 * size).all()
    for i, share in enumerate(u):  # a value depends on its own share only
        assert distribution.quantile(np.array([share]))[0] == values[i]


@given(distribution=distributions(), shares=st.lists(SHARE, min_size=1, max_size=5))
def test_scaling_by_one_changes_nothing(distribution, shares):
    u = np.array(shares)
    same = distribution.scaled(1.0)
    assert type(same) is type(distribution)
    values = distribution.quantile(u)
    spread = getattr(distribution, "std", 0.0) + abs(getattr(distribution, "mean", 0.0))
    size = max(map(abs, [*values, *filter(np.isfinite, range_of(distribution)), spread]))
    np.testing.assert_allclose(same.quantile(u), values, rtol=1e-6, atol=1e-6 * size)


def fills_its_range(distribution):
    return isinstance(distribution, bk.Uniform | bk.LogUniform)


def leaves_the_numbers(distribution, factor):
    """Whether samples above 0 move below the least number or beyond the largest."""
    if not isinstance(distribution, bk.Samples) or min(distribution.values) <= 0.0:
        return False
    logs = [math.log(value) for value in distribution.values]
    center = math.fsum(logs) / len(logs)
    moved = [center + factor * (one - center) for one in logs]
    least, largest = math.log(5e-324), math.log(sys.float_info.max)
    assume(all(abs(one - end) > 1.0 for one in moved for end in (least, largest)))
    return min(moved) < least or max(moved) > largest


@given(distribution=distributions(), factor=st.floats(0.01, 1000.0), share=SHARE)
def test_scaling_stays_within_the_range(distribution, factor, share):
    """No bound moves, whatever the factor; and what is above 0 stays above 0."""
    if fills_its_range(distribution) and factor > 1.0:
        with pytest.raises(bk.ScenarioError, match=r"^factor: .* is not <= 1, because the dist"):
            distribution.scaled(factor)
        return
    if isinstance(distribution, bk.LogNormal) and factor * distribution.sigma > 50.0:
        with pytest.raises(bk.ScenarioError, match=r"^sigma: .* is not <= 50"):
            distribution.scaled(factor)
        return
    if leaves_the_numbers(distribution, factor):
        with pytest.raises(bk.ScenarioError, match=r"^factor: .* beyond what a number can hold"):
            distribution.scaled(factor)
        return
    value = float(distribution.scaled(factor).quantile(np.array([share]))[0])
    low, high = range_of(distribution)
    if isinstance(distribution, bk.Samples):
        assert value > 0.0 or low <= 0.0
    else:
        assert low - 1e-9 * abs(low) <= value <= high + 1e-9 * abs(high)


@given(distribution=distributions(), factor=st.floats(0.01, 3.0), share=SHARE)
def test_scaling_stretches_about_the_middle(distribution, factor, share):
    """Without bounds every quantile moves from or to the center by the factor, or its logarithm."""
    factor = min(factor, 1.0) if fills_its_range(distribution) else factor
    if isinstance(distribution, bk.Normal | bk.LogNormal):
        distribution = distribution.model_copy(update={"low": None, "high": None})
    u = np.array([share])
    before = float(distribution.quantile(u)[0])
    after = float(distribution.scaled(factor).quantile(u)[0])
    positive = isinstance(distribution, bk.Samples) and min(distribution.values) > 0.0
    if isinstance(distribution, bk.LogUniform | bk.LogNormal) or positive:
        if positive:
            center = float(np.exp(np.log(distribution.values).mean()))
        elif isinstance(distribution, bk.LogNormal):
            center = distribution.median
        else:
            center = (distribution.low * distribution.high) ** 0.5
        assert np.log(after / center) == pytest.approx(
            factor * np.log(before / center), rel=1e-6, abs=1e-6
        )
        return
    if isinstance(distribution, bk.Uniform):
        center = (distribution.low + distribution.high) / 2
    elif isinstance(distribution, bk.Normal):
        center = distribution.mean
    else:
        center = float(np.mean(distribution.values))
    bounds = filter(np.isfinite, range_of(distribution))
    size = max(map(abs, [center, before, getattr(distribution, "std", 0.0), *bounds]))
    assert after - center == pytest.approx(factor * (before - center), rel=1e-6, abs=1e-6 * size)


@pytest.mark.parametrize(
    ("low", "high", "nearest"),
    [(300.0, None, 300.0), (300.0, 400.0, 300.0), (None, -300.0, -300.0)],
)
@pytest.mark.parametrize("std", [0.0, 1e-3, 1.0])
def test_a_law_far_outside_its_range_is_at_the_nearer_bound(low, high, nearest, std):
    values = bk.Normal(mean=0.0, std=std, low=low, high=high).quantile(U)
    np.testing.assert_allclose(values, nearest, rtol=1e-3)


@pytest.mark.parametrize(
    "distribution",
    [
        bk.Uniform(low=1.0, high=3.0),
        bk.LogUniform(low=1.0, high=4.0),
        bk.Samples(values=[1.0, 5.0]),
    ],
)
def test_scaling_by_nothing_leaves_no_spread(distribution):
    values = distribution.scaled(0.0).quantile(np.array([0.1, 0.5, 0.9]))
    assert np.ptp(values) == pytest.approx(0.0, abs=1e-12)


def test_scaled_samples_stay_shared():
    assert bk.Samples(values=[1.0, 2.0], rows="shared").scaled(2.0).rows == "shared"


REFUSED = [
    (bk.Uniform, {"low": 2.0, "high": 1.0}, r"^low: 2\.0 is not <= high = 1\.0; swap them$"),
    (bk.LogUniform, {"low": 0.0, "high": 1.0}, r"^low: 0\.0 is not > 0; give a number > 0"),
    (bk.LogUniform, {"low": 3.0, "high": 1.0}, r"^low: 3\.0 is not <= high = 1\.0; swap them$"),
    (bk.Normal, {"mean": 0.0, "std": -1.0}, r"^std: -1\.0 is not >= 0; give a number >= 0"),
    (bk.Normal, {"mean": 0.0, "std": 1.0, "low": 1.0, "high": 0.5}, r"^low: 1\.0 is not <= high"),
    (bk.Normal, {"mean": float("nan"), "std": 1.0}, r"^mean: nan is not finite"),
    (bk.LogNormal, {"median": -1.0, "sigma": 1.0}, r"^median: -1\.0 is not > 0"),
    (bk.LogNormal, {"median": 1.0, "sigma": 1.0, "low": 0.0}, r"^low: 0\.0 is not > 0"),
    (bk.LogNormal, {"median": 1.0, "sigma": 1.0, "mean": 1.0}, r"^mean: is not a known key"),
    (bk.Samples, {"values": []}, r"^values: "),
    (bk.Samples, {"values": [1.0, float("inf")]}, r"^values\S*: inf is not finite"),
    (bk.Samples, {"values": [1.0], "rows": "same"}, r"^rows: 'same' is not one of"),
]


@pytest.mark.parametrize(("law", "values", "message"), REFUSED)
def test_what_is_no_distribution_is_refused(law, values, message):
    with pytest.raises(bk.ScenarioError, match=message):
        law(**values)
