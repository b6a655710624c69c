"""Joints come back from logs of rigs that an independent loop simulated; nothing else matters."""

import importlib
import math
import os
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from breakaway.base.threads import usable_processors
from breakaway.errors import LogError
from breakaway.measure.identification import LAWS, Cascade, Identification, JointFile, identify
from breakaway.measure.logs import Log
from breakaway.model.scenario import Pid
from breakaway.model.scenario.controller import Gains

CASCADE = Cascade(position_gain_per_s=60.0, velocity_gain_n_s_per_m=400.0, force_limit_n=100.0)
PID = Pid(
    gains=Gains(kp_n_per_m=2e4, ki_n_per_m_s=1e5, kd_n_s_per_m=300.0),
    velocity_from="position_difference",
)


def check(found: Identification, truth: dict[str, float], share: float, loose: float) -> None:
    """Check all estimates: within 4 standard errors, and within a share of the truth.

    ``loose`` is the share for what acts on few rows: the peak, the bristle, and its damper.
    """
    few = ("stiction_ratio", "stribeck_velocity_m_per_s", "stiffness_n_per_m", "elastic_share")
    assert found.complete and found.converged
    for one in found.estimates:
        true = truth.get(one.name, 0.0)
        assert abs(one.value - true) < 4.0 * one.standard_error, one
        if one.name != "damping_n_s_per_m" and true:
            allowed = loose if one.name in few else share
            assert one.value == pytest.approx(true, rel=allowed), one


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "left_out"),
    [
        ("coulomb", ("stiction_ratio", "stribeck_velocity_m_per_s")),
        ("stribeck", ()),
    ],
)
@pytest.mark.parametrize("asymmetric", [False, True])
def test_a_law_without_a_bristle_comes_back(
    rig: Any, lugre: dict[str, float], sided: Any, law: str, left_out: Any, asymmetric: bool
) -> None:
    bristle = ("stiffness_n_per_m", "damping_n_s_per_m", *left_out)
    truth = {name: value for name, value in lugre.items() if name not in bristle}
    truth = sided(truth) if asymmetric else truth
    log = rig(**truth).moved(2000, 1000.0, force_noise_n=0.2)
    found = identify(log, law=law, asymmetric=asymmetric, starts=4)
    for one in found.estimates:
        assert one.value == pytest.approx(truth[one.name], rel=0.1), one
    assert found.relative_error_percent < 15.0  # the rows about each reversal


@pytest.mark.parametrize("asymmetric", [False, True])
def test_lugre_comes_back_from_imposed_motion(
    rig: Any, rich_fit: Identification, lugre: dict[str, float], sided: Any, asymmetric: bool
) -> None:
    found, truth = rich_fit, lugre
    if asymmetric:
        truth = sided(lugre)
        log = rig(**truth).moved(1500, 1000.0, force_noise_n=0.1)
        found = identify(log, asymmetric=True, fixed={"delay_s": 0.0}, starts=2)
    check(found, truth, share=0.03, loose=0.15)
    assert all(one.identifiable for one in found.estimates)
    assert 0.09 < found.rms_error < 0.25  # 0.1 of noise, and reversals between two rows


def test_an_elastic_share_comes_back(rig: Any, lugre: dict[str, float]) -> None:
    truth = lugre | {"elastic_share": 0.6}
    log = rig(**truth).moved(1500, 1000.0, force_noise_n=0.1)
    found = identify(log, law="elasto_plastic", starts=2)
    check(found, truth, share=0.02, loose=0.15)


def test_dependence_on_position_comes_back(rig: Any, lugre: dict[str, float]) -> None:
    truth = lugre | {"coulomb_slope_n_per_m": 400.0, "spring_n_per_m": 300.0}
    log = rig(**truth).moved(1500, 1000.0, force_noise_n=0.1)
    found = identify(log, position_dependent=True, origin_m=0.0, starts=2)
    check(found, truth, share=0.05, loose=0.2)


def test_a_weighed_part_has_its_inertia(rig: Any, lugre: dict[str, float]) -> None:
    log = rig(**lugre | {"mass_kg": 5.0}).moved(1500, 1000.0, force_noise_n=0.1)
    found = identify(log, fixed={"mass_kg": 5.0}, starts=2)
    check(found, lugre, share=0.03, loose=0.2)
    assert found.fixed["mass_kg"] == 5.0


