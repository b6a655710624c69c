"""What a study of agreement asks: one question under several friction laws."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import combinations
from math import ceil, log2
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from breakaway.ask.studies.agreement_disturbance import (
    LEFT_OUT,
    OWN,
    AskedDisturbance,
    own_disturbance,
    with_disturbance,
)
from breakaway.ask.studies.base import (
    Changes,
    LevelsTable,
    Share,
    StudyBase,
    StudyModel,
    changed,
    known_metrics,
    percent,
)
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.laws import Law, joint_under
from breakaway.model.scenario.model import Name, NotNegative
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.batch.columns import check_paths, with_nominal_controller

USUAL_LAWS: tuple[Law, ...] = ("lugre", "elasto_plastic", "gms", "coulomb_stiction")
"""Laws that are asked where a study names none."""
RELEASED, SMALLEST = "released", "smallest"
"""What is compared beside metrics: how many are released, and the smallest sufficient level."""


class AgreementVariant(StudyModel):
    """One of the variants that are compared under every law."""

    name: Name
    """A name for tables and figures."""
    changes: Changes = Field(default_factory=dict)
    """What is changed in the scenario, by dotted path; all but its friction law and its seed."""

    @model_validator(mode="after")
    def _leaves_the_law_alone(self) -> Self:
        for path in _paths(self.changes):
            if path == "joint.law":
                raise ValueError(
                    "changes: joint.law is the same for all variants; name laws in agreement.laws"
                )
            if path == "seed":
                raise ValueError(
                    "changes: all variants meet the same parts and draws, so they cannot change "
                    "seed; set it in the study"
                )
        return self


class SmallestTable(LevelsTable):
    """The smallest level of a number that frees a part, searched for each part and each variant.

    Each run is bisected by itself, on the assumption that a run freed at one level is freed at
    every higher one.
    """

    until: Literal["released", "loose"] = "released"
    """What counts: that the part is released, or that it has moved by
    limits.breakaway_travel_m."""


class AgreementTable(StudyModel):
    """What is compared, and under which laws."""

    variants: Annotated[list[AgreementVariant], Field(min_length=1)]
    """The variants; each is compared with each other one."""
    laws: Annotated[list[Law], Field(min_length=1)] = Field(
        default_factory=lambda: list(USUAL_LAWS)
    )
    """Friction laws. Levels, stiffness, damping and so on are those of the scenario's joint."""
    numbers: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Numbers of a law's own by its name, such as elastic_share, attraction_n_per_s, elements.
    Left out: those of the scenario's joint, or the usual ones of a population."""
    disturbances: Annotated[list[AskedDisturbance], Field(min_length=1)] | None = None
    """How friction varies; every law is asked with each: by the paper's random factor on the
    joint_force or the friction_level, along the way (field), from part to part (part: the random
    factor on the friction level, held for the whole run), or not at all (none). Their size is the
    scenario's disturbance.var. Left out: as the scenario says."""
    correlation_length_m: Annotated[float, Field(ge=1e-6, le=1.0)] = 1e-3
    """Correlation length of friction along the way, in m; not used where the scenario's own
    disturbance is a field."""
    smallest: SmallestTable | None = None
    """A number whose smallest sufficient level is compared. Metrics are then compared only if the
    study names some."""
    relevant: dict[str, NotNegative] = Field(default_factory=dict)
    """Difference up to which values count as equal, by metric, "released" (a share) or
    "smallest". Left out: 0."""
    confidence: Share = 0.95
    """Confidence of every interval."""

    @model_validator(mode="after")
    def _asks_more_than_one(self) -> Self:
        for name, found in (
            ("laws", self.laws),
            ("disturbances", self.disturbances or []),
            ("variants", [variant.name for variant in self.variants]),
        ):
            twice = next((one for one in found if list(found).count(one) > 1), None)
            if twice is not None:
                raise ValueError(f"{name}: {twice!r} is given twice; give each once")
        if len(self.laws) < 2:
            raise ValueError(f"laws: {self.laws[0]!r} alone cannot disagree; give two or more")
        if len(self.variants) < 2:
            raise ValueError("variants: 1 is not a comparison; give two or more")
        for law in self.numbers:
            if law not in self.laws:
                raise ValueError(
                    f"numbers.{law}: is not one of the laws {', '.join(self.laws)}; add it to "
                    "laws, or leave it out"
                )
        metrics = [name for name in self.relevant if name not in (RELEASED, SMALLEST)]
        known_metrics(metrics, "agreement.relevant")
        return self


