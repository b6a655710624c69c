"""Scenarios of every kind: parts that break loose, slide and leave within 4 ms."""

from __future__ import annotations

from itertools import product

import breakaway as bk

LENGTH_M = 8e-4
BASE = bk.load_scenario("paper_as_computed").with_(
    {
        "joint.engagement_length_m": LENGTH_M,
        "joint.stiffness_n_per_m": 6e6,
        "joint.damping_n_s_per_m": 1500.0,
        "joint.residual_n": 150.0,
        "timing.duration_s": 4e-3,
        "limits.diverged_error_m": 1.0,
    },
    reference=bk.MinimumJerk(distance_m=1e-3, start_s=3e-4, duration_s=2e-3),
    disturbance=bk.UniformDisturbance(var=0.15, hold_s=1.6e-4),
    controller=bk.Pid(gains=bk.Gains(kp_n_per_m=2e6, ki_n_per_m_s=8e8, kd_n_s_per_m=900.0)),
)
GAINS = BASE.controller.gains
PULSES = {
    "frequency_min_hz": 2000.0,
    "frequency_max_hz": 3500.0,
    "error_full_scale_m": 2e-4,
    "pulse_width_s": 2e-4,
    "base_fraction": 0.3,
}
IMPACTS = bk.TimedImpacts(
    travel_m=LENGTH_M,
    target_s=4e-3,
    force_start_n=300.0,
    search_time_constant_s=5e-4,
    rise_time_constant_s=3e-4,
    rise_min_s=1e-4,
    rise_per_slip=1.0,
    slowing_m_per_s=0.2,
    holding_m_per_s=0.6,
    step_min_m=2e-4,
    step_max_m=9e-4,
    travel_min_m=1.2e-4,
    coast_min_s=1e-4,
    settled_m=1e-5,
    lead_start_s=1e-4,
    lead_min_s=1e-5,
    lead_max_s=1e-3,
    noise_rms_m=1e-8,
    actuator_lag_s=4e-5,
)
RAMP = bk.ForceRamp(rate_n_per_s=1.5e6, travel_m=LENGTH_M)
PUSH_ONLY = bk.PushOnlyActuator(force_max_n=800.0)
FORCE = bk.ForceActuator(force_max_n=900.0, bandwidth_hz=4000.0, force_rate_max_n_per_s=3e6)
CONTACT = bk.Contact(stiffness_n_per_m=5e7, damping_n_s_per_m=3e3, gap_m=1e-6)
STACK = bk.Piezo(
    stroke_m=38e-6,
    stiffness_n_per_m=1e8,
    tip_mass_kg=0.05,
    damping_n_s_per_m=400.0,
    hysteresis_share=0.4,
    preload_n=800.0,
    capacitance_f=13e-6,
    voltage_max_v=120.0,
    current_max_a=20.0,
    amplifier_bandwidth_hz=5000.0,
)
AXIS = {
    "speed_max_m_per_s": 0.4,
    "acceleration_max_m_per_s2": 800.0,
    "stiffness_n_per_m": 3e7,
    "damping_n_s_per_m": 8e3,
    "tool_mass_kg": 1.0,
    "contact": CONTACT,
}
FEED = {"speed_m_per_s": 0.35, "approach_m_per_s": 0.02, "approach_s": 2e-4}
VIBRATED = bk.VibratedFeed(
    feed=bk.FeedSettings(**FEED),
    pulses=bk.StackPulses(
        frequency_hz=2500.0,
        pulse_width_s=2e-4,
        amplitude_ratio=0.7,
        stack_force_n=2000.0,
        force_filter_s=1e-4,
    ),
)
SENSORS = bk.Sensors(
    position=bk.PositionSensor(noise_rms_m=1e-8, quantum_m=1e-8, bandwidth_hz=2e4, delay_samples=1),
    force=bk.ForceSensor(noise_rms_n=1.0, delay_samples=3, bandwidth_hz=5e3),
)
WATCH = bk.Watch(jump_max_m=1e-4)
NERVOUS = bk.Watch(jump_max_m=6e-6, frozen_max_s=1e-3)


