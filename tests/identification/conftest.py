"""Rigs with known friction, simulated by a plain Runge-Kutta loop that shares nothing with ours."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from breakaway.measure.identification import Identification, identify
from breakaway.measure.logs import Log

Array = npt.NDArray[np.float64]
Truth = Mapping[str, float]


class Rig:
    """A rig, its friction, and the logs that it gives.

    ``truth`` names parameters as `breakaway.identify` does; what it leaves out is equal in both
    directions, or absent.
    """

    def __init__(self, **truth: float) -> None:
        self.truth = truth

    def friction(self, x: float, v: float, z: float) -> tuple[float, float]:
        """Return the friction force and dz/dt."""
        one, side = self.truth, "positive" if v >= 0.0 else "negative"
        coulomb = one.get("coulomb_n", one.get(f"coulomb_{side}_n", 0.0))
        viscous = one.get("viscous_n_s_per_m", one.get(f"viscous_{side}_n_s_per_m", 0.0))
        peak = one.get("stiction_ratio", 1.0) - 1.0
        decay = math.exp(-((v / one.get("stribeck_velocity_m_per_s", 1.0)) ** 2))
        level = (coulomb + one.get("coulomb_slope_n_per_m", 0.0) * x) * (1.0 + peak * decay)
        if "stiffness_n_per_m" not in one:
            return math.copysign(level, v) + viscous * v, 0.0
        stiffness = one["stiffness_n_per_m"]
        slip = 1.0
        if "elastic_share" in one:
            share = one["elastic_share"]
            s = min(max((abs(z) * stiffness / level - share) / (1.0 - share), 0.0), 1.0)
            slip = s * s * (3.0 - 2.0 * s) if z * v > 0.0 else 0.0
        rate = v - slip * stiffness * abs(v) * z / level
        return stiffness * z + one["damping_n_s_per_m"] * rate + viscous * v, rate

    def moved(self, rows: int, rate_hz: float, **noise: float) -> Log:
        """Give a log of a motion that is imposed, its force read by a load cell."""
        t_s = np.arange(rows) / rate_hz
        h = 1.0 / rate_hz / 8
        mass, z, force = self.truth.get("mass_kg", 0.0), 0.0, []

        def rate(t: float, z: float) -> float:
            x, v, _ = _motion(t)
            return self.friction(x, v, z)[1]

        for row in t_s:
            x, v, a = _motion(row)
            force.append(mass * a + self.friction(x, v, z)[0] + self._rig(x))
            for step in range(8):
                t = row + step * h
                k1 = rate(t, z)
                k2 = rate(t + h / 2, z + h / 2 * k1)
                k3 = rate(t + h / 2, z + h / 2 * k2)
                z += h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + h, z + h * k3))
        return _noisy(t_s, np.array([_motion(t)[0] for t in t_s]), np.array(force), **noise)

    def driven(
        self, rows: int, rate_hz: float, force_of: Callable[[int, float], float], **noise: float
    ) -> Log:
        """Give a log of a part that a force moves from rest, held from row to row.

        The force is one of row and position; at row 0 it is asked for twice.
        """
        t_s, h, mass = np.arange(rows) / rate_hz, 1.0 / rate_hz / 8, self.truth["mass_kg"]

        def rate(state: Array, force: float) -> Array:
            x, v, z = state.tolist()
            friction, slip = self.friction(x, v, z)
            return np.array([v, (force - friction - self._rig(x)) / mass, slip])

        held = force_of(0, 0.0) - self.truth.get("offset_n", 0.0)
        state, position, forces = (
            np.array([0.0, 0.0, held / self.truth["stiffness_n_per_m"]]),
            [],
            [],
        )
        for row in range(rows):
            force = force_of(row, float(state[0]))
            position.append(state[0])
            forces.append(force)
            for _ in range(8):
                k1 = rate(state, force)
                k2 = rate(state + h / 2 * k1, force)
                k3 = rate(state + h / 2 * k2, force)
                state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(state + h * k3, force))
        return _noisy(t_s, np.array(position), np.array(forces), reference(t_s), **noise)

    def _rig(self, x: float) -> float:
        return self.truth.get("offset_n", 0.0) + self.truth.get("spring_n_per_m", 0.0) * x


def _motion(t: float) -> tuple[float, float, float]:
    """Return position, velocity and acceleration: slow and fast, with many reversals."""
    a, b, c = 6.0, 17.0, 1.0
    return (
        0.01 * math.sin(a * t) + 0.004 * math.sin(b * t + c),
        0.06 * math.cos(a * t) + 0.068 * math.cos(b * t + c),
        -0.36 * math.sin(a * t) - 1.156 * math.sin(b * t + c),
    )


def reference(t_s: Array) -> Array:
    """Return the reference of a closed loop, from rest at 0."""
    return 0.015 * (1 - np.cos(5 * t_s)) + 0.004 * (1 - np.cos(17 * t_s))


def _noisy(
    t_s: Array,
    x: Array,
    force: Array,
    reference_m: Array | None = None,
    *,
    force_noise_n: float = 0.0,
    position_noise_m: float = 0.0,
    seed: int = 0,
) -> Log:
    rng = np.random.default_rng(seed)
    return Log(
        t_s=t_s,
        position_m=x + position_noise_m * rng.standard_normal(len(x)),
        force_n=force + force_noise_n * rng.standard_normal(len(x)),
        reference_m=reference_m,
    )


LUGRE = {
    "coulomb_n": 20.0,
    "viscous_n_s_per_m": 60.0,
    "stiction_ratio": 1.5,
    "stribeck_velocity_m_per_s": 0.01,
    "stiffness_n_per_m": 5e4,
    "damping_n_s_per_m": 150.0,
    "offset_n": 1.5,
}
SIDES = {
    "coulomb_positive_n": 20.0,
    "coulomb_negative_n": 26.0,
    "viscous_positive_n_s_per_m": 60.0,
    "viscous_negative_n_s_per_m": 90.0,
}


def asymmetric(truth: Truth) -> dict[str, float]:
    """Return a truth with sides of its own and no offset."""
    both = ("coulomb_n", "viscous_n_s_per_m", "offset_n")
    return {name: value for name, value in truth.items() if name not in both} | SIDES


@pytest.fixture(scope="session")
def rig() -> type[Rig]:
    """Give the rig."""
    return Rig


@pytest.fixture(scope="session")
def lugre() -> dict[str, float]:
    """Give the truth that most tests share."""
    return dict(LUGRE)


@pytest.fixture(scope="session")
def sided() -> Callable[[Truth], dict[str, float]]:
    """Give what makes a truth differ between the directions."""
    return asymmetric


@pytest.fixture(scope="session")
def rich() -> Log:
    """Give a log with load-cell noise that tells every parameter of a LuGre joint."""
    return Rig(**LUGRE).moved(1500, 1000.0, force_noise_n=0.1)


@pytest.fixture(scope="session")
def rich_fit(rich: Log) -> Identification:
    """Give what that log tells where one clock stamps position and force."""
    return identify(rich, fixed={"delay_s": 0.0}, starts=4)


@pytest.fixture(scope="session")
def pushed() -> Log:
    """Give a log of a part of 3 kg that a known force moves."""
    truth = LUGRE | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    return Rig(**truth).driven(1200, 1000.0, push, position_noise_m=5e-6)


def push(row: int, _: float) -> float:
    """Return a force that moves a part to and fro, and lets it rest."""
    return 36.0 * math.sin(0.012 * row) + 20.0 * math.sin(0.004 * row)


def cascade(rate_hz: float) -> Callable[[int, float], float]:
    """Return a cascade of gains 60 /s and 400 N s/m, limited to 100 N."""
    past = [0.0, 0.0]
    target = reference(np.arange(10_000) / rate_hz)

    def force(row: int, x: float) -> float:
        speed = (x - past[0]) * rate_hz / 2
        past[:] = [past[1], x]
        return min(max(400.0 * (60.0 * (float(target[row]) - x) - speed), -100.0), 100.0)

    return force


def pid(rate_hz: float) -> Callable[[int, float], float]:
    """Return a PID of 2e4 N/m, 1e5 N/(m s) and 300 N s/m on differences, limited to 100 N."""
    memory = [0.0, 0.0]
    target = reference(np.arange(10_000) / rate_hz)

    def force(row: int, x: float) -> float:
        error = float(target[row]) - x
        memory[0] += 1e5 * error / rate_hz
        speed = (x - memory[1]) * rate_hz
        memory[1] = x
        rate = float(target[row + 1] - target[max(row - 1, 0)]) * rate_hz / (2 if row else 1)
        return min(max(2e4 * error + memory[0] + 300.0 * (rate - speed), -100.0), 100.0)

    return force


@pytest.fixture(scope="session")
def drives() -> dict[str, Callable[[float], Any]]:
    """Give the controllers of the closed loops."""
    return {"cascade": cascade, "pid": pid, "push": lambda _: push}


@pytest.fixture(scope="session")
def looped() -> Log:
    """Give a log of a part of 3 kg that a cascade moves."""
    truth = LUGRE | {"mass_kg": 3.0, "damping_n_s_per_m": 300.0}
    return Rig(**truth).driven(1200, 1000.0, cascade(1000.0), force_noise_n=0.1)
