"""Every friction law against its equations, written out here and solved by SciPy with events.

A controller pulls the part out by a millimeter and stops it there, through presliding, breakaway,
sliding and a stop with reversals. SciPy gets the forces of that run, so that what differs is the
step.
"""

from math import exp

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import breakaway as bk

pytestmark = pytest.mark.slow

MASS_KG = 1.0
PERIOD_S = 2e-5
LEVELS = {
    "stiction_n": 450.0,
    "coulomb_n": 360.0,
    "engagement_length_m": 0.1,
    "residual_n": 9.81,
    "stribeck_velocity_m_per_s": 0.09,
    "viscous_n_s_per_m": 60.0,
    "backward_ratio": 0.8,
}
BRISTLE = {
    "stiffness_n_per_m": 3.6e7,
    "damping_n_s_per_m": 9000.0,
    "damping_velocity_m_per_s": 0.2,
}
JOINTS = {
    "lugre": bk.Lugre(**LEVELS, **BRISTLE),
    "elasto_plastic": bk.ElastoPlastic(**LEVELS, **BRISTLE, elastic_share=0.7),
    "gms": bk.Gms(**LEVELS, **BRISTLE, elements=5, attraction_n_per_s=1e6),
    "coulomb_stiction": bk.CoulombStiction(**LEVELS),
}


def level(joint, x, v):
    """g(v, x) of the direction of v."""
    left = 1.0 - x / joint.engagement_length_m
    f_s = joint.residual_n + (joint.stiction_n - joint.residual_n) * left
    f_c = joint.residual_n + (joint.coulomb_n - joint.residual_n) * left
    g = f_c + (f_s - f_c) * exp(-((v / joint.stribeck_velocity_m_per_s) ** 2))
    return g * (joint.backward_ratio if v < 0.0 else 1.0)


def damping(joint, v):
    return joint.damping_n_s_per_m * exp(-((v / joint.damping_velocity_m_per_s) ** 2))


def onset(joint, z, v, g):
    """1 for LuGre; the smooth step of the elasto-plastic law."""
    if isinstance(joint, bk.Lugre):
        return 1.0
    if z * v <= 0.0:
        return 0.0
    share = joint.elastic_share
    s = min(max((abs(z) * joint.stiffness_n_per_m / g - share) / (1.0 - share), 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s)


def one_bristle(joint, forces):
    """x and v at every sample, for LuGre and elasto-plastic friction."""
    k_e = joint.stiffness_n_per_m

    def rates(force):
        def of(_t, y):
            x, v, z = y
            g = level(joint, x, v)
            z_rate = v - onset(joint, z, v, g) * k_e * abs(v) / g * z
            friction = k_e * z + damping(joint, v) * z_rate + joint.viscous_n_s_per_m * v
            return [v, (force - friction) / MASS_KG, z_rate]

        return of

    rows = [np.zeros(3)]
    for force in forces:
        options = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-14}
        rows.append(solve_ivp(rates(force), (0.0, PERIOD_S), rows[-1], **options).y[:, -1])
    return np.array(rows)[:, :2]


