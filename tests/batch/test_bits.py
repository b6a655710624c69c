"""Every run of a batch has the bits of the run on its own."""

import itertools

import numpy as np
import pytest

import breakaway as bk
from breakaway import _core
from breakaway.run.batch import METRICS
from breakaway.run.batch.columns import number_paths, with_nominal_controller
from breakaway.run.resolution import core_job, resolve

FIGURES = METRICS[:-1]
INSTRUCTIONS = _core.instructions()
THREADS = (1, 2, 5)
SHAPES = ("rectangular", "half_sine", "raised_cosine")
LENGTH_M = 5e-4

JOINTS = {
    "lugre": bk.Lugre(
        stiction_n=450.0,
        coulomb_n=360.0,
        stiffness_n_per_m=3.6e7,
        damping_n_s_per_m=9000.0,
        stribeck_velocity_m_per_s=0.09,
        viscous_n_s_per_m=5.0,
        engagement_length_m=LENGTH_M,
    ),
    "two_region": bk.TwoRegion(
        stiction_n=450.0,
        coulomb_n=360.0,
        stiffness_n_per_m=3.6e7,
        damping_n_s_per_m=9000.0,
        engagement_length_m=LENGTH_M,
    ),
}
REFERENCES = (
    bk.MinimumJerk(distance_m=LENGTH_M, duration_s=0.006),
    bk.RampReference(distance_m=LENGTH_M, duration_s=0.005),
    bk.TrapezoidalVelocity(
        distance_m=LENGTH_M, velocity_m_per_s=0.1, acceleration_m_per_s2=100.0, start_s=1e-4
    ),
    bk.StepReference(distance_m=2e-4, start_s=3e-4),
)
GAINS = bk.Gains(kp_n_per_m=3.1e6, ki_n_per_m_s=1.3e9, kd_n_s_per_m=720.0)
WEAK = bk.Gains(kp_n_per_m=8.3e5, ki_n_per_m_s=8.2e8, kd_n_s_per_m=660.0)
ANTI_WINDUP = ("off", "conditional", "back_calculation")


def pulses(i):
    return bk.FmPulses(
        frequency_min_hz=400.0,
        frequency_max_hz=900.0,
        error_full_scale_m=1e-4,
        pulse_width_s=7e-4,
        base_fraction=(0.0, 0.5)[i % 2],
        shape=SHAPES[i % 3],
    )


