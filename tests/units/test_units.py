"""Every name of a number states its unit, and there is one table of them."""

from __future__ import annotations

import ast
import inspect
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from tests.export.kinds import LOOPS, PLANTS

import breakaway as bk
from breakaway.export.interface import FLOW
from breakaway.export.recording import record
from breakaway.model.scenario.model import holds_number
from breakaway.model.units import UNITS, Unit, unit_of, unit_with, without_unit
from breakaway.run.finished import RunMetrics

ATOMS = {
    "n": {"kg": 1, "m": 1, "s": -2},
    "m": {"m": 1},
    "m2": {"m": 2},
    "s": {"s": 1},
    "s2": {"s": 2},
    "kg": {"kg": 1},
    "hz": {"s": -1},
    "pa": {"kg": 1, "m": -1, "s": -2},
    "j": {"kg": 1, "m": 2, "s": -2},
    "w": {"kg": 1, "m": 2, "s": -3},
    "a": {"A": 1},
    "v": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "f": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "rad": {"rad": 1},
    "degc": {"K": 1},
    "k": {"K": 1},
    "percent": {},
}
"""Words of names -> exponents of the base units they mean."""
COUNTS = {"1", "%"}
"""Units of plain numbers."""
EITHER = "Multiple.times"
"""A multiple of a length whose unit is that of the number it becomes."""


def meant(name: str) -> dict[str, int]:
    """The base units of a name, read word by word: ``n_s_per_m`` is N times s over m."""
    words = [part for part in name.split(".") if not part.isdigit()][-1].split("_")[1:]
    over: list[str] = []
    if "per" in words and all(word in ATOMS for word in words[words.index("per") + 1 :]):
        at = words.index("per")
        words, over = words[:at], words[at + 1 :]
    times: list[str] = []
    while words and words[-1] in ATOMS:
        times.append(words.pop())
    exponents: Counter[str] = Counter()
    for sign, atoms in ((1, times), (-1, over)):
        for atom in atoms:
            for base, power in ATOMS[atom].items():
                exponents[base] += sign * power
    return {base: power for base, power in exponents.items() if power}


def models_of(model: type[BaseModel], seen: set[type[BaseModel]]) -> set[type[BaseModel]]:
    """A model, and all that are in it, of all unions."""
    if model not in seen:
        seen.add(model)
        for field in model.model_fields.values():
            for inner in named_in(field.annotation):
                models_of(inner, seen)
    return seen


def named_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in getattr(annotation, "__args__", ()):
        yield from named_in(part)


def numbers() -> dict[str, FieldInfo]:
    """Every number of every model, by its model's name and its own."""
    models: set[type[BaseModel]] = set()
    for root in (bk.Scenario, bk.Method, bk.PartPopulation):
        models_of(root, models)
    return {
        f"{model.__name__}.{name}": field
        for model in sorted(models, key=lambda one: one.__name__)
        for name, field in model.model_fields.items()
        if field.annotation is int or holds_number(field.annotation)
    }


NUMBERS = numbers()


def metric_texts() -> dict[str, str]:
    """What the source says of each metric."""
    [found] = ast.parse(inspect.getsource(RunMetrics)).body
    assert isinstance(found, ast.ClassDef)
    texts = {}
    for field, text in zip(found.body, found.body[1:], strict=False):
        if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr):
            assert isinstance(field.target, ast.Name) and isinstance(text.value, ast.Constant)
            texts[field.target.id] = " ".join(str(text.value.value).split())
    return texts


def test_the_walk_finds_every_kind() -> None:
    for known in ("Gms.attraction_n_per_s", "ForceRamp.rate_n_per_s", "Piezo.capacitance_f"):
        assert known in NUMBERS
    assert {"PartPopulation.duration_s", "Gentleness.jump_max_m"} <= set(NUMBERS)
    assert len(NUMBERS) > 150


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_has_the_unit_of_its_name_and_of_its_description(name: str) -> None:
    unit = unit_of(name)
    assert unit.base == meant(name)
    assert (unit.symbol in COUNTS) == (not unit.base)
    described = " ".join((NUMBERS[name].description or "").split())
    symbols = "|".join(re.escape(one.symbol) for one in UNITS.values())
    told = re.findall(rf"\bin ({symbols})(?=[.,;: )]|$)", described)
    assert set(told) <= {unit.symbol} or name == EITHER
    assert told or unit.symbol == "1", described


