"""Every field of every scenario model, found by walking the models themselves."""

import copy
import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

import pytest
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

import breakaway as bk

# Values with which the examples below run. A new required number that is not here is 1.0 or, where
# that is out of its range, in the middle of it.
TYPICAL = {
    "stiction_n": 450.0,
    "coulomb_n": 360.0,
    "stiffness_n_per_m": 3.6e7,
    "damping_n_s_per_m": 9000.0,
    "engagement_length_m": 0.1,
    "stribeck_velocity_m_per_s": 0.09,
    "distance_m": 1e-4,  # near enough for a step not to diverge
    "velocity_m_per_s": 5e-3,
    "duration_s": 0.01,
    "force_max_n": 1000.0,
    "settling_time_s": 5e-4,
    "kp_n_per_m": 3.1e6,
    "ki_n_per_m_s": 1.3e9,
    "kd_n_s_per_m": 720.0,
    "error_full_scale_m": 1e-3,
    "pulse_width_s": 2e-3,
    "breakaway_travel_m": 2.5e-5,
}


def models_in(annotation):
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in models_in(part)]


def tag_of(model):
    """The field by which a union tells its members apart, with its value."""
    return {
        name: field.default
        for name, field in model.model_fields.items()
        if name in ("law", "kind")
        and get_origin(field.annotation) is Literal
        and len(get_args(field.annotation)) == 1
    }


@functools.cache
def properties_of(model):
    return model.model_json_schema()["properties"]


def example(model):
    """Plain values of a model: its tag and whatever is required."""
    values: dict[str, Any] = tag_of(model)
    schema = properties_of(model)
    for name, field in model.model_fields.items():
        if field.default is not PydanticUndefined or field.default_factory is not None:
            continue
        inner = models_in(field.annotation)
        if inner:
            values[name] = example(inner[0])
        elif name in TYPICAL:
            values[name] = TYPICAL[name]
        elif schema[name]["type"] == "array":
            values[name] = [1.0]
        elif "enum" in schema[name]:
            values[name] = schema[name]["enum"][0]
        elif schema[name]["type"] == "string":
            values[name] = "text"
        else:
            low = schema[name].get("minimum", schema[name].get("exclusiveMinimum", -1.0))
            high = schema[name].get("maximum", schema[name].get("exclusiveMaximum", 3.0 - low))
            number = 1.0 if low < 1.0 < high else (low + high) / 2
            values[name] = int(number) if schema[name]["type"] == "integer" else number
    return values


def paired(scenario):
    """Give what moves a feed a feed axis, and a feed axis what moves it."""
    actuator, controller = (kind_in(scenario, name) for name in ("actuator", "controller"))
    if controller in ("steady_feed", "vibrated_feed"):
        if actuator != "feed_axis":
            tip = example(bk.Piezo) if controller == "vibrated_feed" else {"kind": "rigid"}
            scenario["actuator"] = {**example(bk.FeedAxis), "tip": tip}
    elif actuator == "feed_axis":
        scenario["controller"] = example(bk.SteadyFeed)
    return scenario


def kind_in(scenario, name):
    table = scenario.get(name)
    return table.get("kind") if isinstance(table, dict) else None


@dataclass(frozen=True)
class Site:
    """A field at its place in a scenario."""

    label: str
    path: tuple[str, ...]
    model: type[BaseModel]
    wrap: Callable[[dict], dict]

    @property
    def dotted(self):
        return ".".join(self.path)

    @property
    def name(self):
        return self.path[-1]

    @property
    def field(self):
        return self.model.model_fields[self.name]

    @property
    def schema(self):
        """What the JSON schema says of the field, but for the option of leaving it out."""
        schema = properties_of(self.model)[self.name]
        options = [o for o in schema.get("anyOf", [schema]) if o.get("type") != "null"]
        return options[0]

    def base(self):
        """A valid scenario, as plain values, that has the field's model in it."""
        return self._scenario(example(self.model))

    def with_value(self, value):
        return self._scenario({**example(self.model), self.name: value})

    def without(self):
        values = example(self.model)
        values.pop(self.name, None)
        return self._scenario(values)

    def with_key(self, key, value):
        return self._scenario({**example(self.model), key: value})

    def _scenario(self, values):
        scenario = copy.deepcopy(self.wrap(values))
        return paired(scenario) if self.path[0] in ("actuator", "controller") else scenario


def walk(model=bk.Scenario, path=(), label="", wrap=lambda values: values):
    for name, field in model.model_fields.items():
        yield Site(f"{label}{name}", (*path, name), model, wrap)
        inner = models_in(field.annotation)
        if name in ("drift", "normal_force") and label != "joint[lugre].":
            continue  # the same for all laws
        for member in inner:
            tag = "".join(tag_of(member).values()) if len(inner) > 1 else ""
            yield from walk(
                member,
                (*path, name),
                f"{label}{name}[{tag}]." if tag else f"{label}{name}.",
                lambda values, name=name, model=model, wrap=wrap: wrap(
                    {**example(model), name: values}
                ),
            )


SITES = {site.label: site for site in walk()}


def pytest_generate_tests(metafunc):
    if "site" in metafunc.fixturenames:
        marker = metafunc.definition.get_closest_marker("sites")
        chosen = {k: s for k, s in SITES.items() if marker is None or marker.args[0](s)}
        metafunc.parametrize("site", chosen.values(), ids=chosen.keys())
    if "table" in metafunc.fixturenames:  # one site for every model at every place
        tables = {(site.path[:-1], site.model): site for site in SITES.values()}
        ids = [site.label.rpartition(".")[0] or "scenario" for site in tables.values()]
        metafunc.parametrize("table", tables.values(), ids=ids)


@pytest.fixture(scope="session")
def sites():
    return list(SITES.values())
