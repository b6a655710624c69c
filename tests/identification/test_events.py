"""Breakaway events: known answers, lower bounds, refusals, invariances, measured seals."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from breakaway.errors import LogError
from breakaway.measure.identification.events import BreakawayEvent, find_breakaway_events
from breakaway.measure.identification.identifiability import identifiability
from breakaway.measure.identification.stretches import find_stretches, noise
from breakaway.measure.logs.log import Log

Array = npt.NDArray[np.float64]

SEALS = Path(__file__).parents[2] / "../shared/data/seals"
CASES = Path(__file__).parents[2] / "../shared/cases"

STARTS_MOVING = ("O-ring_5bar.csv",)

HOLD_N = 90.0
SLIDE_N = 40.0
PRESLIDING_M = 2e-4


def rig(
    *,
    breakaway_n: float = HOLD_N,
    rate_n_per_s: float = 100.0,
    rest_s: float = 0.5,
    seed: int | None = None,
    back: bool = False,
    offset_n: float = 0.0,
) -> Log:
    """A rest, a load that bends the bristles as it grows, a slip, sliding; and back if asked."""
    t = np.arange(0.0, 6.0, 0.005)
    slip = rest_s + breakaway_n / rate_n_per_s
    load = np.clip(rate_n_per_s * (t - rest_s), 0.0, None)
    slide = SLIDE_N + (breakaway_n - SLIDE_N) * np.exp(-(t - slip) / 0.02)
    force = np.where(t <= slip, load, slide)
    x = PRESLIDING_M * np.minimum(load / breakaway_n, 1.0) + 0.01 * np.maximum(t - slip, 0.0)
    if back:
        turn = 4.0
        x = np.where(t < turn, x, 2 * np.interp(turn, t, x) - x)
        force = np.where(t < turn, force, -SLIDE_N)
    if seed is not None:
        rng = np.random.default_rng(seed)
        force = force + 0.3 * rng.standard_normal(len(t))
        x = 4e-6 * np.round((x + 2e-6 * rng.standard_normal(len(t))) / 4e-6)
    return Log(t_s=t, position_m=x, force_n=force + offset_n)


def only(log: Log, **asked: Any) -> BreakawayEvent:
    report = find_breakaway_events(log, **asked)
    assert report.refused == ()
    (event,) = report.events
    return event


def without(log: Log, lost: npt.NDArray[np.bool_]) -> Log:
    return Log(t_s=log.t_s[~lost], position_m=log.position_m[~lost], force_n=log.force_n[~lost])


def changed(log: Log, t: Any = 1.0, x: Any = 1.0, f: Any = 1.0, later_s: float = 0.0) -> Log:
    return Log(t_s=t * log.t_s + later_s, position_m=x * log.position_m, force_n=f * log.force_n)


# Known answers


@pytest.mark.parametrize("breakaway_n", [42.0, 60.0, 90.0, 300.0])
def test_finds_a_known_breakaway(breakaway_n: float) -> None:
    event = only(rig(breakaway_n=breakaway_n))
    assert event.breakaway_force_n == pytest.approx(breakaway_n, rel=0.01)
    assert event.sliding_force_n == pytest.approx(SLIDE_N, rel=1e-3)
    assert event.breakaway_over_sliding == pytest.approx(breakaway_n / SLIDE_N, rel=0.01)
    assert event.presliding_displacement_m == pytest.approx(PRESLIDING_M, rel=0.08)
    assert event.loading_rate_n_per_s == pytest.approx(100.0, rel=1e-6)
    assert event.time_s == pytest.approx(0.5 + breakaway_n / 100.0, abs=0.006)
    assert (event.direction, event.is_lower_bound, event.reason) == (1, False, "")
    assert event.fallen_share == 1.0


@pytest.mark.parametrize("seed", range(20))
def test_finds_it_in_noise_and_steps_of_the_position(seed: int) -> None:
    event = only(rig(seed=seed))
    assert abs(event.breakaway_force_n - HOLD_N) < 0.01 * HOLD_N + 3.0 * event.force_noise_n
    assert event.force_noise_n == pytest.approx(0.3, rel=0.2)
    assert event.sliding_force_n == pytest.approx(SLIDE_N, abs=0.1)
    assert event.presliding_displacement_m == pytest.approx(PRESLIDING_M, rel=0.15)
    assert event.loading_rate_n_per_s == pytest.approx(100.0, rel=0.02)
    assert not event.is_lower_bound


def test_without_a_peak_the_ratio_is_one() -> None:
    event = only(rig(breakaway_n=SLIDE_N, seed=3))
    assert event.breakaway_over_sliding == pytest.approx(1.0, abs=0.03)


def test_a_late_rise_of_sliding_friction_is_no_breakaway() -> None:
    log = rig(breakaway_n=60.0)
    bump = 40.0 * np.exp(-(((log.t_s - 4.0) / 0.3) ** 2))
    event = only(replaced(log, log.force_n + bump))
    assert event.breakaway_force_n == pytest.approx(60.0, rel=0.01)
    event = only(replaced(rig(breakaway_n=SLIDE_N), rig(breakaway_n=SLIDE_N).force_n + bump))
    assert event.breakaway_force_n == pytest.approx(SLIDE_N, rel=0.01)


def replaced(log: Log, force_n: Array) -> Log:
    return Log(t_s=log.t_s, position_m=log.position_m, force_n=force_n)


def test_offset_from_sliding_both_ways() -> None:
    report = find_breakaway_events(rig(back=True, offset_n=5.0, seed=1))
    assert report.offset_n == pytest.approx(5.0, abs=0.1)
    event = report.events[0]
    assert event.raw_breakaway_force_n == pytest.approx(HOLD_N + 5.0, abs=1.0)
    assert event.breakaway_force_n == event.raw_breakaway_force_n - report.offset_n
    assert event.raw_sliding_force_n == pytest.approx(SLIDE_N + 5.0, abs=0.2)
    assert event.breakaway_over_sliding == pytest.approx(HOLD_N / SLIDE_N, rel=0.02)
    (turn,) = report.reversals
    assert (turn.direction, turn.time_s) == (-1, pytest.approx(4.0, abs=0.02))
    assert [level.direction for level in report.sliding] == [1, -1]


def test_offset_given_or_not_known() -> None:
    one_way = rig(offset_n=5.0)
    report = find_breakaway_events(one_way)
    assert (report.offset_n, report.offset_error_n) == (None, None)
    assert report.offset_reason == "the part slides only one way; give offset_n"
    assert report.events[0].breakaway_force_n == report.events[0].raw_breakaway_force_n
    assert only(one_way, offset_n=5.0).breakaway_force_n == pytest.approx(HOLD_N, rel=0.01)


def test_a_rest_after_a_turn_is_a_start_again() -> None:
    t = np.arange(0.0, 6.0, 0.005)
    v = np.select([t < 0.5, t < 2.0, t < 3.0, t < 4.5], [0.0, 0.01, 0.0, -0.01], 0.01)
    force = np.select([t < 0.5, t < 2.0, t < 3.0, t < 4.5], [0.0, 20.0, 0.0, -20.0], 20.0)
    for start, sign in ((0.5, 1.0), (3.0, -1.0)):
        near = np.abs(t - start) < 0.01
        force[near] = 50.0 * sign
    report = find_breakaway_events(Log(t_s=t, position_m=np.cumsum(v) * 0.005, force_n=force))
    assert [event.direction for event in report.events] == [1, -1]
    assert [event.breakaway_force_n for event in report.events] == [50.0, 50.0]
    assert report.events[1].rest_s == pytest.approx(1.0, abs=0.03)
    assert len(report.reversals) == 1


# What a log hides


@pytest.mark.parametrize(
    ("lost", "value_n", "words"),
    [
        ((1.30, 1.60), 80.0, "follows the recorded peak at once"),
        ((1.395, 1.60), 90.0, "follows the recorded peak at once|begins 1 sample after"),
        ((1.405, 1.60), 90.0, "begins 1 sample after the recorded peak, when .* % of the fall"),
    ],
)
def test_a_gap_at_the_peak_makes_a_lower_bound(
    lost: tuple[float, float], value_n: float, words: str
) -> None:
    log = rig()
    event = only(without(log, (log.t_s > lost[0]) & (log.t_s < lost[1])))
    assert event.is_lower_bound
    assert event.breakaway_force_n == pytest.approx(value_n, rel=0.015)
    assert event.breakaway_force_n <= HOLD_N
    assert re.search(words, event.reason)


def test_a_fall_that_was_recorded_shows_the_peak() -> None:
    log = rig()
    lost = (log.t_s > 1.42) & (log.t_s < 1.8)
    assert not only(without(log, lost)).is_lower_bound
    strict = only(without(log, lost), passed_share=0.95)
    assert strict.is_lower_bound
    assert strict.fallen_share == pytest.approx(1.0 - np.exp(-1.0), abs=0.15)


def test_a_gap_while_it_slides_hides_nothing() -> None:
    log = rig()
    event = only(without(log, (log.t_s > 2.0) & (log.t_s < 2.3)))
    assert (event.is_lower_bound, event.breakaway_force_n) == (False, pytest.approx(HOLD_N))


def test_a_gap_before_the_load_exceeds_sliding_is_refused() -> None:
    log = rig()
    report = find_breakaway_events(without(log, (log.t_s > 0.7) & (log.t_s < 1.7)))
    assert report.events == ()
    assert "its breakaway was not recorded" in report.refused[0]


def test_a_log_that_begins_moving_is_refused() -> None:
    log = rig(back=True)
    report = find_breakaway_events(without(log, log.t_s < 2.0))
    assert report.events == ()
    words = "is already moving at 10 mm/s in the first sample; its breakaway was not recorded"
    assert report.refused == (words,)


def test_a_log_that_begins_amid_the_loading_is_a_lower_bound() -> None:
    log = rig()
    event = only(without(log, log.t_s < 1.0))
    assert event.is_lower_bound
    assert event.reason.startswith("the log starts with the load already growing, at 50 N")
    assert (event.presliding_displacement_m, event.load_start_s) == (None, None)


def creep(t: Array, since_s: float) -> Array:
    """A position at rest that slides at 9 mm/s from a time on."""
    return 9e-3 * np.maximum(t - since_s, 0.0)


def test_a_load_that_rises_into_a_gap_is_a_lower_bound() -> None:
    t = np.arange(0.0, 6.0, 0.01)
    rises = t < 0.595
    force = np.where(rises, 207.0 * np.maximum(t - 0.5, 0.0), 19.2)
    lost = (t > 0.595) & (t < 0.865)
    log = Log(t_s=t, position_m=creep(t, 0.57), force_n=force)
    event = only(without(log, lost))
    assert event.breakaway_over_sliding == pytest.approx(0.97, abs=0.003)
    assert event.loading_rate_n_per_s == pytest.approx(207.0)
    assert (event.is_lower_bound, event.fallen_share) == (True, None)
    assert event.reason == "a gap of 0.28 s follows the recorded peak at once"


def test_the_first_sample_after_a_gap_is_a_lower_bound() -> None:
    log = rig()
    event = only(without(log, (log.t_s > 1.2) & (log.t_s < 1.398)))
    assert event.is_lower_bound
    assert event.breakaway_force_n == pytest.approx(90.0, rel=0.01)
    assert event.reason.startswith("a gap of 0.2 s lies between the start of loading and")


def test_a_single_sample_before_a_gap_is_no_rest() -> None:
    t = np.concatenate([[0.0], np.arange(0.27, 5.0, 0.01)])
    speed = np.where(t < 0.29, 1.5e-3, 20e-3)
    speed[0] = 0.5e-3 / 0.27
    position = np.concatenate([[0.0], np.cumsum(speed[:-1] * np.diff(t))])
    report = find_breakaway_events(Log(t_s=t, position_m=position, force_n=np.full(len(t), 5.0)))
    assert report.events == ()
    (reason,) = report.refused
    assert reason == "shows no rest of 0.04 s before it first moves; its breakaway was not recorded"


def test_a_load_that_rises_between_two_samples_is_a_lower_bound() -> None:
    fine = np.arange(0.0, 10.0, 0.001)
    force = np.where(fine < 2.0, 0.0, 40.0 + 1e-3 * fine)
    force[np.abs(fine - 2.0) < 1.5e-3] = 300.0
    position = 0.01 * np.maximum(fine - 2.0, 0.0)
    log = Log(t_s=fine[25::50], position_m=position[25::50], force_n=force[25::50])
    event = only(log)
    assert event.is_lower_bound
    assert event.breakaway_force_n == pytest.approx(40.0, rel=0.01)
    assert event.reason.startswith("the load rises by 40 N with 0 samples on the way")


@pytest.mark.parametrize("spike_s", [0.2, 1.1, 2.5])
@pytest.mark.parametrize("value_n", [9999.0, -9999.0])
def test_a_single_sample_that_stands_alone_is_no_breakaway(spike_s: float, value_n: float) -> None:
    log = rig(seed=3)
    force = log.force_n.copy()
    force[np.searchsorted(log.t_s, spike_s - 1e-6)] = value_n
    event, clean = only(replaced(log, force)), only(log)
    assert event.breakaway_force_n == pytest.approx(clean.breakaway_force_n, abs=0.01)
    assert event.sliding_force_n == pytest.approx(clean.sliding_force_n, abs=0.01)
    assert not event.is_lower_bound
    assert find_breakaway_events(log).spikes == ()
    (spike,) = find_breakaway_events(replaced(log, force)).spikes
    assert (spike.time_s, spike.force_n) == (pytest.approx(spike_s), value_n)


def test_a_single_sample_beside_the_peak_may_be_it() -> None:
    log = rig(seed=3)
    force = log.force_n.copy()
    force[np.searchsorted(log.t_s, 1.4) + 1] = 500.0
    event = only(replaced(log, force))
    assert event.breakaway_force_n == pytest.approx(HOLD_N, rel=0.01)
    assert event.is_lower_bound and "stands alone beside the peak" in event.reason


def test_a_force_that_is_cut_off_is_a_lower_bound() -> None:
    log = rig(seed=2)
    event = only(replaced(log, np.minimum(log.force_n, 80.0)))
    assert (event.is_lower_bound, event.breakaway_force_n) == (True, 80.0)
    assert "as if cut off" in event.reason


def test_a_load_that_grows_to_the_end_is_a_lower_bound() -> None:
    event = only(without(rig(seed=1), rig().t_s > 1.2))
    assert event.is_lower_bound
    assert "before sliding is established" in event.reason
    assert event.sliding_force_n is None


def test_a_part_that_never_moves_held_its_largest_load() -> None:
    log = rig(seed=1)
    event = only(without(log, log.t_s > 1.2), min_slip_m=1e-3)
    assert event.is_lower_bound
    assert event.breakaway_force_n == pytest.approx(70.0, abs=1.5)
    assert event.reason == "the part never moves; it held this load"
    assert (event.sliding_force_n, event.breakaway_over_sliding) == (None, None)


# What must not matter


def numbers(event: BreakawayEvent) -> list[float]:
    return [
        event.breakaway_force_n,
        event.sliding_force_n or 0.0,
        event.presliding_displacement_m or 0.0,
        event.loading_rate_n_per_s or 0.0,
        event.rest_s,
    ]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_neither_the_origin_of_time_nor_the_direction_matters(seed: int) -> None:
    log = rig(seed=seed, back=True)
    here = find_breakaway_events(log).events[0]
    later = find_breakaway_events(changed(log, later_s=1000.0)).events[0]
    np.testing.assert_allclose(numbers(later), numbers(here), rtol=1e-4)
    assert later.time_s == pytest.approx(here.time_s + 1000.0)
    flipped = find_breakaway_events(changed(log, x=-1.0, f=-1.0)).events[0]
    np.testing.assert_allclose(numbers(flipped), numbers(here), rtol=1e-12)
    assert flipped.direction == -here.direction


@pytest.mark.parametrize("factor", [1e-3, 7.0, 1e3])
def test_units_scale_the_answer(factor: float) -> None:
    log = rig(seed=4, back=True)
    here = find_breakaway_events(log).events[0]
    more = find_breakaway_events(changed(log, f=factor)).events[0]
    assert more.breakaway_force_n == pytest.approx(factor * here.breakaway_force_n)
    assert more.breakaway_over_sliding == pytest.approx(here.breakaway_over_sliding)
    wide = find_breakaway_events(changed(log, x=factor)).events[0]
    assert wide.presliding_displacement_m == pytest.approx(
        factor * (here.presliding_displacement_m or 0.0)
    )
    assert wide.breakaway_force_n == pytest.approx(here.breakaway_force_n, rel=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_uneven_steps_are_as_good_as_even_ones(seed: int) -> None:
    log = rig()
    rng = np.random.default_rng(seed)
    t = np.sort(rng.choice(np.arange(0.0, 6.0, 0.001), 1500, replace=False))
    even = [np.interp(t, log.t_s, column) for column in (log.position_m, log.force_n)]
    event = only(Log(t_s=t, position_m=even[0], force_n=even[1]), gap_s=0.1)
    assert event.breakaway_force_n == pytest.approx(HOLD_N, rel=0.02)
    assert event.sliding_force_n == pytest.approx(SLIDE_N, rel=1e-3)
    assert not event.is_lower_bound


# Errors


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"min_rest_s": -1.0}, r"min_rest_s is -1; it must be >= 0 s"),
        ({"rest_speed_m_per_s": 0.0}, r"rest_speed_m_per_s is 0; it must be > 0 m/s"),
        ({"passed_share": 1.5}, r"passed_share is 1.5; it must be > 0 and <= 1"),
        ({"gap_s": float("nan")}, r"gap_s is nan; it must be > 0 s"),
        ({"offset_n": float("inf")}, r"offset_n is inf; it must be finite N"),
    ],
)
def test_settings_are_checked(asked: dict[str, float], words: str) -> None:
    with pytest.raises(LogError, match=words):
        find_breakaway_events(rig(), **asked)


def test_neither_motion_nor_load_is_refused() -> None:
    t = np.arange(100) / 100.0
    with pytest.raises(LogError, match=r"neither moves .* nor is loaded .* record a log in which"):
        find_breakaway_events(Log(t_s=t, position_m=0.0 * t, force_n=0.0 * t))


def test_repeated_stamps_are_refused() -> None:
    t = np.repeat(np.arange(50) / 100.0, 2)
    with pytest.raises(LogError, match=r"row 2: the step .* is 0 s; it must be at least 1e-09 s"):
        find_breakaway_events(Log(t_s=t, position_m=t, force_n=t))


def test_gaps_everywhere_are_refused() -> None:
    t = np.cumsum(np.where(np.arange(100) % 2, 1.0, 0.001)[::-1])
    with pytest.raises(LogError, match="gaps in 100 rows leave most rows without neighbors"):
        find_breakaway_events(Log(t_s=t, position_m=t, force_n=t), gap_s=0.5)


FINITE = st.floats(-1e12, 1e12, allow_nan=False)


@settings(max_examples=150, deadline=None)
@given(st.integers(10, 60).flatmap(lambda n: arrays(np.float64, (3, n), elements=FINITE)))
@example(np.zeros((3, 10)))
@example(np.tile(np.arange(40.0), (3, 1)))
def test_any_numbers_give_a_report_or_a_log_error(columns: Array) -> None:
    for t in (columns[0], np.sort(columns[0]), np.arange(columns.shape[1]) / 100.0):
        try:
            report = find_breakaway_events(Log(t_s=t, position_m=columns[1], force_n=columns[2]))
        except LogError:
            continue
        assert all(np.isfinite(event.breakaway_force_n) for event in report.events)


LEVELS = st.sampled_from([0.0, 0.0, 0.0, 1e-3, 0.01, -0.01])


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.tuples(LEVELS, st.integers(1, 40), st.floats(-50.0, 50.0)), min_size=2, max_size=8),
    st.integers(0, 2**32 - 1),
)
def test_any_moves_and_rests_with_gaps_give_a_report(
    moves: list[tuple[float, int, float]], seed: int
) -> None:
    speed = np.concatenate([np.full(5 * count, v) for v, count, _ in moves] + [np.zeros(10)])
    force = np.concatenate([np.full(5 * count, f) for _, count, f in moves] + [np.zeros(10)])
    rng = np.random.default_rng(seed)
    kept = rng.random(len(speed)) > 0.02
    kept[:10] = True
    t = np.arange(len(speed)) / 100.0
    force = force + rng.standard_normal(len(t))
    log = Log(t_s=t[kept], position_m=(np.cumsum(speed) / 100.0)[kept], force_n=force[kept])
    try:
        report = find_breakaway_events(log)
    except LogError:
        return
    for event in report.events:
        assert event.is_lower_bound == bool(event.reason)
        assert log.t_s[0] <= event.time_s <= log.t_s[-1]


# Stretches


def test_a_small_move_is_presliding() -> None:
    t = np.arange(0.0, 4.0, 0.01)
    x = 5e-5 * np.clip((t - 0.5) / 0.02, 0.0, 1.0) + 0.01 * np.maximum(t - 2.0, 0.0)
    log = Log(t_s=t, position_m=x, force_n=np.minimum(t, 2.0))
    assert [s.direction for s in find_stretches(log).stretches] == [0, 1]
    assert [s.direction for s in find_stretches(log, min_slip_m=1e-5).stretches] == [0, 1, 0, 1]


def test_noise_of_a_coarse_channel_is_that_of_its_rounding() -> None:
    assert noise(np.repeat(np.arange(50.0), 40)) == pytest.approx(1.0 / np.sqrt(12.0))


@pytest.mark.parametrize(("log", "count"), [(rig(), 1), (rig(back=True), 1), (None, 0)])
def test_rests_that_end_in_motion_are_those_that_events_start_from(
    log: Log | None, count: int
) -> None:
    moving = without(rig(), rig().t_s < 2.0)
    found = find_breakaway_events(log or moving)
    assert len(found.events) == count
    assert identifiability(log or moving, law="coulomb").excitation.rests == count


# A pull with three samples of 9.999 kN, as a test machine exports it


@pytest.mark.parametrize(
    ("name", "held_n", "slides_n", "spikes_s"),
    [
        ("teil_1.csv", 3365.0, 1753.0, [0.67, 1.271, 1.36]),
        ("teil_2.csv", 3318.0, 2223.0, [0.4615, 1.1095, 1.466]),
    ],
)
def test_spikes_of_a_test_machine_are_no_breakaway(
    name: str, held_n: float, slides_n: float, spikes_s: list[float]
) -> None:
    path = CASES / name
    if not path.exists():
        pytest.skip("the simulated pulls (../shared/cases) are absent")
    report = find_breakaway_events(pull_log(path))
    assert [spike.time_s for spike in report.spikes] == spikes_s
    assert {spike.force_n for spike in report.spikes} == {9999.0}
    (event,) = report.events
    assert event.breakaway_force_n == pytest.approx(held_n, abs=10.0)
    assert event.sliding_force_n == pytest.approx(slides_n, abs=10.0)
    assert not event.is_lower_bound


def pull_log(path: Path) -> Log:
    """Read mm and kN with decimal commas; cells that hold no number, and repeated rows, go."""
    rows = [
        [float(cell.replace(",", ".")) for cell in line.split(";")]
        for line in path.read_text(encoding="latin-1").splitlines()[7:]
        if "OVL" not in line and not line.endswith(";")
    ]
    columns = np.array(rows)[np.diff([-1.0, *(row[0] for row in rows)]) > 0.0].T
    return Log(t_s=columns[0], position_m=1e-3 * columns[1], force_n=1e3 * columns[2])


# Measured seals


def seal_log(path: Path) -> Log:
    columns = np.genfromtxt(path, delimiter=",", names=True)
    return Log(
        t_s=columns["t_s"],
        position_m=columns["x_m"],
        force_n=columns["friction_N"],
        source=Path(path.name),
    )


@pytest.fixture(scope="module")
def seals() -> dict[str, Log]:
    paths = sorted(SEALS.glob("*.csv"))
    if not paths:
        pytest.skip("the measured logs (../shared/data) are absent")
    return {path.name: seal_log(path) for path in paths}


def test_every_seal_whose_start_is_seen_lies_where_it_should(seals: dict[str, Log]) -> None:
    for name, log in seals.items():
        report = find_breakaway_events(log)
        assert report.offset_n is not None and 0.5 < report.offset_n < 5.0, name
        if name in STARTS_MOVING:
            assert report.events == () and "already moving" in report.refused[0]
            continue
        (event,) = report.events
        assert event.breakaway_over_sliding is not None
        assert 1.6 < event.breakaway_over_sliding < 4.2, name
        assert event.is_lower_bound and "a gap of 0.2" in event.reason, name
        assert event.time_s < 0.2 and event.loading_rate_n_per_s is not None
        assert 5e-5 < (event.presliding_displacement_m or 0.0) < 4e-4, name
        assert len(report.reversals) >= 12


def test_a_seal_that_is_cut_into_its_sliding_is_refused(seals: dict[str, Log]) -> None:
    for name, log in seals.items():
        for rows in (30, 60, 150):
            cut = without(log, np.arange(len(log.t_s)) < rows)
            report = find_breakaway_events(cut)
            assert report.events == (), (name, rows)
            assert report.refused, (name, rows)


def test_a_seal_runs_the_other_way_too(seals: dict[str, Log]) -> None:
    for log in seals.values():
        here, there = (find_breakaway_events(changed(log, x=s, f=s)) for s in (1.0, -1.0))
        assert there.offset_n == pytest.approx(-(here.offset_n or 0.0))
        for one, other in zip(here.events, there.events, strict=True):
            np.testing.assert_allclose(numbers(other), numbers(one))
