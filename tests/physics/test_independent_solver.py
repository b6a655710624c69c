"""Our plant and loop against an independent SciPy solution of the continuous equations.

A sampled PID differs from a continuous one by its hold, to first order in the control period; so
the difference must halve with the period, and vanish under Richardson extrapolation. A force that
is the same for both leaves the integrator alone, which must show its order.
"""

from itertools import pairwise

import numpy as np
import pytest

import breakaway as bk

# Joints without a limit cycle, on a guide short enough for half of the contact to be lost.
JOINTS = {
    "paper": {},
    "soft": {"joint.stiffness_n_per_m": 5e6, "joint.damping_n_s_per_m": 3000.0},
    "low_stribeck_velocity": {
        "joint.stribeck_velocity_m_per_s": 0.02,
        "controller.gains.kd_n_s_per_m": 6000.0,
    },
    "damped": {"joint.damping_n_s_per_m": 3e4, "joint.viscous_n_s_per_m": 200.0},
    "stiff_and_heavy": {
        "joint.stiffness_n_per_m": 1e8,
        "joint.damping_n_s_per_m": 15000.0,
        "part.mass_kg": 2.0,
    },
}
PERIODS_S = (1e-5, 5e-6, 2.5e-6)


@pytest.fixture(scope="module")
def resolved():
    return bk.simulate(bk.load_scenario("paper_as_computed")).scenario


def continuous_loop(scipy_lugre, scenario, times):
    """x, v, z, I and IAE of a continuous PID (SYSTEM.md sections 1, 3 and 7)."""
    plant = scipy_lugre.of(scenario.joint, scenario.part.mass_kg)
    gains, reference = scenario.controller.gains, scenario.reference
    distance, duration = reference.distance_m, reference.duration_s

    def error(t, y):
        tau = min(t / duration, 1.0)
        r = distance * (10 * tau**3 - 15 * tau**4 + 6 * tau**5)
        rate = distance / duration * 30 * tau**2 * (1 - tau) ** 2
        return r - y[0], rate - y[1]

    def force(t, y):
        e, e_rate = error(t, y)
        return gains.kp_n_per_m * e + y[3] + gains.kd_n_s_per_m * e_rate

    def controller(t, y):
        e, _ = error(t, y)
        return gains.ki_n_per_m_s * e, abs(e)

    absolute = [1e-15, 1e-12, 1e-16, 1e-9, 1e-17]
    return plant.move(force, controller, np.zeros(5), times, rtol=1e-11, atol=absolute)


@pytest.mark.parametrize("joint", JOINTS)
def test_sampled_loop_converges_on_the_continuous_one(joint, resolved, scipy_lugre):
    scenario = resolved.with_(
        {
            "joint.engagement_length_m": 0.02,
            "reference.distance_m": 0.018,
            "reference.duration_s": 0.1,
            "timing.duration_s": 0.12,
            "controller.gains.kd_n_s_per_m": 2500.0,
            **JOINTS[joint],
        }
    )
    times = np.linspace(0.0, 0.12, 241)
    expected = continuous_loop(scipy_lugre, scenario, times)
    positions, iaes = [], []
    for period_s in PERIODS_S:
        run = bk.simulate(
            scenario.with_(
                {
                    "timing.control_period_s": period_s,
                    "trace.every_samples": round(times[1] / period_s),
                }
            )
        )
        np.testing.assert_allclose(run.trace["t_s"], times, rtol=0, atol=1e-12)
        positions.append(run.trace["position_m"])
        iaes.append(run.metrics.iae_m_s)

    def worst(position):
        return np.abs(position - expected[0]).max()

    errors = [worst(x) for x in positions]
    assert errors[0] < 5e-7  # of 18 mm, and of an error of about 60 um
    ratios = np.divide(errors[:-1], errors[1:])
    assert np.all((ratios > 1.85) & (ratios < 2.1)), ratios
    # Richardson: the term in h is gone, what is left falls with h squared ...
    once = [2 * fine - coarse for coarse, fine in pairwise(positions)]
    assert 3.7 < worst(once[0]) / worst(once[1]) < 4.3
    # ... and is gone in turn after another extrapolation.
    assert worst((4 * once[1] - once[0]) / 3) < 3e-10
    iae = [2 * fine - coarse for coarse, fine in pairwise(iaes)]
    assert (4 * iae[1] - iae[0]) / 3 == pytest.approx(expected[4, -1], rel=1e-6)


