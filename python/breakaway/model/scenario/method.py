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


class TrainingParts(Model):
    """Parts that the numbers of a method were chosen on.

    Examples
    --------
    >>> TrainingParts(population="seized_parts", seed=0, first=0, runs=256).numbers
    range(0, 256)

    """

    population: Name
    """Name of the population."""
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    """Seed that they were drawn by."""
    first: Annotated[int, Field(ge=0, lt=2**62)]
    """Number of the first of them."""
    runs: Annotated[int, Field(ge=1, lt=2**62)]
    """How many they are."""

    @property
    def numbers(self) -> range:
        """Numbers of all of them."""
        return range(self.first, self.first + self.runs)


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
    tuned_on: list[TrainingParts] = Field(default_factory=list)
    """Parts that its numbers were chosen on, which a tuning notes. Left out: none."""

    def tuned_among(self, seed: int, numbers: range) -> range | None:
        """Give the first parts among some that its numbers were chosen on; None if there are none.

        Parts of the same seed and number come from the same random numbers, whatever their
        population is.

        Parameters
        ----------
        seed : int
            Seed of the parts.
        numbers : range
            Their numbers, consecutive.

        Examples
        --------
        >>> import breakaway as bk
        >>> feed = bk.load_method("steady_feed")
        >>> parts = TrainingParts(population="seized_parts", seed=0, first=0, runs=256)
        >>> tuned = feed.model_copy(update={"tuned_on": [parts]})
        >>> tuned.tuned_among(0, range(200, 1000)), tuned.tuned_among(1, range(1000))
        (range(200, 256), None)

        """
        check_arguments(Method.tuned_among, locals(), ScenarioError)
        for parts in self.tuned_on:
            start = max(parts.first, numbers.start)
            stop = min(parts.numbers.stop, numbers.stop)
            if parts.seed == seed and start < stop:
                return range(start, stop)
        return None

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
