"""One case by itself: each metric at each number of steps, and its scenario."""

from __future__ import annotations

from tests.accuracy.figures import COUNTS, errors_of, floors_of
from tests.accuracy.scenarios import Case
from tests.accuracy.steps import FINER, affordable, steps_of
from tests.accuracy.verdict import figures_at, judge

from breakaway.model.scenario.files import scenario_toml

LEVELS = (1, 2, 5, 10, 25, FINER, 2 * FINER)
"""Steps over those of the default."""


def show_alone(case: Case) -> None:
    """Print a case: its scenario, its metrics at all levels, and what becomes of it."""
    scenario, floors = case.scenario, floors_of(case.scenario)
    print(scenario_toml(scenario))
    steps = steps_of(scenario)
    levels = sorted({affordable(scenario, steps * level) for level in LEVELS})
    found = [figures_at(scenario, level) for level in levels]
    print(f"{case.kind}; steps in a control period, and the error of the first against the last")
    print(f"{'':26}" + "".join(f"{level:>14}" for level in levels))
    errors = errors_of(found[0], found[-1], floors)
    for name, error in errors.items():
        off = f"{error:g}" if name in COUNTS else f"{100 * error:.3g} %"
        print(f"{name:26}" + "".join(f"{run[name]:>14.7g}" for run in found) + f"{off:>12}")
    verdict = judge(case)
    print(f"{verdict.state}; largest error {100 * verdict.worst:.3g} %")
