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
    assert paper.with_(slow).steps_per_period == 48
    stated = paper.with_({"timing.steps_per_period": 1})
    refused(stated, slow, "timing.steps_per_period: 1", "0.001", "give 20 or more")
    finer = paper.with_({**slow, "timing.steps_per_period": 20})
    assert finer.timing.steps_per_period == 20
    refused(stated, {"timing.integrator": "rk4"}, "rk4 is explicit", "give 3 or more")


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


FEED = {"speed_m_per_s": 0.0125, "approach_m_per_s": 0.001, "approach_s": 0.01}


def test_an_actuator_that_does_not_heed_its_controller(paper):
    axis = bk.load_method("steady_feed").actuator
    feed = bk.SteadyFeed(**FEED)
    refused(paper, {}, "actuator.kind: 'feed_axis'", "'pid'", "give ideal", actuator=axis)
    refused(paper, {}, "actuator.kind: 'ideal'", "'steady_feed'", "feed_axis", controller=feed)
    assert paper.with_(actuator=axis, controller=feed).actuator == axis
    vibrated = bk.load_method("vibrated_feed").controller
    words = ("actuator.tip.kind: 'rigid'", "give 'piezo'")
    refused(paper, {}, *words, actuator=axis, controller=vibrated)
    stacked = axis.model_copy(update={"tip": bk.load_stack("pi_p888_91_pd200")})
    assert paper.with_(actuator=stacked, controller=vibrated).controller == vibrated


def test_a_grip_that_starts_outside_its_play(paper):
    axis = bk.load_method("steady_feed").actuator
    fed = paper.with_(actuator=axis, controller=bk.SteadyFeed(**FEED))
    words = ("actuator.contact.gap_m: 2e-05", "backlash_m = 1e-05", "starts within its play")
    refused(fed, {"actuator.contact.gap_m": 2e-5, "actuator.contact.backlash_m": 1e-5}, *words)
    held = fed.with_({"actuator.contact.gap_m": 0.0, "actuator.contact.backlash_m": 0.0})
    assert held.actuator.contact.backlash_m == 0.0


RAMP = {"kind": "force_ramp", "rate_n_per_s": 1e4, "travel_m": 0.1}
IMPACTS = {"kind": "timed_impacts", "travel_m": 0.1, "target_s": 8.0}
PULSES = {
    "kind": "fm_vibration",
    "pid": {"gains": {"kind": "pole_placement", "settling_time_s": 5e-4, "damping_ratio": 1.0}},
    "vibration": {"error_full_scale_m": 1e-4, "pulse_width_s": 1e-3},
}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"breakaway_travel_m": 0.1, "vibration": PULSES},
            ("controller.breakaway_travel_m: 0.1", "not below breakaway.travel_m = 0.1; give less"),
        ),
        (
            {"vibration": IMPACTS | {"travel_m": 2e-5}},
            ("controller.breakaway_travel_m: 3e-05", "below vibration.travel_m = 2e-05; give less"),
        ),
        ({"breakaway": IMPACTS}, ("controller.breakaway.kind: 'timed_impacts'", "'force_ramp'")),
        ({"vibration": RAMP}, ("controller.vibration.kind: 'force_ramp'", "'timed_impacts'")),
        (
            {"vibration": PULSES | {"vibration": PULSES["vibration"] | {"pulse_width_s": 1e-5}}},
            ("controller.vibration.vibration.pulse_width_s: 1e-05", "two control periods"),
        ),
        (
            {
                "vibration": PULSES
                | {
                    "pid": PULSES["pid"]
                    | {"anti_windup": "back_calculation", "tracking_time_s": 1e-6}
                }
            },
            ("controller.vibration.pid.tracking_time_s: 1e-06", "timing.control_period_s = 1e-05"),
        ),
    ],
)
def test_two_steps_that_do_not_go_together(paper, changes, words):
    steps = {"breakaway": RAMP, "vibration": IMPACTS, "breakaway_travel_m": 3e-5}
    both = bk.TwoStep.model_validate(steps)
    assert paper.with_(controller=both).controller == both
    refused(paper, {}, *words, controller={"kind": "two_step"} | steps | changes)


