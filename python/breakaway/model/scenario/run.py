"""How a scenario is run, traced and judged."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from breakaway.model.scenario.magnitudes import (
    Duration,
    DurationOrZero,
    ForceOrZero,
    LengthOrZero,
)
from breakaway.model.scenario.model import Model, Positive


class Timing(Model):
    """Duration, sampling and integration."""

    duration_s: Duration
    """How long is simulated, in s; a whole number of control periods."""
    control_period_s: Duration = 1e-5
    """T_s: the controller is sampled at this period and its force held, in s."""
    one_sample_delay: bool = False
    """Whether a force takes effect one period after the sample it was computed from."""
    integrator: Literal["linearly_implicit_midpoint", "rk4"] = "linearly_implicit_midpoint"
    """How the plant is stepped; rk4 is for checks: it is explicit and needs shorter steps."""
    steps_per_period: Annotated[int, Field(ge=1, le=100_000)] | Literal["auto"] = "auto"
    """Integration steps in a control period. "auto": as many as part and rig ask for, which mostly
    puts metrics within 1 % of those of ever finer steps. Stated steps that are longer than 0.3
    sqrt(mass / stiffness) s, or a fifteenth of that for rk4, are refused."""


class Trace(Model):
    """What is recorded of a run."""

    every_samples: Annotated[int, Field(ge=0, le=1_000_000_000)] = 10
    """A row is kept every so many control samples; 0 for no trace."""


class Limits(Model):
    """Where a run counts as diverged, released, loose, or too rough."""

    diverged_error_m: Positive | None = None
    """Error above which a run has diverged, in m. Left out: half the engagement length."""
    diverged_force_n: Positive | None = None
    """Force above which a run has diverged, in N. Left out: 20 times the stiction force."""
    release_tolerance_m: LengthOrZero = 1e-6
    """The part counts as free this far before the end of the guide, in m: a reference that ends
    there is approached from below."""
    after_release_s: DurationOrZero | None = None
    """The run ends this long after the release, in s. Left out: it runs for its duration."""
    breakaway_travel_m: Positive | None = None
    """Travel at which the joint counts as loose, in m. Left out: 2 stiction_n /
    stiffness_n_per_m."""
    contact_force_n: ForceOrZero | None = None
    """Force above which the actuator counts as pushing, in N; it separates impacts. Left out: 0, or
    a thousandth of the actuator's largest force if it has a lag."""
    peak_force_max_n: Positive | None = None
    """Largest force that the part may see, in N. Left out: no limit."""
    jump_max_m: Positive | None = None
    """Largest jump, travel above the reference's speed in one slip, in m. Left out: no limit."""
    release_velocity_max_m_per_s: Positive | None = None
    """Largest velocity at release, in m/s. Left out: no limit."""
