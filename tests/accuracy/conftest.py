"""One pull under several laws and by several drives, far from any limit of the steps."""

import pytest

import breakaway as bk
from breakaway.model.scenario.laws import joint_under

PID = {
    "kind": "pid",
    "gains": {"kind": "given", "kp_n_per_m": 3e6, "ki_n_per_m_s": 1e9, "kd_n_s_per_m": 2500.0},
}
RAMP = {"kind": "force_ramp", "rate_n_per_s": 1e4, "travel_m": 0.02}
FEED = {"kind": "steady_feed", "speed_m_per_s": 0.3, "approach_m_per_s": 0.02, "approach_s": 0.01}
AXIS = {
    "kind": "feed_axis",
    "speed_max_m_per_s": 1.0,
    "acceleration_max_m_per_s2": 50.0,
    "stiffness_n_per_m": 2e6,
    "damping_n_s_per_m": 1500.0,
    "tool_mass_kg": 2.0,
}
CONTACT = {"stiffness_n_per_m": 2e7, "damping_n_s_per_m": 1500.0, "gap_m": 1e-4}
FORCE = {"force_max_n": 8e3, "bandwidth_hz": 1e3, "force_rate_max_n_per_s": 2e5}
DRIVES = {
    "ideal": ({"kind": "ideal"}, PID),
    "push_only": ({"kind": "push_only", "force_max_n": 1e3}, RAMP),
    "force": ({"kind": "force", **FORCE}, RAMP),
    "feed_rigid": ({**AXIS, "contact": CONTACT}, FEED),
    "feed_grip": ({**AXIS, "contact": {**CONTACT, "backlash_m": 2e-4}}, FEED),
}


def pull(law: str, drive: str) -> bk.Scenario:
    base = bk.load_scenario("paper_as_computed")
    actuator, controller = DRIVES[drive]
    joint = joint_under(law, base.joint, {"engagement_length_m": 0.02, "residual_n": 50.0})
    return bk.Scenario.model_validate(
        {
            "joint": joint.model_dump(),
            "part": {"mass_kg": 1.0},
            "reference": {"kind": "minimum_jerk", "distance_m": 0.03, "duration_s": 0.15},
            "actuator": actuator,
            "controller": controller,
            "timing": {"duration_s": 0.2, "control_period_s": 1e-5, "steps_per_period": 5},
            "limits": {"after_release_s": 1e-3, "diverged_error_m": 1.0, "diverged_force_n": 1e6},
            "trace": {"every_samples": 0},
        }
    )


@pytest.fixture(scope="session", name="pull")
def _pull():
    """The function; a fixture because test folders are no packages."""
    return pull
