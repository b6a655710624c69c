"""What becomes of one case: its errors at the default steps against a converged reference."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from tests.accuracy.chaos import is_chaotic, unlike
from tests.accuracy.figures import Figures, errors_of, figures_of, floors_of, worst_of
from tests.accuracy.independent import is_known, solve
from tests.accuracy.scenarios import Case
from tests.accuracy.steps import FINER, FIRST_STEPS_MAX, affordable, at_steps, steps_of

import breakaway as bk

CONVERGED = 3e-3
"""Largest error of a reference against one of half its steps."""
CLOSE = 1e-2
"""Error that a metric may have at the default steps."""
DOUBLINGS = 3
"""How often a reference that is not converged is made finer."""


class State(StrEnum):
    """What a reference is worth."""

    CONVERGED = "converged"
    """Twice its steps change nothing."""
    CHAOTIC = "chaotic"
    """It depends on a start that nobody knows: only distributions can be compared."""
    UNRESOLVED = "unresolved"
    """It still changes at the most steps that are affordable, and is not chaotic."""


@dataclass
class Verdict:
    """What was found of a case."""

    number: int
    kind: str
    state: State
    steps: int
    reference_steps: int
    samples: int
    errors: dict[str, float]
    """By metric; of a chaotic case none."""
    unlike: dict[str, float] = field(default_factory=dict)
    """Of a chaotic case: metrics whose distributions differ, each with how far."""
    solved: dict[str, float] = field(default_factory=dict)
    """Errors against the independent solver, of the metrics that it knows."""
    limit: dict[str, float] = field(default_factory=dict)
    """Errors of the reference against the independent solver."""
    default_wall_s: float = 0.0
    wall_s: float = 0.0

    @property
    def worst(self) -> float:
        return max(map(worst_of, filter(None, (self.errors, self.solved))), default=0.0)


def figures_at(scenario: bk.Scenario, steps: int) -> Figures:
    return figures_of(bk.simulate(at_steps(scenario, steps)))


def judge(case: Case, solver: Path | None = None) -> Verdict:
    """Run a case at its default and at finer steps until nothing moves, and solve it if we can."""
    began = time.perf_counter()
    scenario, floors = case.scenario, floors_of(case.scenario)
    steps = steps_of(scenario)
    default = figures_at(scenario, steps)
    default_wall_s = time.perf_counter() - began
    reference, reference_steps, moved = _reference(scenario, steps, floors)
    errors = errors_of(default, reference, floors)
    state = State.CONVERGED if moved <= CONVERGED else State.UNRESOLVED
    differs: dict[str, float] = {}
    doubtful = state is State.UNRESOLVED or worst_of(errors) > CLOSE
    if doubtful and is_chaotic(scenario, reference_steps, floors):
        state, errors = State.CHAOTIC, {}
        differs = unlike(scenario, steps, reference_steps, floors)
    solution = solve(solver, scenario) if errors and solver and is_known(scenario) else None
    return Verdict(
        number=case.number,
        kind=str(case.kind),
        state=state,
        steps=steps,
        reference_steps=reference_steps,
        samples=scenario.samples,
        errors=errors,
        unlike=differs,
        solved=_errors_of_known(default, solution, floors),
        limit=_errors_of_known(reference, solution, floors),
        default_wall_s=default_wall_s,
        wall_s=time.perf_counter() - began,
    )


def _reference(scenario: bk.Scenario, steps: int, floors: Figures) -> tuple[Figures, int, float]:
    """Figures at fine enough steps, these steps, and by how much the last doubling moved."""
    count = max(2 * steps, affordable(scenario, steps * FINER, FIRST_STEPS_MAX))
    before = figures_at(scenario, max(1, count // 2))
    for _ in range(DOUBLINGS):
        found = figures_at(scenario, count)
        moved = worst_of(errors_of(found, before, floors))
        finer = affordable(scenario, 2 * count)
        if moved <= CONVERGED or finer == count:
            break
        before, count = found, finer
    return found, count, moved


def _errors_of_known(
    figures: Figures, solution: Figures | None, floors: Figures
) -> dict[str, float]:
    return errors_of(figures, solution, floors) if solution else {}
