"""How many integration steps a case takes: the one place that decides."""

from __future__ import annotations

import breakaway as bk

FINER = 50
"""Steps of the reference over those of the default."""
STEPS_MAX = 2e8
"""Most integration steps of one run: a reference that needs more is less fine."""
FIRST_STEPS_MAX = 4e7
"""As many for the first try of a reference: only one that is not converged needs more."""


def steps_of(scenario: bk.Scenario) -> int:
    """Steps in a control period, as a number."""
    return bk.resolve(scenario).timing.steps_per_period


def at_steps(scenario: bk.Scenario, steps: int) -> bk.Scenario:
    """The scenario at an explicit number of steps, be it more than a file may ask for."""
    timing = scenario.timing.model_copy(update={"steps_per_period": steps})
    return scenario.model_copy(update={"timing": timing})


def affordable(scenario: bk.Scenario, steps: int, most: float = STEPS_MAX) -> int:
    """That many steps in a control period, or as many as a run may take in all."""
    return min(steps, max(1, int(most / scenario.samples)))
