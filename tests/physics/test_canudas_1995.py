"""The figures that introduced LuGre: Canudas de Wit, Olsson, Astrom and Lischinsky,
*A New Model for Control of Systems with Friction*, IEEE TAC 40(3), 1995.

Their joint: sigma_0 = 1e5 N/m, sigma_1 = sqrt(1e5) N s/m, sigma_2 = 0.4 N s/m, F_c = 1 N,
F_s = 1.5 N, v_s = 0.001 m/s, on a mass of 1 kg. Contact is lost over 1e9 m, that is, never.
"""

from math import log, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import breakaway as bk

F_S, F_C, SIGMA_0, SIGMA_2, V_S = 1.5, 1.0, 1e5, 0.4, 1e-3
PULL_N_PER_M, PULL_M_PER_S = 2.0, 0.1


@pytest.fixture(scope="module")
def joint():
    return bk.Lugre(
        stiction_n=F_S,
        coulomb_n=F_C,
        stiffness_n_per_m=SIGMA_0,
        damping_n_s_per_m=sqrt(SIGMA_0),
        viscous_n_s_per_m=SIGMA_2,
        stribeck_velocity_m_per_s=V_S,
        engagement_length_m=1e9,
        residual_n=1.0,
    )


@pytest.fixture(scope="module")
def plant(joint, scipy_lugre):
    return scipy_lugre.of(joint)


def extract(joint, reference, *, kp=0.0, ki=0.0, kd=0.0, duration_s, period_s, every_samples):
    return bk.simulate(
        bk.Scenario(
            joint=joint,
            part=bk.Part(mass_kg=1.0),
            reference=reference,
            disturbance=bk.UniformDisturbance(hold_s=1.0),
            controller=bk.Pid(gains=bk.Gains(kp_n_per_m=kp, ki_n_per_m_s=ki, kd_n_s_per_m=kd)),
            timing=bk.Timing(duration_s=duration_s, control_period_s=period_s),
            limits=bk.Limits(diverged_error_m=1e12, diverged_force_n=1e12),
            trace=bk.Trace(every_samples=every_samples),
        )
    )


# Stick-slip: a spring of 2 N/m whose end moves at 0.1 m/s pulls the mass.


@pytest.fixture(scope="module")
def stick_slip(joint):
    return extract(
        joint,
        bk.RampReference(distance_m=PULL_M_PER_S * 40.0, duration_s=40.0),
        kp=PULL_N_PER_M,
        duration_s=40.0,
        period_s=1e-4,
        every_samples=100,
    ).trace


def slips_of(trace):
    """Rows at which slips start and end."""
    slipping = trace["velocity_m_per_s"] > 10 * V_S
    edges = np.flatnonzero(np.diff(slipping.astype(int)))
    starts = edges[::2]
    assert not slipping[0]
    assert starts.size >= 5
    return starts, edges[1::2]


def test_stick_slip_as_scipy_has_it(stick_slip, plant):
    t_s = stick_slip["t_s"]
    expected = plant.move(
        lambda t, y: PULL_N_PER_M * (PULL_M_PER_S * t - y[0]),
        lambda _t, _y: (),
        np.zeros(3),
        t_s,
        rtol=1e-10,
        atol=1e-14,
    )
    # 0.25 mm in slips of 0.9 m: the hold delays the spring by half a period of 0.1 ms.
    np.testing.assert_allclose(stick_slip["position_m"], expected[0], rtol=0, atol=2.5e-4)
    friction = [plant.force(*state) for state in expected.T]
    assert stick_slip["joint_force_n"].max() == pytest.approx(max(friction), rel=5e-3)


def test_sticking_and_slipping_alternate(stick_slip):
    starts, ends = slips_of(stick_slip)
    velocity, position = stick_slip["velocity_m_per_s"], stick_slip["position_m"]
    for end, start in zip(ends, starts[1:], strict=False):
        stuck = slice(end + 10, start - 100)  # away from the creep before each slip
        assert np.abs(velocity[stuck]).max() < 1e-3 * velocity.max()
        assert np.ptp(position[stuck]) < 1e-3
    for start, end in zip(starts, ends, strict=False):
        assert velocity[start : end + 1].max() > 3 * PULL_M_PER_S
    # The mass is at rest until the spring reaches F_s, at 7.5 s.
    assert stick_slip["t_s"][starts[0]] == pytest.approx(
        F_S / PULL_N_PER_M / PULL_M_PER_S, rel=0.02
    )


def test_spring_force_peaks_at_stiction(stick_slip):
    starts, ends = slips_of(stick_slip)
    spring = stick_slip["applied_force_n"]
    for start, end in zip(starts, ends, strict=False):
        assert spring[start : end + 1].max() == pytest.approx(F_S, rel=0.02)
    assert stick_slip["joint_force_n"].max() <= F_S