def controllers() -> dict[str, bk.Scenario]:
    """Every controller, and every option of a PID."""
    found: dict[str, bk.Scenario] = {}
    options = product(
        ("error", "measurement"),
        ("sensor", "position_difference"),
        ("off", "conditional", "back_calculation"),
    )
    pids = []
    for n, (of, source, windup) in enumerate(options):
        settings = {
            "gains": GAINS,
            "derivative_of": of,
            "velocity_from": source,
            "anti_windup": windup,
            "derivative_filter_s": 2e-5 * (n % 2),
        }
        pids.append(settings)
        found[f"pid_{of}_{source}_{windup}"] = BASE.with_(
            controller=bk.Pid(**settings), actuator=PUSH_ONLY
        )
    for n, shape in enumerate(("rectangular", "half_sine", "raised_cosine")):
        pulses = bk.FmPulses(**PULSES, shape=shape)
        vibration = bk.FmVibration(pid=bk.PidSettings(**pids[n + 5]), vibration=pulses)
        first = bk.Pid(**pids[2 * n]) if n < 2 else RAMP
        two = bk.TwoStep(breakaway=first, vibration=vibration, breakaway_travel_m=2e-4)
        found[f"fm_{shape}"] = BASE.with_(controller=vibration, actuator=PUSH_ONLY)
        found[f"two_step_{shape}"] = BASE.with_(
            controller=two, actuator=PUSH_ONLY, watch=(None, NERVOUS, WATCH)[n]
        )
    impacts = bk.TwoStep(breakaway=RAMP, vibration=IMPACTS, breakaway_travel_m=2e-4)
    found["two_step_impacts"] = BASE.with_(controller=impacts, actuator=FORCE, watch=WATCH)
    found["ramp"] = BASE.with_(controller=RAMP, actuator=FORCE, watch=NERVOUS)
    found["impacts"] = BASE.with_(controller=IMPACTS, actuator=FORCE)
    stacked = bk.FeedAxis(**AXIS, tip=STACK)
    found["steady_feed"] = BASE.with_(
        controller=bk.SteadyFeed(**FEED), actuator=bk.FeedAxis(**AXIS)
    )
    found["vibrated_feed"] = BASE.with_(controller=VIBRATED, actuator=stacked, watch=WATCH)
    delayed = BASE.with_({"timing.one_sample_delay": True}, watch=NERVOUS)
    found["pid_watched_delayed"] = delayed
    motions = {
        "step": bk.StepReference(distance_m=1e-3, start_s=3e-4),
        "ramp": bk.RampReference(distance_m=1e-3, start_s=3e-4, duration_s=2e-3),
        "trapezoid": bk.TrapezoidalVelocity(
            distance_m=1e-3, start_s=3e-4, velocity_m_per_s=0.7, acceleration_m_per_s2=1500.0
        ),
    }
    for name, motion in motions.items():
        found[f"reference_{name}"] = BASE.with_(reference=motion)
    return found