def test_lugre_comes_back_from_a_known_force(pushed: Log, lugre: dict[str, float]) -> None:
    truth = lugre | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    found = identify(pushed, motion="free", steps_per_row=4, starts=2)
    check(found, truth, share=0.005, loose=0.05)
    assert 4.5e-6 < found.rms_error < 5.5e-6
    assert found.channel == "position_m"
    linear = identify(pushed, motion="free", law="coulomb", force_held=False, starts=1)
    assert linear["mass_kg"].value == pytest.approx(3.0, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_sliding_friction_comes_back_from_a_known_force(
    rig: Any, drives: Any, lugre: dict[str, float], law: str
) -> None:
    stiff = {"mass_kg": 3.0, "stiffness_n_per_m": 2e5, "damping_n_s_per_m": 800.0}
    truth = lugre | stiff | ({"stiction_ratio": 1.0} if law == "coulomb" else {})
    log = rig(**truth).driven(1200, 1000.0, drives["push"](1000.0), position_noise_m=5e-6)
    found = identify(log, law=law, motion="free", starts=4)
    for name in ("mass_kg", "coulomb_n", "viscous_n_s_per_m"):
        assert found[name].value == pytest.approx(truth[name], rel=0.05)


def test_lugre_comes_back_from_a_cascade(looped: Log, lugre: dict[str, float]) -> None:
    truth = lugre | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    found = identify(looped, motion="closed_loop", controller=CASCADE, steps_per_row=2, starts=2)
    check(found, truth, share=0.01, loose=0.03)
    assert found.channel == "force_n"


def test_sides_come_back_from_a_pid(
    rig: Any, drives: Any, lugre: dict[str, float], sided: Any
) -> None:
    truth = sided(lugre) | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    log = rig(**truth).driven(1200, 1000.0, drives["pid"](1000.0), force_noise_n=0.02)
    found = identify(
        log,
        motion="closed_loop",
        controller=PID,
        force_limit_n=100.0,
        asymmetric=True,
        steps_per_row=2,
        starts=2,
    )
    check(found, truth, share=0.005, loose=0.02)


def test_a_robust_loss_withstands_outliers(rich: Log) -> None:
    force = rich.force_n.copy()
    for first in range(0, len(force), 97):
        force[first : first + 3] += 200.0  # a single one is left out of every fit
    log = replace(rich, force_n=force)
    plain = identify(log, starts=2)["coulomb_n"].value
    robust = identify(log, loss="cauchy", starts=2)["coulomb_n"].value
    assert abs(robust - 20.0) < 0.2 < abs(plain - 20.0)


def test_each_repeat_has_an_offset_of_its_own(rich: Log) -> None:
    drift = np.where(rich.t_s < 0.7495, 0.0, 3.0)
    log = replace(rich, force_n=rich.force_n + drift)
    found = identify(log, repeats=[(0.0, 0.7495), (0.7495, 2.0)], starts=2)
    assert found["offset_1_n"].value == pytest.approx(1.5, abs=0.2)
    assert found["offset_2_n"].value == pytest.approx(4.5, abs=0.2)
    assert len(found.spans) == 2


def test_a_gap_splits_a_span_and_changes_little(rich: Log) -> None:
    kept = (rich.t_s < 0.7) | (rich.t_s > 0.9)
    log = Log(t_s=rich.t_s[kept], position_m=rich.position_m[kept], force_n=rich.force_n[kept])
    found = identify(log, starts=2)
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.02)
    assert set(found.fit.segment.tolist()) == {0, 1}


def test_fixed_parameters_stay(rich: Log) -> None:
    found = identify(rich, fixed={"stiffness_n_per_m": 5e4, "offset_n": 1.5}, starts=1)
    assert "stiffness_n_per_m" not in found.values
    assert found.fixed["offset_n"] == 1.5
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.01)


# What a log does not mean cannot matter.


def scaled(log: Log, position: float = 1.0, force: float = 1.0, later_s: float = 0.0) -> Log:
    reference = None if log.reference_m is None else position * log.reference_m
    return Log(
        t_s=log.t_s + later_s,
        position_m=position * log.position_m,
        force_n=force * log.force_n,
        reference_m=reference,
    )


def powers(name: str) -> tuple[int, int]:
    """Return the powers of force and position in a parameter's unit."""
    force = 0 if name in ("stiction_ratio", "stribeck_velocity_m_per_s", "elastic_share") else 1
    if name == "stribeck_velocity_m_per_s":
        return force, 1
    return force, -1 if name.endswith(("_per_m", "_kg")) else 0


