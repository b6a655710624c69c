"""A trial is what its parts are, one by one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import breakaway as bk
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.files import preset_names
from breakaway.model.scenario.laws import LAWS
from breakaway.run.trials import TRIAL_METRICS, part_columns, scenario_of

SHORT = bk.Uniform(low=0.001, high=0.002)


@pytest.fixture(scope="module")
def population() -> bk.PartPopulation:
    """Seized parts in guides of 1 to 2 mm, which are out within a second."""
    whole = bk.load_population("seized_parts")
    parts = whole.parts.model_copy(update={"engagement_length_m": SHORT})
    return whole.model_copy(update={"parts": parts, "duration_s": 0.6})


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", preset_names("methods"))
def test_every_method_runs_under_every_law_and_replays_to_the_bit(population, name, law):
    trial = bk.run_trial(population, bk.load_method(name), law=law, runs=range(3, 6), seed=4)
    run = trial.replay(1, trace_every=0)
    for metric in TRIAL_METRICS:
        alone, together = getattr(run.metrics, metric), trial.metrics[metric][1]
        assert alone == together or (np.isnan(alone) and np.isnan(together)), metric


def test_parts_do_not_depend_on_threads_or_on_each_other(population):
    method = bk.load_method("timed_impacts")
    whole = bk.run_trial(population, method, runs=range(40), seed=1, threads=1)
    half = bk.run_trial(population, method, runs=range(17, 40), seed=1, threads=2)
    for name in TRIAL_METRICS:
        np.testing.assert_array_equal(whole.metrics[name][17:], half.metrics[name])


def test_another_seed_is_other_parts(population):
    one, other = (bk.draw_parts(population, range(5), seed=seed) for seed in (0, 1))
    assert not np.isclose(one["stiction_n"], other["stiction_n"]).any()


def test_parts_are_what_the_issue_says():
    parts = bk.draw_parts(bk.load_population("seized_parts"), range(20_000), seed=3)
    for name, low, high in (
        ("stiction_n", 150.0, 4500.0),
        ("stiction_ratio", 1.1, 3.0),
        ("presliding_m", 5e-6, 30e-6),
        ("bristle_damping_ratio", 0.2, 1.0),
        ("stribeck_velocity_m_per_s", 0.005, 0.2),
        ("mass_kg", 0.2, 2.0),
        ("engagement_length_m", 0.02, 0.1),
        ("var", 0.0, 0.5),
        ("hold_s", 1e-4, 1e-2),
        ("correlation_length_m", 1e-5, 1e-2),
        ("level_draw", -1.0, 1.0),
    ):
        values = parts[name]
        assert low <= values.min() <= low + 0.01 * (high - low), name
        assert high - 0.01 * (high - low) <= values.max() <= high, name
    assert np.median(parts["stiction_n"]) == pytest.approx(np.sqrt(150.0 * 4500.0), rel=0.03)


def test_a_joint_is_made_of_its_part(population):
    parts = {
        name: values[:1] for name, values in bk.draw_parts(population, range(1), seed=0).items()
    }
    method = bk.load_method("force_ramp")
    columns = part_columns(population, method, "lugre", "none", parts)
    k_e, m = columns["joint.stiffness_n_per_m"][0], parts["mass_kg"][0]
    assert columns["joint.stiction_n"] / columns["joint.coulomb_n"] == pytest.approx(
        parts["stiction_ratio"]
    )
    assert columns["joint.stiction_n"] / k_e == pytest.approx(parts["presliding_m"])
    ratio = columns["joint.damping_n_s_per_m"][0] / (2.0 * np.sqrt(k_e * m))
    assert ratio == pytest.approx(parts["bristle_damping_ratio"][0])
    assert columns["controller.travel_m"] == parts["engagement_length_m"]


def test_every_part_takes_its_own_steps(population):
    method = bk.load_method("force_ramp")
    trial = bk.run_trial(population, method, runs=range(40), seed=0)
    steps = [trial.scenario(i).steps_per_period for i in range(40)]
    assert len(set(steps)) > 2
    for i in (int(np.argmin(steps)), int(np.argmax(steps))):
        run = trial.replay(i, trace_every=0)
        assert run.scenario.timing.steps_per_period == steps[i]
        assert run.metrics.peak_force_n == trial.metrics["peak_force_n"][i]


def test_a_gentle_part_is_free_and_within_every_limit(population):
    trial = bk.run_trial(population, bk.load_method("steady_feed"), runs=range(12), seed=2)
    gentle = trial.within(population.gentle)
    assert gentle.any()
    for name in ("peak_over_breakaway", "largest_jump_m", "release_velocity_m_per_s"):
        rough = dict(trial.metrics) | {name: np.full(12, 1e3)}
        assert not dataclasses.replace(trial, metrics=rough).within(population.gentle).any()
    stuck = dict(trial.metrics) | {"time_to_release_s": np.full(12, np.nan)}
    assert not dataclasses.replace(trial, metrics=stuck).within(population.gentle).any()


def test_what_a_method_knows_has_to_be_a_number_of_it(population):
    method = bk.load_method("force_ramp")
    wrong = method.model_copy(update={"knows": {"controler.travel_m": "engagement_length_m"}})
    with pytest.raises(StudyError, match=r"controler\.travel_m"):
        scenario_of(population, wrong, "lugre", "field", seed=0)


def test_a_method_may_be_told_a_multiple_of_a_length(population):
    method = bk.load_method("steady_feed")
    told = {"controller.speed_m_per_s": {"of": "engagement_length_m", "times": 5.0}}
    paced = bk.Method.parse(method.model_dump(exclude_none=True) | {"knows": told})
    trial = bk.run_trial(population, paced, runs=range(12), seed=2)
    lengths_m = trial.parts["engagement_length_m"]
    assert trial.released.all()
    for row in (0, 5):
        controller = trial.scenario(row).controller
        assert controller.speed_m_per_s == 5.0 * lengths_m[row]
    wrong = told["controller.speed_m_per_s"] | {"times": -1.0}
    with pytest.raises(ScenarioError, match=r"knows.*times: -1.0 is not > 0"):
        bk.Method.parse(method.model_dump(exclude_none=True) | {"knows": {"x": wrong}})


@pytest.mark.parametrize(
    ("load", "name", "hint"),
    [
        (bk.load_population, "seized_part", "seized_parts"),
        (bk.load_method, "timed_impact", "timed_impacts"),
    ],
)
def test_a_wrong_name_is_answered_with_the_right_one(load, name, hint):
    with pytest.raises(ScenarioError, match=hint):
        load(name)


def test_a_watch_does_not_stop_what_is_sound():
    population = bk.load_population("seized_parts").model_copy(update={"duration_s": 0.3})
    trial = bk.run_trial(population, bk.load_method("timed_impacts"), runs=range(64), seed=9)
    assert population.watch is not None
    assert (trial.metrics["stop_reason"] == 0.0).all()


def test_a_ramp_and_then_impacts_free_gently_what_the_ramp_alone_throws_out(population):
    told = ("breakaway", "vibration")
    controller = bk.TwoStep(
        breakaway=bk.ForceRamp(rate_n_per_s=2e4, travel_m=1.0),
        vibration=bk.TimedImpacts(travel_m=1.0, target_s=0.2, force_start_n=100.0),
        breakaway_travel_m=5e-5,
    )
    impacts = bk.load_method("timed_impacts").model_copy(
        update={
            "controller": controller,
            "knows": {f"controller.{step}.travel_m": "engagement_length_m" for step in told},
        }
    )
    ramp = impacts.model_copy(
        update={
            "controller": controller.breakaway,
            "knows": {"controller.travel_m": "engagement_length_m"},
        }
    )
    two, one = (
        bk.run_trial(population, method, runs=range(24), seed=5) for method in (impacts, ramp)
    )
    assert one.released.all()
    assert two.within(population.gentle).mean() > 0.8
    assert not one.within(population.gentle).any()
    run = two.replay(3, trace_every=0)
    assert run.metrics.largest_jump_m == two.metrics["largest_jump_m"][3]


def test_impacts_behind_a_lag_are_told_apart(population):
    trial = bk.run_trial(population, bk.load_method("timed_impacts"), runs=range(4), seed=1)
    assert (trial.metrics["impacts"] > 5).all()
    scenario = trial.scenario(0)
    assert bk.resolve(scenario).limits.contact_force_n == 1e-3 * scenario.actuator.force_max_n
    never = scenario.with_({"limits.contact_force_n": 1e9, "trace.every_samples": 0})
    assert bk.simulate(never).metrics.impacts == 0
