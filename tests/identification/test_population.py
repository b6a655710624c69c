"""Populations: known distributions, coverage of the intervals, lower bounds, repeats, refusals."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

import breakaway as bk
from breakaway.ask.studies.study import RobustnessStudy
from breakaway.errors import LogError
from breakaway.measure.identification.censored import (
    FittedDistribution,
    fit_distribution,
    kaplan_meier,
)
from breakaway.measure.identification.events import BreakawayReport, find_breakaway_events
from breakaway.measure.identification.population import fit_population
from breakaway.measure.logs.log import Log

MEDIAN_N, SIGMA = 450.0, 0.3

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


def draws(seed: int, count: int = 40) -> tuple[Array, Bools]:
    """Draw breakaway forces, of which about 30 % are hidden above a limit of their own."""
    rng = np.random.default_rng(seed)
    force = MEDIAN_N * np.exp(SIGMA * rng.standard_normal(count))
    limit = MEDIAN_N * np.exp(0.22 + SIGMA * rng.standard_normal(count))
    return np.minimum(force, limit), limit < force


def report_of(*events: tuple[float, float, bool], like: BreakawayReport) -> BreakawayReport:
    """Make a report of events with a breakaway and a sliding force each."""
    made = [
        replace(
            like.events[0],
            breakaway_force_n=hold,
            sliding_force_n=slide,
            breakaway_over_sliding=hold / slide,
            is_lower_bound=bound,
        )
        for hold, slide, bound in events
    ]
    return replace(like, events=tuple(made))


@pytest.fixture(scope="module")
def like() -> BreakawayReport:
    t_s = np.arange(400) / 100.0
    load = np.where(t_s <= 1.0, 90.0 * t_s, 40.0)
    x = 0.01 * np.maximum(t_s - 1.0, 0.0)
    return find_breakaway_events(Log(t_s=t_s, position_m=x, force_n=load))


@pytest.fixture(scope="module")
def fitted() -> list[FittedDistribution]:
    return [fit_distribution(*draws(seed)) for seed in range(200)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "truth"), [("median", MEDIAN_N), ("sigma", SIGMA)])
def test_intervals_cover_the_truth(
    fitted: list[FittedDistribution], name: str, truth: float
) -> None:
    inside = [fit.interval[name][0] <= truth <= fit.interval[name][1] for fit in fitted]
    assert 0.90 <= np.mean(inside) <= 0.99
    score = [(fit.parameters[name] - truth) / fit.standard_error[name] for fit in fitted]
    assert 0.85 < np.std(score) < 1.2
    shares = [fit.censored / len(fit.values) for fit in fitted]
    assert np.mean(shares) == pytest.approx(0.3, abs=0.02)


def test_taking_lower_bounds_for_values_is_biased(fitted: list[FittedDistribution]) -> None:
    medians = np.array([fit.parameters["median"] for fit in fitted])
    ignored = [
        np.exp(np.log(fit.values).mean()) for fit in fitted
    ]  # the likelihood's maximum without lower bounds
    assert np.mean(medians) == pytest.approx(MEDIAN_N, rel=0.01)
    assert np.mean(ignored) < 0.95 * MEDIAN_N
    left_out = [np.exp(np.log(fit.values[~fit.is_lower_bound]).mean()) for fit in fitted]
    assert np.mean(left_out) < 0.95 * MEDIAN_N


def test_without_lower_bounds_it_is_the_mean_and_its_error() -> None:
    values, _ = draws(1)
    fit = fit_distribution(values, np.zeros(len(values), dtype=bool))
    y = np.log(values)
    assert fit.parameters["median"] == pytest.approx(np.exp(y.mean()), rel=1e-6)
    assert fit.parameters["sigma"] == pytest.approx(y.std(), rel=1e-5)
    error = fit.parameters["median"] * y.std() / np.sqrt(len(y))
    assert fit.standard_error["median"] == pytest.approx(error, rel=1e-4)
    error = y.std() / np.sqrt(2 * len(y))
    assert fit.standard_error["sigma"] == pytest.approx(error, rel=1e-3)
    log_l = -0.5 * len(y) * (np.log(2 * np.pi * y.var()) + 1.0) - y.sum()
    assert fit.aic["log_normal"] == pytest.approx(4.0 - 2.0 * log_l)


def test_normal_and_log_normal_are_told_apart() -> None:
    rng = np.random.default_rng(2)
    skewed = np.exp(0.6 * rng.standard_normal(100))
    none = np.zeros(100, dtype=bool)
    assert (aic := fit_distribution(skewed, none).aic)["log_normal"] < aic["normal"] - 10.0
    even = 10.0 + rng.standard_normal(100)
    fit = fit_distribution(even - 10.0, none, kind="normal")
    assert list(fit.aic) == ["normal"]
    assert fit.parameters == pytest.approx({"mean": 0.0, "std": 1.0}, abs=0.25)


def test_units_scale_the_fit() -> None:
    values, bound = draws(3)
    one = fit_distribution(values, bound)
    milli = fit_distribution(1e3 * values, bound)
    assert milli.parameters["median"] == pytest.approx(1e3 * one.parameters["median"])
    assert milli.parameters["sigma"] == pytest.approx(one.parameters["sigma"])
    assert milli.interval["sigma"] == pytest.approx(one.interval["sigma"], rel=1e-5)
    order = np.random.default_rng(0).permutation(len(values))
    other = fit_distribution(values[order], bound[order])
    assert other.parameters == pytest.approx(one.parameters)


def test_survival_of_a_textbook_sample() -> None:
    # Freireich's 6-MP remission times, weeks, as Kaplan and Meier's method is usually shown.
    weeks = [6, 6, 6, 6, 7, 9, 10, 10, 11, 13, 16, 17, 19, 20, 22, 23, 25, 32, 32, 34, 35]
    lost = [0, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1]
    share = kaplan_meier(np.array(weeks, dtype=float), np.array(lost, dtype=bool))
    known = {6: 0.857, 7: 0.807, 10: 0.753, 13: 0.690, 16: 0.627, 22: 0.538, 23: 0.448}
    for week, value in known.items():
        assert share[weeks.index(week)] == pytest.approx(value, abs=5e-4)


def test_distance_tells_two_kinds_of_parts_from_one() -> None:
    one, _ = draws(4, 200)
    none = np.zeros(200, dtype=bool)
    fit = fit_distribution(one, none)
    assert fit.distance < fit.distance_limit
    two = np.concatenate([one[:100] / 10.0, one[100:]])
    fit = fit_distribution(two, none)
    assert fit.distance > fit.distance_limit
    assert np.all(np.diff(fit.expected) >= 0.0)


def test_an_interval_may_have_no_end() -> None:
    values = np.array([1.0, 1.1, *([2.0] * 30)])
    fit = fit_distribution(values, values == 2.0)
    assert fit.interval["median"][1] == np.inf or fit.interval["median"][1] > 100.0
    assert fit.interval["median"][0] > 1.1


# Logs and reports


def test_parts_with_repeats_count_once(like: BreakawayReport) -> None:
    reports = [
        report_of((100.0, 50.0, False), like=like),
        report_of((110.0, 50.0, False), (140.0, 55.0, False), like=like),
        report_of((150.0, 60.0, True), like=like),
        report_of((130.0, 52.0, False), (150.0, 52.0, True), (125.0, 52.0, False), like=like),
        report_of((130.0, 52.0, True), (150.0, 52.0, False), (160.0, 52.0, False), like=like),
    ]
    population = fit_population(reports)
    assert population.table["breakaway_force_n"].tolist() == [100.0, 125.0, 150.0, 130.0, 150.0]
    # A bound above the median leaves it alone; one below it may raise it.
    assert population.bounds["breakaway_force_n"].tolist() == [False, False, True, False, True]
    assert not population.bounds["sliding_force_n"].any()
    assert (population.events, population.repeats) == (10, 3)


def test_logs_of_one_part_are_named(like: BreakawayReport) -> None:
    reports = [report_of((f, 50.0, False), like=like) for f in (100.0, 120.0, 90.0, 140.0)]
    population = fit_population(reports, parts=["a", "b", "a", "c"])
    assert population.parts == ("a", "b", "c")
    assert population.table["breakaway_force_n"].tolist() == [95.0, 120.0, 140.0]


def test_refused_starts_are_counted(like: BreakawayReport) -> None:
    refused = replace(like, events=(), refused=("is already moving",))
    reports = [report_of((f, 50.0, False), like=like) for f in (100.0, 120.0, 90.0)]
    population = fit_population([*reports, refused, replace(like, events=())])
    assert population.refused == ("log: is already moving", "log: has no start from rest")
    assert len(population.parts) == 3


def test_the_fit_is_the_spread_of_a_study(like: BreakawayReport) -> None:
    rng = np.random.default_rng(5)
    slide = 360.0 * np.exp(0.1 * rng.standard_normal(30))
    hold = slide * 1.3 * np.exp(0.02 * rng.standard_normal(30))
    population = fit_population(
        [report_of((h, s, False), like=like) for h, s in zip(hold, slide, strict=True)]
    )
    spread = population.distributions()
    assert list(spread) == ["joint.stiction_n", "joint.coulomb_n"]
    assert isinstance(spread["joint.stiction_n"], bk.LogNormal)
    together = population.correlated(500, seed=3)
    study = RobustnessStudy(
        scenario="paper_as_computed",
        runs=300,
        vary=together,
        robustness={
            "over": "part_scale",
            "low": 0.5,
            "high": 1.0,
            "resolution": 0.1,
            "failure_probability_max": 0.1,
        },
    )
    assert study.draws()
    high, low = (np.asarray(together[field].values) for field in spread)
    assert np.all(high >= low)
    assert np.corrcoef(np.log(high), np.log(low))[0, 1] == pytest.approx(
        population.correlation, abs=0.05
    )
    assert np.median(high) == pytest.approx(spread["joint.stiction_n"].median, rel=0.03)
    assert together == population.correlated(500, seed=3)
    assert together != population.correlated(500, seed=4)


def test_logs_are_searched() -> None:
    t_s = np.arange(400) / 100.0
    x = 0.01 * np.maximum(t_s - 1.0, 0.0)
    load = np.where(t_s <= 1.0, 90.0 * t_s, 40.0)
    logs = [Log(t_s=t_s, position_m=x, force_n=f * load) for f in (0.8, 1.0, 1.5)]
    fits = fit_population(logs).fits
    assert fits["breakaway_force_n"].values.tolist() == pytest.approx([72.0, 90.0, 135.0])


# Refusals


@pytest.mark.parametrize(
    ("values", "bounds", "words"),
    [
        ([1.0, 2.0], [0, 0], "2 parts gave a value; at least 3 are needed"),
        ([1.0, 2.0, 3.0], [1, 1, 1], "0 of 3 values are not lower bounds"),
        ([1.0, 2.0, 3.0], [0, 1, 1], "1 of 3 values are not lower bounds"),
        ([2.0, 2.0, 2.0], [0, 0, 0], "1 of them different; at least 2"),
        ([-1.0, 2.0, 3.0], [0, 0, 0], "the smallest value is -1; .* needs finite values > 0"),
        ([1.0, np.nan, 3.0], [0, 0, 0], "needs finite values"),
        ([1.0, 2.0, 3.0], [0, 0], "one-dimensional and of the same length"),
    ],
)
def test_values_that_can_not_be_fitted(values: list[float], bounds: list[int], words: str) -> None:
    with pytest.raises(LogError, match=words):
        fit_distribution(values, bounds)


def test_settings_are_checked(like: BreakawayReport) -> None:
    reports = [report_of((f, 50.0, False), like=like) for f in (100.0, 120.0, 90.0)]
    with pytest.raises(LogError, match="distribution: 'weibull' is not one of log_normal"):
        fit_population(reports, distribution="weibull")  # type: ignore[arg-type]
    with pytest.raises(LogError, match=r"confidence is 95; it must be > 0 and < 1"):
        fit_population(reports, confidence=95)
    with pytest.raises(LogError, match="1 names of parts for 3 logs; give one for each"):
        fit_population(reports, parts=["a"])
    with pytest.raises(LogError, match=r"count is 0; it must be 1 to 1000000"):
        fit_population(reports).correlated(0)


def test_too_few_events_say_why(like: BreakawayReport) -> None:
    refused = replace(like, events=(), refused=("is already moving at 3.1 mm/s",))
    with pytest.raises(LogError, match=r"breakaway_force_n: 1 parts .*; log: is already moving"):
        fit_population([like, refused])
    with pytest.raises(LogError, match="0 parts gave a value"):
        fit_population([])