@pytest.mark.parametrize(("position", "force"), [(1000.0, 1.0), (1.0, 50.0), (1e-3, 1e-3)])
def test_units_do_not_matter(
    rich: Log, rich_fit: Identification, position: float, force: float
) -> None:
    one = rich_fit
    other = identify(scaled(rich, position, force), starts=4)
    for each in one.estimates:
        by_force, by_position = powers(each.name)
        factor = force**by_force * position**by_position
        assert other[each.name].value == pytest.approx(factor * each.value, rel=1e-4)
        assert other[each.name].standard_error == pytest.approx(
            factor * each.standard_error, rel=1e-2
        )
    assert other.relative_error_percent == pytest.approx(one.relative_error_percent, rel=1e-6)


def test_the_origins_of_time_and_position_do_not_matter(
    rich: Log, rich_fit: Identification
) -> None:
    other = identify(scaled(rich, later_s=64.0), starts=4)
    there = identify(replace(rich, position_m=rich.position_m + 0.5), starts=4)
    for each in rich_fit.estimates:
        assert other[each.name].value == pytest.approx(each.value, rel=1e-5)
        assert there[each.name].value == pytest.approx(each.value, rel=1e-5)


def test_direction_swaps_sides(rig: Any, lugre: dict[str, float], sided: Any) -> None:
    log = rig(**sided(lugre)).moved(1500, 1000.0, force_noise_n=0.1)
    one = identify(log, asymmetric=True, starts=1)
    other = identify(scaled(log, -1.0, -1.0), asymmetric=True, starts=1)
    swap = {"positive": "negative", "negative": "positive"}
    for each in one.estimates:
        words = [swap.get(word, word) for word in each.name.split("_")]
        assert other["_".join(words)].value == pytest.approx(each.value, rel=1e-4)


def test_the_order_of_repeats_does_not_matter(rich: Log) -> None:
    cut = 750
    here, there = slice(0, cut), slice(cut, 1500)

    def joined(first: slice, second: slice) -> Log:
        return Log(
            t_s=np.concatenate([rich.t_s[:cut], rich.t_s[:cut] + 5.0]),
            position_m=np.concatenate([rich.position_m[first], rich.position_m[second]]),
            force_n=np.concatenate([rich.force_n[first], rich.force_n[second]]),
        )

    spans = [(0.0, 1.0), (5.0, 6.0)]
    one = identify(joined(here, there), repeats=spans, starts=4)
    other = identify(joined(there, here), repeats=spans, starts=4)
    swap = {"offset_1_n": "offset_2_n", "offset_2_n": "offset_1_n"}
    for each in one.estimates:
        same = other[swap.get(each.name, each.name)].value
        assert same == pytest.approx(each.value, rel=1e-3, abs=1e-3)


# The same call gives the same figures, and Ctrl-C the best so far.


