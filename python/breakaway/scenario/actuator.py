"""What turns a commanded force into a force on the part."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from breakaway.scenario.model import Model, Positive


class IdealActuator(Model):
    """Delivers every commanded force, pushing or pulling."""

    kind: Literal["ideal"] = "ideal"
    """The kind of actuator."""


class PushOnlyActuator(Model):
    """A tip that pushes up to a limit and can not pull."""

    kind: Literal["push_only"] = "push_only"
    """The kind of actuator."""
    force_max_n: Positive
    """Largest force, in N."""


Actuator = Annotated[IdealActuator | PushOnlyActuator, Field(discriminator="kind")]