def test_paper_loop_with_a_continuous_pid(resolved, scipy_lugre):
    """The limit cycle, too, is that of the equations and not of an integrator."""
    expected = continuous_loop(scipy_lugre, resolved, np.linspace(0.0, 0.5, 3))[4, -1]
    assert expected == pytest.approx(2.899051e-6, rel=1e-5)  # also by Radau and by DOP853
    coarse, fine, finest = (
        bk.simulate(
            resolved.with_({"timing.control_period_s": period_s, "trace.every_samples": 0})
        ).metrics.iae_m_s
        for period_s in (2.5e-6, 1.25e-6, 6.25e-7)
    )
    assert (coarse - expected) / (fine - expected) == pytest.approx(2.0, abs=0.05)
    assert (8 * finest - 6 * fine + coarse) / 3 == pytest.approx(expected, rel=1e-5)


def ramp(resolved, integrator, steps, changes):
    """A force that rises by 8 N at every sample, whatever the joint does.

    Integral control on an error that is constant to 1e-12: the reference is 1e9 m away.
    """
    scenario = resolved.with_(
        {
            "controller.gains.kp_n_per_m": 0.0,
            "controller.gains.ki_n_per_m_s": 8e4 / 1e9,
            "controller.gains.kd_n_s_per_m": 0.0,
            "limits.diverged_error_m": 1e10,
            "limits.diverged_force_n": 1e9,
            "timing.control_period_s": 1e-4,
            "timing.duration_s": 80e-4,
            "timing.steps_per_period": 100,
            "trace.every_samples": 1,
            **changes,
        },
        reference=bk.StepReference(distance_m=1e9),
    )
    # Steps too coarse for a scenario, unchecked here: their errors stand out from rounding.
    timing = {"integrator": integrator, "steps_per_period": steps}
    timing = scenario.timing.model_copy(update=timing)
    return bk.simulate(scenario.model_copy(update={"timing": timing}))


@pytest.mark.parametrize("joint", ["paper", "soft", "low_stribeck_velocity", "damped"])
@pytest.mark.parametrize(
    ("integrator", "order", "steps", "largest"),
    [
        ("linearly_implicit_midpoint", 2, (16, 32, 64), 4e-4),
        ("rk4", 4, (16, 32, 64), 6e-9),
    ],
)
def test_order_under_a_held_force(
    joint, integrator, order, steps, largest, resolved, scipy_lugre, held_solutions
):
    changes = {path: value for path, value in JOINTS[joint].items() if path.startswith("joint.")}
    errors = []
    for count in steps:
        run = ramp(resolved, integrator, count, changes)
        forces = run.trace["applied_force_n"][:-1]
        np.testing.assert_allclose(forces, 8.0 * np.arange(1, 81), rtol=1e-11)
        if joint not in held_solutions:
            plant = scipy_lugre.of(run.scenario.joint)
            held_solutions[joint] = plant.move_held(forces, 1e-4)
        expected = held_solutions[joint]
        columns = ("position_m", "velocity_m_per_s", "bristle_m")
        errors.append(
            [
                np.abs(run.trace[name] - state).max() / np.abs(state).max()
                for name, state in zip(columns, expected, strict=True)
            ]
        )
    assert expected[0, -1] > 2e-4  # broken loose: presliding and sliding are both covered
    errors = np.array(errors)
    assert np.all(errors[0] < largest), errors
    resolvable = errors[1:] > 1e-12  # below lies the rounding of both solutions
    assert resolvable[0].sum() >= 2 or order == 4
    orders = np.log2(errors[:-1] / errors[1:])[resolvable]
    assert orders.size >= 1
    assert np.all(np.abs(orders - order) < 0.15), orders


@pytest.fixture(scope="module")
def held_solutions():
    """SciPy's answers by joint: both integrators are held to the same."""
    return {}


def test_paper_loop_has_its_known_value(resolved):
    assert bk.simulate(resolved).metrics.iae_m_s == pytest.approx(3.0361549e-6, rel=2e-5)


@pytest.mark.slow
def test_oracle_has_its_known_value(resolved):
    oracle = bk.simulate(
        resolved.with_({"timing.integrator": "rk4", "timing.steps_per_period": 100})
    )
    assert oracle.metrics.iae_m_s == pytest.approx(3.0361549e-6, rel=1e-7)
    assert oracle.metrics.peak_force_n == pytest.approx(601.3447, abs=1e-4)