@pytest.mark.parametrize(("name", "text"), metric_texts().items())
def test_a_metric_has_the_unit_of_its_name_and_of_its_description(name: str, text: str) -> None:
    unit = unit_of(name)
    assert unit.base == meant(name)
    if unit.symbol != "1":
        assert re.search(rf"\b{re.escape(unit.symbol)}(?=[.;:,]|$)", text), text


def test_every_metric_is_looked_at() -> None:
    assert list(metric_texts()) == list(RunMetrics.__dataclass_fields__)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plain", "axis_stack_sensed"])
def test_columns_of_a_trace(name: str) -> None:
    run = bk.simulate(PLANTS[name].with_({"trace.every_samples": 1}))
    data = run.to_xarray()
    assert set(run.trace) - {"t_s"} == set(data.data_vars)
    for column in ("t_s", *data.data_vars):
        assert unit_with(data[column].attrs["units"]).base == meant(str(column)) != {}


@pytest.mark.parametrize("name", LOOPS)
def test_numbers_of_exported_code(name: str) -> None:
    recording = record(bk.resolve(LOOPS[name]), "loop", "double")
    variables = [*recording.parameters, *recording.states, *recording.outputs]
    assert len(variables) > 20
    for one in variables:
        assert unit_with(one.unit).base == meant(one.path), one.path


def test_what_flows_in_and_out_of_exported_code() -> None:
    for names in FLOW.values():
        for name in names:
            assert unit_of(name).base == meant(name)


@pytest.mark.parametrize(("ending", "unit"), UNITS.items())
def test_a_symbol_its_ending_and_its_base_units_agree(ending: str, unit: Unit) -> None:
    assert unit.base == meant(f"name_{ending}")
    numerator, _, denominator = unit.symbol.partition("/")
    spelled = re.findall(r"[A-Za-z%]+", numerator) + re.findall(r"[A-Za-z]+", denominator)
    assert [word.lower().replace("%", "percent") for word in spelled] == [
        word.rstrip("2") for word in ending.split("_") if word != "per"
    ]
    assert unit_with(unit.symbol) == unit
    assert without_unit(f"joint.name_{ending}") == "joint.name"


def test_the_rate_of_a_force_ramp() -> None:
    """It ends with per_s, and is no mere rate."""
    path = "controller.rate_n_per_s"
    batch = bk.simulate_many(LOOPS["ramp"], 2, vary={path: np.array([1e6, 2e6])})
    assert batch.to_arrow().schema.field(path).metadata == {b"unit": b"N/s"}
    assert batch.to_xarray()[path].attrs["units"] == "N/s"


def test_columns_of_a_batch() -> None:
    """Every number of a scenario that may differ from run to run, and every metric."""
    scenario = PLANTS["axis_stack_sensed"]
    paths = ["joint.stiction_n", "actuator.tip.capacitance_f", "actuator.acceleration_max_m_per_s2"]
    values = {path: value_at(scenario, path) for path in paths}
    batch = bk.simulate_many(scenario, 1, vary={path: [v] for path, v in values.items()})
    for name, column in batch.to_xarray().data_vars.items():
        assert unit_with(column.attrs["units"]).base == meant(str(name)), name


def value_at(scenario: bk.Scenario, path: str) -> float:
    value: Any = scenario
    for name in path.split("."):
        value = getattr(value, name)
    return float(value)


@pytest.mark.parametrize("name", ["impacts", "steps_per_period", "rise_per_slip", "n", "", "1.2"])
def test_names_without_a_unit(name: str) -> None:
    assert unit_of(name).symbol == "1"
    assert without_unit(name) == name


def test_prefixes_that_nobody_uses() -> None:
    assert unit_of("duration_s").power_of(7200.0) == 0
    assert unit_of("mass_kg").power_of(1e-3) == 0
    assert unit_of("force_n").power_of(1e15) == 9
    assert unit_of("travel_m").power_of(1e-15) == -9
