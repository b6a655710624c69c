"""What is tuned, over which ranges, on which parts, and what counts as better."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from breakaway.ask.studies.base import ByPath, StudyModel
from breakaway.ask.tuning.numbers import check_number, number_of, with_numbers
from breakaway.ask.tuning.scores import PIEZO_METRICS, SHARES, ScoreKind, score_kind
from breakaway.base.arguments import check_arguments
from breakaway.base.text import LONGEST_NAME, shown
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.actuator import FeedAxis, Piezo
from breakaway.model.scenario.files import load_method, load_population
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.model import Name, Text
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.variation import VariationKind
from breakaway.run.trials import scenario_of

EVALUATIONS_MAX = 10_000
"""Most evaluations of a tuning."""
TUNED_LAST = f"_tuned_{EVALUATIONS_MAX}"
"""The longest that a tuned method has after its name."""
TEST_FIRST, TEST_RUNS = 1_000_000, 1000
"""Unseen parts where a tuning does not say which."""


def _population(given: object) -> object:
    return load_population(given) if isinstance(given, str) else given


def _method(given: object) -> object:
    return load_method(given) if isinstance(given, str) else given


def _lugre() -> list[Law]:
    return ["lugre"]


def _by_path(tables: object, prefix: str = "") -> object:
    """Read ranges by dotted path, from quoted paths or from tables within tables."""
    if not isinstance(tables, Mapping):
        return tables
    found: dict[str, Any] = {}
    for name, table in tables.items():
        inner = isinstance(table, Mapping) and any(
            isinstance(value, Mapping) for value in table.values()
        )
        deeper = _by_path(table, f"{prefix}{name}.") if inner else {f"{prefix}{name}": table}
        found |= deeper if isinstance(deeper, dict) else {}
    return found


def _ranges(tables: object) -> object:
    flat = _by_path(tables)
    return _tables("tune", flat, TunedNumber) if isinstance(flat, Mapping) else flat


def _bounds(tables: object) -> object:
    return _tables("constraints", tables, ScoreBound) if isinstance(tables, Mapping) else tables


def _tables(field: str, tables: Mapping[str, Any], model: type[StudyModel]) -> dict[str, Any]:
    """Read the tables of a field that is keyed by names with dots, with errors that name both."""
    found: dict[str, Any] = {}
    for name, table in tables.items():
        try:
            found[name] = model.parse(table) if isinstance(table, Mapping) else table
        except StudyError as error:
            lines = str(error).split("\n")
            raise StudyError("\n".join(f"{field}.{name}.{line}" for line in lines)) from None
    return found


class TunedNumber(StudyModel):
    """The range over which a number is tuned.

    Examples
    --------
    >>> TunedNumber(low=1e-3, high=2e-2, log=True).log
    True

    """

    low: float
    """Smallest value."""
    high: float
    """Largest value."""
    log: bool = False
    """Whether to search its logarithm evenly: for numbers of unknown magnitude."""

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low: {self.low!r} is not < high = {self.high!r}; swap them")
        if self.log and self.low <= 0.0:
            raise ValueError(f"low: {self.low!r} is not > 0; a logarithmic scale needs that")
        return self


class ScoreBound(StudyModel):
    """What a score must reach, or must not exceed.

    Examples
    --------
    >>> ScoreBound(at_least=0.99).at_least
    0.99

    """

    at_least: float | None = None
    """For shares: the smallest share."""
    at_most: float | None = None
    """For quantiles: the largest value."""


class PartRange(StudyModel):
    """Numbers of parts of a population.

    Examples
    --------
    >>> PartRange(first=1000, runs=500).numbers
    range(1000, 1500)

    """

    first: Annotated[int, Field(ge=0, lt=2**62)]
    """Number of the first part."""
    runs: Annotated[int, Field(ge=1, le=100_000_000)]
    """How many parts."""

    @property
    def numbers(self) -> range:
        """Numbers of all parts."""
        return range(self.first, self.first + self.runs)


def _own_variation(values: dict[str, Any]) -> VariationKind:
    own: VariationKind = values["population"].variation
    return own


class Tuning(StudyModel):
    """A method, the ranges of some of its numbers, and the scores to improve.

    Examples
    --------
    >>> tuning = Tuning(
    ...     population="seized_parts",
    ...     method="steady_feed",
    ...     objectives=["p99_peak_over_breakaway"],
    ...     tune={"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
    ... )
    >>> tuning.laws, tuning.training_runs
    (['lugre'], 256)

    """

    kind: Literal["tune"] = "tune"
    """What this is."""
    name: Name = "tuning"
    """A name for tables and figures."""
    description: Text = ""
    """What the tuning is for."""
    population: Annotated[
        PartPopulation, BeforeValidator(_population, json_schema_input_type=PartPopulation | str)
    ]
    """The parts: the name of a preset, the path of a file (from the tuning's own folder), or its
    tables."""
    method: Annotated[Method, BeforeValidator(_method, json_schema_input_type=Method | str)]
    """What is tuned: the name of a preset, the path of a file (from the tuning's own folder), or
    its tables."""
    laws: Annotated[list[Law], Field(min_length=1)] = Field(default_factory=_lugre)
    """Friction laws of the joints. Every score is that of the law where it is worst."""
    variation: VariationKind = Field(default_factory=_own_variation)
    """How their friction varies. Left out: as the population says."""
    objectives: Annotated[list[Name], Field(min_length=1, max_length=4)]
    """Scores to improve: shares are made large, quantiles of metrics small."""
    constraints: Annotated[dict[str, ScoreBound], BeforeValidator(_bounds)] = Field(
        default_factory=dict
    )
    """What other scores must reach, by their names."""
    tune: Annotated[
        dict[str, TunedNumber],
        BeforeValidator(_ranges, json_schema_input_type=ByPath[TunedNumber]),
        Field(min_length=1, max_length=40),
    ]
    """Ranges of the numbers that are tuned, by dotted path, such as "controller.target_s"."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """Seed of parts, disturbances and noise."""
    training_runs: Annotated[int, Field(ge=1, le=100_000_000)] = 256
    """Parts to tune on: numbers 0 to training_runs - 1."""
    test_runs: PartRange = PartRange(first=TEST_FIRST, runs=TEST_RUNS)
    """Parts that tuning never sees and that the tuned method is scored on."""
    evaluations: Annotated[int, Field(ge=1, le=EVALUATIONS_MAX)] = 100
    """How many methods are tried."""
    sampler_seed: Annotated[int, Field(ge=0, lt=2**32)] = 0
    """Seed of the choice of methods."""
    confidence: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.95
    """Confidence of the intervals."""

    @property
    def training(self) -> range:
        """Numbers of the parts that are tuned on."""
        return range(self.training_runs)

    @cached_property
    def objective_kinds(self) -> tuple[ScoreKind, ...]:
        """What the objectives are of."""
        return tuple(score_kind(name) for name in self.objectives)

    @cached_property
    def kinds(self) -> tuple[ScoreKind, ...]:
        """All that is scored: objectives, constraints and the shares."""
        names = dict.fromkeys([*self.objectives, *self.constraints, *SHARES])
        return tuple(score_kind(name) for name in names)

    @cached_property
    def start(self) -> dict[str, float] | None:
        """The tuned numbers as the method has them, None where they are not all in range."""
        numbers: dict[str, float] = {}
        for path, span in self.tune.items():
            value = number_of(self.method, path)
            if value is None or not span.low <= value <= span.high:
                return None
            numbers[path] = value
        return numbers

    def tuned(self, numbers: Mapping[str, float]) -> Method:
        """Give the method with tuned numbers.

        Parameters
        ----------
        numbers : mapping
            By dotted path.

        Raises
        ------
        ScenarioError
            The numbers do not go together.

        """
        check_arguments(Tuning.tuned, locals(), ScenarioError)
        return with_numbers(self.method, numbers)

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        _check_name(self.method.name)
        _check_parts(self)
        for path, span in self.tune.items():
            check_number(self.method, path, {"low": span.low, "high": span.high})
        _check_scores(self)
        if len(set(self.laws)) < len(self.laws):
            raise StudyError(f"laws: {self.laws!r} names a law twice; name each law once")
        for law in self.laws:
            try:
                asked = (self.population, self.method, law, self.variation)
                scenario_of(*asked, seed=self.seed)
            except ScenarioError as error:
                raise StudyError(
                    f"method: does not fit the population under the law {law}: {error}"
                ) from None
        return self


def _check_name(name: str) -> None:
    """Raise unless a tuned method can have a longer one."""
    most = LONGEST_NAME - len(TUNED_LAST)
    if len(name) > most:
        raise StudyError(
            f"method.name: {shown(name)} has {len(name)} characters; the names of tuned methods "
            f"add {TUNED_LAST[:6]!r} or more to it: give a name of at most {most} characters"
        )


def _check_parts(tuning: Tuning) -> None:
    unseen = tuning.test_runs.numbers
    if unseen.start < tuning.training_runs:
        last = min(unseen.stop, tuning.training_runs) - 1
        raise StudyError(
            f"test_runs.first: {unseen.start} is not >= training_runs = {tuning.training_runs}: "
            f"parts {unseen.start} to {last} would be tuned on and called unseen; give a first "
            f"part >= {tuning.training_runs}"
        )
    known = tuning.method.tuned_among(tuning.seed, unseen)
    if known is not None:
        raise StudyError(
            f"test_runs.first: {unseen.start} takes parts {known.start} to {known.stop - 1}, which "
            f"the method {tuning.method.name!r} was tuned on; give the numbers of parts that it "
            "never saw"
        )


def _check_scores(tuning: Tuning) -> None:
    for i, name in enumerate(tuning.objectives):
        _checked_kind(f"objectives[{i}]", name, tuning.method)
        if tuning.objectives.count(name) > 1:
            raise StudyError(f"objectives: {name!r} is named twice; name each score once")
    for name, bound in tuning.constraints.items():
        kind = _checked_kind(f"constraints.{name}", name, tuning.method)
        key, other = ("at_least", "at_most") if kind.more_is_better else ("at_most", "at_least")
        value = getattr(bound, key)
        if value is None or getattr(bound, other) is not None:
            raise StudyError(f"constraints.{name}: give {key} = a number, and nothing else")
        if kind.more_is_better and not 0.0 < value <= 1.0:
            raise StudyError(
                f"constraints.{name}.at_least: {value!r} is not a share > 0 and <= 1; give one"
            )
        if not kind.more_is_better and value <= 0.0:
            raise StudyError(
                f"constraints.{name}.at_most: {value!r} is not > 0; give such a number"
            )


def _checked_kind(field: str, name: str, method: Method) -> ScoreKind:
    try:
        kind = score_kind(name)
    except StudyError as error:
        raise StudyError(f"{field}: {error}") from None
    if kind.metric in PIEZO_METRICS and not _has_piezo(method):
        raise StudyError(
            f"{field}: {name!r} needs a piezo, which the method does not have; give another score"
        )
    return kind


def _has_piezo(method: Method) -> bool:
    return isinstance(method.actuator, FeedAxis) and isinstance(method.actuator.tip, Piezo)