class AgreementStudy(StudyBase):
    """The same question under every friction law: which conclusions do not depend on one of them.

    Under every law all variants meet the same parts and draws, and a controller that was designed
    for the scenario's own joint: it does not know the law.

    Examples
    --------
    >>> AgreementStudy(
    ...     scenario="paper_as_computed",
    ...     runs=1,
    ...     agreement=AgreementTable(
    ...         laws=["lugre", "gms"],
    ...         variants=[
    ...             AgreementVariant(name="light"),
    ...             AgreementVariant(name="heavy", changes={"part.mass_kg": 2.0}),
    ...         ],
    ...     ),
    ... ).certain
    True

    """

    kind: Literal["agreement"] = "agreement"
    """The kind of study."""
    agreement: AgreementTable
    """What is compared."""

    @property
    def recorded(self) -> tuple[str, ...]:
        """Metrics that are recorded of each run."""
        asked = self.agreement.smallest
        names = super().recorded if self.compares_metrics else ()
        needed = ("time_to_breakaway_s",) if asked and asked.until == "loose" else ()
        return (*names, *(name for name in needed if name not in names))

    @property
    def shown(self) -> tuple[str, ...]:
        """Metrics that are compared."""
        return super().shown if self.compares_metrics else ()

    @property
    def compares_metrics(self) -> bool:
        """Whether anything is compared beside the smallest sufficient level."""
        return self.agreement.smallest is None or self.metrics is not None

    @cached_property
    def disturbances(self) -> list[str]:
        """How friction varies, one after the other, or that variants differ in it."""
        asked: list[str] = list(self.agreement.disturbances or [])
        own = {own_disturbance(scenario) for scenario in self._changed.values()}
        return asked or (list(own) if len(own) == 1 else [OWN])

    @cached_property
    def scenarios(self) -> dict[tuple[str, str, str], Scenario]:
        """Law, disturbance, and name of a variant -> its scenario."""
        length_m = self.agreement.correlation_length_m
        return {
            (law, disturbance, name): with_disturbance(scenario, disturbance, length_m)
            for name, nominal in self._changed.items()
            for law, scenario in self._under_every_law(nominal)
            for disturbance in self.disturbances
        }

    @property
    def certain(self) -> bool:
        """Whether nothing is drawn, so that one run shows everything."""
        cases = dict.fromkeys(case[:2] for case in self.scenarios)
        return all(certain_under(self, law, disturbance) for law, disturbance in cases)

    @property
    def undisturbed(self) -> bool:
        """Whether no run of any variant is disturbed."""
        return not any(self._is_disturbed(case) for case in self.scenarios)

    @property
    def jolted(self) -> bool:
        """Whether a disturbance multiplies the whole joint force in any variant."""
        return any(
            own_disturbance(scenario) == "joint_force" and self._is_disturbed(case)
            for case, scenario in self.scenarios.items()
        )

    def _is_disturbed(self, case: tuple[str, str, str]) -> bool:
        varied = "disturbance.var" in varied_under(self, *case)
        return varied or self.scenarios[case].disturbance.var > 0.0

    @cached_property
    def _changed(self) -> dict[str, Scenario]:
        """Give the scenario of each variant, its controller designed for its own joint."""
        found: dict[str, Scenario] = {}
        for variant in self.agreement.variants:
            where = f"agreement.variants.{variant.name}.changes"
            scenario = changed(self.base, variant.changes, where) if variant.changes else self.base
            try:
                found[variant.name] = with_nominal_controller(scenario)
            except ScenarioError as error:
                raise StudyError(f"{where}: {error}") from None
        return found

    def _under_every_law(self, nominal: Scenario) -> Iterator[tuple[Law, Scenario]]:
        for law in self.agreement.laws:
            numbers = self.agreement.numbers.get(law, {})
            try:
                joint = joint_under(law, nominal.joint, numbers)
            except ScenarioError as error:
                where = f"agreement.numbers.{law}."
                raise StudyError(where + str(error).replace("\n", f"\n{where}")) from None
            yield law, nominal.with_(joint=joint)

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        self._refuse_what_is_not_fixed()
        self._refuse_twins()
        self._refuse_runs_that_show_nothing()
        if self.agreement.smallest is not None:
            self._refuse_levels_that_are_none(self.agreement.smallest)
        return self

    def _refuse_twins(self) -> None:
        cases = dict.fromkeys(case[:2] for case in self.scenarios)
        names = [variant.name for variant in self.agreement.variants]
        for one, other in combinations(names, 2):
            if all(self.scenarios[*c, one] == self.scenarios[*c, other] for c in cases):
                raise StudyError(
                    f"agreement.variants: {one!r} and {other!r} are the same; change one, or "
                    "leave it out"
                )

    def _refuse_what_is_not_fixed(self) -> None:
        asked = self.agreement
        sought = [] if asked.smallest is None else [asked.smallest.over]
        fixed = {
            **dict.fromkeys(self.vary, "is also in vary; leave one out"),
            **dict.fromkeys(sought, "is sought in agreement.smallest; leave one out"),
        }
        if asked.disturbances is not None:
            also = "is also in agreement.disturbances; leave one out"
            fixed |= {"disturbance.acts_on": also, "disturbance.kind": also}
        for variant in asked.variants:
            for path in _paths(variant.changes):
                if path in fixed:
                    raise StudyError(
                        f"agreement.variants.{variant.name}.changes: {path} {fixed[path]}"
                    )
        if len(self.disturbances) > 1 and self.undisturbed:
            raise StudyError(
                "agreement.disturbances: are all the same, because disturbance.var is 0 in every "
                "variant; give it a value, or leave disturbances out"
            )

    def _refuse_runs_that_show_nothing(self) -> None:
        needed = ceil(1.0 - log2(1.0 - self.agreement.confidence))
        if self.certain and self.runs > 1:
            raise StudyError(
                f"runs: {self.runs} runs of each variant would all be the same, because nothing is "
                f"drawn: {self._why_certain()}; give one of them, or runs = 1"
            )
        if not self.certain and self.runs < needed:
            raise StudyError(
                f"runs: {self.runs} runs cannot show which way differences go at "
                f"{percent(self.agreement.confidence)} confidence, even where all agree; give "
                f"{needed} or more"
            )

    def _why_certain(self) -> str:
        if self.disturbances == ["none"]:
            return "agreement.disturbances is none, and vary names nothing else"
        return "vary is empty and disturbance.var is 0"

    def _refuse_levels_that_are_none(self, asked: SmallestTable) -> None:
        if asked.over in self.vary:
            raise StudyError(
                f"agreement.smallest.over: {asked.over} is also in vary; a number is either "
                "sought or drawn: leave one out"
            )
        for (law, disturbance, name), scenario in self.scenarios.items():
            where = f"({name}, {law})"
            if asked.over in LEFT_OUT.get(disturbance, ()):
                raise StudyError(
                    f"agreement.smallest.over: {asked.over} means nothing where "
                    f"agreement.disturbances has {disturbance!r}; leave one out"
                )
            try:
                check_paths(scenario, {asked.over: None})
            except StudyError as error:
                raise StudyError(f"agreement.smallest.over: {where} {error}") from None
            for end in ("low", "high"):
                level = {asked.over: getattr(asked, end)}
                changed(scenario, level, f"agreement.smallest.{end}: {where}")


