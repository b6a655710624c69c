"""An independent LuGre plant in SciPy: written from the papers' equations, not from our code."""

from dataclasses import dataclass
from math import exp

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import breakaway as bk


@dataclass(frozen=True)
class ScipyLugre:
    """LuGre friction with contact loss (SYSTEM.md section 1) and a mass, for `solve_ivp`."""

    f_s0: float
    f_c0: float
    f_end: float
    l_f: float
    k_e: float
    c: float
    sigma_2: float
    v_s: float
    m: float = 1.0

    @classmethod
    def of(cls, joint: bk.Lugre, mass_kg: float = 1.0):
        """The same numbers as a joint of ours whose residual force is given."""
        assert joint.residual_n is not None
        return cls(
            f_s0=joint.stiction_n,
            f_c0=joint.coulomb_n,
            f_end=joint.residual_n,
            l_f=joint.engagement_length_m,
            k_e=joint.stiffness_n_per_m,
            c=joint.damping_n_s_per_m,
            sigma_2=joint.viscous_n_s_per_m,
            v_s=joint.stribeck_velocity_m_per_s,
            m=mass_kg,
        )

    def level(self, x, v):
        """g(v, x): equations (3), (5), (6)."""
        left = 1.0 - min(max(x, 0.0), self.l_f) / self.l_f
        f_s = self.f_end + (self.f_s0 - self.f_end) * left
        f_c = self.f_end + (self.f_c0 - self.f_end) * left
        return f_c + (f_s - f_c) * exp(-((v / self.v_s) ** 2))

    def bristle_rate(self, x, v, z):
        """dz/dt: equation (2) with the missing k_e."""
        return v - self.k_e * abs(v) / self.level(x, v) * z

    def force(self, x, v, z):
        """R: equation (1); none beyond the guide."""
        if x >= self.l_f:
            return 0.0
        return self.k_e * z + self.c * self.bristle_rate(x, v, z) + self.sigma_2 * v

    def move(self, force_of, extra_rates, start, times, **tolerances):
        """Integrate x, v, z and the controller's own states under F = force_of(t, y)."""

        def rates(t, y):
            x, v, z = y[0], y[1], y[2]
            acceleration = (force_of(t, y) - self.force(x, v, z)) / self.m
            return [v, acceleration, self.bristle_rate(x, v, z), *extra_rates(t, y)]

        options = {"method": "LSODA", "rtol": 1e-11, "atol": 1e-15} | tolerances
        solution = solve_ivp(rates, (times[0], times[-1]), start, t_eval=times, **options)
        assert solution.success, solution.message
        return solution.y

    def move_held(self, forces, period_s, start=(0.0, 0.0, 0.0)):
        """x, v, z at every sample under held forces: integrated anew for each sample."""
        rows = [np.asarray(start, dtype=float)]
        for force in forces:
            y = self.move(
                lambda _t, _y, f=force: f,
                lambda _t, _y: (),
                rows[-1],
                (0.0, period_s),
                method="DOP853",
                rtol=1e-13,
                atol=1e-17,
            )
            rows.append(y[:, -1])
        return np.array(rows).T

    def impose(self, velocity_of, times):
        """R at given times for a motion imposed on a relaxed joint, from x = 0."""

        def rates(t, y):
            v = velocity_of(t)
            return [v, self.bristle_rate(y[0], v, y[1])]

        solution = solve_ivp(
            rates,
            (0.0, times[-1]),
            [0.0, 0.0],
            t_eval=times,
            method="LSODA",
            rtol=1e-10,
            atol=1e-16,
        )
        assert solution.success, solution.message
        pairs = zip(times, *solution.y, strict=True)
        return np.array([self.force(x, velocity_of(t), z) for t, x, z in pairs])


@pytest.fixture(scope="session")
def scipy_lugre():
    """The class; a fixture because test folders are no packages."""
    return ScipyLugre
