"""Every field refuses what it cannot use by name, value, range and remedy, and nothing else.

The fields are found by walking the models (conftest.py), so that a new one is covered at once.
"""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.scenario.conftest import tag_of

import breakaway as bk
from breakaway.base.text import shown
from breakaway.run.resolution import at_steps

NASTY = [
    None,
    True,
    "",
    "no such value",
    b"bytes",
    [],
    [1.0],
    {},
    {"no_such_key": 1},
    1 + 2j,
    float("nan"),
    float("inf"),
    -float("inf"),
    0,
    -0.0,
    -1,
    -1.5,
    5e-324,
    1e-300,
    1e-9,
    0.5,
    3,
    7.25,
    1e9,
    2**63,
    2**64,
    1e300,
    1.7976931348623157e308,
    10**400,
]
PATH = re.compile(r"^[a-z_0-9]+(\.[a-z_0-9]+)*: ")


def fits(site, value):
    """Whether the JSON schema allows the value; None for a table, which has tests of its own."""
    if value is None:
        return "None" in str(site.field.annotation)
    schema = site.schema
    if "enum" in schema or "const" in schema:
        return value in schema.get("enum", [schema.get("const")])
    if schema.get("type") == "string":
        return isinstance(value, str) and len(value) >= schema.get("minLength", 0)
    if schema.get("type") == "boolean":
        return isinstance(value, bool)
    if schema.get("type") not in ("number", "integer"):
        return None
    kinds = int if schema["type"] == "integer" else int | float
    if isinstance(value, bool) or not isinstance(value, kinds):
        return False
    return (
        abs(value) <= 1.7976931348623157e308  # not NaN either
        and value > schema.get("exclusiveMinimum", -math.inf)
        and value >= schema.get("minimum", -math.inf)
        and value < schema.get("exclusiveMaximum", math.inf)
        and value <= schema.get("maximum", math.inf)
    )


def wanted_words(site):
    """What an error must say about the values that the field takes."""
    schema = site.schema
    if "enum" in schema or "const" in schema:
        return [repr(word) for word in schema.get("enum", [schema.get("const")])]
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    words = [f"{sign} {schema[key]:g}" for key, sign in signs.items() if key in schema]
    kinds = {"number": "a number", "integer": "a whole number", "string": "a text"}
    return [*words, kinds.get(schema.get("type"), "")]


def says_what_to_do(line):
    return re.search(r"; \w+|is not one of '", line) is not None


def check_refusal(site, value, message):
    """The field itself is named; or two fields that do not go together, one of them this one."""
    lines = message.splitlines()
    assert all(PATH.match(line) or "is not a known key" in line for line in lines), message
    assert all(says_what_to_do(line) for line in lines), message
    own = [line for line in lines if line.startswith((f"{site.dotted}:", f"{site.dotted}."))]
    if fits(site, value) is False:
        assert len(own) == len(lines) == 1, message
        assert shown(value) in message or shown(str(value)) in message, message
        for words in wanted_words(site):
            assert words in message, message
    elif fits(site, value) is None:  # a table: it, or a key in it, is wrong or missing
        assert own, message
        assert shown(value) in message or "is missing" in message or "known key" in message, message
    else:
        assert site.name in message or repr(float(value)) in message, message


def shortened(scenario):
    short = scenario.with_(
        {
            "timing.duration_s": min(scenario.samples, 20) * scenario.timing.control_period_s,
            "trace.every_samples": 1,
        }
    )
    return at_steps(short, min(short.steps_per_period, 4))


def try_value(site, value):
    """Parse, and where that goes, run; any error but a proper `ScenarioError` fails the test."""
    try:
        scenario = bk.Scenario.parse(site.with_value(value))
    except bk.ScenarioError as error:
        check_refusal(site, value, str(error))
        return
    assert fits(site, value) is not False, f"{site.label} = {value!r} should be refused"
    try:
        run = bk.simulate(shortened(scenario))
    except bk.ScenarioError as error:
        message = str(error)
    else:
        assert run.metrics.simulated_s <= scenario.timing.duration_s * (1 + 1e-9)
        return
    # A design that has no gains: whatever it names, by its whole path.
    assert PATH.match(message), message
    assert "." in message.partition(":")[0], message


def test_the_walk_reaches_all_unions_and_depths(sites):
    labels = {site.label for site in sites}
    assert {
        "seed",
        "joint[lugre].stribeck_velocity_m_per_s",
        "joint[two_region].coulomb_n",
        "reference[trapezoidal_velocity].acceleration_m_per_s2",
        "controller[two_step].breakaway[pid].gains[pole_placement].static_share",
        "controller[two_step].vibration[timed_impacts].lead_max_s",
        "controller[fm_vibration].vibration.pulse_width_s",
        "limits.peak_force_max_n",
    } <= labels


