"""Scenarios of one contact under vibration: a part that a feed moves on, or that a force pushes."""

from math import pi, sqrt

import breakaway as bk
from breakaway.model.scenario.controller import AnyController
from breakaway.model.scenario.files import scenario_toml
from breakaway.model.scenario.joint import AnyJoint

FRICTION_N = 360.0
"""mu N_0, at rest and sliding, so that without vibration nothing depends on the velocity."""
NORMAL_N = 2000.0
"""N_0."""
STIFFNESS_N_PER_M = 3.6e7
"""k, of the elastic contact along and across the motion."""
YIELD_M = FRICTION_N / STIFFNESS_N_PER_M
"""mu N_0 / k, the deflection at which the elastic contact slips."""
NORMAL_STIFFNESS_N_PER_M = 5e7
FREQUENCY_HZ = 100.0
OMEGA_PER_S = 2 * pi * FREQUENCY_HZ
STIFF = {"stiffness_n_per_m": 1e12, "damping_n_s_per_m": 3e6}
"""Axis, stack and contact of a feed that yields far less than the elastic contact."""
GUIDE_M = 1.0
PERIOD_S = 2e-6
CYCLES = 12

LEVELS = {
    "stiction_n": FRICTION_N,
    "coulomb_n": FRICTION_N,
    "residual_n": FRICTION_N,
    "stribeck_velocity_m_per_s": 0.1,
    "engagement_length_m": GUIDE_M,
}
RIGID = bk.CoulombStiction(**LEVELS)
ELASTIC = bk.ElastoPlastic(
    **LEVELS, stiffness_n_per_m=STIFFNESS_N_PER_M, damping_n_s_per_m=0.0, elastic_share=0.9998
)
"""Prandtl's element, but for the last 0.02 % of its level."""
DAMPED = ELASTIC.model_copy(update={"damping_n_s_per_m": 600.0})
"""The same for a part that would swing on its contact."""
LIGHT_KG = 0.01
"""A mass whose inertia does not count."""


def along(joint: AnyJoint, speed: float, softness: float) -> bk.Scenario:
    """A part that is moved on at v + v_a cos(w t).

    Parameters
    ----------
    joint : joint
        RIGID or ELASTIC.
    speed : float
        v / v_a.
    softness : float
        K, the yield deflection over the amplitude of the vibration.

    """
    amplitude_m = YIELD_M / softness
    return _fed(joint, speed * OMEGA_PER_S * amplitude_m, stroke_m=2 * amplitude_m)


def across(speed: float, softness: float) -> bk.Scenario:
    """A part that is moved on at v on an elastic contact that vibrates across the motion.

    Parameters
    ----------
    speed : float
        v / v_a.
    softness : float
        K, the yield deflection over the amplitude of the vibration.

    """
    amplitude_m = YIELD_M / softness
    return _fed(shaken_across(ELASTIC, 1 / softness), speed * OMEGA_PER_S * amplitude_m)


def pressed(amplitude: float, speed: float) -> bk.Scenario:
    """A part that is moved on at v on an elastic contact whose normal force vibrates.

    Parameters
    ----------
    amplitude : float
        du_z / u_z0.
    speed : float
        v k_x / (mu k_z w du_z).

    """
    return _fed(shaken_normal(ELASTIC, amplitude), speed * amplitude * OMEGA_PER_S * YIELD_M)


def sprung(amplitude: float, speed: float, *, mass_kg: float = LIGHT_KG) -> bk.Scenario:
    """The same with a rigid contact: its spring k_x is the axis of the feed, and the part is light.

    Half of the mass is the tool's.
    """
    axis = bk.FeedAxis(
        stiffness_n_per_m=STIFFNESS_N_PER_M,
        damping_n_s_per_m=sqrt(STIFFNESS_N_PER_M * mass_kg),
        speed_max_m_per_s=10.0,
        acceleration_max_m_per_s2=1e6,
        tool_mass_kg=mass_kg / 2,
        contact=bk.Contact(**STIFF, backlash_m=0.0),
    )
    feed_m_per_s = speed * amplitude * OMEGA_PER_S * YIELD_M
    feed = bk.SteadyFeed(speed_m_per_s=feed_m_per_s, approach_m_per_s=feed_m_per_s, approach_s=0.0)
    joint = shaken_normal(RIGID, amplitude)
    return _scenario(joint, actuator=axis, controller=feed, mass_kg=mass_kg / 2)


def pushed(joint: AnyJoint, share: float) -> bk.Scenario:
    """A light part under a force that rises within a cycle to a share of mu N_0, and then stays."""
    return _scenario(
        joint,
        mass_kg=LIGHT_KG,
        actuator=bk.PushOnlyActuator(force_max_n=share * FRICTION_N),
        controller=bk.ForceRamp(rate_n_per_s=share * FRICTION_N * FREQUENCY_HZ, travel_m=GUIDE_M),
    )