def test_period_of_stick_slip_is_that_of_dry_friction(stick_slip):
    """With rigid contact: slip from F_s under F_c + sigma_2 v until v = 0, then wait for F_s."""

    def stops(_t, y):
        return y[1]

    stops.terminal, stops.direction = True, -1
    slip = solve_ivp(
        lambda _t, y: [PULL_N_PER_M * (PULL_M_PER_S - y[1]), y[0] - F_C - SIGMA_2 * y[1]],
        (0.0, 10.0),
        [F_S, 1e-12],
        events=stops,
        rtol=1e-9,
    )
    sticking_s = (F_S - slip.y[0, -1]) / (PULL_N_PER_M * PULL_M_PER_S)
    starts, _ = slips_of(stick_slip)
    periods = np.diff(stick_slip["t_s"][starts])
    assert periods == pytest.approx(slip.t[-1] + sticking_s, rel=0.03)
    assert np.ptp(periods) < 0.03  # it repeats itself, to the rows of the trace


# Varying breakaway force: the force is ramped at different rates.

RATES_N_PER_S = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)


def breakaway_friction(friction, velocity):
    """The largest friction before the mass is off, ten times faster than v_s."""
    off = np.flatnonzero(velocity > 10 * V_S)[0]
    return friction[:off].max()


@pytest.mark.slow
def test_breakaway_force_falls_with_the_force_rate(joint, plant):
    period_s, found = 1e-4, []
    for rate in RATES_N_PER_S:
        duration_s = round(3.0 / rate / period_s) * period_s
        # Integral control on an error of 1e9 m, constant to 1e-9: a force ramp.
        run = extract(
            joint,
            bk.StepReference(distance_m=1e9),
            ki=rate / 1e9,
            duration_s=duration_s,
            period_s=period_s,
            every_samples=1,
        )
        trace = run.trace
        np.testing.assert_allclose(
            trace["applied_force_n"][:-1], rate * (trace["t_s"][:-1] + period_s), rtol=1e-8
        )
        times = np.linspace(0.0, duration_s, 20_001)
        states = plant.move(
            lambda t, _y, rate=rate: rate * t, lambda _t, _y: (), np.zeros(3), times, atol=1e-14
        )
        friction = np.array([plant.force(*state) for state in states.T])
        expected = breakaway_friction(friction, states[1])
        found.append(breakaway_friction(trace["joint_force_n"], trace["velocity_m_per_s"]))
        assert found[-1] == pytest.approx(expected, rel=1e-3)
    assert np.all(np.diff(found) < -0.01)
    assert 1.4 < found[0] < F_S  # near stiction at 1 N/s ...
    assert F_C < found[-1] < 1.02  # ... and near Coulomb friction at 50 N/s


# Frictional lag: friction follows a velocity that varies but keeps its sign.


def lag_loop(joint, plant, frequency_rad_per_s):
    """The last of several cycles: velocity, and friction as we and as SciPy have it."""
    rows = 2000
    period_s = 2 * np.pi / frequency_rad_per_s
    cycles = 2 + int(np.ceil(0.2 / period_s))  # bristles settle within 0.1 s
    t_s = (np.arange(cycles * rows) + 0.5) * (period_s / rows)

    def velocity(t):
        return 1.5e-3 - 1.2e-3 * np.cos(frequency_rad_per_s * t)

    motion = bk.impose_motion(joint, velocity(t_s), period_s=period_s / rows)
    expected = plant.impose(velocity, t_s)
    return velocity(t_s)[-rows:], motion.joint_force_n[-rows:], expected[-rows:]


def test_friction_lags_velocity_and_more_so_when_faster(joint, plant):
    widths, areas = [], []
    for frequency in (1.0, 10.0, 25.0):
        velocity, friction, expected = lag_loop(joint, plant, frequency)
        np.testing.assert_allclose(friction, expected, rtol=0, atol=1e-6)
        half = velocity.size // 2
        accelerating, decelerating = friction[:half], friction[half:][::-1]
        assert velocity[:half] == pytest.approx(velocity[half:][::-1], rel=1e-9)
        assert np.all(accelerating >= decelerating)
        widths.append((accelerating - decelerating).max())
        areas.append(np.trapezoid(np.r_[friction, friction[0]], np.r_[velocity, velocity[0]]))
        if frequency == 1.0:  # nearly the static curve g(v) + sigma_2 v
            static = np.array([plant.level(0.0, v) + SIGMA_2 * v for v in velocity])
            np.testing.assert_allclose(friction, static, rtol=0, atol=0.01)
    assert widths == pytest.approx([0.0129, 0.1009, 0.1488], rel=0.01)  # N, of the steady 0.4
    assert areas[2] > 1.5 * areas[1] > 1.5 * 5 * areas[0] > 0


# Presliding: much slower than v_s the bristle obeys dF/dx = sigma_0 (1 - sgn(v) F / F_s).


# Under a force that rises at every sample the midpoint rule predicts the midpoint velocity from
# a joint force that is one sample old, and so overrates presliding creep by T_s**2 sigma_0 / 2 m:
# 5 % at 1 ms.
PRESLIDING_PERIOD_S = 2.5e-4


