"""What every study has: its scenario, what differs from run to run, and what is recorded."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import fields
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field, model_validator

from breakaway.ask.studies.levels import stepped_levels, varied_numbers
from breakaway.base.text import shown
from breakaway.errors import ScenarioError, StudyError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.distribution import Distribution
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.model import Model, Name, Text
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch.columns import check_paths, with_nominal_controller
from breakaway.run.finished import RunMetrics
from breakaway.run.overlay import lay_file_over

METRICS = tuple(field.name for field in fields(RunMetrics))
"""What can be recorded of each run, beside its outcome."""
HEADLINES = ("peak_force_n", "largest_jump_m", "time_to_release_s")
"""Metrics that are shown where a study does not say which."""

Share = Annotated[float, Field(gt=0.0, lt=1.0)]

Value = TypeVar("Value")
ByPath = dict[str, Value | dict[str, Any]]
"""How values by dotted path stand in a file: by quoted paths, or in tables within tables."""


class StudyModel(Model):
    """A table of what is asked; its errors are `StudyError`."""

    if not TYPE_CHECKING:

        def __init__(self, **values: Any) -> None:  # noqa: ANN401 - pydantic checks them
            try:
                super().__init__(**values)
            except ScenarioError as error:
                raise StudyError(str(error)) from None

        __init__.__pydantic_base_init__ = True


def loaded(scenario: object) -> object:
    """Load what is the name of a preset or the path of a file; anything else stays as it is."""
    return load_scenario(scenario) if isinstance(scenario, str) else scenario


def _loaded_joint(joint: object) -> object:
    return JointFile.load(joint) if isinstance(joint, str) else joint


def _as_written(table: dict[str, Any]) -> dict[str, Any]:
    """Give a table as TOML has it, values before tables, so that it reads back as it was."""
    plain = {
        name: value.model_dump(exclude_none=True) if isinstance(value, BaseModel) else value
        for name, value in table.items()
    }
    values = {name: value for name, value in plain.items() if not isinstance(value, dict)}
    tables = {name: _as_written(value) for name, value in plain.items() if isinstance(value, dict)}
    return values | tables


Changes = Annotated[dict[str, Any], AfterValidator(_as_written)]
"""What is changed in a scenario: values by dotted path, or tables."""


def known_metrics(names: list[str], where: str = "metrics") -> list[str]:
    """Give the names back, unless one of them is not a metric or is given twice.

    Raises
    ------
    StudyError
        The message says ``where`` they were given.

    """
    for name in names:
        if name not in METRICS:
            near = difflib.get_close_matches(name, METRICS, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}?" if near else f"give some of {', '.join(METRICS)}"
            raise StudyError(f"{where}: {shown(name)} is not a metric; {hint}")
        if names.count(name) > 1:
            raise StudyError(f"{where}: {name!r} is named twice; name each metric once")
    return names


def _known_metrics(names: list[str]) -> list[str]:
    return known_metrics(names)


class StudyBase(StudyModel):
    """What every study has: a scenario, what differs from run to run, and how many runs."""

    name: Name = "study"
    """A name for tables and figures."""
    description: Text = ""
    """What the study is for."""
    scenario: Annotated[Scenario, BeforeValidator(loaded, json_schema_input_type=Scenario | str)]
    """The scenario: the name of a preset, the path of a file (from the study's own folder), or
    its tables."""
    joint: (
        Annotated[JointFile, BeforeValidator(_loaded_joint, json_schema_input_type=JointFile | str)]
        | None
    ) = None
    """A joint that was identified from a log: the path of its file (from the study's own folder).
    Its values are laid over the scenario, and its draws are added to what differs from part to
    part."""
    changes: Changes = Field(default_factory=dict)
    """What is changed in the scenario, by dotted path, such as "joint.stiction_n"."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None
    """Seed of all random draws. Left out: the scenario's."""
    runs: Annotated[int, Field(ge=1, le=1_000_000_000)]
    """Runs of each point: of a grid, a level, a controller, a variant; base samples of a
    sensitivity study."""
    metrics: Annotated[list[Name], Field(min_length=1), AfterValidator(_known_metrics)] | None = (
        None
    )
    """Metrics that are recorded. Left out: all; tables and figures show the main ones."""
    design: Literal["random", "sobol", "latin_hypercube"] = "random"
    """How the values of what varies are spread."""
    vary: Annotated[
        dict[str, Distribution],
        BeforeValidator(varied_numbers, json_schema_input_type=ByPath[Distribution]),
    ] = Field(default_factory=dict)
    """What differs from part to part: a distribution by dotted path."""
    runs_per_piece: Annotated[int, Field(ge=1, le=1_000_000)] = 8192
    """Runs that are written together. A killed study loses only the piece it was working on."""

    @cached_property
    def base(self) -> Scenario:
        """The scenario with the study's changes and seed."""
        scenario = self.scenario
        if self.joint is not None:
            try:
                scenario = lay_file_over(scenario, self.joint, "joint")
            except ScenarioError as error:
                raise StudyError(str(error)) from None
        if self.changes:
            scenario = changed(scenario, self.changes, "changes")
        return scenario if self.seed is None else scenario.with_(seed=self.seed)

    @property
    def recorded(self) -> tuple[str, ...]:
        """Metrics that are recorded of each run."""
        return METRICS if self.metrics is None else tuple(self.metrics)

    @property
    def shown(self) -> tuple[str, ...]:
        """Metrics that tables and figures show."""
        return HEADLINES if self.metrics is None else tuple(self.metrics)

    @model_validator(mode="before")
    @classmethod
    def _draws_of_the_joint(cls, values: Any) -> Any:  # noqa: ANN401 - pydantic checks them
        """Let the draws of a joint file vary, but where the study says otherwise."""
        if not isinstance(values, dict) or values.get("joint") is None:
            return values
        joint = _loaded_joint(values["joint"])
        if not isinstance(joint, JointFile):
            return values
        drawn = {path: law.model_dump() for path, law in joint.vary().items()}
        given = values.get("changes") or {}
        own = {path: law for path, law in drawn.items() if path not in given}
        return {**values, "joint": joint, "vary": {**own, **(values.get("vary") or {})}}

    @model_validator(mode="after")
    def _varies_numbers_of_the_scenario(self) -> Self:
        try:
            check_paths(with_nominal_controller(self.base), self.vary)
        except StudyError as error:
            raise StudyError(f"vary.{error}") from None
        return self

    def draws(self) -> bool:
        """Whether anything is random from run to run."""
        return bool(self.vary) or self.base.disturbance.var > 0.0

    def refuse_equal_runs(self, swept: Mapping[str, Any]) -> None:
        """Raise a `StudyError` where all runs of a point would be the same."""
        if self.runs > 1 and not self.draws() and "disturbance.var" not in swept:
            raise StudyError(
                f"runs: {self.runs} runs of each point would all be the same, because nothing is "
                "drawn: vary is empty and disturbance.var is 0; give one of them, or runs = 1"
            )


class LevelsTable(StudyModel):
    """A number whose level is searched for, and the levels that may be tried."""

    over: Name
    """The number whose level is searched for, by dotted path, such as "actuator.force_max_n"."""
    low: float
    """Lowest level that is tried."""
    high: float
    """Highest level that is tried."""
    resolution: Annotated[float, Field(gt=0.0)]
    """Distance between levels: low, low + resolution, ..., high."""

    @model_validator(mode="after")
    def _has_levels(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low: {self.low!r} is not < high = {self.high!r}; swap them")
        if self.resolution > (self.high - self.low) * (1 + 1e-9):
            raise ValueError(
                f"resolution: {self.resolution!r} is not <= high - low = "
                f"{self.high - self.low:.6g}; give a smaller one"
            )
        if (self.high - self.low) / self.resolution > 1e6:
            raise ValueError(
                f"resolution: {self.resolution!r} makes more than 1e6 levels; give a larger one"
            )
        return self

    @property
    def levels(self) -> list[float]:
        """The levels, in their order."""
        return stepped_levels(self.low, self.high, self.resolution)


def changed(scenario: Scenario, changes: Mapping[str, Any], where: str) -> Scenario:
    """Give a changed scenario: values by dotted path, or tables by the name of a field.

    Raises
    ------
    StudyError
        The changed scenario is not valid; the message says ``where`` it was changed.

    """
    by_path = {path: value for path, value in changes.items() if "." in path}
    tables = {name: value for name, value in changes.items() if "." not in name}
    try:
        return scenario.with_(by_path, **tables)
    except ScenarioError as error:
        raise StudyError(f"{where}: {error}") from None


def percent(share: float) -> str:
    """Give a share in percent.

    Examples
    --------
    >>> percent(0.95), percent(0.999)
    ('95 %', '99.9 %')

    """
    return f"{100.0 * share:.6g} %"
