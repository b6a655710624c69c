"""The measurement before the pull: how a joint yields, and what that tells."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

import breakaway as bk
from breakaway.ask.advice.measurement import SHAPES, _errors, design_measurement, yielding
from breakaway.ask.advice.outcome import Bounds

K_E, F_S = 3e7, 200.0


@pytest.mark.parametrize("kind", SHAPES)
def test_references_begin_and_end_without_force(kind: str) -> None:
    u = np.linspace(0.0, 1.0, 2001)
    shape = SHAPES[kind](u)
    assert shape[0] == 0.0 and abs(shape[-1]) < 1e-9
    assert shape.min() >= 0.0 and shape.max() == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("kind", SHAPES)
def test_a_slow_force_moves_the_joint_as_the_law_itself_says(kind: str) -> None:
    """The core's LuGre, its motion imposed as it was computed, gives the force back."""
    u = np.linspace(0.0, 1.0, 4001)
    force_n = 150.0 * SHAPES[kind](u)
    (x_m,) = yielding(force_n, np.array([K_E]), np.array([F_S]))
    joint = bk.Lugre(
        stiction_n=F_S,
        coulomb_n=F_S,
        stribeck_velocity_m_per_s=0.05,
        stiffness_n_per_m=K_E,
        damping_n_s_per_m=0.0,
        viscous_n_s_per_m=0.0,
        engagement_length_m=1e9,
        residual_n=F_S,
    )
    period_s = 0.25
    found = bk.impose_motion(joint, np.diff(x_m) / period_s, period_s=period_s)
    at_mid_step = 0.5 * (force_n[1:] + force_n[:-1])
    np.testing.assert_allclose(found.joint_force_n, at_mid_step, atol=0.05)


def test_errors_are_those_of_many_fits() -> None:
    """Fits of noisy measurements scatter as the bound says, within what 200 fits tell."""
    u = np.linspace(0.0, 1.0, 401)
    force_n, noise_m = 100.0 * SHAPES["ten pulses"](u), 2e-7
    (x_m,) = yielding(force_n, np.array([K_E]), np.array([F_S]))
    rng = np.random.default_rng(0)

    def fitted(noisy: np.ndarray) -> float:
        def misfit(logs: np.ndarray) -> np.ndarray:
            k_e, f_s = np.exp(logs)
            return (yielding(force_n, np.array([k_e]), np.array([f_s]))[0] - noisy) / noise_m

        return float(least_squares(misfit, np.log([K_E, F_S])).x[1])

    logs = [fitted(x_m + noise_m * rng.standard_normal(len(x_m))) for _ in range(200)]
    (bound,) = _errors(force_n, np.array([K_E]), np.array([F_S]), noise_m)
    assert np.std(logs) == pytest.approx(bound, rel=0.15)
    assert np.mean(logs) == pytest.approx(np.log(F_S), abs=4.0 * bound / np.sqrt(200))


@pytest.mark.slow
def test_it_stays_below_what_parts_and_limits_bear(advice: bk.Advice) -> None:
    bounds = advice.bounds
    rig = bounds.rig.model_copy(
        update={
            "reads": ("position",),
            "sensors": bk.Sensors(position=bk.PositionSensor(noise_rms_m=1e-7)),
        }
    )
    found = design_measurement(advice.tried, Bounds(bounds.limits, bounds.gentle, rig))
    assert found is not None and bounds.limits is not None
    assert found.force_n.max() == pytest.approx(found.peak_n, rel=1e-2)
    assert found.peak_n <= bounds.limits.force_max_n
    assert np.mean(advice.tried.quantities["stiction_n"] < found.peak_n) <= 0.02 + 1 / 48
    assert found.after == min(found.after, *found.others.values())
    blind = Bounds(bounds.limits, bounds.gentle, rig.model_copy(update={"reads": ("force",)}))
    assert design_measurement(advice.tried, blind) is None