def travel(force_from, force_to):
    """Dahl's travel between two forces in a quasi-static motion, in m, by separation."""
    sign = 1.0 if force_to > force_from else -1.0
    ratio = (1.0 - sign * force_from / F_S) / (1.0 - sign * force_to / F_S)
    return sign * F_S / SIGMA_0 * log(ratio)


def dahl(force, moved):
    """The force after a motion from a state of given force: the inverse of `travel`."""
    sign = np.sign(moved)
    return sign * F_S + (force - sign * F_S) * np.exp(-np.abs(moved) * SIGMA_0 / F_S)


def test_presliding_loops_close_under_cyclic_motion(joint):
    amplitude, steps, period_s = 1e-5, 2000, 1e-2  # 0.5 um/s, 1/2000 of v_s
    quarter = np.full(steps // 2, amplitude / (steps // 2) / period_s)
    half = np.repeat(quarter, 2)
    velocities = np.concatenate([quarter, *[-half, half] * 4])
    motion = bk.impose_motion(joint, velocities, period_s=period_s)
    force = SIGMA_0 * motion.bristle_m
    turns = steps // 2 - 1 + steps * np.arange(9)
    tops, bottoms = force[turns[::2]], force[turns[1::2]]
    expected, turning_forces = 0.0, []
    for moved in [amplitude, *[-2 * amplitude, 2 * amplitude] * 4]:
        expected = dahl(expected, moved)
        turning_forces.append(expected)
    assert force[turns] == pytest.approx(turning_forces, rel=1e-3)
    assert np.abs(force).max() < F_S  # presliding throughout
    # The loop closes once the first loading is forgotten, and loses energy.
    assert tops[-1] == pytest.approx(tops[-2], rel=2e-3)
    assert bottoms[-1] == pytest.approx(-tops[-1], rel=2e-3)
    last = slice(turns[-3] + 1, turns[-1] + 1)
    lost_j = np.sum(motion.joint_force_n[last] * velocities[last]) * period_s
    top = tops[-1]
    loop = 2 * (2 * amplitude * F_S - F_S / SIGMA_0 * 2 * top)  # twice the integral of F dx
    assert lost_j == pytest.approx(loop, rel=0.01)


def test_presliding_loop_closes_under_cyclic_force(joint):
    """Force up to 0.95 F_s, down to -0.95 F_s and up again: the published figure.

    Derivative control on a triangular reference velocity raises and lowers the force, a
    negative proportional gain takes it below zero, and integral control raises it again.
    """
    peak, turn_s, rise_s = 0.95 * F_S, 20.0, 200.0
    distance, rate = 1e6, 1e6 / (turn_s / 2)
    # Up: peak = A - B / 2 + C / 12, then down to -peak = -B + C / 2, then a rise of 2 peak.
    c = 2 * peak * turn_s / rise_s
    b = peak + c / 2
    a = peak + b / 2 - c / 12
    trace = extract(
        joint,
        bk.TrapezoidalVelocity(
            distance_m=distance,
            velocity_m_per_s=rate,
            acceleration_m_per_s2=rate / (turn_s / 2),
        ),
        kp=-b / distance,
        ki=c / distance / turn_s,
        kd=a / rate,
        duration_s=turn_s + rise_s,
        period_s=PRESLIDING_PERIOD_S,
        every_samples=40,
    ).trace
    force, position = trace["applied_force_n"], trace["position_m"]
    up, down = np.argmax(force[: force.size // 4]), np.argmin(force)
    assert force[[up, down, -1]] == pytest.approx([peak, -peak, peak], rel=1e-3)
    first, back, again = position[up], position[down] - position[up], position[-1] - position[down]
    # The last 5 % of a rise take most of the travel, at up to a tenth of v_s.
    assert first == pytest.approx(travel(0.0, peak), rel=0.02)
    assert back == pytest.approx(travel(peak, -peak), rel=0.02)
    assert again == pytest.approx(travel(-peak, peak), rel=0.02)
    assert abs(back + again) < 0.02 * again  # closed: the travel back is made again


def test_one_sided_force_cycles_creep(joint):
    """LuGre's known fault, which flatters vibration: it drifts below stiction."""
    peak, turn_s, distance = 0.8 * F_S, 20.0, 1e6
    rate = distance / (turn_s / 2)
    trace = extract(
        joint,
        bk.TrapezoidalVelocity(
            distance_m=distance,
            velocity_m_per_s=rate,
            acceleration_m_per_s2=rate / (turn_s / 2),
        ),
        kd=peak / rate,
        duration_s=turn_s,
        period_s=PRESLIDING_PERIOD_S,
        every_samples=40,
    ).trace
    assert trace["applied_force_n"].max() == pytest.approx(peak, rel=1e-3)
    assert abs(trace["applied_force_n"][-1]) < 1e-3
    drift = travel(0.0, peak) + travel(peak, 0.0)
    assert drift == pytest.approx(-F_S / SIGMA_0 * log(1 - 0.8**2))
    assert trace["position_m"][-1] == pytest.approx(drift, rel=0.01)