def _has(scenario: Scenario, path: str) -> bool:
    try:
        check_paths(scenario, {path: None})
    except StudyError:
        return False
    return True


def varied_under(study: AgreementStudy, law: str, disturbance: str, variant: str) -> list[str]:
    """Give the numbers in ``vary`` that a case has a place for."""
    scenario = study.scenarios[law, disturbance, variant]
    left_out = LEFT_OUT.get(disturbance, ())
    return [path for path in study.vary if path not in left_out and _has(scenario, path)]


def certain_under(study: AgreementStudy, law: str, disturbance: str) -> bool:
    """Whether nothing is drawn for any variant under a law with a disturbance."""
    cases = [(law, disturbance, variant.name) for variant in study.agreement.variants]
    drawn = (varied_under(study, *case) or _is_drawn(study.scenarios[case]) for case in cases)
    return not any(drawn)


def _is_drawn(scenario: Scenario) -> bool:
    """Whether anything is random from run to run."""
    sensors = scenario.sensors
    noise = () if sensors is None else (sensors.position.noise_rms_m, sensors.force.noise_rms_n)
    return scenario.disturbance.var > 0.0 or any(noise)


def _paths(changes: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Give what is changed by dotted path, from tables too."""
    for name, value in changes.items():
        if isinstance(value, Mapping):
            yield from _paths(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}"