def controllers(i):
    settings = {
        "gains": GAINS,
        "derivative_of": ("error", "measurement")[i % 2],
        "velocity_from": ("sensor", "position_difference")[i // 2 % 2],
        "derivative_filter_s": (0.0, 3e-5)[i // 3 % 2],
        "anti_windup": ANTI_WINDUP[i % 3],
    }
    pid = bk.PidSettings(**settings)
    return {
        "pid": bk.Pid(**settings),
        "fm_vibration": bk.FmVibration(pid=pid, vibration=pulses(i)),
        "two_step": bk.TwoStep(
            breakaway=bk.Pid(**settings),
            vibration=bk.FmVibration(
                pid=pid.model_copy(update={"gains": WEAK}), vibration=pulses(i)
            ),
            breakaway_travel_m=2.5e-5,
        ),
    }


def disturbances(acts_on, i):
    hold_s = (1e-4, 3.7e-5, 1e-5)[i % 3]
    return {
        "uniform": bk.UniformDisturbance(var=0.3, hold_s=hold_s, acts_on=acts_on),
        "gaussian": bk.GaussianDisturbance(var=0.15, hold_s=hold_s, acts_on=acts_on),
        "band_limited": bk.BandLimitedDisturbance(
            var=0.15, hold_s=hold_s, acts_on=acts_on, bandwidth_hz=400.0
        ),
    }


TIMINGS = (
    {},
    {"one_sample_delay": True},
    {"steps_per_period": 3},
    {"integrator": "rk4", "steps_per_period": 12},
)


def case(i, joint, controller, law, acts_on):
    """Give a scenario of these kinds; what else there is to choose differs from case to case."""
    return bk.Scenario(
        seed=i,
        joint=JOINTS[joint],
        part=bk.Part(mass_kg=1.0),
        reference=REFERENCES[i % 4],
        disturbance=disturbances(acts_on, i)[law],
        actuator=(bk.IdealActuator(), bk.PushOnlyActuator(force_max_n=900.0))[i // 2 % 2],
        controller=controllers(i)[controller],
        timing=bk.Timing(duration_s=0.008, **TIMINGS[i // 3 % 4]),
        limits=bk.Limits(diverged_error_m=5e-3),
        trace=bk.Trace(every_samples=0),
    )


KINDS = list(
    itertools.product(
        JOINTS,
        ("pid", "fm_vibration", "two_step"),
        ("uniform", "gaussian", "band_limited"),
        ("joint_force", "friction_level"),
    )
)
CASES = {"-".join(kinds): case(i, *kinds) for i, kinds in enumerate(KINDS)}

STACK = bk.Piezo(
    stroke_m=38e-6,
    stiffness_n_per_m=1e8,
    tip_mass_kg=0.02,
    damping_n_s_per_m=200.0,
    hysteresis_share=0.4,
    preload_n=800.0,
    capacitance_f=13e-6,
    loss_tangent=0.02,
    voltage_max_v=120.0,
    current_max_a=10.0,
    amplifier_bandwidth_hz=5000.0,
)


def axis(tip, backlash_m=None):
    return bk.FeedAxis(
        speed_max_m_per_s=0.2,
        acceleration_max_m_per_s2=200.0,
        stiffness_n_per_m=3e7,
        damping_n_s_per_m=8e3,
        tool_mass_kg=2.0,
        tip=tip,
        contact=bk.Contact(
            stiffness_n_per_m=1e8, damping_n_s_per_m=3e3, gap_m=1e-6, backlash_m=backlash_m
        ),
    )


FORCE = bk.ForceActuator(force_max_n=900.0, bandwidth_hz=3000.0, force_rate_max_n_per_s=2e6)
FEED = {"speed_m_per_s": 0.1, "approach_m_per_s": 0.01, "approach_s": 5e-4}
RAMP = bk.ForceRamp(rate_n_per_s=1.5e5, travel_m=LENGTH_M)
IMPACTS = bk.TimedImpacts(
    travel_m=LENGTH_M,
    target_s=8e-3,
    force_start_n=200.0,
    search_time_constant_s=1e-3,
    rise_time_constant_s=5e-4,
    rise_min_s=1e-4,
    rise_per_slip=1.0,
    slowing_m_per_s=0.1,
    holding_m_per_s=0.3,
    step_min_m=8e-5,
    step_max_m=3e-4,
    travel_min_m=2e-5,
    coast_min_s=2e-4,
    settled_m=1e-5,
    lead_start_s=2e-4,
)
VIBRATED = bk.VibratedFeed(
    feed=bk.FeedSettings(**FEED),
    pulses=bk.StackPulses(
        frequency_hz=1000.0,
        pulse_width_s=5e-4,
        amplitude_ratio=0.6,
        stack_force_n=2000.0,
        force_filter_s=5e-4,
    ),
)
SENSORS = bk.Sensors(
    position=bk.PositionSensor(noise_rms_m=2e-8, bandwidth_hz=2e4, delay_samples=1),
    force=bk.ForceSensor(noise_rms_n=1.0, quantum_n=0.5),
)
BLURRED = bk.Sensors(position=bk.PositionSensor(noise_rms_m=1e-7, quantum_m=5e-8))
WATCH = bk.Watch(jump_max_m=5e-5, frozen_max_s=1e-3)
STEPS = {
    "ramp": RAMP,
    "pid": controllers(7)["pid"],
    "impacts": IMPACTS,
    "fm": controllers(5)["fm_vibration"],
}


def two_steps(breakaway, vibration):
    return bk.TwoStep(
        breakaway=STEPS[breakaway], vibration=STEPS[vibration], breakaway_travel_m=2.5e-5
    )


PUSHED = {
    "force-ramp-seen": ("lugre", FORCE, RAMP, {"sensors": SENSORS, "watch": WATCH}),
    "force-impacts": ("coulomb_stiction", FORCE, IMPACTS, {}),
    "push_only-impacts-blurred": (
        "gms",
        bk.PushOnlyActuator(force_max_n=900.0),
        IMPACTS,
        {"sensors": BLURRED, "watch": bk.Watch(jump_max_m=5e-5)},
    ),
    "force-pid-seen": (
        "elasto_plastic",
        FORCE,
        controllers(7)["pid"],
        {"sensors": SENSORS, "watch": WATCH},
    ),
    "force-two_step-ramp-impacts": ("coulomb_stiction", FORCE, two_steps("ramp", "impacts"), {}),
    "force-two_step-ramp-fm": ("lugre", FORCE, two_steps("ramp", "fm"), {"sensors": SENSORS}),
    "force-two_step-pid-impacts": ("gms", FORCE, two_steps("pid", "impacts"), {"watch": WATCH}),
    "axis-steady": ("lugre", axis(bk.RigidTip()), bk.SteadyFeed(**FEED), {}),
    "stack-vibrated": ("two_region", axis(STACK), VIBRATED, {}),
    "stack-vibrated-seen": ("gms", axis(STACK), VIBRATED, {"sensors": SENSORS, "watch": WATCH}),
    "grip-vibrated": ("lugre", axis(STACK, 3e-6), VIBRATED, {}),
}
MORE_JOINTS = {
    "elasto_plastic": bk.ElastoPlastic(
        **JOINTS["lugre"].model_dump(exclude={"law"}), elastic_share=0.6
    ),
    "gms": bk.Gms(
        **JOINTS["lugre"].model_dump(exclude={"law"}), elements=4, attraction_n_per_s=2e6
    ),
    "coulomb_stiction": bk.CoulombStiction(
        stiction_n=450.0,
        coulomb_n=360.0,
        stribeck_velocity_m_per_s=0.09,
        engagement_length_m=LENGTH_M,
    ),
}


def pushed(i, joint, actuator, controller, seen):
    """Give a scenario of kinds that the product above leaves out."""
    timing = {"steps_per_period": (1, 3)[i % 2], "one_sample_delay": i % 3 == 0}
    return case(i, "lugre", "pid", "uniform", "joint_force").with_(
        joint=(JOINTS | MORE_JOINTS)[joint],
        actuator=actuator,
        controller=controller,
        timing=bk.Timing(duration_s=0.008, **timing),
        **seen,
    )


CASES |= {name: pushed(i, *kinds) for i, (name, kinds) in enumerate(PUSHED.items())}


def rows_around(scenario, path, count, rng):
    """Values within some percent of the scenario's own, all of them valid."""
    values = bk.resolve(scenario).model_dump()
    for name in path.split("."):
        values = values[name]
    if values is None:  # a limit that is not set: what some runs exceed and some do not
        typical = {
            "peak_force_max_n": 700.0,
            "jump_max_m": 1e-5,
            "after_release_s": 3e-4,
            "bandwidth_hz": 1e4,
            "quantum_m": 1e-9,
            "quantum_n": 1e-2,
        }
        values = typical.get(path.rpartition(".")[2], 0.1)
        return np.where(rng.random(count) < 0.2, values, 1e3 * values)
    if values == 0.0:
        return rng.choice([0.0, 1e-5, 1e-4], count)
    if path == "limits.diverged_error_m":  # here and there a run diverges
        return np.where(rng.random(count) < 0.2, 3e-4, values)
    if path == "disturbance.hold_s":
        return values * rng.uniform(1.0, 5.0, count)
    if path == "disturbance.var":
        return np.where(rng.random(count) < 0.2, 0.0, values * rng.uniform(0.5, 1.5, count))
    return values * rng.uniform(0.95, 1.05, count)


def vary_all(scenario, paths, count, seed=0):
    rng = np.random.default_rng(seed)
    return {path: rows_around(scenario, path, count, rng) for path in paths}


def changeable(scenario):
    """Everything but a step's bound, which other numbers have to stay below."""
    kind = scenario.reference.kind
    return [
        path
        for path in number_paths(scenario)
        if not (kind == "step" and path == "limits.diverged_error_m")
    ]


@pytest.fixture
def assert_same_bits(bits):
    def check(batch):
        for i in range(len(batch)):
            index = int(batch.run_index[i])
            runs = [bk.simulate(batch.scenario_of(i), run_index=index)]
            if i % 6 == 0:
                runs.append(batch.replay(i))
            for run in runs:
                assert (run.seed, run.run_index) == (batch.scenario.seed, index)
                for name, column in batch.metrics.items():
                    one, other = column[i], getattr(run.metrics, name)
                    assert bits(one) == bits(other), f"row {i}: {name}: {one!r}, {other!r}"
                if batch.outcome_codes is not None:
                    assert batch["outcome"][i] == run.outcome

    return check


@pytest.fixture
def assert_same_batch(bits):
    def check(one, other):
        assert set(one.columns) == set(other.columns)
        for name in set(one.columns) - {"outcome"}:
            np.testing.assert_array_equal(bits(one[name]), bits(other[name]), err_msg=name)
        np.testing.assert_array_equal(one.run_index, other.run_index)
        np.testing.assert_array_equal(one.outcome_codes, other.outcome_codes)

    return check


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_all_numbers_at_once(name, assert_same_bits, assert_same_batch):
    """More runs than any instructions have lanes, and no whole number of lanes."""
    scenario, runs = CASES[name], 33
    vary = vary_all(scenario, changeable(scenario), runs)
    batches = [
        bk.simulate_many(
            scenario, range(7, 7 + runs), vary=vary, threads=threads, instructions=instructions
        )
        for threads, instructions in zip(itertools.cycle(THREADS), INSTRUCTIONS, strict=False)
    ]
    for other in batches[1:]:
        assert_same_batch(batches[0], other)
    assert_same_bits(batches[0])


def test_cases_end_in_every_way():
    """The comparisons above are worth something only if much of what can happen does."""
    outcomes, happened = set(), dict.fromkeys(FIGURES, 0)
    for scenario in list(CASES.values())[::2]:
        vary = vary_all(scenario, changeable(scenario), 33)
        batch = bk.simulate_many(scenario, 33, vary=vary)
        outcomes |= set(batch["outcome"])
        for name in FIGURES:
            happened[name] += np.isfinite(batch[name]).sum()
    assert outcomes == set(_core.OUTCOMES)
    assert min(happened.values()) > 30, happened


ALONE = (
    {
        name: CASES[name]
        for name in ("force-ramp-seen", "force-impacts", "stack-vibrated", "grip-vibrated")
    }
    | {
        kind: next(s for name, s in CASES.items() if name.startswith(kind))
        for kind in ("lugre-pid", "lugre-fm", "lugre-two", "two_region-pid", "two_region-two")
    }
    | {"band_limited": CASES["lugre-pid-band_limited-friction_level"]}
)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ALONE)
def test_each_number_on_its_own(kind, assert_same_bits):
    """A number in the place of another would be seen."""
    scenario = ALONE[kind].with_({"timing.duration_s": 0.005})
    for path in changeable(scenario):
        batch = bk.simulate_many(scenario, 5, vary=vary_all(scenario, [path], 5), threads=1)
        assert list(batch.varied) == [path]
        assert_same_bits(batch)


@pytest.mark.parametrize("name", CASES)
def test_every_number_of_a_job_has_a_place(name):
    """Under the path by which Python has it, but for tables that hold a law's numbers.

    The core has room for more elements than are given.
    """
    job = core_job(resolve(CASES[name]), 0)
    places = _core.number_places(job)
    assert list(places.values()) == list(range(len(places)))
    paths = leaves({name: job[name] for name in ("extraction", "limits")})
    given = {path.replace(".friction.", ".").replace(".law.", ".") for path in paths}
    assert len(given) == len(paths)
    assert given <= set(places)
    assert {path for path in places if "_shares." not in path} <= given


def leaves(values, prefix=""):
    """Give the paths of all numbers within dictionaries and lists."""
    items = values.items() if isinstance(values, dict) else enumerate(values)
    found = set()
    for name, value in items:
        if isinstance(value, dict | list | tuple):
            found |= leaves(value, f"{prefix}{name}.")
        elif isinstance(value, float):
            found.add(f"{prefix}{name}")
    return found


def test_numbers_are_found_in_every_room():
    paths = {path for scenario in CASES.values() for path in number_paths(scenario)}
    assert {
        "joint.residual_n",
        "joint.viscous_n_s_per_m",
        "part.mass_kg",
        "reference.acceleration_m_per_s2",
        "disturbance.var",
        "disturbance.hold_s",
        "disturbance.bandwidth_hz",
        "actuator.force_max_n",
        "actuator.bandwidth_hz",
        "actuator.stiffness_n_per_m",
        "actuator.contact.gap_m",
        "actuator.contact.backlash_m",
        "actuator.tip.hysteresis_share",
        "sensors.position.noise_rms_m",
        "sensors.force.quantum_n",
        "watch.jump_max_m",
        "watch.frozen_max_s",
        "controller.rate_n_per_s",
        "controller.force_start_n",
        "controller.feed.approach_s",
        "controller.pulses.amplitude_ratio",
        "limits.after_release_s",
        "controller.gains.ki_n_per_m_s",
        "controller.derivative_filter_s",
        "controller.pid.tracking_time_s",
        "controller.breakaway.gains.kp_n_per_m",
        "controller.breakaway.rate_n_per_s",
        "controller.vibration.pid.gains.kp_n_per_m",
        "controller.vibration.vibration.pulse_width_s",
        "controller.vibration.force_start_n",
        "controller.breakaway_travel_m",
        "limits.diverged_error_m",
        "limits.peak_force_max_n",
        "limits.release_velocity_max_m_per_s",
    } <= paths


@pytest.mark.slow
@pytest.mark.parametrize("name", bk.preset_names())
@pytest.mark.parametrize("var", [0.0, 0.125])
def test_presets(name, var, assert_same_bits, assert_same_batch):
    """The commonest kinds, whose loop is compiled on its own; long enough for a second block."""
    scenario = bk.load_scenario(name).with_({"timing.duration_s": 0.015, "disturbance.var": var})
    varied = {
        "joint.stiction_n": bk.Normal(mean=450.0, std=50.0, low=370.0),
        "part.mass_kg": bk.Uniform(low=0.9, high=1.1),
    }
    for vary in ({}, varied):
        batches = [
            bk.simulate_many(scenario, 19, vary=vary, instructions=instructions, threads=2)
            for instructions in INSTRUCTIONS
        ]
        for other in batches[1:]:
            assert_same_batch(batches[0], other)
        assert_same_bits(batches[0])


def test_a_whole_extraction(assert_same_bits):
    scenario = bk.load_scenario("paper_as_computed").with_({"disturbance.var": 0.05})
    batch = bk.simulate_many(
        scenario, 3, vary={"joint.stiction_n": bk.LogUniform(low=400.0, high=500.0)}
    )
    assert set(batch["outcome"]) == {"released"}
    assert_same_bits(batch)


@pytest.mark.parametrize("instructions", INSTRUCTIONS)
def test_runs_that_diverge_beside_runs_that_do_not(instructions, assert_same_bits):
    """At any sample of any block, by error, by force, and by leaving the numbers."""
    scenario = bk.load_scenario("paper_as_computed").with_(
        {
            "controller.gains": bk.Gains(
                kp_n_per_m=828.2e3, ki_n_per_m_s=823940e3, kd_n_s_per_m=662.5
            ),
            "timing.duration_s": 0.2,
            "disturbance.var": 0.2,
        }
    )
    rng = np.random.default_rng(3)
    runs = 40
    vary = {
        "controller.gains.kp_n_per_m": np.where(
            np.arange(runs) % 5 == 3, -1e12, 10.0 ** rng.uniform(5.0, 7.5, runs)
        ),
        "limits.diverged_error_m": 10.0 ** rng.uniform(-7.0, -1.3, runs),
        "limits.diverged_force_n": np.where(
            np.arange(runs) % 5 == 3, 1e12, 10.0 ** rng.uniform(1.5, 4.0, runs)
        ),
    }
    vary["limits.diverged_error_m"][3::5] = 1e12
    batch = bk.simulate_many(scenario, runs, vary=vary, instructions=instructions)
    assert_same_bits(batch)
    diverged = batch["outcome"] == "diverged"
    assert 10 <= diverged.sum() <= 38
    blocks = np.unique(batch["simulated_s"][diverged] // (4096 * 1e-5))
    assert len(blocks) >= 3, blocks
    assert diverged[3::5].all()


@pytest.mark.parametrize("metric", METRICS)
def test_a_metric_has_the_same_bits_whatever_else_is_asked_for(metric, bits):
    """With runs that are free, that are not, that exceed limits and that diverge."""
    scenario = CASES["lugre-pid-gaussian-joint_force"]
    vary = vary_all(
        scenario,
        ["joint.stiction_n", "limits.diverged_error_m", "limits.peak_force_max_n"],
        35,
    )
    everything = bk.simulate_many(scenario, 35, vary=vary)
    alone = bk.simulate_many(scenario, 35, vary=vary, metrics=[metric])
    assert set(alone.columns) == {*vary, metric}
    if metric == "outcome":
        assert len(set(alone["outcome"])) >= 2
        np.testing.assert_array_equal(alone["outcome"], everything["outcome"])
        return
    assert alone.outcome_codes is None
    np.testing.assert_array_equal(bits(alone[metric]), bits(everything[metric]))


@pytest.mark.parametrize(
    "limit", ["peak_force_max_n", "jump_max_m", "release_velocity_max_m_per_s"]
)
def test_outcomes_alone_know_limits_that_all_runs_share(limit):
    scenario = CASES["lugre-pid-uniform-joint_force"]
    metric = {
        "peak_force_max_n": "peak_force_n",
        "jump_max_m": "largest_jump_m",
        "release_velocity_max_m_per_s": "release_velocity_m_per_s",
    }[limit]
    values = bk.simulate_many(scenario, 21)[metric]
    middle = float(np.nanmedian(values))
    strict = scenario.with_({f"limits.{limit}": middle})
    batch = bk.simulate_many(strict, 21, metrics=["outcome"])
    np.testing.assert_array_equal(batch["outcome"] == "limit_exceeded", values > middle)
    assert 0 < (values > middle).sum() < 21


@pytest.mark.parametrize("first", [1, 2**32 - 3, 2**63 - 2])
def test_first_run(quick, first, assert_same_bits):
    vary = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)}
    batch = bk.simulate_many(quick, range(first, first + 5), vary=vary)
    assert batch.run_index.tolist() == list(range(first, first + 5))
    assert len(set(batch["iae_m_s"])) == 5
    assert_same_bits(batch)


def test_pieces_of_a_batch_are_the_batch(assert_same_batch, bits):
    scenario = CASES["lugre-two_step-band_limited-joint_force"]
    table = {"rows": "shared", "distribution": "samples"}
    vary = {
        "joint.stiction_n": bk.Normal(mean=450.0, std=30.0, low=380.0),
        "part.mass_kg": bk.Samples(values=[0.9, 1.0, 1.1], **table),
        "disturbance.var": bk.Uniform(low=0.0, high=0.2),
        "limits.diverged_error_m": bk.Samples(values=[1e-3, 2e-3, 3e-3], **table),
    }
    whole = bk.simulate_many(scenario, 45, vary=vary)
    cuts = [0, 1, 4, 20, 37, 45]
    pieces = [
        bk.simulate_many(scenario, range(start, stop), vary=vary, threads=threads)
        for start, stop, threads in zip(cuts[:-1], cuts[1:], (1, 2, 5, 1, 2), strict=True)
    ]
    for name in whole.columns:
        together = np.concatenate([piece[name] for piece in pieces])
        if name == "outcome":
            np.testing.assert_array_equal(together, whole[name])
        else:
            np.testing.assert_array_equal(bits(together), bits(whole[name]), err_msg=name)
    assert_same_batch(pieces[2], bk.simulate_many(scenario, range(4, 20), vary=vary))


def test_arrays_and_draws_mix(quick, assert_same_bits):
    """Values that are given take no draws: the others are what they are without them."""
    drawn = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)}
    given = {"part.mass_kg": [0.9, 1.0, 1.1]}
    mixed = bk.simulate_many(quick, 3, vary={**given, **drawn})
    alone = bk.simulate_many(quick, 3, vary=drawn)
    assert list(mixed.varied) == ["part.mass_kg", "joint.stiction_n"]
    np.testing.assert_array_equal(mixed["joint.stiction_n"], alone["joint.stiction_n"])
    np.testing.assert_array_equal(mixed["part.mass_kg"], given["part.mass_kg"])
    assert_same_bits(mixed)


def test_a_designed_controller_does_not_know_its_part(assert_same_bits):
    scenario = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 0.005})
    batch = bk.simulate_many(scenario, 4, vary={"part.mass_kg": [0.8, 1.0, 1.2, 1.4]})
    assert batch.scenario == with_nominal_controller(scenario)
    gains = {repr(batch.scenario_of(i).controller.gains) for i in range(4)}
    assert gains == {repr(bk.resolve(scenario).controller.gains)}
    assert_same_bits(batch)
    own = bk.simulate(scenario.with_({"part.mass_kg": 1.4}))
    assert own.metrics.iae_m_s != batch["iae_m_s"][3]


def test_a_filter_of_no_time_is_no_filter(quick, bits):
    """A column in which it is zero takes another way than a scenario in which it is."""
    path = "controller.derivative_filter_s"
    column = bk.simulate_many(quick, 4, vary={path: [0.0, 1e-4, 0.0, 0.0]})
    plain = bk.simulate_many(quick, 4)
    for name in FIGURES:
        same = bits(column[name]) == bits(plain[name])
        assert same[[0, 2, 3]].all(), name
    assert column["iae_m_s"][1] != plain["iae_m_s"][1]