@pytest.mark.parametrize("kind", ["force", "feed_axis"])
def test_runge_kutta_steps_no_actuator_that_moves(paper, kind):
    method = bk.load_method("force_ramp" if kind == "force" else "steady_feed")
    rk4 = {"timing.integrator": "rk4", "timing.steps_per_period": 20}
    fields = {"actuator": method.actuator, "controller": method.controller}
    refused(paper, rk4, f"'rk4' does not step an actuator of kind '{kind}'", **fields)


@pytest.mark.parametrize("law", ["gms", "coulomb_stiction"])
def test_runge_kutta_steps_one_bristle_only(paper, law):
    names = ("stiction_n", "coulomb_n", "stribeck_velocity_m_per_s", "engagement_length_m")
    joint = {"law": law, **{name: getattr(paper.joint, name) for name in names}}
    if law == "gms":
        own = {"stiffness_n_per_m": 3.6e7, "damping_n_s_per_m": 9e3, "attraction_n_per_s": 1e6}
        joint |= {**own, "elements": 4}
    rk4 = {"timing.integrator": "rk4", "timing.steps_per_period": 20}
    refused(paper, rk4, f"'rk4' does not step joint.law = '{law}'", joint=joint)


def test_what_is_resolved_is_a_scenario(paper):
    """A rigid joint is loose at once, but its breakaway travel can be read again."""
    names = ("stiction_n", "coulomb_n", "stribeck_velocity_m_per_s", "engagement_length_m")
    rigid = bk.CoulombStiction(**{name: getattr(paper.joint, name) for name in names})
    pushed = paper.with_(
        joint=rigid,
        actuator=bk.PushOnlyActuator(force_max_n=900.0),
        controller=bk.ForceRamp(rate_n_per_s=1e4, travel_m=0.1),
    )
    resolved = bk.resolve(pushed)
    assert 0.0 < resolved.limits.breakaway_travel_m < 1e-6
    assert bk.Scenario.parse(resolved.model_dump()) == resolved
    # 450 N at 10 kN/s; then x = 10 kN/s t^3 / (6 m) until that travel.
    loose_s = 0.045 + (6 * resolved.limits.breakaway_travel_m / 1e4) ** (1 / 3)
    assert bk.simulate(pushed).metrics.time_to_breakaway_s == pytest.approx(loose_s, abs=2.5e-5)


@pytest.mark.parametrize("name", bk.preset_names("stacks"))
def test_stacks_have_the_figures_that_they_say(name):
    stack = bk.load_stack(name)
    blocking_n = stack.stiffness_n_per_m * stack.stroke_m
    held_hz = (stack.stiffness_n_per_m / stack.tip_mass_kg) ** 0.5 / (2 * 3.141592653589793)
    ratio = stack.damping_n_s_per_m / (2 * (stack.stiffness_n_per_m * stack.tip_mass_kg) ** 0.5)
    expected = {
        "pi_p888_91_pd200": (3800.0, 20e3),
        "pi_p887_91_pd200": (1900.0, 20e3),
        "noliac_nac2023_x14_pd200": (8500.0, 16.2e3),
    }[name]
    assert (blocking_n, held_hz) == pytest.approx(expected, rel=5e-3)
    assert ratio == pytest.approx(0.02, rel=0.01)
    # Branches of a full loop: 10/27 h of the stroke apart, of 1 - 5/27 h that is left of it.
    share = stack.hysteresis_share
    assert 10 / 27 * share / (1 - 5 / 27 * share) == pytest.approx(0.15, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(("unknown", "more"), [(3, 0), (40_000, 39_995)])
def test_a_file_of_another_kind_is_refused_in_a_few_lines(tmp_path, unknown, more):
    path = tmp_path / "other.toml"
    path.write_text("".join(f"k{number} = 1\n" for number in range(unknown)))
    with pytest.raises(bk.ScenarioError) as caught:
        bk.load_scenario(path)
    lines = str(caught.value).split("\n")
    assert len(lines) == (12 if more else 9)
    assert (lines[-1] == f"and {more:,} more") == bool(more)
