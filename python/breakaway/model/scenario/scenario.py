"""The whole scenario."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, isfinite, sqrt
from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, model_validator

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.model.scenario.actuator import (
    Actuator,
    FeedAxis,
    ForceActuator,
    IdealActuator,
    Piezo,
)
from breakaway.model.scenario.controller import (
    Controller,
    FmVibration,
    SteadyFeed,
    TwoStep,
    VibratedFeed,
    pids,
)
from breakaway.model.scenario.disturbance import Disturbance, UniformDisturbance
from breakaway.model.scenario.joint import AnyJoint, Part
from breakaway.model.scenario.joint_source import JointSource
from breakaway.model.scenario.model import Model, Name, Text
from breakaway.model.scenario.normal_force import STEPS_PER_CYCLE
from breakaway.model.scenario.reference import Reference, StepReference
from breakaway.model.scenario.run import Limits, Timing, Trace
from breakaway.model.scenario.sensor import Sensors, Watch
from breakaway.model.scenario.steps import (
    OF_OSCILLATION,
    OF_RK4,
    asking_for_most_steps,
    steps_per_period,
)

SAMPLES_MAX = 4_000_000_000
"""Most integration steps of one run."""
LENGTHS_MAX = 400_000
"""Most correlation lengths of a field in a guide: beyond, its hash would repeat."""
ROWS_MAX = 10_000_000
"""Most rows of one trace."""


class Scenario(Model):
    """An extraction: joint, part, reference, disturbance, actuator, controller, and how to run it.

    Scenarios do not change; `with_` gives a changed copy. Every number is checked here and only
    here. Not checked: whether the controller is stable (see `breakaway.design.stability`).

    Examples
    --------
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed")
    >>> rough = scenario.with_(disturbance=bk.UniformDisturbance(var=0.05, hold_s=1e-4), seed=7)
    >>> rough.disturbance.var, rough.seed, scenario.seed
    (0.05, 7, 0)
    >>> scenario.with_({"joint.stiction_n": -450})
    Traceback (most recent call last):
        ...
    breakaway.errors.ScenarioError: joint.stiction_n: -450 is not > 0; give a number > 0 and ...

    """

    name: Name = "scenario"
    """A name for tables and figures."""
    description: Text = ""
    """What the scenario is for."""
    breakaway_version: Name | None = None
    """The version that wrote the file; for information, not checked."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """Seed of all random draws."""
    joint: Annotated[AnyJoint, Field(discriminator="law")]
    """The seized joint."""
    part: Part
    """The part in it."""
    reference: Reference
    """Where the part should be."""
    disturbance: Disturbance = UniformDisturbance()
    """How its friction varies along the way, or as the paper draws it anew in time."""
    actuator: Actuator = IdealActuator()
    """What pushes."""
    sensors: Sensors | None = None
    """What the controller sees through. Left out: ideal sensors."""
    watch: Watch | None = None
    """Stops the controller when its sensors cannot be right. Left out: nothing does."""
    controller: Controller
    """What decides how hard."""
    timing: Timing
    """Duration, sampling and integration."""
    limits: Limits = Limits()
    """Where a run counts as diverged, released, loose, or too rough."""
    trace: Trace = Trace()
    """What is recorded."""
    joint_source: JointSource | None = None
    """Where the joint is from. Left out: from no log."""

    @property
    def samples(self) -> int:
        """Control samples of a run."""
        return round(self.timing.duration_s / self.timing.control_period_s)

    @property
    def steps_per_period(self) -> int:
        """Integration steps in a control period: as stated, or what "auto" stands for."""
        stated = self.timing.steps_per_period
        return int(steps_per_period(self)) if stated == "auto" else stated

    @model_validator(mode="after")
    def _runs_whole_periods(self) -> Self:
        duration, period = self.timing.duration_s, self.timing.control_period_s
        ratio = duration / period
        in_period = self.steps_per_period
        steps = ratio * in_period
        if steps > SAMPLES_MAX:
            raise ValueError(
                f"timing.duration_s: {duration!r} takes {steps:.3g} integration steps, "
                f"{in_period:,} in each timing.control_period_s = {period!r}, more than "
                f"{SAMPLES_MAX:.0e} ({asking_for_most_steps(self)} ask for short ones); shorten "
                "it, or give timing.steps_per_period"
            )
        whole = max(1, round(ratio))
        if abs(ratio - whole) > 1e-6:
            raise ValueError(
                f"timing.duration_s: {duration!r} is not a whole number of "
                f"timing.control_period_s = {period!r}; give {whole * period!r}"
            )
        every = self.trace.every_samples
        if every and ratio / every > ROWS_MAX:
            raise ValueError(
                f"trace.every_samples: {every!r} makes {ratio / every:.3g} rows, more than "
                f"{ROWS_MAX:.0e}; give {int(ratio // ROWS_MAX) + 1} or more"
            )
        return self

    @model_validator(mode="after")
    def _steps_are_short(self) -> Self:
        timing, k_e, m = self.timing, self.joint.stiffness_n_per_m, self.part.mass_kg
        self._check_rk4_has_one_bristle()
        if timing.steps_per_period == "auto" or not isfinite(k_e):
            return self
        step_s = timing.control_period_s / timing.steps_per_period
        longest_s = OF_OSCILLATION * sqrt(m / k_e)
        rule = f"{OF_OSCILLATION:g} sqrt(part.mass_kg / joint.stiffness_n_per_m)"
        if timing.integrator == "rk4":
            longest_s, rule = longest_s / OF_RK4, f"{rule} / {OF_RK4:g}, because rk4 is explicit,"
            damping = self.joint.damping_n_s_per_m
            if damping * longest_s > m:
                longest_s, rule = m / damping, "part.mass_kg / joint.damping_n_s_per_m"
        if step_s > longest_s * (1 + 1e-9):
            ratio = timing.control_period_s / longest_s if longest_s > 0 else float("inf")
            needed = ratio * (1 - 1e-9)
            remedy = f"give {ceil(needed)} or more" if needed <= 1e5 else "sample faster"
            raise ValueError(
                f"timing.steps_per_period: {timing.steps_per_period!r} makes steps of {step_s:.4g} "
                f"s of timing.control_period_s = {timing.control_period_s!r}, not <= {rule} = "
                f"{longest_s:.4g} s, so the bristle is not resolved; {remedy}"
            )
        return self

    def _check_rk4_has_one_bristle(self) -> None:
        if self.timing.integrator == "rk4" and not self.joint.one_bristle:
            raise ValueError(
                f"timing.integrator: 'rk4' does not step joint.law = {self.joint.law!r}; give "
                "'linearly_implicit_midpoint'"
            )

    @model_validator(mode="after")
    def _is_free_near_the_end(self) -> Self:
        tolerance_m, length_m = self.limits.release_tolerance_m, self.joint.engagement_length_m
        if tolerance_m > 0.01 * length_m:
            raise ValueError(
                f"limits.release_tolerance_m: {tolerance_m!r} is not <= a hundredth of "
                f"joint.engagement_length_m = {length_m!r}; give a number <= {0.01 * length_m:.4g}"
            )
        return self

    @model_validator(mode="after")
    def _starts_within_bounds(self) -> Self:
        bound_m = self.limits.diverged_error_m or self.joint.engagement_length_m / 2
        if isinstance(self.reference, StepReference) and self.reference.distance_m > bound_m:
            raise ValueError(
                f"reference.distance_m: a step of {self.reference.distance_m!r} is an error above "
                f"limits.diverged_error_m = {bound_m!r} at once; give a larger bound, or a "
                "reference that moves gradually"
            )
        return self

    @model_validator(mode="after")
    def _tracks_no_faster_than_it_samples(self) -> Self:
        period = self.timing.control_period_s
        for path, pid in pids(self.controller).items():
            if pid.anti_windup == "back_calculation" and pid.tracking_time_s < period * (1 - 1e-9):
                raise ValueError(
                    f"controller.{path}tracking_time_s: {pid.tracking_time_s!r} is not >= "
                    f"timing.control_period_s = {period!r}; back calculation would overshoot; give "
                    "a longer one"
                )
        return self

    @model_validator(mode="after")
    def _actuator_heeds_its_controller(self) -> Self:
        feeds = isinstance(self.controller, SteadyFeed | VibratedFeed)
        if feeds != isinstance(self.actuator, FeedAxis):
            wanted = "feed_axis" if feeds else "ideal, push_only or force"
            raise ValueError(
                f"actuator.kind: {self.actuator.kind!r} cannot do what controller.kind = "
                f"{self.controller.kind!r} asks; give {wanted}"
            )
        tip = self.actuator.tip if isinstance(self.actuator, FeedAxis) else None
        if isinstance(self.controller, VibratedFeed) and not isinstance(tip, Piezo):
            raise ValueError(  # noqa: TRY004 - pydantic turns only this into its own error
                "actuator.tip.kind: 'rigid' cannot do what controller.kind = 'vibrated_feed' "
                "asks; give 'piezo'"
            )
        if self.timing.integrator == "rk4" and isinstance(self.actuator, FeedAxis | ForceActuator):
            raise ValueError(
                f"timing.integrator: 'rk4' does not step an actuator of kind "
                f"{self.actuator.kind!r}; give 'linearly_implicit_midpoint'"
            )
        return self

    @model_validator(mode="after")
    def _holds_at_least_one_period(self) -> Self:
        if self.disturbance.kind == "field":
            return self
        hold, period = self.disturbance.hold_s, self.timing.control_period_s
        if self.disturbance.var > 0.0 and hold < period * (1 - 1e-9):
            raise ValueError(
                f"disturbance.hold_s: {hold!r} is not >= timing.control_period_s = {period!r}; "
                "the joint force is constant over a control period"
            )
        return self

    @model_validator(mode="after")
    def _field_is_not_too_fine(self) -> Self:
        if self.disturbance.kind != "field":
            return self
        length, whole = self.disturbance.correlation_length_m, self.joint.engagement_length_m
        if whole / length > LENGTHS_MAX:
            raise ValueError(
                f"disturbance.correlation_length_m: {length!r} is not >= joint.engagement_length_m "
                f"/ {LENGTHS_MAX:,} = {whole / LENGTHS_MAX:.4g}; give a longer one"
            )
        return self

    @model_validator(mode="after")
    def _vibration_can_be_followed(self) -> Self:
        normal = self.joint.normal_force
        if normal is None:
            return self
        if normal.transverse is not None:
            self._check_law_is_in_plane()
        step_s = self.timing.control_period_s / self.steps_per_period
        for name in ("vibration", "transverse"):
            vibration = getattr(normal, name)
            if vibration is None:
                continue
            fastest_hz = 1.0 / (STEPS_PER_CYCLE * step_s)
            if vibration.frequency_hz > fastest_hz * (1 + 1e-9):
                raise ValueError(
                    f"joint.normal_force.{name}.frequency_hz: {vibration.frequency_hz!r} is not <= "
                    f"{fastest_hz:.4g}, {STEPS_PER_CYCLE} integration steps of {step_s:.4g} s in a "
                    "cycle; raise timing.steps_per_period"
                )
        return self

    def _check_law_is_in_plane(self) -> None:
        if not self.joint.in_plane:
            raise ValueError(
                f"joint.normal_force.transverse: law {self.joint.law!r} does not say what "
                "vibration across the motion does; give joint.law = 'lugre' or 'elasto_plastic'"
            )
        if self.timing.integrator == "rk4":
            raise ValueError(
                "timing.integrator: 'rk4' does not step joint.normal_force.transverse; give "
                "'linearly_implicit_midpoint'"
            )

    @model_validator(mode="after")
    def _samples_its_pulses(self) -> Self:
        controller, where = self.controller, "controller.vibration"
        vibrating = controller.vibration if isinstance(controller, TwoStep) else controller
        if not isinstance(vibrating, FmVibration):
            return self
        if vibrating is not controller:
            where += ".vibration"
        pulses, period = vibrating.vibration, self.timing.control_period_s
        if pulses.frequency_max_hz >= 0.5 / period:
            raise ValueError(
                f"{where}.frequency_max_hz: {pulses.frequency_max_hz!r} is not below "
                f"the Nyquist frequency {0.5 / period:.6g} Hz of timing.control_period_s = "
                f"{period!r}; sample faster or vibrate slower"
            )
        if pulses.pulse_width_s < 2 * period * (1 - 1e-9):
            raise ValueError(
                f"{where}.pulse_width_s: {pulses.pulse_width_s!r} is not >= two "
                f"control periods of {period!r} s; sample faster or widen the pulse"
            )
        return self

    def with_(self, changes: Mapping[str, Any] | None = None, /, **fields: Any) -> Self:  # noqa: ANN401
        """Give a changed copy.

        Parameters
        ----------
        changes : mapping, optional
            Values by dotted path, such as ``{"joint.stiction_n": 900.0}``.
        **fields
            New values of top-level fields: a model replaces the field, a mapping changes the
            keys it names (and replaces the field where it names another law or kind).

        Raises
        ------
        ScenarioError
            The changed scenario is not valid, or a path leads nowhere.

        """
        check_arguments(Scenario.with_, locals(), ScenarioError)
        values = self.model_dump()
        if _is_model(fields.get("joint")):
            values["joint_source"] = None
        for path, value in (changes or {}).items():
            _set_path(values, path, _plain(value))
        for name, value in fields.items():
            values[name] = _merged(values.get(name), _plain(value), replace=_is_model(value))
        return type(self).parse(values)


def _is_model(value: object) -> bool:
    return isinstance(value, BaseModel)


def _plain(value: object) -> object:
    return value.model_dump() if isinstance(value, BaseModel) else value


def _merged(old: object, new: object, *, replace: bool) -> object:
    if replace or not isinstance(old, dict) or not isinstance(new, Mapping):
        return new
    if any(tag in new and new[tag] != old.get(tag) for tag in ("law", "kind")):
        return dict(new)
    return {
        **old,
        **{k: _merged(old.get(k), _plain(v), replace=_is_model(v)) for k, v in new.items()},
    }


def _set_path(values: dict[str, Any], path: str, value: object) -> None:
    *parents, last = path.split(".")
    for depth, name in enumerate(parents):
        inner = values.get(name)
        if not isinstance(inner, dict):
            known = ", ".join(values)
            where = ".".join(parents[: depth + 1])
            raise ScenarioError(f"{where}: is not a table of the scenario; known keys: {known}")
        values = inner
    values[last] = value
