"""Cases that independent solvers found wrong, without a word, at steps that were allowed."""

import pytest
from tests.accuracy.figures import errors_of, figures_of, floors_of, worst_of
from tests.accuracy.steps import at_steps, steps_of

import breakaway as bk

RAMP = {"kind": "force_ramp", "rate_n_per_s": 3e4, "travel_m": 5e-3}
PUSH = {"kind": "push_only", "force_max_n": 1e4}
FEED = {"kind": "steady_feed", "speed_m_per_s": 0.05, "approach_m_per_s": 1e-3, "approach_s": 0.05}
AXIS = {
    "kind": "feed_axis",
    "speed_max_m_per_s": 0.1,
    "acceleration_max_m_per_s2": 1.0,
    "stiffness_n_per_m": 3e7,
    "damping_n_s_per_m": 1e4,
    "tool_mass_kg": 5.0,
    "contact": {"stiffness_n_per_m": 3e8, "damping_n_s_per_m": 5e3, "gap_m": 1e-5},
}


def seen(joint, mass_kg, period_s, drive, duration_s=0.5):
    actuator, controller = drive
    return bk.Scenario.model_validate(
        {
            "joint": joint,
            "part": {"mass_kg": mass_kg},
            "reference": {"kind": "ramp", "distance_m": 5e-3, "duration_s": duration_s},
            "actuator": actuator,
            "controller": controller,
            "timing": {"duration_s": duration_s, "control_period_s": period_s},
            "limits": {"after_release_s": 0.0, "diverged_error_m": 1.0},
            "trace": {"every_samples": 0},
        }
    )


def bristle(law, stiction_n, coulomb_n, stiffness, damping, stribeck, length_m=5e-3):
    extra = {"elastic_share": 0.7} if law == "elasto_plastic" else {}
    return extra | {
        "law": law,
        "stiction_n": stiction_n,
        "coulomb_n": coulomb_n,
        "stiffness_n_per_m": stiffness,
        "damping_n_s_per_m": damping,
        "stribeck_velocity_m_per_s": stribeck,
        "engagement_length_m": length_m,
    }


RIGID = {
    "law": "coulomb_stiction",
    "stiction_n": 450.0,
    "coulomb_n": 300.0,
    "stribeck_velocity_m_per_s": 0.02,
    "engagement_length_m": 5e-3,
}
CASES = {
    "a steep fall of friction": seen(
        bristle("lugre", 120.0, 44.0, 3.1e8, 5e3, 4.4e-3), 0.33, 1e-4, (PUSH, RAMP)
    ),
    "a steeper one": seen(
        bristle("elasto_plastic", 6567.0, 2452.0, 2.4e8, 3e3, 3.6e-3), 0.12, 1e-4, (PUSH, RAMP)
    ),
    "rigid friction before a stiff axis": seen(RIGID, 1.0, 1e-3, (AXIS, FEED)),
    "a guide shorter than a period's way": seen(
        bristle("lugre", 450.0, 360.0, 3.6e7, 9e3, 0.09, 1e-4), 1.0, 2e-4, (PUSH, RAMP)
    ),
}


WHERE_IT_IS_AFTERWARDS = (
    "work_j",
    "supplied_work_j",
    "largest_impact_work_j",
    "largest_step_m",
    "final_position_m",
)
"""What is of the end of the period in which a part is free: in a short guide it flies on for as
long as it took, so an error of its time is one of this."""


@pytest.mark.parametrize("name", CASES)
def test_is_right_at_the_default_steps(name):
    scenario = CASES[name]
    found = bk.simulate(scenario)
    assert found.metrics.release_velocity_m_per_s > 0.0
    finer = figures_of(bk.simulate(at_steps(scenario, 50 * steps_of(scenario))))
    errors = errors_of(figures_of(found), finer, floors_of(scenario))
    if scenario.joint.engagement_length_m < 1e-3:
        for metric in WHERE_IT_IS_AFTERWARDS:
            assert errors.pop(metric) < 0.03
    assert worst_of(errors) < 0.01, errors
    assert not any("coarse" in warning for warning in found.warnings)


def test_coarse_steps_are_warned_of_and_checked():
    scenario = CASES["rigid friction before a stiff axis"]
    wanted = steps_of(scenario)
    coarse = scenario.with_({"timing.steps_per_period": 1})
    run = bk.simulate(coarse)
    (said,) = [warning for warning in run.warnings if "coarse" in warning]
    assert f"ask for {wanted}" in said
    accuracy = bk.check_accuracy(coarse)
    assert accuracy.settled and accuracy.worst[1] > 0.05
    assert 1 < accuracy.wanted_steps <= 2 * wanted


def test_one_level_settles_nothing(monkeypatch):
    monkeypatch.setattr("breakaway.run.accuracy.STEPS_MAX", 1000)
    accuracy = bk.check_accuracy(bk.load_scenario("paper_as_computed"))
    assert list(accuracy.levels) == [1]
    assert not accuracy.settled and accuracy.wanted_steps is None
