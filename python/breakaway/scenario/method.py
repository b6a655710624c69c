"""A way to free a part: actuator, controller, and what they are told of it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from breakaway.scenario.actuator import Actuator
from breakaway.scenario.controller import Controller
from breakaway.scenario.model import Model
from breakaway.scenario.reference import Reference

Known = Literal["engagement_length_m"]


class Method(Model):
    """A way to free parts: what pushes, what decides, and what it knows of each part.

    Examples
    --------
    >>> import breakaway as bk
    >>> bk.load_method("steady_feed").controller.kind
    'steady_feed'

    """

    name: str
    """A name for tables and figures."""
    description: str = ""
    """How it works, in a sentence or two."""
    actuator: Actuator
    """What pushes."""
    controller: Controller
    """What decides how hard. Gains by pole placement are designed for the population's nominal
    part."""
    reference: Reference | None = None
    """Where the part should be, for controllers that follow one. Left out: 0."""
    knows: dict[str, Known] = Field(default_factory=dict)
    """Numbers that are told the length of engagement of each part, by dotted path, such as
    ``controller.travel_m``; everything else is the same for all parts."""