def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads(
    rich: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = identify(rich, law="stribeck", starts=4, seed=3)
    again = identify(rich, law="stribeck", starts=4, seed=3)
    home = importlib.import_module("breakaway.measure.identification.output_error")
    monkeypatch.setattr(home, "usable_processors", lambda: 1)
    alone = identify(rich, law="stribeck", starts=4, seed=3)
    assert one.estimates == again.estimates == alone.estimates
    assert one.notes == alone.notes


def test_another_seed_comes_to_the_same_joint(rich: Log, rich_fit: Identification) -> None:
    other = identify(rich, starts=4, seed=2)
    for each in rich_fit.estimates:
        assert abs(other[each.name].value - each.value) < 0.1 * each.standard_error


def test_ctrl_c_gives_the_best_so_far_and_leaves_nothing_running(rich: Log) -> None:
    def stop(*_: int) -> None:
        raise KeyboardInterrupt

    before = threading.active_count()
    stopped = identify(rich, starts=12, progress=stop)
    assert not stopped.complete
    assert "stopped before it finished" in stopped.notes[0]
    assert threading.active_count() == before
    assert stopped.rms_error < 25.0
    again = identify(rich, law="coulomb", starts=2)
    assert again.complete and again.starts == 2
    assert not any("stopped" in note for note in again.notes)


def test_progress_counts_the_starts(rich: Log) -> None:
    seen: list[tuple[int, int]] = []
    identify(rich, law="coulomb", starts=3, progress=lambda *at: seen.append(at))
    assert seen[:3] == [(1, 3), (2, 3), (3, 3)]


# What comes out.


def test_predicts_rows_that_were_not_fitted(rich: Log) -> None:
    found = identify(rich, repeats=[(0.0, 1.1)], starts=2)
    held_out = found.predict(spans=[(1.1, 2.0)])
    assert (len(held_out.t_s), held_out.t_s[0]) == (400, 1.1)
    assert held_out.rms_error < 0.3
    assert held_out.relative_force_error_percent < 1.5
    assert found.predict(rich.between(1.1, 2.0)).rms_error < 0.5
    np.testing.assert_array_equal(held_out.measured_force_n, rich.force_n[1100:])


def test_replays_what_was_fitted(pushed: Log) -> None:
    found = identify(pushed, motion="free", starts=1, law="stribeck")
    assert found.fit.rms_error == pytest.approx(found.rms_error)
    assert found.fit.error.shape == (1200,)
    assert found.predict().rms_error == pytest.approx(found.rms_error)


def test_least_squares_is_the_regression(rig: Any, lugre: dict[str, float]) -> None:
    truth = {name: lugre[name] for name in ("coulomb_n", "viscous_n_s_per_m", "offset_n")}
    log = rig(**truth | {"mass_kg": 20.0}).moved(2000, 1000.0, force_noise_n=0.2)
    found = identify(log, law="coulomb", method="least_squares")
    assert found["mass_kg"].value == pytest.approx(20.0, rel=0.02)
    assert found["coulomb_n"].value == pytest.approx(20.0, rel=0.02)


# What is refused.

BAD: list[tuple[dict[str, Any], str]] = [
    ({"law": "dahl"}, "law: 'dahl' is not one of coulomb, stribeck, lugre, elasto_plastic"),
    ({"motion": "fre"}, "motion: 'fre' is not one of imposed, free, closed_loop"),
    ({"method": "guess"}, "method: 'guess' is not one of least_squares, output_error"),
    ({"loss": "l1"}, "loss: 'l1' is not one of linear, soft_l1, huber, cauchy"),
    ({"starts": 0}, "starts: 0 is not a whole number from 1 to 1000000"),
    ({"starts": 2.0}, "starts: 2.0 is not a whole number"),
    ({"starts": True}, "starts: True is not a whole number"),
    ({"steps_per_row": 0}, "steps_per_row: 0 is not a whole number from 1 to 10000"),
    ({"fixed": {"stifness": 1.0}}, "'stifness' is not a parameter of this law"),
    ({"fixed": {"coulomb_n": math.nan}}, r"fixed\.coulomb_n: nan is not within"),
    ({"free": ["mass"]}, "'mass' is not a parameter of this law"),
    ({"law": "coulomb", "fixed": {"stiction_ratio": 1.0}}, "'stiction_ratio' is not a parameter"),
    ({"repeats": [(0.5, 0.2)]}, "span 0.5 s to 0.2 s holds 0 rows .* at least 10"),
    ({"repeats": [(3.0, 4.0)]}, "span 3 s to 4 s holds 0 rows .* within 0 s to 1.499 s"),
    ({"repeats": [(0.0, 0.5), (0.4, 1.0)]}, "span 0.4 s to 1 s .* without overlap"),
    ({"repeats": [(1.0, 1.5), (0.0, 0.5)]}, "span 0 s to 0.5 s .* in order"),
    ({"repeats": [(math.nan, 1.0)]}, r"repeats: .* is not a list of \(start_s, end_s\)"),
    ({"repeats": [(0.1,)]}, r"repeats: .* is not a list of pairs of numbers"),
    ({"fixed": {"coulomb_n": -5.0}}, r"fixed\.coulomb_n: -5.0 is not within"),
    ({"fixed": {"mass_kg": -1.0}}, r"fixed\.mass_kg: -1.0 is not within 0"),
    ({"fixed": {"mass_kg": "1"}}, r"fixed\.mass_kg: '1' is not a number"),
    ({"fixed": {"coulomb_n": 5.0}, "free": ["coulomb_n"]}, "'coulomb_n' is fixed too"),
    ({"seed": -1}, "seed: -1 is not a whole number"),
    ({"force_limit_n": -1.0}, "force_limit_n: -1.0 is not > 0"),
    ({"origin_m": math.inf}, "origin_m: inf is not a finite position"),
    ({"lowpass_hz": 0.0}, "lowpass_hz is 0; .* must be > 0 and < 500 Hz"),
    ({"lowpass_hz": 500.0}, "lowpass_hz is 500; .* must be > 0 and < 500 Hz"),
    ({"motion": "closed_loop", "controller": CASCADE}, "needs the channel 'reference_m'"),
    ({"method": "least_squares"}, "'least_squares' fits law 'coulomb' to imposed motion"),
    (
        {"method": "least_squares", "law": "coulomb", "motion": "free"},
        "'least_squares' fits law 'coulomb' to imposed motion",
    ),
    (
        {"method": "least_squares", "law": "coulomb", "repeats": [(0.0, 1.0)]},
        "the whole log at once.*`between`",
    ),
]


@pytest.mark.parametrize(("settings", "words"), BAD, ids=[words[:30] for _, words in BAD])
def test_refuses_a_setting_by_name(rich: Log, settings: dict[str, Any], words: str) -> None:
    with pytest.raises(LogError, match=words):
        identify(rich, **settings)


@pytest.mark.parametrize(
    "controller",
    [None, Pid(gains={"kind": "pole_placement", "settling_time_s": 1, "damping_ratio": 1})],
)
def test_a_closed_loop_needs_a_controller_with_numbers(looped: Log, controller: Any) -> None:
    with pytest.raises(LogError, match=r"controller: .* needs a Cascade, or a Pid whose gains"):
        identify(looped, motion="closed_loop", controller=controller)


def with_repeated_stamp(log: Log) -> Log:
    t_s = log.t_s.copy()
    t_s[500] = t_s[499]
    return replace(log, t_s=t_s)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda log: Log(t_s=log.t_s, force_n=log.force_n), "no channel 'position_m'"),
        (lambda log: Log(t_s=log.t_s, position_m=log.position_m), "no channel 'force_n'"),
        (lambda log: scaled(log, position=0.0), "never moves .*: record a log in which it slides"),
        (lambda log: scaled(log, force=0.0), "force is 0 in every row; record the force"),
        (with_repeated_stamp, "row 501: 0.499 s repeats"),
    ],
    ids=["no position", "no force", "rest", "no force at all", "repeated stamp"],
)
def test_refuses_a_log_that_can_not_tell(
    rich: Log, change: Callable[[Log], Log], words: str
) -> None:
    with pytest.raises(LogError, match=words):
        identify(change(rich))


