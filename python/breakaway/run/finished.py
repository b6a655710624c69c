"""One finished run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from breakaway.base.equality import ByValue
from breakaway.base.extras import pandas
from breakaway.base.one_line import OneLine, counted
from breakaway.errors import ScenarioError
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.units import unit_of
from breakaway.run.warnings import warnings_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


class Outcome(StrEnum):
    """How a run ended."""

    RELEASED = "released"
    """The part is free, and no limit was exceeded."""
    NOT_RELEASED = "not_released"
    """Time ran out."""
    DIVERGED = "diverged"
    """The error or the force passed its bound, or was not a number."""
    LIMIT_EXCEEDED = "limit_exceeded"
    """Force, jump or velocity at release exceeded what the scenario allows."""


@dataclass(frozen=True, eq=False)
class RunMetrics(ByValue):
    """The figures of a run; NaN (null in JSON) for what did not happen."""

    simulated_s: float
    """Time until the end or until the run diverged, s."""
    iae_m_s: float
    """Integral of |e|, summed at control samples, m s."""
    ise_m2_s: float
    """Integral of e^2, m^2 s."""
    itae_m_s2: float
    """Integral of t |e|, m s^2."""
    largest_error_m: float
    """Largest |e|, m."""
    peak_force_n: float
    """Largest |F|, N."""
    peak_over_breakaway: float
    """Largest |F| over the largest force that friction can hold with, anywhere along the guide: the
    joint's stiction force at the seat, where nothing varies."""
    mean_force_n: float
    """Mean of F, N."""
    rms_force_n: float
    """Root of the mean of F^2, N."""
    impulse_n_s: float
    """Integral of F over time, N s."""
    work_j: float
    """Integral of F over travel, J."""
    friction_loss_j: float
    """Work lost in the joint: the work done on it, less what its bristles still store, J."""
    impacts: float
    """Number of impacts: stretches of time with F > limits.contact_force_n."""
    contact_time_s: float
    """Time with F > limits.contact_force_n, s."""
    mean_impact_s: float
    """Mean duration of an impact, s."""
    largest_step_m: float
    """Largest travel from the start of an impact to the start of the next, m."""
    largest_impact_work_j: float
    """Largest work done by one impact, J."""
    largest_jump_m: float
    """Largest travel above the reference's speed in one slip within the guide, m: this harms the
    part."""
    time_to_breakaway_s: float
    """When the joint broke loose, s."""
    time_to_release_s: float
    """When the part came free, s."""
    release_velocity_m_per_s: float
    """Velocity when the part came free, m/s."""
    saturation_time_s: float
    """Time during which the actuator could not deliver the command, s."""
    supplied_work_j: float
    """Work that the drives of the actuator supplied, J."""
    actuator_loss_j: float
    """Energy lost in the actuator's dampers and its contact, J; a contact still strained at the
    end counts as lost."""
    rms_current_a: float
    """Root of the mean square of the stack's current, A; 0 without a stack."""
    stack_cycles: float
    """Full strokes of the stack, out and back: the charge moved over twice the full charge."""
    stack_loss_w: float
    """Mean power that heats the stack, W: ``tan(delta) / (omega C) rms_current**2`` at 1 kHz."""
    stack_tension_n: float
    """Largest tension of the stack beyond its preload, N; below 0 where it was always pressed."""
    stop_reason: float
    """Why the watch stopped the controller: 0 not at all, 1 not a number, 2 the position jumped,
    3 it was frozen, 4 the clock stood still."""
    final_position_m: float
    """Position at the end, m."""

    def to_dict(self) -> dict[str, float | None]:
        """Figures by name, None for what did not happen."""
        return {name: value if isfinite(value) else None for name, value in asdict(self).items()}


@dataclass(frozen=True, eq=False)
class Run(OneLine, ByValue):
    """A finished run: outcome, figures, trace, and the resolved scenario that reruns it."""

    outcome: Outcome
    """How it ended."""
    metrics: RunMetrics
    """Its figures."""
    trace: Mapping[str, NDArray[np.float64]]
    """Columns ``t_s``, ``reference_m``, ``position_m``, ``velocity_m_per_s``, ``bristle_m``,
    ``applied_force_n`` and ``joint_force_n``, read-only; empty without a trace. A row holds the
    state at a control sample and the forces during the period after it.

    With a feed axis also ``feed_m``, ``tool_m`` and ``tip_m``: where the tip's face would be with
    axis and stack relaxed, with only the stack relaxed, and where it is. ``position_m - tip_m`` is
    the gap, below zero where the tip presses on the part, above the play of a grip where it
    pulls; ``tip_m - tool_m`` what the stack
    lengthens, ``feed_m - tool_m`` what the axis yields."""
    scenario: Scenario
    """What was run, every number explicit."""
    seed: int
    """Seed of its random draws."""
    run_index: int
    """Its number among the runs of that seed."""

    def __repr__(self) -> str:
        m, said = self.metrics, [f"{self.outcome}", f"peak force {self.metrics.peak_force_n:.5g} N"]
        if isfinite(m.time_to_release_s):
            said.append(f"free after {m.time_to_release_s:.5g} s")
        if self.warnings:
            said.append(counted(len(self.warnings), "warning"))
        return f"<run of {self.scenario.name!r}: {', '.join(said)}>"

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know before trusting its figures, one sentence each.

        Examples
        --------
        >>> import breakaway as bk
        >>> scenario = bk.load_scenario("paper_as_computed")
        >>> wild = bk.simulate(scenario.with_({"limits.diverged_force_n": 400.0}))
        >>> wild.warnings[0].partition(": ")[2]
        'peak force 400.27 N is above limits.diverged_force_n = 400 N'

        """
        return tuple(warnings_of(self.scenario, self.outcome, self.metrics, self.trace))

    def to_xarray(self) -> xarray.Dataset:
        """Give the trace as a dataset over ``t_s``, with units, and outcome and seed as attributes.

        Raises
        ------
        ScenarioError
            The run has no trace.

        Examples
        --------
        >>> import breakaway as bk
        >>> data = bk.simulate(bk.load_scenario("paper_as_computed")).to_xarray()
        >>> data.position_m.attrs["units"], data.attrs["outcome"]
        ('m', 'released')

        """
        import xarray

        self._refuse_no_trace()
        data = {
            name: ("t_s", values, {"units": unit_of(name).symbol})
            for name, values in self.trace.items()
            if name != "t_s"
        }
        attributes = {
            "scenario": self.scenario.name,
            "outcome": str(self.outcome),
            "seed": self.seed,
            "run_index": self.run_index,
        }
        time = ("t_s", self.trace["t_s"], {"units": "s"})
        return xarray.Dataset(data, coords={"t_s": time}, attrs=attributes)

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is optional
        """Give the trace as a pandas DataFrame, by ``t_s``.

        Raises
        ------
        ScenarioError
            The run has no trace.
        StudyError
            pandas is not installed.

        Examples
        --------
        >>> import breakaway as bk
        >>> frame = bk.simulate(bk.load_scenario("paper_as_computed")).to_pandas()
        >>> frame.index.name, f"{frame.applied_force_n.max():.1f}"
        ('t_s', '601.3')

        """
        self._refuse_no_trace()
        return pandas().DataFrame(dict(self.trace)).set_index("t_s")

    def _refuse_no_trace(self) -> None:
        if not self.trace:
            raise ScenarioError("trace.every_samples: is 0, so there is no trace; give 1 or more")

    def plot(self) -> Figure:
        """Draw position, error and forces over time."""
        from breakaway.drawing.run import plot_run

        return plot_run(self)