def plants() -> dict[str, bk.Scenario]:
    """Every law, actuator, sensor and disturbance, with one step in a period and several."""
    levels = {"stiction_n": 450.0, "coulomb_n": 360.0}
    guide = {"engagement_length_m": LENGTH_M, "residual_n": 150.0}
    bristle = {"stiffness_n_per_m": 6e6, "damping_n_s_per_m": 1500.0}
    stribeck = {"stribeck_velocity_m_per_s": 0.09, "viscous_n_s_per_m": 40.0}
    options = {"damping_velocity_m_per_s": 0.4, "backward_ratio": 0.7}
    full = {**levels, **guide, **bristle, **stribeck, **options}
    joints = {
        "lugre": bk.Lugre(**full),
        "elasto_plastic": bk.ElastoPlastic(**full, elastic_share=0.6),
        "gms": bk.Gms(**full, attraction_n_per_s=2e6, elements=5),
        "two_region": bk.TwoRegion(**levels, **guide, **bristle, backward_ratio=0.7),
        "coulomb": bk.CoulombStiction(**levels, **guide, **stribeck, backward_ratio=0.7),
    }
    friction_level = bk.UniformDisturbance(var=0.15, hold_s=1.6e-4, acts_on="friction_level")
    found: dict[str, bk.Scenario] = {"plain": BASE}
    for n, (name, joint) in enumerate(joints.items()):
        steps = {"timing.steps_per_period": 1 + 2 * (n % 2)}
        found[name] = BASE.with_(steps, joint=joint, disturbance=friction_level)
    found["rk4"] = BASE.with_({"timing.integrator": "rk4", "timing.steps_per_period": 5})
    found["push_only_delayed"] = BASE.with_({"timing.one_sample_delay": True}, actuator=PUSH_ONLY)
    found["force_sensed"] = BASE.with_(
        {"timing.steps_per_period": 2},
        actuator=FORCE,
        sensors=SENSORS,
        disturbance=bk.GaussianDisturbance(var=0.1, hold_s=3e-5),
    )
    found["axis"] = BASE.with_(
        actuator=bk.FeedAxis(**AXIS),
        controller=bk.SteadyFeed(**FEED),
        disturbance=bk.BandLimitedDisturbance(var=0.1, hold_s=2e-5, bandwidth_hz=3e3),
    )
    found["axis_stack_sensed"] = BASE.with_(
        {"timing.steps_per_period": 2},
        actuator=bk.FeedAxis(**AXIS, tip=STACK),
        controller=VIBRATED,
        sensors=SENSORS,
        watch=WATCH,
    )
    found["axis_grip"] = found["axis_stack_sensed"].with_(
        {"actuator.contact.backlash_m": 4e-6, "timing.steps_per_period": 1}
    )
    found["axis_gms"] = found["axis"].with_(joint=joints["gms"])
    return found


def varying() -> dict[str, bk.Scenario]:
    """Friction that varies along the way, during a pull, and with a normal force that shakes: what
    single precision cannot hold."""
    joints = {name: PLANTS[name].joint for name in ("lugre", "elasto_plastic", "gms", "coulomb")}
    drift = bk.DriftOverTime(time_s=[0.0, 1e-3, 4e-3], factor=[1.0, 0.9, 1.1])
    shaken = bk.NormalForceOverTravel(
        travel_m=[0.0, LENGTH_M],
        force_n=[1000.0, 600.0],
        vibration=bk.NormalVibration(
            amplitude_m=2e-6, stiffness_n_per_m=1e8, frequency_hz=900.0, phase_turns=0.2
        ),
    )
    across = bk.TransverseVibration(amplitude_m=5e-6, frequency_hz=2000.0)
    found: dict[str, bk.Scenario] = {}
    laws = (("bounded", 0.3), ("gaussian", 0.15), ("log_normal", 0.3), ("bounded", 0.1))
    for n, ((name, joint), (law, var)) in enumerate(zip(joints.items(), laws, strict=True)):
        field = bk.FieldDisturbance(law=law, var=var, correlation_length_m=2e-5)
        steps = {"timing.steps_per_period": 1 + 2 * (n % 2)}
        normal = shaken.model_copy(update={"transverse": across if n < 2 else None})
        changed = joint.model_copy(update={"drift": drift, "normal_force": normal})
        found[f"{name}_varying"] = BASE.with_(steps, joint=changed, disturbance=field)
        found[f"{name}_{law}_field"] = BASE.with_(steps, joint=joint, disturbance=field)
    found["sensed_field"] = BASE.with_(sensors=SENSORS, disturbance=field)
    return found


CONTROLLERS, PLANTS = controllers(), plants()
VARYING = varying()
LOOPS = {**PLANTS, **{name: CONTROLLERS[name] for name in list(CONTROLLERS)[12:]}}
