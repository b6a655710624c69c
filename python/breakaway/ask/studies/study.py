"""What a study asks, and the checks that it does not contradict itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, TypeAdapter, model_validator

from breakaway.ask.studies.agreement_study import AgreementStudy
from breakaway.ask.studies.base import (
    ByPath,
    Changes,
    LevelsTable,
    Share,
    StudyBase,
    StudyModel,
    changed,
    loaded,
    percent,
)
from breakaway.ask.studies.levels import Level, grid_levels
from breakaway.ask.studies.statistics import runs_needed
from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.distribution import Samples
from breakaway.model.scenario.model import Name
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch.columns import check_paths, with_nominal_controller

PART_SCALE = "part_scale"
"""What stands for the scale of all that differs from part to part."""

Failure = Literal["diverged", "not_released", "limit_exceeded"]
FAILURES: tuple[Failure, ...] = ("diverged", "not_released", "limit_exceeded")


class SweepTable(StudyModel):
    """What a sweep goes through."""

    grid: Annotated[
        dict[str, list[Level]],
        BeforeValidator(grid_levels, json_schema_input_type=ByPath[list[Level]]),
    ] = Field(default_factory=dict)
    """Values by dotted path, as a list or as {from, to, count, spacing = "linear" | "log"}; every
    combination is a point. Left out: one point."""
    confidence: Share = 0.95
    """Confidence of the intervals of the outcomes' probabilities."""


class SweepStudy(StudyBase):
    """What happens to the extraction over a grid of values, or over many parts.

    Every point of the grid is a scenario of its own: what it leaves open, such as gains by pole
    placement, is designed for it. All points have the same run numbers, and so the same draws.

    Examples
    --------
    >>> import breakaway as bk
    >>> study = SweepStudy(
    ...     scenario="paper_as_computed",
    ...     runs=100,
    ...     sweep=SweepTable(grid={"disturbance.var": [0.0, 0.1, 0.2]}),
    ... )
    >>> study.kind, study.sweep.grid
    ('sweep', {'disturbance.var': [0.0, 0.1, 0.2]})

    """

    kind: Literal["sweep"] = "sweep"
    """The kind of study."""
    sweep: SweepTable = SweepTable()
    """What it goes through."""

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        grid = self.sweep.grid
        both = sorted(set(grid) & set(self.vary))
        if both:
            raise StudyError(
                f"sweep.grid.{both[0]}: is also in vary; a number is either swept or drawn: "
                "leave one out"
            )
        if not grid and not self.draws():
            raise StudyError(
                "sweep.grid: is empty, so is vary, and disturbance.var is 0: nothing differs; give "
                "values to sweep, or distributions"
            )
        self.refuse_equal_runs(grid)
        return self


class RobustnessTable(LevelsTable):
    """The levels that are searched, and what counts as survived."""

    over: Name
    """The number whose largest survived level is searched for, by dotted path, such as
    "disturbance.var"; or "part_scale", which multiplies the spread of everything in vary, within
    its low and high."""
    failure: list[Failure] = Field(default_factory=lambda: list(FAILURES), min_length=1)
    """Outcomes that count as failure."""
    failure_probability_max: Share
    """A level is survived where the failure probability is shown to be at most this."""
    confidence: Share = 0.95
    """Confidence of that: of the one-sided bound of Clopper and Pearson."""

    @model_validator(mode="after")
    def _is_survived_or_not(self) -> Self:
        if len(set(self.failure)) < len(self.failure):
            raise ValueError(f"failure: {self.failure!r} names an outcome twice; name each once")
        if self.over == PART_SCALE and self.low <= 0.0:
            raise ValueError(f"low: {self.low!r} is not > 0; parts need some spread")
        return self


