"""The derivatives that a fit goes by are those of what it makes small."""

from typing import Any

import numpy as np
import pytest

from breakaway.measure.identification import LAWS, Cascade, identify
from breakaway.measure.logs import Log
from breakaway.model.scenario import Pid
from breakaway.model.scenario.controller import Gains

CASCADE = Cascade(position_gain_per_s=60.0, velocity_gain_n_s_per_m=400.0, force_limit_n=100.0)
PID = Pid(gains=Gains(kp_n_per_m=2e4, ki_n_per_m_s=1e5, kd_n_s_per_m=300.0))
MOTIONS: list[dict[str, Any]] = [
    {"motion": "imposed", "fixed": {"mass_kg": 2.0}},
    {"motion": "free"},
    {"motion": "closed_loop", "controller": CASCADE},
    {"motion": "closed_loop", "controller": PID, "force_limit_n": 100.0},
]


SMALL = {
    "offset_n": 1.5,
    "elastic_share": 0.6,
    "coulomb_slope_n_per_m": 40.0,
    "spring_n_per_m": 30.0,
    "mass_kg": 3.0,
}


@pytest.mark.slow
@pytest.mark.parametrize("options", [{}, {"asymmetric": True, "position_dependent": True}])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("settings", MOTIONS, ids=["imposed", "free", "cascade", "pid"])
def test_slopes_are_central_differences(
    looped: Log,
    lugre: dict[str, float],
    sided: Any,
    settings: dict[str, Any],
    law: str,
    options: dict[str, Any],
) -> None:
    wanted = {"lugre": 2, "elasto_plastic": 3}.get(law, 0)
    free = ("stiction_ratio", "damping_n_s_per_m", "elastic_share")[:wanted]
    log = looped.between(0.3, 0.9)
    problem = identify(log, law=law, starts=1, free=free, **settings, **options).internals.problem
    truth = lugre | sided(lugre) | SMALL
    at = np.array([one.internal(1.02 * truth[one.name]) for one in problem.layout.free])
    slopes = problem.residual_and_slopes(at)[1]
    for place in range(len(at)):
        step = np.zeros_like(at)
        step[place] = 1e-6 * max(1.0, abs(at[place]))
        rise = problem.residual(at + step) - problem.residual(at - step)
        central = rise / (2.0 * step[place])
        error = np.linalg.norm(central - slopes[:, place])
        assert error < 1e-5 * np.linalg.norm(central), problem.layout.free[place].name


def test_lanes_give_the_sums_of_the_residuals(rich: Log) -> None:
    found = identify(rich, starts=1)
    problem, best = found.internals.problem, found.internals.best
    many = best + 0.1 * np.random.default_rng(0).standard_normal((9, len(best)))
    one_by_one = [problem.residual(at) @ problem.residual(at) for at in many]
    np.testing.assert_allclose(problem.sums_of_squares(many, threads=2), one_by_one, rtol=1e-9)
    np.testing.assert_array_equal(
        problem.sums_of_squares(many, threads=1), problem.sums_of_squares(many, threads=2)
    )
