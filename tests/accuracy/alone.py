"""One case by itself: each metric at each number of steps, and its scenario."""

from __future__ import annotations

from math import nan
from pathlib import Path

from tests.accuracy.figures import COUNTS, errors_of, floors_of
from tests.accuracy.independent import is_known, solve
from tests.accuracy.scenarios import Case
from tests.accuracy.steps import FINER, affordable, steps_of
from tests.accuracy.verdict import figures_at, judge

from breakaway.model.scenario.files import scenario_toml

LEVELS = (1, 2, 5, 10, 25, FINER, 2 * FINER)
"""Steps over those of the default."""


def show_alone(case: Case, solver: Path | None) -> None:
    """Print a case: its scenario, its metrics at all levels, and what becomes of it."""
    scenario, floors = case.scenario, floors_of(case.scenario)
    print(scenario_toml(scenario))
    steps = steps_of(scenario)
    levels = sorted({affordable(scenario, steps * level) for level in LEVELS})
    found = [figures_at(scenario, level) for level in levels]
    heads = [str(level) for level in levels]
    solution = solve(solver, scenario) if solver and is_known(scenario) else None
    if solution:
        found.append({**dict.fromkeys(found[-1], nan), **solution})
        heads.append("solver")
    print(f"{case.kind}; steps in a control period, and the error of the first against the finest")
    print(f"{'':26}" + "".join(f"{head:>14}" for head in heads))
    errors = errors_of(found[0], found[len(levels) - 1], floors)
    for name, error in errors.items():
        off = f"{error:g}" if name in COUNTS else f"{100 * error:.3g} %"
        print(f"{name:26}" + "".join(f"{run[name]:>14.7g}" for run in found) + f"{off:>12}")
    verdict = judge(case, solver)
    print(f"{verdict.state}; largest error {100 * verdict.worst:.3g} %")
