"""How far from instability one step in a control period is: IAE error for joints that are stiffer.

python -m bench.peers.edge
"""

from __future__ import annotations

import breakaway as bk

from .equations import RULES
from .loop import ORACLE_STEPS, Loop, numbers, scenario
from .numba_ import scalar

DURATION_S = 0.5
STIFFER = (1.0, 1.5, 2.0, 4.0)


def oracle_iae_m_s(stiffness_n_per_m: float) -> float:
    """IAE of run 0 with the gains of the joint as it is."""
    designed = bk.resolve(scenario(DURATION_S))
    changes = {
        "joint.stiffness_n_per_m": stiffness_n_per_m,
        "timing.integrator": "rk4",
        "timing.steps_per_period": 2 * ORACLE_STEPS,
    }
    return bk.simulate(designed.with_(changes)).metrics.iae_m_s


def main() -> None:
    """One line for each stiffness."""
    print(f"{'stiffness':10s}" + "".join(f"{name:>38s}" for name in RULES.values()))
    p = numbers()
    for times in STIFFER:
        stiffer = p._replace(stiffness_n_per_m=times * p.stiffness_n_per_m)
        known = oracle_iae_m_s(stiffer.stiffness_n_per_m)
        loop = Loop(stiffer, (0,), DURATION_S)
        errors = [scalar(rule, loop, 1)()[0] / known - 1.0 for rule in RULES]
        print(f"{times:<10g}" + "".join(f"{error:38.1e}" for error in errors))


if __name__ == "__main__":
    main()