def elements(joint, forces):
    """x and v at every sample for Maxwell-slip; events: an element lets go, or the motion turns."""
    kappa, nu = (np.array(shares[: joint.elements]) for shares in joint.all_shares())
    k = kappa * joint.stiffness_n_per_m
    n, attraction = joint.elements, joint.attraction_n_per_s

    def rates(force, slips):
        def of(_t, y):
            x, v, z = y[0], y[1], y[2:]
            g = level(joint, x, v)
            pulled = attraction * (nu * slips - k * z / g) / k
            z_rate = np.where(slips == 0.0, v, slips * np.minimum(slips * pulled, slips * v))
            friction = k @ z + damping(joint, v) * (kappa @ z_rate) + joint.viscous_n_s_per_m * v
            return np.r_[v, (force - friction) / MASS_KG, z_rate]

        return of

    def lets_go(i):
        def at(_t, y):
            return nu[i] * level(joint, y[0], y[1]) - k[i] * abs(y[2 + i])

        at.terminal, at.direction = True, -1
        return at

    def turns(_t, y):
        return y[1]

    turns.terminal = True
    y, slips, rows = np.zeros(2 + n), np.zeros(n), [np.zeros(2 + n)]
    options = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-14}
    for force in forces:
        t = 0.0
        while t < PERIOD_S and (force != 0.0 or y.any()):  # nothing happens before the first push
            stuck = np.flatnonzero(slips == 0.0)
            # A motion that has just turned does not turn again where it is.
            turns.direction = -np.sign(y[1] or rates(force, slips)(t, y)[1])
            watched = [turns, *map(lets_go, stuck)]
            of = rates(force, slips)
            solution = solve_ivp(of, (t, PERIOD_S), y, events=watched, **options)
            t, y = solution.t[-1], solution.y[:, -1]
            if solution.status == 1:
                turned, *loose = (len(found) > 0 for found in solution.t_events)
                slips = slips.copy()
                slips[stuck[loose]] = np.sign(y[1])
                if turned:
                    slips[:], y[1] = 0.0, turns.direction * 1e-300
        rows.append(y)
    return np.array(rows)[:, :2]


def rigid(joint, forces):
    """x and v at every sample for rigid friction; events: a stop."""
    y, stuck, rows = np.zeros(2), True, [np.zeros(2)]
    for force in forces:
        t = 0.0
        while t < PERIOD_S:
            direction = np.sign(force) if y[1] == 0.0 else np.sign(y[1])
            if stuck and abs(force) <= level(joint, y[0], 0.0 if force > 0 else -1e-300):
                break

            def rates(_t, y, direction=direction, force=force):
                g = level(joint, y[0], direction * abs(y[1]) or direction * 1e-300)
                friction = direction * g + joint.viscous_n_s_per_m * y[1]
                return [y[1], (force - friction) / MASS_KG]

            def stops(_t, y):
                return y[1]

            stops.terminal, stops.direction = True, -direction
            options = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-14}
            solution = solve_ivp(rates, (t, PERIOD_S), y, events=stops, **options)
            t, y = solution.t[-1], solution.y[:, -1]
            stuck = solution.status == 1
            if stuck:
                y[1] = 0.0
        rows.append(y)
    return np.array(rows)


SOLVERS = {
    "lugre": one_bristle,
    "elasto_plastic": one_bristle,
    "gms": elements,
    "coulomb_stiction": rigid,
}
"""How each law is solved."""
LARGEST = {
    "lugre": 6e-5,
    "elasto_plastic": 1e-4,
    "gms": 3e-4,
    "coulomb_stiction": 6e-6,
}
"""Largest error of x with steps of 10 us, as a share of the travel.

Found: 4.6e-5, 7.4e-5, 2.1e-4 and 3.7e-6; steps of 2.5 us divide all of them by 17 to 21.
"""


def pulled(joint, steps):
    """Our run of the law."""
    return bk.simulate(
        bk.resolve(bk.load_scenario("paper_as_computed")).with_(
            {
                "reference.distance_m": 1e-3,
                "reference.duration_s": 3e-3,
                "controller.gains.kd_n_s_per_m": 2500.0,
                "timing.duration_s": 5e-3,
                "timing.control_period_s": PERIOD_S,
                "timing.steps_per_period": steps,
                "trace.every_samples": 1,
            },
            joint=joint,
        )
    )


@pytest.mark.parametrize("law", JOINTS)
def test_law_agrees_with_an_independent_solution(law):
    joint = JOINTS[law]
    errors = []
    for steps in (2, 8):
        trace = pulled(joint, steps).trace
        expected = SOLVERS[law](joint, trace["applied_force_n"][:-1])
        errors.append(np.abs(trace["position_m"] - expected[:, 0]).max() / 1e-3)
    assert trace["position_m"].max() > 0.9e-3  # pulled out
    slowest = trace["velocity_m_per_s"].min()  # what has a bristle swings back, what has none stays
    assert slowest == 0.0 if law == "coulomb_stiction" else slowest < -1e-3
    assert errors[0] < LARGEST[law] and errors[0] > 12.0 * errors[1], errors
