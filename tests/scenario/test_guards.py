"""Valid numbers that would simulate something else than they say."""

import pytest

import breakaway as bk


@pytest.fixture(scope="module")
def paper():
    return bk.load_scenario("paper_as_computed")


def refused(scenario, changes, *words, **fields):
    with pytest.raises(bk.ScenarioError) as caught:
        scenario.with_(changes, **fields)
    for word in words:
        assert word in str(caught.value)


def test_a_step_that_does_not_resolve_the_bristle(paper):
    slow = {"timing.control_period_s": 1e-3, "disturbance.hold_s": 1e-3}
    refused(paper, slow, "timing.steps_per_period: 1", "0.001", "give 20 or more")
    finer = paper.with_({**slow, "timing.steps_per_period": 20})
    assert finer.timing.steps_per_period == 20
    refused(paper, {"timing.integrator": "rk4"}, "rk4 is explicit", "give 3 or more")


def test_the_guard_keeps_a_stuck_joint_stuck(paper):
    """A push of 0.9 F_s0 at a control period of 1 ms: with too long a step it came loose."""
    pushed = paper.with_(
        {
            "timing.control_period_s": 1e-3,
            "timing.steps_per_period": 20,
            "timing.duration_s": 0.2,
            "disturbance.hold_s": 1e-3,
            "limits.diverged_error_m": 1e4,
        },
        reference=bk.StepReference(distance_m=1000.0),
        controller=bk.Pid(gains=bk.Gains(kp_n_per_m=0.405, ki_n_per_m_s=0.0, kd_n_s_per_m=0.0)),
    )
    run = bk.simulate(pushed)
    assert run.outcome == "not_released"
    assert run.metrics.final_position_m < 2e-4
    # Unchecked, one step in each period: the wrong answer that the guard is for.
    timing = pushed.timing.model_copy(update={"steps_per_period": 1})
    assert bk.simulate(pushed.model_copy(update={"timing": timing})).outcome == "released"


def test_a_part_that_is_pulled_back_is_not_released(paper):
    weak = bk.Gains(kp_n_per_m=1e4, ki_n_per_m_s=0.0, kd_n_s_per_m=0.0)
    run = bk.simulate(paper.with_({"timing.duration_s": 1.0}, controller=bk.Pid(gains=weak)))
    assert run.trace["position_m"].max() > 0.1  # it was out
    assert run.trace["position_m"][-1] < 0.0999
    assert run.outcome == "not_released"
    assert run.metrics.to_dict()["time_to_release_s"] is None


def test_a_tolerance_that_frees_the_seated_part(paper):
    words = ("limits.release_tolerance_m: 0.2", "joint.engagement_length_m = 0.1", "give")
    refused(paper, {"limits.release_tolerance_m": 0.2}, *words)


def test_a_step_that_is_out_of_bounds_at_once(paper):
    step = bk.StepReference(distance_m=0.1)
    refused(paper, {}, "reference.distance_m", "limits.diverged_error_m = 0.05", reference=step)
    assert paper.with_({"limits.diverged_error_m": 0.2}, reference=step).reference == step


def test_a_back_calculation_that_overshoots(paper):
    changes = {"controller.anti_windup": "back_calculation", "controller.tracking_time_s": 1e-6}
    refused(paper, changes, "controller.tracking_time_s: 1e-06", "timing.control_period_s = 1e-05")


def test_a_diverged_run_tells_of_the_sample_that_ended_it(paper):
    wild = bk.Gains(kp_n_per_m=828.2e3, ki_n_per_m_s=823940e3, kd_n_s_per_m=662.5)
    run = bk.simulate(paper.with_({"trace.every_samples": 1000}, controller=bk.Pid(gains=wild)))
    limits, m = run.scenario.limits, run.metrics
    assert run.outcome == "diverged"
    assert m.peak_force_n > limits.diverged_force_n or m.largest_error_m > limits.diverged_error_m
    assert run.trace["t_s"][-1] == pytest.approx(m.simulated_s)
    assert abs(run.trace["applied_force_n"][-1]) == pytest.approx(m.peak_force_n)
    assert run.trace["position_m"][-1] == m.final_position_m
