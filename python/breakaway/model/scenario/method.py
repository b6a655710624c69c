"""A way to free a part: actuator, controller, and what they know of it."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.model.scenario.actuator import Actuator
from breakaway.model.scenario.controller import Controller
from breakaway.model.scenario.model import Model, Name, Positive, Text
from breakaway.model.scenario.reference import Reference

Array = NDArray[np.float64]
Quantity = Literal["engagement_length_m"]


class Multiple(Model):
    """A quantity of each part, times a number that is the same for all.

    Examples
    --------
    >>> import breakaway as bk
    >>> told = bk.load_method("vibrated_feed").knows["controller.feed.speed_m_per_s"]
    >>> told.of, told.times
    ('engagement_length_m', 0.11)

    """

    of: Quantity
    """The quantity that is known of a part."""
    times: Positive
    """Factor, in the unit of the result over that of the quantity: a speed in m/s that is 0.1 times
    a length in m covers that length in 10 s."""


def _form_of(told: object) -> str:
    return "quantity" if isinstance(told, str) else "multiple"


Known = Annotated[
    Annotated[Quantity, Tag("quantity")] | Annotated[Multiple, Tag("multiple")],
    Discriminator(_form_of),
]


class Method(Model):
    """A way to free parts: what pushes, what decides, and what it knows of each part.

    Examples
    --------
    >>> import breakaway as bk
    >>> bk.load_method("steady_feed").controller.kind
    'steady_feed'

    """

    name: Name
    """A name for tables and figures."""
    description: Text = ""
    """How it works, in a sentence or two."""
    actuator: Actuator
    """What pushes."""
    controller: Controller
    """What decides how hard. Gains by pole placement are designed for the population's nominal
    part."""
    reference: Reference | None = None
    """Where the part should be, for controllers that follow one. Left out: 0."""
    knows: dict[str, Known] = Field(default_factory=dict)
    """Numbers that follow the length of engagement of each part, or a multiple of it, by dotted
    path, such as ``controller.travel_m``; everything else is the same for all parts."""

    def told(self, engagement_length_m: Array) -> dict[str, Array]:
        """Give the numbers that each part sets.

        Parameters
        ----------
        engagement_length_m : array
            Length of engagement of each part, in m.

        Returns
        -------
        dict of str to array
            A number for each part, by dotted path.

        Examples
        --------
        >>> import breakaway as bk, numpy as np
        >>> bk.load_method("vibrated_feed").told(np.array([0.1]))
        {'controller.feed.speed_m_per_s': array([0.011])}

        """
        check_arguments(Method.told, locals(), ScenarioError)
        length_m = engagement_length_m
        return {
            path: told.times * length_m if isinstance(told, Multiple) else length_m
            for path, told in self.knows.items()
        }