def test_examples_are_valid_and_run(table):
    run = bk.simulate(shortened(bk.Scenario.parse(table.base())))
    assert run.trace["t_s"].size > 1


@pytest.mark.slow
def test_nasty_values(site):
    for value in NASTY:
        try_value(site, value)


NUMBERS = st.floats() | st.integers() | st.floats(1e-9, 1e9) | st.integers(-5, 5)
VALUES = (
    NUMBERS
    | st.text()
    | st.booleans()
    | st.none()
    | st.lists(NUMBERS, max_size=2)
    | st.dictionaries(st.text("ab. ", max_size=3), NUMBERS, max_size=2)
)


@pytest.mark.slow
def test_arbitrary_values(sites):
    @settings(max_examples=300)
    @given(site=st.sampled_from(sites), value=VALUES)
    def run(site, value):
        try_value(site, value)

    run()


@pytest.mark.slow
def test_a_missing_field_is_named_or_has_a_default(site):
    values = site.without()
    if not site.field.is_required() and site.name not in ("law", "kind"):
        bk.Scenario.parse(values)
        return
    try:
        bk.Scenario.parse(values)
    except bk.ScenarioError as error:
        message = str(error)
        assert message.startswith(f"{site.dotted}: is missing; "), message
        assert len(message.splitlines()) == 1, message
    else:  # no union here, so that the tag may be left out
        assert not site.field.is_required()


def test_an_unknown_key_is_refused_at_every_level(table):
    for key in ("zzzz_no_such", "", "__class__", "law_"):
        where = ".".join([*table.path[:-1], key])
        with pytest.raises(bk.ScenarioError) as caught:
            bk.Scenario.parse(table.with_key(key, 1.0))
        message = str(caught.value)
        assert message.startswith(f"{where}: is not a known key; "), message
    with pytest.raises(bk.ScenarioError, match="known keys: ") as caught:
        bk.Scenario.parse(table.with_key("zzzz_no_such", 1.0))
    for name in table.model.model_fields:
        assert name in str(caught.value)


@pytest.mark.slow
@pytest.mark.sites(lambda site: len(site.name) >= 4)  # a shorter name is near nothing
def test_a_misspelled_key_is_refused_with_the_nearest_name(site):
    typo = site.name[:2] + site.name[3:]  # a letter is missing
    with pytest.raises(bk.ScenarioError) as caught:
        bk.Scenario.parse(site.with_key(typo, 1.0))
    where = ".".join([*site.path[:-1], typo])
    expected = f"{where}: is not a known key; did you mean {site.name}?"
    assert str(caught.value).startswith(expected)


@pytest.mark.sites(
    lambda site: (
        site.name in ("law", "kind") and "[" in site.label and site.name in tag_of(site.model)
    )
)
def test_a_wrong_kind_is_refused_with_the_nearest(site):
    right = site.field.default
    with pytest.raises(bk.ScenarioError) as caught:
        bk.Scenario.parse(site.with_value(right + "x"))
    message = str(caught.value)
    assert message.startswith(f"{site.dotted}: '{right}x' is not one of "), message
    assert message.endswith(f"; did you mean {right!r}?"), message


@pytest.mark.slow
def test_models_alone_refuse_the_same(site):
    """A model that is built on its own names its own fields."""
    values = dict(site.base())
    for key in site.path[:-1]:
        values = values[key]
    values[site.name] = object
    with pytest.raises(bk.ScenarioError) as caught:
        site.model(**values)
    assert str(caught.value).startswith((f"{site.name}: ", f"{site.name}.")), caught.value


def test_several_errors_come_at_once():
    scenario = bk.load_scenario("paper_as_computed")
    with pytest.raises(bk.ScenarioError) as caught:
        scenario.with_(
            {
                "joint.stiction_n": -1.0,
                "part.mass_kg": "heavy",
                "controller.gains.damping_ratio": 0.0,
                "timing.control_perod_s": 1e-5,
            }
        )
    starts = [line.partition(":")[0] for line in str(caught.value).splitlines()]
    assert sorted(starts) == [
        "controller.gains.damping_ratio",
        "joint.stiction_n",
        "part.mass_kg",
        "timing.control_perod_s",
    ]


def test_models_do_not_change():
    scenario = bk.load_scenario("paper_as_computed")
    for model, name in ((scenario, "seed"), (scenario.joint, "stiction_n")):
        with pytest.raises(Exception, match="frozen"):
            setattr(model, name, 1)
