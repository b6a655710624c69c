"""Logs are cut, resampled and repaired on request only, and remember it."""

from collections.abc import Callable

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.logs import Channel, Log

FAST, SLOW = np.arange(5000) / 1000.0, 3.0 + np.arange(400) / 200.0


def two_rates() -> Log:
    return Log.from_channels(
        [Channel("position_m", FAST, 2.0 * FAST), Channel("force_n", SLOW, 1.0 - SLOW)]
    )


def motion(t_s: np.ndarray) -> Log:
    return Log(t_s=t_s, position_m=2.0 * t_s, force_n=1.0 - t_s, history=("made up",))


def test_resampled_to_a_rate_on_the_overlap() -> None:
    log = two_rates().resampled(rate_hz=100.0)
    assert (log.rows, log.t_s[0], log.t_s[-1]) == (200, 3.0, pytest.approx(4.99))
    np.testing.assert_allclose(log.position_m, 2.0 * log.t_s)
    np.testing.assert_allclose(log.force_n, 1.0 - log.t_s)
    assert log.history == ("interpolated linearly to 100 Hz",)


def test_resampled_to_the_stamps_of_a_channel() -> None:
    log = two_rates().resampled(like="force_n")
    np.testing.assert_array_equal(log.t_s, SLOW)
    np.testing.assert_array_equal(log.force_n, 1.0 - SLOW)
    assert log.history == ("interpolated linearly to the stamps of force_n",)


def test_resampled_refuses_gaps_unless_told() -> None:
    log = motion(np.concatenate([np.arange(50) / 100.0, 1.0 + np.arange(50) / 100.0]))
    words = r"'position_m' has a gap of 0.51 s after 0.49 s; .*log.between.*across_gaps=True"
    with pytest.raises(LogError, match=words):
        log.resampled(rate_hz=50.0)
    across = log.resampled(rate_hz=50.0, across_gaps=True)
    assert across.history[-1] == "interpolated linearly to 50 Hz, across 2 gaps"
    assert log.between(0.0, 0.49).resampled(rate_hz=50.0).rows == 25


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "needs either rate_hz or like"),
        ({"rate_hz": 1.0, "like": "force_n"}, "needs either rate_hz or like"),
        ({"like": "pressure_pa"}, "there is no channel 'pressure_pa'"),
        ({"rate_hz": -1.0}, "rate_hz is -1.0; it must be > 0"),
        ({"rate_hz": float("nan")}, "rate_hz is nan"),
        ({"rate_hz": 1e15}, "rate_hz is 1.*; .*fewer than"),
        ({"rate_hz": 1.0}, "lie 2 samples of 1 Hz; at least 10"),
    ],
)
def test_resampled_refuses(keys: dict[str, object], words: str) -> None:
    with pytest.raises(LogError, match=words):
        two_rates().resampled(**keys)  # type: ignore[arg-type]


def test_resampled_refuses_channels_that_do_not_overlap() -> None:
    late = Channel("force_n", FAST + 100.0, FAST)
    log = Log.from_channels([Channel("position_m", FAST, FAST), late])
    with pytest.raises(LogError, match="the channels do not overlap"):
        log.resampled(rate_hz=100.0)


def test_between_keeps_stamps() -> None:
    log = motion(np.arange(100) / 100.0).between(0.2, 0.5)
    assert (log.t_s[0], log.t_s[-1], log.rows) == (0.2, 0.5, 31)
    assert log.channels["force_n"].t_s is log.t_s
    assert log.history == ("made up", "cut to 0.2 s to 0.5 s")
    with pytest.raises(LogError, match=r"'position_m' has 0 samples; .*it spans 0.2 s to 0.5 s"):
        log.between(7.0, 8.0)


def test_using_takes_a_channel_for_another() -> None:
    t_s = np.arange(20.0)
    log = Log(t_s=t_s, channels={"friction_n": t_s, "pressure_pa": t_s}).using(force_n="friction_n")
    np.testing.assert_array_equal(log.force_n, t_s)
    assert (list(log.channels), log.history) == (
        ["friction_n", "pressure_pa", "force_n"],
        ("force_n is the channel 'friction_n'",),
    )
    with pytest.raises(LogError, match="'pressure_pa' is a pressure, and 'force_n' is a force"):
        log.using(force_n="pressure_pa")
    with pytest.raises(LogError, match="there is no channel 'load_n'"):
        log.using(force_n="load_n")


def test_stamps_are_repaired_on_request() -> None:
    t_s = np.array([0, 1, 2, 2, 4, 3, 5, 6, 7, 8, 9, 10, 11], dtype=float)
    log = motion(t_s)
    assert {f.kind for f in log.findings} >= {"repeated_stamps", "unordered_stamps"}
    fixed = log.sorted_by_time().without_repeated_stamps()
    np.testing.assert_array_equal(fixed.t_s, np.arange(12.0))
    np.testing.assert_array_equal(fixed.position_m, 2.0 * np.arange(12.0))
    assert fixed.history[1:] == (
        "samples sorted by time",
        "2 samples with repeated stamps left out",
    )
    fixed.check_increasing()


@pytest.mark.parametrize(
    "change",
    [
        lambda log: log.between(0.0, 0.5),
        lambda log: log.sorted_by_time(),
        lambda log: log.resampled(rate_hz=30.0),
        lambda log: log.using(load_n="force_n"),
    ],
)
def test_a_change_leaves_the_log_as_it_was(change: Callable[[Log], Log]) -> None:
    log = motion(np.arange(100) / 100.0)
    changed = change(log)
    assert (log.rows, log.history) == (100, ("made up",))
    assert len(changed.history) == 2
    np.testing.assert_allclose(changed.position_m, 2.0 * changed.t_s)