def test_refuses_to_predict_what_is_not_there(rich: Log) -> None:
    found = identify(rich, law="coulomb", starts=1)
    with pytest.raises(LogError, match="span 7 s to 8 s holds 0 rows"):
        found.predict(spans=[(7.0, 8.0)])
    with pytest.raises(LogError, match="motion: 'closed_loop' needs a mass"):
        found.predict(motion="closed_loop")
    with pytest.raises(LogError, match="needs the channel 'reference_m'"):
        identify(rich, law="coulomb", fixed={"mass_kg": 1.0}, starts=1).predict(
            motion="closed_loop"
        )
    with pytest.raises(LogError, match="motion: 'fre' is not one of"):
        found.predict(motion="fre")  # type: ignore[arg-type]
    with pytest.raises(LogError, match=r"'mass_kg' was not fitted; .* coulomb_n"):
        found.profile("mass_kg")


def columns(rows: int) -> st.SearchStrategy[tuple[Any, ...]]:
    shapes = {
        "noise": lambda rng: rng.standard_normal(rows),
        "sine": lambda rng: np.sin(np.arange(rows) * rng.uniform(0.01, 3.0)),
        "walk": lambda rng: np.cumsum(rng.standard_normal(rows)),
        "steps": lambda rng: np.round(3.0 * np.sin(np.arange(rows) * rng.uniform(0.01, 0.3))),
        "impact": lambda rng: (np.arange(rows) == rng.integers(rows)).astype(float),
    }
    one = st.tuples(st.sampled_from(list(shapes)), st.integers(-9, 6))
    return st.tuples(one, one, st.integers(0, 2**32)).map(
        lambda drawn: tuple(
            10.0**power * shapes[shape](np.random.default_rng([drawn[2], place]))
            for place, (shape, power) in enumerate(drawn[:2])
        )
    )


@pytest.mark.slow
@settings(max_examples=40)
@given(
    data=st.integers(10, 200).flatmap(lambda rows: columns(rows)),
    step_s=st.sampled_from([1e-5, 1e-3, 1.0]),
    law=st.sampled_from(LAWS),
    motion=st.sampled_from(["imposed", "free", "closed_loop"]),
    asymmetric=st.booleans(),
    loss=st.sampled_from(["linear", "cauchy"]),
)
def test_any_log_gives_a_joint_or_a_reason(
    data: Any, step_s: float, law: str, motion: str, asymmetric: bool, loss: str
) -> None:
    x, force = data
    log = Log(t_s=step_s * np.arange(len(x)), position_m=x, force_n=force, reference_m=x)
    try:
        found = identify(
            log,
            law=law,
            motion=motion,
            controller=CASCADE,
            asymmetric=asymmetric,
            loss=loss,
            starts=2,
        )
        assert all(math.isfinite(one.value) for one in found.estimates)
        assert math.isfinite(found.rms_error)
        JointFile.from_identification(found)
    except LogError:
        pass


def test_uses_the_cpus_that_it_may() -> None:
    assert 1 <= usable_processors() <= (os.cpu_count() or 1)
