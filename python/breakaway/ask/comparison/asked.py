"""What a comparison asks: the population, the methods, laws and variations, how many parts."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar

import tomli_w
from pydantic import Field, model_validator

from breakaway.ask.comparison.training import refuse_training_parts
from breakaway.ask.studies.base import StudyModel
from breakaway.base.arguments import run_numbers
from breakaway.base.reading import read_toml
from breakaway.base.text import shown
from breakaway.errors import StudyError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.files import load_method, load_population, preset_names
from breakaway.model.scenario.laws import LAWS, Law
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.model import Name
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.variation import VARIATIONS, VariationKind
from breakaway.run.batch.simulation import RUNS_MAX
from breakaway.run.overlay import lay_over
from breakaway.run.trials import Case

AnyName = TypeVar("AnyName", bound=str | Path | Method)

KIND = "comparison"
USUAL_LAWS: tuple[Law, ...] = ("lugre", "elasto_plastic", "gms")
"""Laws that are compared where none are named."""
USUAL_RUNS = 10_000
"""Parts that are tried where no number is given."""


def _own_variation(values: dict[str, Any]) -> list[VariationKind]:
    return [values["population"].variation]


class Asked(StudyModel):
    """A comparison with all its numbers: the same numbers give the same bytes."""

    kind: Literal["comparison"] = "comparison"
    """What this is."""
    population: PartPopulation
    """Where the parts are from."""
    methods: Annotated[list[Method], Field(min_length=1)]
    """Ways to free them, each with a name of its own."""
    laws: list[Law] = Field(default_factory=lambda: list(USUAL_LAWS), min_length=1)
    """Friction laws of their joints; the courses of single parts are shown under the first."""
    variations: Annotated[list[VariationKind], Field(min_length=1)] = Field(
        default_factory=_own_variation
    )
    """How their friction varies; every law is asked with each. Left out: as the population says."""
    runs: Annotated[int, Field(ge=1, lt=RUNS_MAX)] = USUAL_RUNS
    """How many parts each method tries under each law, with each variation."""
    first: Annotated[int, Field(ge=0, lt=2**62)] = 0
    """Number of the first of them."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """Seed of parts, disturbances and noise."""
    baselines: list[Name] = Field(default_factory=list)
    """Names of the methods whose best one the others are measured against. Left out: all."""
    allow_training_parts: bool = False
    """Whether a method may be compared on parts that it was tuned on."""
    runs_per_piece: Annotated[int, Field(ge=1)] = 5000
    """Parts of the population in one piece: many fill the processor's lanes, few lose less work."""

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        names = [method.name for method in self.methods]
        for kind, given in (
            ("methods", names),
            ("laws", self.laws),
            ("variations", self.variations),
            ("baselines", self.baselines),
        ):
            twice = next((name for name in given if list(given).count(name) > 1), None)
            if twice is not None:
                raise ValueError(f"{kind}: {twice!r} is given twice; give each once")
        for name in self.baselines:
            if name not in names:
                raise ValueError(f"baselines: {name!r} is not one of {', '.join(names)}")
        if not self.allow_training_parts:
            refuse_training_parts(self.methods, self.seed, self.numbers)
        return self

    @property
    def numbers(self) -> range:
        """Numbers of the parts that each method tries in each case."""
        return range(self.first, self.first + self.runs)

    @property
    def cases(self) -> list[Case]:
        """Every law with every variation."""
        return [Case(law, variation) for law in self.laws for variation in self.variations]

    @property
    def names(self) -> list[str]:
        """Names of the methods."""
        return [method.name for method in self.methods]

    def toml(self) -> str:
        """Give all it takes to run it again, as TOML that reads back bit for bit."""
        how = "# The whole comparison. Runs again: breakaway compare comparison.toml --out DIR\n\n"
        return how + tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))


def ask(
    population: str | Path | PartPopulation,
    methods: Sequence[str | Path | Method] | str | None = None,
    *,
    joint: str | Path | JointFile | None = None,
    laws: Sequence[str] | str | None = None,
    variations: Sequence[str] | str | None = None,
    runs: int | range | None = None,
    seed: int | None = None,
    baselines: Sequence[str] | str | None = None,
    allow_training_parts: bool | None = None,
) -> Asked:
    """Put a comparison together from names, files and objects.

    A file may hold a population, or a whole comparison as a folder has it; what is given beside
    it counts then instead of what it says.

    Raises
    ------
    StudyError
        A number, a law or a variation is not valid.
    ScenarioError
        There is no such population or method, or it is not valid.

    """
    whole = _whole(population) if isinstance(population, str | Path) else None
    lists = {
        "laws": _listed(laws),
        "variations": _listed(variations),
        "baselines": _listed(baselines),
    }
    allowed = {"allow_training_parts": allow_training_parts}
    given = {**_counted(runs), "seed": seed, **lists, **allowed}
    values: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    for name, known in (("laws", LAWS), ("variations", VARIATIONS)):
        _check_known(name, lists[name] or (), known)
    if whole is not None:
        values = {name: getattr(whole, name) for name in type(whole).model_fields} | values
    elif isinstance(population, PartPopulation):
        values["population"] = population
    else:
        values["population"] = load_population(population)
    if joint is not None:
        values["population"] = lay_over(values["population"], joint)
    if whole is None or methods is not None:
        chosen = preset_names("methods") if methods is None else _listed(methods) or []
        values["methods"] = [m if isinstance(m, Method) else load_method(m) for m in chosen]
    return Asked(**values)


def _counted(runs: int | range | None) -> dict[str, Any]:
    """Give a range of part numbers as a first one and how many; a number stays as it is."""
    if not isinstance(runs, range):
        return {"runs": runs}
    numbers = run_numbers(runs)
    return {"first": numbers.start, "runs": len(numbers)}


def _listed(given: Sequence[AnyName] | AnyName | None) -> list[AnyName] | None:
    """Give a list; one name alone is a list of one."""
    if given is None:
        return None
    return list(given) if isinstance(given, Sequence) and not isinstance(given, str) else [given]


def _check_known(name: str, given: Sequence[str], known: Sequence[str]) -> None:
    for word in given:
        if word not in known:
            near = difflib.get_close_matches(str(word), known, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise StudyError(f"{name}: {shown(word)} is not one of {', '.join(known)}{hint}")


def _whole(source: str | Path) -> Asked | None:
    """Read a file that holds a whole comparison; None where it does not."""
    if isinstance(source, str) and source in preset_names("populations"):
        return None
    try:
        values = read_toml(Path(source))
    except (OSError, ValueError):
        return None  # whoever reads it as a population says what is wrong
    if values.get("kind") != KIND:
        return None
    try:
        return Asked.parse(values)
    except StudyError as error:
        separator = "\n" if "\n" in str(error) else " "
        raise StudyError(f"{source}:{separator}{error}") from None