class RobustnessStudy(StudyBase):
    """The largest level of a number that is survived, by bisection.

    Every level has the same run numbers, and so the same draws, and meets the same controller,
    designed for the scenario as it stands.

    Examples
    --------
    >>> RobustnessStudy(
    ...     scenario="paper_as_computed",
    ...     runs=1000,
    ...     robustness=RobustnessTable(
    ...         over="disturbance.var",
    ...         low=0.05, high=0.9, resolution=0.05, failure_probability_max=0.001,
    ...     ),
    ... )
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: runs: 1000 runs cannot show a failure probability <= 0.001 ...

    """

    kind: Literal["robustness"] = "robustness"
    """The kind of study."""
    robustness: RobustnessTable
    """What is sought."""

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        asked = self.robustness
        needed = runs_needed(asked.failure_probability_max, asked.confidence)
        if self.runs < needed:
            raise StudyError(
                f"runs: {self.runs} runs cannot show a failure probability <= "
                f"{asked.failure_probability_max:g} at {percent(asked.confidence)} confidence, "
                f"even without any failure; give {needed} or more"
            )
        if asked.over == PART_SCALE:
            if not self.vary:
                raise StudyError(
                    "robustness.over: is 'part_scale', but vary is empty; give distributions"
                )
            self._refuse_to_leave_ranges()
        else:
            self._refuse_levels_that_are_none()
        return self

    def _refuse_to_leave_ranges(self) -> None:
        for path, law in self.vary.items():
            try:
                law.scaled(self.robustness.high)
            except ScenarioError as error:
                raise StudyError(f"robustness.high: vary.{path}: {error}") from None

    def _refuse_levels_that_are_none(self) -> None:
        asked, path = self.robustness, self.robustness.over
        if path in self.vary:
            raise StudyError(
                f"robustness.over: {path} is also in vary; a number is either sought or drawn: "
                "leave one out"
            )
        try:
            check_paths(with_nominal_controller(self.base), {path: None})
        except StudyError as error:
            raise StudyError(f"robustness.over: {error}; or part_scale") from None
        self.refuse_equal_runs({path: None})
        for name in ("low", "high"):
            changed(self.base, {path: getattr(asked, name)}, f"robustness.{name}")


class SensitivityTable(StudyModel):
    """How a sensitivity study is judged."""

    confidence: Share = 0.95
    """Confidence of the intervals of the indices."""


class SensitivityStudy(StudyBase):
    """Which of the numbers that differ from part to part matter: Sobol indices.

    The draws of the disturbance count as one more input, so that the index of a number is not
    blurred by them.

    Examples
    --------
    >>> import breakaway as bk
    >>> SensitivityStudy(
    ...     scenario="paper_as_computed", runs=100,
    ...     vary={"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)},
    ... )
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: runs: 100 is not a power of 2 ... give 64 or 128

    """

    kind: Literal["sensitivity"] = "sensitivity"
    """The kind of study."""
    sensitivity: SensitivityTable = SensitivityTable()
    """How it is judged."""

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        if not self.vary:
            raise StudyError("vary: is empty; give a distribution for each number to compare")
        if self.runs & (self.runs - 1) or self.runs < 8:
            below = max(8, 1 << (self.runs.bit_length() - 1))
            raise StudyError(
                f"runs: {self.runs} is not a power of 2 and >= 8; Sobol samples are balanced "
                f"only then: give {below} or {2 * below}"
            )
        if self.runs > 2**17:
            raise StudyError(f"runs: {self.runs} base samples are not <= {2**17}; give fewer")
        if self.design != "random":
            raise StudyError(
                f"design: {self.design!r} does not apply here; Sobol indices have their own "
                "design: leave it out"
            )
        for path, distribution in self.vary.items():
            if isinstance(distribution, Samples) and distribution.rows == "shared":
                raise StudyError(
                    f"vary.{path}.rows: 'shared' ties numbers to each other; Sobol indices assume "
                    "independent ones: give 'independent'"
                )
        return self


