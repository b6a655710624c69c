"""Small scenarios for studies: one that is over at once, one whose failures are known exactly."""

import pytest

import breakaway as bk

FORCE_MAX_N = 600.0
LENGTH_M = 0.01
STIFFNESS = 3.6e7
WEIGHT_N = 9.81


@pytest.fixture(scope="session")
def quick() -> bk.Scenario:
    """Give a disturbed extraction of 2 ms, of which nothing comes loose."""
    return bk.load_scenario("paper_as_computed").with_(
        {"disturbance.var": 0.2, "timing.duration_s": 0.002}
    )


@pytest.fixture(scope="session")
def pushed() -> bk.Scenario:
    """Give a joint that breaks loose at its stiction force, and an actuator of limited force.

    Under the two-region law it is released exactly where its stiction is within what the
    actuator can push, see `largest_stiction_n`.
    """
    scenario = bk.load_scenario("paper_as_computed").with_(
        joint=bk.TwoRegion(
            stiction_n=450.0,
            coulomb_n=100.0,
            stiffness_n_per_m=STIFFNESS,
            damping_n_s_per_m=20_000.0,  # no overshoot
            engagement_length_m=LENGTH_M,
        ),
        reference=bk.MinimumJerk(distance_m=0.0101, duration_s=0.02),
        actuator=bk.PushOnlyActuator(force_max_n=FORCE_MAX_N),
        timing={"duration_s": 0.025},
        limits={"diverged_error_m": 1.0, "diverged_force_n": 1e6},
    )
    return scenario.with_({"controller.anti_windup": "conditional"})


@pytest.fixture(scope="session")
def largest_stiction_n() -> float:
    """Give the stiction at which F_s(x) = F_max where the stuck joint holds F_max: x = F_max / k_e.

    F_s falls linearly over the guide, to the weight of the part at its end.
    """
    share = FORCE_MAX_N / STIFFNESS / LENGTH_M
    return (FORCE_MAX_N - share * WEIGHT_N) / (1.0 - share)
