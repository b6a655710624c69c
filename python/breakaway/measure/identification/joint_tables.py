"""The tables of a joint file."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from breakaway.measure.identification.rig_file import RigFile
from breakaway.measure.logs.log import Array
from breakaway.model.scenario.distribution import LogUniform
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.model import Model, Name, NotNegative, Positive, Text


def _number(end: object) -> object:
    """Read an infinite end that JSON, which has no number for it, gives as a word."""
    return float(str(end)) if end in ("inf", "-inf") else end


End = Annotated[float, Field(allow_inf_nan=True), BeforeValidator(_number)]
"""An end of an interval, which may be infinite."""


class Settings(Model):
    """Settings of the regression."""

    lowpass_hz: Positive
    decimation: Annotated[int, Field(ge=1)]
    sample_rate_hz: Positive
    trimmed_samples: Annotated[int, Field(ge=0)]


class FitSettings(Model):
    """Settings of an output-error fit, as `breakaway.identify` names them."""

    law: Name
    asymmetric: bool
    position_dependent: bool
    motion: Name
    repeats: list[list[float]]
    origin_m: float
    steps_per_row: Annotated[int, Field(ge=1)]
    rig: RigFile | None = None
    loss: Name
    starts: Annotated[int, Field(ge=1)]
    seed: int
    complete: bool


class Search(Model):
    """Settings of the search for breakaway, as `find_breakaway_events` names them."""

    rest_speed_m_per_s: Positive | None = None
    min_rest_s: NotNegative
    min_slip_m: NotNegative | None = None
    gap_s: Positive | None = None
    sliding_window_s: Positive | None = None
    passed_share: Annotated[float, Field(gt=0.0, le=1.0)]
    offset_n: float | None = None
    rig: RigFile | None = None


class Assumed(Model):
    """A usual value of what no log told, and a wide range about it.

    Draws fill the range evenly: its logarithm where it does not start at 0.

    Examples
    --------
    >>> one = Assumed(value=0.03, low=0.005, high=0.2, why="one speed")
    >>> draws = one.draws(np.random.default_rng(0), 1000)
    >>> bool((draws >= 0.005).all() and (draws <= 0.2).all())
    True

    """

    value: NotNegative
    low: NotNegative
    high: Positive
    why: Text

    @model_validator(mode="after")
    def _is_a_range(self) -> Assumed:
        if not self.low <= self.value <= self.high:
            raise ValueError(
                f"value: {self.value!r} is not from low = {self.low!r} to high = {self.high!r}; "
                "give low <= value <= high"
            )
        return self

    def draws(self, rng: np.random.Generator, count: int) -> Array:
        """Draw values of the range.

        Parameters
        ----------
        rng : numpy.random.Generator
            What draws.
        count : int
            How many, >= 0.

        """
        shares = rng.random(count)
        if self.low == 0.0:
            return np.asarray(self.high * shares)
        return LogUniform(low=self.low, high=self.high).quantile(shares)


class Provenance(Model):
    """Where the figures come from. ``log_sha256`` is absent for a log that was in no file."""

    log: Text
    log_sha256: Name | None = None
    breakaway_version: Name
    method: Text
    settings: Settings | None = None
    fit: FitSettings | None = None
    search: Search | None = None
    samples: Annotated[int, Field(ge=1)]
    notes: Annotated[list[Text], Field(default_factory=list)]


class Part(Model):
    """The moving part."""

    mass_kg: Positive | None = None


class Joint(Model):
    """What the log tells of the joint; where directions differ, of the positive one.

    ``law`` is the friction law of a scenario that the fit was made with. It is absent where the fit
    says nothing of how a stuck joint yields. ``backward_ratio`` is the level of the negative
    direction over that of the positive one.
    """

    law: Law | None = None
    coulomb_n: NotNegative
    viscous_n_s_per_m: NotNegative | None = None
    stiction_n: Positive | None = None
    stiffness_n_per_m: Positive | None = None
    damping_n_s_per_m: NotNegative | None = None
    stribeck_velocity_m_per_s: Positive | None = None
    elastic_share: Annotated[float, Field(ge=0.0, lt=1.0)] | None = None
    backward_ratio: Positive | None = None


class Rig(Model):
    """What belongs to the rig that measured, not to the joint."""

    offset_n: float


class Draws(Model):
    """Joints that are as likely as any other, given the log: a row of all columns is one joint.

    ``source`` says what they were drawn from: the posterior, the normal distribution that the
    standard errors and correlations give, of which values that no joint can have are drawn again,
    or the intervals of what was seen and the ranges of what is assumed.
    """

    source: Text
    seed: int
    values: dict[str, list[float]]


class PullFigures(Model):
    """How the part was pulled: what follows from joint and rig together, and none of it alone."""

    release_speed_m_per_s: Positive | None = None
    """Largest speed, over two samples, from the peak until the load is that of sliding."""
    sliding_speed_m_per_s: Positive | None = None
    """Speed of the steady sliding that tells ``coulomb_n``."""
    loading_rate_n_per_s: float | None = None
    presliding_displacement_m: float | None = None


class AsymmetricParameters(Model):
    """Parameters with friction of its own in each direction, positive where it resists."""

    mass_kg: float
    viscous_positive_n_s_per_m: float
    viscous_negative_n_s_per_m: float
    coulomb_positive_n: float
    coulomb_negative_n: float


class Asymmetric(AsymmetricParameters):
    """The asymmetric parameters and their standard errors."""

    standard_error: AsymmetricParameters


class RelativeForceError(Model):
    """100 ‖F - W θ‖ / ‖F‖ of either fit, in percent."""

    symmetric: NotNegative
    asymmetric: NotNegative
