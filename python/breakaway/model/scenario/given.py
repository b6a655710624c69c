"""Refuse what is not the model that a function takes, such as the name of a preset."""

from __future__ import annotations

from typing import get_args

from breakaway.base.arguments import check_kind
from breakaway.errors import ScenarioError
from breakaway.model.scenario.joint import AnyJoint
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.scenario import Scenario


def check_scenario(given: object) -> None:
    """Refuse what is no scenario.

    Examples
    --------
    >>> check_scenario("paper_as_computed")
    Traceback (most recent call last):
        ...
    breakaway.errors.ScenarioError: scenario: 'paper_as_computed' is not a Scenario; load_...

    """
    remedy = "load_scenario gives that of a preset or a file"
    check_kind("scenario", given, Scenario, remedy, ScenarioError)


def check_population(given: object) -> None:
    """Refuse what is no population of parts."""
    remedy = "load_population gives that of a preset or a file"
    check_kind("population", given, PartPopulation, remedy, ScenarioError)


def check_method(given: object) -> None:
    """Refuse what is no method of extraction."""
    remedy = "load_method gives that of a preset or a file"
    check_kind("method", given, Method, remedy, ScenarioError)


def check_joint(given: object) -> None:
    """Refuse what is no joint."""
    remedy = "give a joint, such as that of a scenario, scenario.joint"
    check_kind("joint", given, get_args(AnyJoint), remedy, ScenarioError)
