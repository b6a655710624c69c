"""How accurate the metrics of a scenario are: the same run at finer and finer steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, isfinite, isnan
from typing import Any

from breakaway.base.arguments import check_arguments, check_whole
from breakaway.base.one_line import OneLine
from breakaway.errors import ScenarioError
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.finished import RunMetrics
from breakaway.run.resolution import at_steps
from breakaway.run.simulation import simulate

CLOSE = 0.01
"""A metric is accurate if it is as near as this to that of the finest steps, relative to it."""
STILL = 0.001
"""Metrics have settled if twice the steps move none of them by more."""
COUNTS = ("impacts", "stack_cycles")
"""Metrics that are counted: one more or less is accurate."""
STEPS_MAX = 300_000_000
"""Most integration steps of one run that is tried."""


@dataclass(frozen=True, repr=False)
class Accuracy(OneLine):
    """The metrics of a scenario at finer and finer integration steps."""

    asked_steps: int
    """Integration steps in a control period of the scenario itself."""
    levels: Mapping[int, RunMetrics]
    """Integration steps in a control period -> the metrics of that run, finest last."""
    settled: bool
    """Whether the last doubling moved no metric by more than a thousandth."""

    def __repr__(self) -> str:
        name, moved = self.worst
        worst = f"{name} is {100 * moved:.2g} % off" if moved else "nothing moves"
        wanted = "not found" if self.wanted_steps is None else self.wanted_steps
        return f"<accuracy at {self.asked_steps} steps: {worst}; wanted: {wanted}>"

    @property
    def errors(self) -> dict[str, float]:
        """How far each metric of the scenario is from that at the finest steps, relative to it."""
        return self._errors_at(self.asked_steps)

    @property
    def worst(self) -> tuple[str, float]:
        """The metric that is furthest off, and how far."""
        return max(self.errors.items(), key=lambda item: item[1])

    @property
    def wanted_steps(self) -> int | None:
        """Fewest steps tried with every metric within 1 %; none if the metrics never settled."""
        if not self.settled:
            return None
        return next(n for n in self.levels if max(self._errors_at(n).values()) <= CLOSE)

    def to_dict(self) -> dict[str, Any]:
        """Give everything in plain values, for JSON."""
        return {
            "asked_steps_per_period": self.asked_steps,
            "wanted_steps_per_period": self.wanted_steps,
            "settled": self.settled,
            "errors": {n: e if isfinite(e) else None for n, e in self.errors.items()},
            "metrics": {str(n): metrics.to_dict() for n, metrics in self.levels.items()},
        }

    def _errors_at(self, steps: int) -> dict[str, float]:
        return errors_between(self.levels[steps], self.levels[max(self.levels)])


def errors_between(coarse: RunMetrics, fine: RunMetrics) -> dict[str, float]:
    """Give how far each metric is from that of finer steps; counts in ones beyond the first."""
    others = fine.to_dict()
    return {
        name: _error(value, others[name], counted=name in COUNTS)
        for name, value in coarse.to_dict().items()
    }


def _error(value: float | None, fine: float | None, *, counted: bool) -> float:
    if value == fine or (value is None and fine is None):
        return 0.0
    if value is None or fine is None or not isfinite(value) or not isfinite(fine):
        return inf
    if counted:
        return max(0.0, abs(value - fine) - 1.0) / max(abs(fine), 1.0)
    error = abs(value - fine) / abs(fine) if fine else inf
    return inf if isnan(error) else error


def check_accuracy(
    scenario: Scenario,
    *,
    run_index: int = 0,
    progress: Callable[[int], None] | None = None,
) -> Accuracy:
    """Run a scenario again with finer steps until no metric moves.

    Each run has twice the integration steps of the one before. The control period stays: it is part
    of what is simulated.

    Parameters
    ----------
    scenario : Scenario
        What is simulated, at the steps that it states or that "auto" stands for.
    run_index : int, optional
        Number of the run among the runs of the scenario's seed.
    progress : callable, optional
        Called with the steps in a control period before each run.

    Returns
    -------
    Accuracy
        `settled` is false where a metric still moved by more than a thousandth at 3e8 integration
        steps, or where twice the scenario's own steps would be more than that, so that there is one
        level: motion that is chaotic does not settle at any steps.

    Raises
    ------
    ScenarioError
        It is not a scenario, or the controller cannot be designed for this joint.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 0.05})
    >>> accuracy = bk.check_accuracy(scenario)
    >>> accuracy.asked_steps, accuracy.settled, accuracy.wanted_steps
    (1, True, 1)

    """
    check_arguments(check_accuracy, locals(), ScenarioError)
    check_whole("run_index", run_index, ScenarioError, 0, 2**64 - 1)
    untraced = scenario.model_copy(
        update={"trace": scenario.trace.model_copy(update={"every_samples": 0})}
    )
    asked = steps = scenario.steps_per_period
    levels: dict[int, RunMetrics] = {}
    settled = False
    while not settled and (not levels or steps * scenario.samples <= STEPS_MAX):
        if progress:
            progress(steps)
        levels[steps] = simulate(at_steps(untraced, steps), run_index=run_index).metrics
        if len(levels) > 1:
            moved = errors_between(levels[steps // 2], levels[steps])
            settled = max(moved.values()) <= STILL
        steps *= 2
    return Accuracy(asked, levels, settled)