class ComparedController(StudyModel):
    """One of the controllers that are compared."""

    name: Name
    """A name for tables and figures."""
    scenario: (
        Annotated[Scenario, BeforeValidator(loaded, json_schema_input_type=Scenario | str)] | None
    ) = None
    """A scenario whose controller and actuator are taken; gains that it leaves open are designed
    for the study's scenario. Left out: those of the study's scenario."""
    changes: Changes = Field(default_factory=dict)
    """What is changed in the controller, the actuator, the reference or the timing."""

    @model_validator(mode="after")
    def _leaves_the_part_alone(self) -> Self:
        allowed = ("controller", "actuator", "reference", "timing")
        for path in self.changes:
            if path.split(".")[0] not in allowed:
                raise ValueError(
                    f"changes: {path} is not one of {', '.join(allowed)}; all controllers meet the "
                    "same parts: change it in the study's own changes"
                )
        return self

    def applied_to(self, base: Scenario) -> Scenario:
        """Give the scenario with this controller in it.

        Parameters
        ----------
        base : Scenario
            The study's scenario; it does not change.

        Raises
        ------
        StudyError
            The controller does not fit the scenario.

        """
        check_arguments(ComparedController.applied_to, locals(), StudyError)
        if self.scenario is not None:
            taken = {"controller": self.scenario.controller, "actuator": self.scenario.actuator}
            try:
                base = base.with_(**taken)
            except ScenarioError as error:
                raise StudyError(f"compare.controllers.{self.name}.scenario: {error}") from None
        where = f"compare.controllers.{self.name}.changes"
        return changed(base, self.changes, where) if self.changes else base


class CompareTable(StudyModel):
    """What is compared."""

    controllers: Annotated[list[ComparedController], Field(min_length=1)]
    """The controllers; the others are compared with the first."""
    confidence: Share = 0.95
    """Confidence of every interval."""


class CompareStudy(StudyBase):
    """Controllers on the same parts and with the same draws, compared run by run.

    Examples
    --------
    >>> CompareStudy(
    ...     scenario="paper_as_computed",
    ...     runs=100,
    ...     changes={"disturbance.var": 0.1},
    ...     compare=CompareTable(controllers=[ComparedController(name="alone")]),
    ... )
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: compare.controllers: 1 is not a comparison; give two or more

    """

    kind: Literal["compare"] = "compare"
    """The kind of study."""
    compare: CompareTable
    """What is compared."""

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        controllers = self.compare.controllers
        if len(controllers) < 2:
            raise StudyError("compare.controllers: 1 is not a comparison; give two or more")
        seen: dict[str, Scenario] = {}
        for controller in controllers:
            if controller.name in seen:
                raise StudyError(
                    f"compare.controllers: two are named {controller.name!r}; give each a name of "
                    "its own"
                )
            scenario = controller.applied_to(self.base)
            twin = next((name for name, other in seen.items() if other == scenario), None)
            if twin is not None:
                raise StudyError(
                    f"compare.controllers: {twin!r} and {controller.name!r} are the same; change "
                    "one, or leave it out"
                )
            seen[controller.name] = scenario
        self.refuse_equal_runs({})
        return self


Study = SweepStudy | RobustnessStudy | SensitivityStudy | CompareStudy | AgreementStudy

KINDS: dict[str, type[Study]] = {
    "sweep": SweepStudy,
    "robustness": RobustnessStudy,
    "sensitivity": SensitivityStudy,
    "compare": CompareStudy,
    "agreement": AgreementStudy,
}
"""Kind of a study -> its model."""


def study_schema() -> dict[str, Any]:
    """The JSON Schema of a study of any kind, as it stands in a file.

    Examples
    --------
    >>> sorted(study_schema()["discriminator"]["mapping"]) == sorted(KINDS)
    True

    """
    any_kind: TypeAdapter[Study] = TypeAdapter(Annotated[Study, Field(discriminator="kind")])
    return any_kind.json_schema()
