"""What finer steps make of a run, as a table."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from breakaway.base.one_line import counted
from breakaway.cli.quantity import show_value, split_unit
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy

if TYPE_CHECKING:
    from breakaway.model.scenario import Scenario
    from breakaway.run.accuracy import Accuracy


def accuracy_of(scenario: Scenario) -> Accuracy:
    """Check the accuracy of a scenario, saying on a terminal that it goes on."""
    from breakaway.run.accuracy import check_accuracy

    with busy("running again with finer steps ..."):
        return check_accuracy(scenario)


def accuracy_sheet(accuracy: Accuracy) -> tuple[Sheet, str]:
    """Give each metric that moves at each number of steps, and what follows."""
    levels = [counted(steps, "step") for steps in accuracy.levels]
    sheet = Sheet("", ["metric", *levels, "unit", "off"], numbers=[*levels, "off"])
    for name, error in accuracy.errors.items():
        values = [metrics.to_dict()[name] for metrics in accuracy.levels.values()]
        unit = show_value(name, values[-1])[1]
        shown = [_in_unit(name, value, unit) for value in values]
        sheet.add(split_unit(name)[0], *shown, unit, _percent(error))
    return sheet, _verdict(accuracy)


def _in_unit(name: str, value: float | None, unit: str) -> str:
    shown, its_unit = show_value(name, value)
    return shown if its_unit == unit else f"{shown} {its_unit}".strip()


def _percent(error: float) -> str:
    return f"{100 * error:.2g} %" if isfinite(error) else "all"


def _verdict(accuracy: Accuracy) -> str:
    from breakaway.run.accuracy import STEPS_MAX

    finest = max(accuracy.levels)
    if len(accuracy.levels) == 1:
        return (
            f"accuracy: not checked: twice the {finest:,} steps in a control period would take "
            f"more than {STEPS_MAX:,} integration steps; shorten timing.duration_s"
        )
    if not accuracy.settled:
        return (
            f"accuracy: metrics still move by more than 0.1 % at {finest:,} steps in a control "
            "period: the motion is chaotic, or needs finer steps than can be tried"
        )
    name, error = accuracy.worst
    moved = f"{split_unit(name)[0]} is {_percent(error)} off" if error else "nothing moves"
    return (
        f"accuracy: at {counted(accuracy.asked_steps, 'step')} in a control period {moved}; "
        f"timing.steps_per_period wants {accuracy.wanted_steps:,} for all metrics within 1 %"
    )
