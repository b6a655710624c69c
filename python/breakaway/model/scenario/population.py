"""Parts nobody knows: what differs between them, and what is done to none of them."""

from __future__ import annotations

from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from breakaway.model.scenario.correlation import Correlation, check_correlations
from breakaway.model.scenario.distribution import Distribution, Samples
from breakaway.model.scenario.laws import LawNumbers
from breakaway.model.scenario.model import Model, Name, Positive, Text
from breakaway.model.scenario.sensor import Sensors, Watch
from breakaway.model.scenario.variation import VariationKind

QUANTITIES = (
    "stiction_n",
    "stiction_ratio",
    "presliding_m",
    "bristle_damping_ratio",
    "stribeck_velocity_m_per_s",
    "mass_kg",
    "engagement_length_m",
    "var",
    "hold_s",
    "correlation_length_m",
)
"""What differs from part to part by a distribution, in the order in which it is drawn."""
LEVEL_DRAW = "level_draw"
"""w of a part, uniform on [-1, 1]: where friction varies from part to part, its levels are
multiplied by ``1 + var w``."""
OF_A_PART = (*QUANTITIES, LEVEL_DRAW)
"""All that is drawn of a part, in this order."""


class PartDistributions(Model):
    """How the parts of a population differ.

    Quantities are independent of each other, but for the population's ``correlations``.
    """

    stiction_n: Distribution
    """F_s0, the force that breaks the joint loose at the seat, in N."""
    stiction_ratio: Distribution
    """F_s0 / F_c0."""
    presliding_m: Distribution
    """F_s0 / k_e: how far the bristles stretch before they slip, in m."""
    bristle_damping_ratio: Distribution
    """c / (2 sqrt(k_e m))."""
    stribeck_velocity_m_per_s: Distribution
    """v_s, in m/s."""
    mass_kg: Distribution
    """m, in kg."""
    engagement_length_m: Distribution
    """l_f, in m."""
    var: Distribution
    """Size of the variation of friction, relative to its levels, whatever its kind: levels are
    multiplied by numbers from 1 - var to 1 + var."""
    hold_s: Distribution
    """Time between redraws, in s; at least one control period. Used by the variation
    ``paper_random_factor`` alone."""
    correlation_length_m: Distribution
    """How far friction along the way stays alike, in m: there its correlation has fallen to 1/e.
    Used by the variation ``field`` alone."""


class Gentleness(Model):
    """The most that a part may suffer.

    The defaults of a population (1.5 times, 0.5 mm, 0.3 m/s; strictly 1.25, 0.25 mm, 0.1 m/s) are
    assumed, not sourced.
    """

    peak_over_breakaway_max: Positive
    """Largest force over the largest that friction can hold the part with, anywhere along its
    guide."""
    jump_max_m: Positive
    """Largest uncontrolled travel in one slip, in m."""
    release_velocity_max_m_per_s: Positive
    """Largest velocity at release, in m/s."""


class PartPopulation(Model):
    """A population of seized parts, and the rig's clock and sensors that all methods share.

    Examples
    --------
    >>> import breakaway as bk
    >>> population = bk.load_population("seized_parts")
    >>> round(population.nominal["stiction_n"], 1)
    821.6

    """

    name: Name
    """A name for tables and figures."""
    description: Text = ""
    """What the population is."""
    parts: PartDistributions
    """How its parts differ."""
    correlations: list[Correlation] = Field(default_factory=list)
    """Which of their quantities go together. Left out: none."""
    assumed: dict[str, Text] = Field(default_factory=dict)
    """Which of their quantities have a range that no log told -> why. For information; left out:
    the file does not say."""
    variation: VariationKind = "field"
    """How the friction of a part varies, where a trial or a comparison asks for nothing else:
    along the way (``field``), from part to part (``part``), anew in time as in the paper
    (``paper_random_factor``), or not at all (``none``)."""
    laws: LawNumbers = LawNumbers()
    """What some friction laws need in addition."""
    disturbance_acts_on: Literal["joint_force", "friction_level"] = "friction_level"
    """What the paper's random factor multiplies: the friction level alone leaves a stuck part at
    rest."""
    duration_s: Positive = 10.0
    """Time allowed for each part, in s."""
    control_period_s: Positive = 5e-5
    """T_s, in s."""
    one_sample_delay: bool = True
    """Whether a command takes effect one period after its sample."""
    sensors: Sensors = Sensors()
    """Sensors of the controllers."""
    watch: Watch | None = None
    """Stops a controller whose sensors cannot be right."""
    gentle: Gentleness = Gentleness(
        peak_over_breakaway_max=1.5, jump_max_m=0.5e-3, release_velocity_max_m_per_s=0.3
    )
    """What counts as gentle; the usual limits are assumed."""
    strict: Gentleness = Gentleness(
        peak_over_breakaway_max=1.25, jump_max_m=0.25e-3, release_velocity_max_m_per_s=0.1
    )
    """What counts as strictly gentle; the usual limits are assumed."""

    @cached_property
    def nominal(self) -> dict[str, float]:
        """The part whose quantities are all at their medians: all that controllers are told."""
        half = np.array([0.5])
        medians = {name: float(getattr(self.parts, name).quantile(half)[0]) for name in QUANTITIES}
        return medians | {LEVEL_DRAW: 0.0}

    @model_validator(mode="after")
    def _names_its_quantities(self) -> Self:
        for name in self.assumed:
            if name not in QUANTITIES:
                raise ValueError(f"assumed: {name!r} is not one of {', '.join(QUANTITIES)}")
        check_correlations(QUANTITIES, self.correlations)
        for place, correlation in enumerate(self.correlations):
            for name in correlation.of:
                found = getattr(self.parts, name)
                if isinstance(found, Samples) and found.rows == "shared":
                    raise ValueError(
                        f"correlations.{place}.of: {name!r} is drawn from shared rows of a table, "
                        "which keep the table's own correlation; leave one of the two out"
                    )
        return self
