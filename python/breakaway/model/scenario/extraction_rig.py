"""What a rig can do to a part: its drive, its reach, its sensors and its clock."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from breakaway.model.scenario.actuator import FeedAxis, ForceActuator
from breakaway.model.scenario.magnitudes import Force, Length
from breakaway.model.scenario.model import Model, Name, Positive, Text
from breakaway.model.scenario.sensor import Sensors


class ExtractionRig(Model):
    """A rig that pulls or pushes parts out.

    Examples
    --------
    >>> import breakaway as bk
    >>> rig = bk.load_rig("screw_jack")
    >>> rig.actuator.kind, rig.reads
    ('feed_axis', ())

    """

    name: Name
    """A name for tables and figures."""
    description: Text = ""
    """What the rig is, in a sentence."""
    sources: Annotated[tuple[Text, ...], Field(strict=False)] = ()
    """Where its figures are from."""
    actuator: Annotated[ForceActuator | FeedAxis, Field(discriminator="kind")]
    """What pushes: a force behind a lag, or an axis that moves."""
    force_max_n: Force
    """Largest force that the rig may bear, in N."""
    stroke_m: Length
    """How far it reaches, in m."""
    reads: Annotated[tuple[Literal["position", "force"], ...], Field(strict=False)] = ()
    """What its controller can read."""
    sensors: Sensors = Sensors()
    """The sensors that it reads them with."""
    control_period_s: Positive
    """T_s, in s."""
    one_sample_delay: bool = True
    """Whether a command takes effect one period after its sample."""