def shaken_normal(joint: AnyJoint, amplitude: float) -> AnyJoint:
    """Give a joint the normal force N_0 (1 - amplitude cos(w t))."""
    vibration = bk.NormalVibration(
        amplitude_m=amplitude * NORMAL_N / NORMAL_STIFFNESS_N_PER_M,
        stiffness_n_per_m=NORMAL_STIFFNESS_N_PER_M,
        frequency_hz=FREQUENCY_HZ,
        phase_turns=-0.25,
    )
    force = bk.ConstantNormalForce(force_n=NORMAL_N, vibration=vibration)
    return joint.model_copy(update={"normal_force": force})


def shaken_across(joint: AnyJoint, amplitude: float) -> AnyJoint:
    """Give a joint a vibration across the motion, of an amplitude in yield deflections."""
    vibration = bk.TransverseVibration(
        amplitude_m=amplitude * YIELD_M, frequency_hz=FREQUENCY_HZ, phase_turns=0.25
    )
    force = bk.ConstantNormalForce(force_n=NORMAL_N, transverse=vibration)
    return joint.model_copy(update={"normal_force": force})


def _fed(joint: AnyJoint, speed_m_per_s: float, *, stroke_m: float = 0.0) -> bk.Scenario:
    """Give a part in the grip of a feed that moves on; a stack adds a sine of a stroke.

    Pulses of the stack as long as their period are one sine; their ratio is so large that all of
    them take the whole stroke.
    """
    feed = bk.FeedSettings(
        speed_m_per_s=speed_m_per_s, approach_m_per_s=speed_m_per_s, approach_s=0.0
    )
    stack = bk.Piezo(
        **STIFF,
        stroke_m=stroke_m or 1e-6,
        tip_mass_kg=0.1,
        preload_n=800.0,
        capacitance_f=1e-6,
        voltage_max_v=120.0,
        current_max_a=10.0,
        amplifier_bandwidth_hz=1e5,
    )
    pulses = bk.StackPulses(
        frequency_hz=FREQUENCY_HZ,
        pulse_width_s=1 / FREQUENCY_HZ,
        stack_force_n=1000.0,
        amplitude_ratio=1e4 if stroke_m else 0.0,
        force_filter_s=1.0,
    )
    axis = bk.FeedAxis(
        **STIFF,
        speed_max_m_per_s=10.0,
        acceleration_max_m_per_s2=1e6,
        tool_mass_kg=10.0,
        tip=stack,
        contact=bk.Contact(**STIFF, backlash_m=0.0),
    )
    return _scenario(joint, actuator=axis, controller=bk.VibratedFeed(feed=feed, pulses=pulses))


def _scenario(
    joint: AnyJoint,
    actuator: bk.FeedAxis | bk.PushOnlyActuator,
    controller: AnyController,
    *,
    mass_kg: float = 1.0,
) -> bk.Scenario:
    return bk.Scenario(
        joint=joint,
        part=bk.Part(mass_kg=mass_kg),
        reference=bk.StepReference(distance_m=GUIDE_M),
        actuator=actuator,
        controller=controller,
        timing=bk.Timing(
            duration_s=CYCLES / FREQUENCY_HZ, control_period_s=PERIOD_S, steps_per_period=4
        ),
        limits=bk.Limits(diverged_error_m=1.0, diverged_force_n=1e6),
        trace=bk.Trace(every_samples=1),
    )


def mean_friction(scenario: bk.Scenario) -> float:
    """Simulate; give the mean friction of the last cycle as a share of mu N_0."""
    samples = round(1 / FREQUENCY_HZ / PERIOD_S)
    friction_n = bk.simulate(scenario).trace["joint_force_n"]
    return float(friction_n[-1 - samples : -1].mean()) / FRICTION_N


def creep(scenario: bk.Scenario) -> float:
    """Simulate; give how far the part goes in the last cycle as a share of the yield deflection."""
    samples = round(1 / FREQUENCY_HZ / PERIOD_S)
    position_m = bk.simulate(scenario).trace["position_m"]
    return float(position_m[-2] - position_m[-2 - samples]) / YIELD_M


def static_friction(joint: AnyJoint) -> float:
    """Give the smallest force under which a part still creeps, as a share of mu N_0.

    Creep is by more than 1e-4 of the yield deflection in a cycle.
    """
    low, high = 0.0, 1.5
    while high - low > 2e-5:
        middle = (low + high) / 2
        creeps = creep(pushed(joint, middle)) > 1e-4
        low, high = (low, middle) if creeps else (middle, high)
    return (low + high) / 2


def main() -> None:
    """Print one of them as a file: a normal force that vibrates, a = 0.6, s = 0.3."""
    print(scenario_toml(pressed(0.6, 0.3)))


if __name__ == "__main__":
    main()
