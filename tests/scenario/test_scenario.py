"""Scenarios as wholes: changed copies, files, presets, resolution, checks across fields."""

import math
import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import breakaway as bk
from breakaway.model.scenario import parse_scenario, scenario_toml

GIVEN = bk.Gains(kp_n_per_m=1e6, ki_n_per_m_s=1e8, kd_n_s_per_m=2500.0)
PULSES = bk.FmPulses(error_full_scale_m=1e-3, pulse_width_s=2e-3)


@pytest.fixture(scope="module")
def paper():
    return bk.load_scenario("paper_as_computed")


@pytest.fixture(scope="module")
def vibrating(paper):
    pid = bk.PidSettings(gains=GIVEN)
    return paper.with_(controller=bk.FmVibration(pid=pid, vibration=PULSES))


# with_


def test_with_changes_a_copy(paper):
    before = paper.model_dump()
    changed = paper.with_({"joint.stiction_n": 900.0, "timing.steps_per_period": 2}, seed=7)
    assert (changed.joint.stiction_n, changed.timing.steps_per_period, changed.seed) == (900, 2, 7)
    assert paper.model_dump() == before
    untouched = {"seed": 0, "joint": before["joint"], "timing": before["timing"]}
    assert changed.model_dump() | untouched == before


def test_with_nothing_is_equal(paper):
    assert paper.with_() == paper
    assert paper.with_({}) == paper


def test_with_a_mapping_changes_the_keys_it_names(paper):
    changed = paper.with_(joint={"stiction_n": 900.0}, controller={"gains": {"pole_per_s": 100.0}})
    assert changed.joint == paper.joint.model_copy(update={"stiction_n": 900.0})
    assert changed.controller.gains.pole_per_s == 100.0
    assert changed.controller.gains.settling_time_s == paper.controller.gains.settling_time_s


def test_with_a_model_replaces(paper):
    disturbance = bk.UniformDisturbance(var=0.05, hold_s=2e-4)
    once = paper.with_(disturbance=disturbance)
    assert once.disturbance == disturbance
    assert once.with_(disturbance=bk.UniformDisturbance(var=0.1)).disturbance.hold_s == 1e-4
    inside = paper.with_(controller={"gains": GIVEN})
    assert inside.controller.gains == GIVEN
    assert inside.with_({"controller.gains": GIVEN}) == inside


def test_with_another_kind_replaces(paper):
    two_region = {
        "law": "two_region",
        "stiction_n": 450.0,
        "coulomb_n": 360.0,
        "stiffness_n_per_m": 3.6e7,
        "damping_n_s_per_m": 9000.0,
        "engagement_length_m": 0.1,
    }
    assert paper.with_(joint=two_region).joint == bk.TwoRegion(**two_region)
    step = paper.with_(reference={"kind": "step", "distance_m": 0.05})
    assert step.reference == bk.StepReference(distance_m=0.05)
    limited = paper.with_(actuator={"kind": "push_only", "force_max_n": 500.0})
    assert limited.actuator == bk.PushOnlyActuator(force_max_n=500.0)
    assert limited.with_(actuator={"kind": "push_only"}) == limited  # the same kind: merged
    assert limited.with_(actuator={"kind": "ideal"}) == paper
    # A nested kind replaces only the table that it is in.
    given_gains = paper.with_(controller={"gains": GIVEN.model_dump()})
    assert given_gains.controller.gains == GIVEN


def test_with_a_new_kind_by_path_leaves_keys_that_it_does_not_know(paper):
    with pytest.raises(bk.ScenarioError, match=r"^joint\.viscous_n_s_per_m: is not a known key"):
        paper.with_({"joint.law": "two_region"})


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("jont.stiction_n", r"^jont: is not a table of the scenario; known keys: name, .*joint"),
        ("joint.stiction_n.more", r"^joint\.stiction_n: is not a table .*known keys: .*stiction_n"),
        ("joint.stction_n", r"^joint\.stction_n: is not a known key; did you mean stiction_n\?"),
        ("sed", r"^sed: is not a known key; did you mean seed\?"),
        ("", r"^: is not a known key; known keys: name,"),
        ("joint.", r"^joint\.: is not a known key; known keys:"),
        (".joint", r"^: is not a table of the scenario"),
    ],
)
def test_with_a_path_that_leads_nowhere(paper, path, message):
    with pytest.raises(bk.ScenarioError, match=message):
        paper.with_({path: 1.0})


def test_with_a_misspelled_field(paper):
    with pytest.raises(bk.ScenarioError, match=r"^disturbanc: .*did you mean disturbance\?"):
        paper.with_(disturbanc=bk.UniformDisturbance())


# Files

FLOATS = st.floats(min_value=5e-324, max_value=1e6)
READABLE = st.characters(exclude_categories=["Cc", "Cf", "Cn", "Cs", "Zl", "Zp"])


@given(
    stiction_n=FLOATS,
    coulomb_n=FLOATS,
    pair=st.tuples(FLOATS, FLOATS),
    damping_n_s_per_m=st.just(0.0) | FLOATS,
    residual_n=st.none() | FLOATS,
    gains=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3),
    name=st.text(READABLE, min_size=1, max_size=100),
    description=st.text(),
    seed=st.integers(0, 2**63 - 1),
)
def test_toml_reads_back_bit_for_bit(pair, gains, name, description, seed, **joint):
    kp, ki, kd = gains
    joint["stiffness_n_per_m"], mass_kg = sorted(pair)  # a bristle that the period resolves
    scenario = bk.Scenario(
        name=name,
        description=description,
        seed=seed,
        joint=bk.Lugre(**joint, stribeck_velocity_m_per_s=0.1, engagement_length_m=0.1),
        part=bk.Part(mass_kg=mass_kg),
        reference=bk.StepReference(distance_m=0.05),
        controller=bk.Pid(gains=bk.Gains(kp_n_per_m=kp, ki_n_per_m_s=ki, kd_n_s_per_m=kd)),
        timing=bk.Timing(duration_s=0.1),
    )
    again = parse_scenario(scenario_toml(scenario), "text")
    assert again == scenario
    assert bits_of(again.model_dump()) == bits_of(scenario.model_dump())


def bits_of(values):
    """Floats as text that tells -0.0 from 0.0."""
    if isinstance(values, dict):
        return {key: bits_of(value) for key, value in values.items()}
    return values.hex() if isinstance(values, float) else values


def test_save_and_load(paper, vibrating, tmp_path):
    for number, scenario in enumerate((paper, vibrating)):
        path = tmp_path / f"{number}.toml"
        bk.save_scenario(scenario, path)
        assert bk.load_scenario(path) == scenario
        assert bk.load_scenario(str(path)) == scenario
    assert sorted(p.name for p in tmp_path.iterdir()) == ["0.toml", "1.toml"]  # nothing left over


def test_saving_where_it_can_not_be(paper, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(bk.OutputError, match="cannot be written"):
        bk.save_scenario(paper, tmp_path / "file" / "scenario.toml")


def test_loading_what_is_not_there(tmp_path):
    with pytest.raises(bk.ScenarioError, match=r"did you mean paper_as_computed\?"):
        bk.load_scenario("paper_as_computd")
    with pytest.raises(bk.ScenarioError, match=r"nor a preset|neither a file nor a preset"):
        bk.load_scenario(tmp_path / "none.toml")
    with pytest.raises(bk.ScenarioError, match="cannot be read as text"):
        bk.load_scenario(tmp_path)


def test_loading_what_is_not_a_scenario(paper, tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("[joint\n")
    with pytest.raises(bk.ScenarioError, match=r"broken\.toml: is not TOML: "):
        bk.load_scenario(path)
    path.write_bytes(b"name = '\xff'")
    with pytest.raises(bk.ScenarioError, match=r"broken\.toml: cannot be read as text"):
        bk.load_scenario(path)
    path.write_text(scenario_toml(paper).replace("stiction_n", "stictin_n"))
    with pytest.raises(bk.ScenarioError) as caught:
        bk.load_scenario(path)
    first, *rest = str(caught.value).splitlines()
    assert first == f"{path}:"
    assert sorted(line.partition(":")[0] for line in rest) == [
        "joint.stictin_n",
        "joint.stiction_n",
    ]


# Presets


def test_presets_are_listed():
    names = bk.preset_names()
    assert "paper_as_computed" in names
    assert names == sorted(names)


@pytest.mark.parametrize("name", bk.preset_names())
def test_presets_load_resolve_and_run(name, tmp_path):
    scenario = bk.load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    run = bk.simulate(scenario)
    again = bk.simulate(run.scenario)
    assert_same_bits(run, again)
    bk.save_scenario(scenario, tmp_path / "copy.toml")
    assert bk.load_scenario(tmp_path / "copy.toml") == scenario


def assert_same_bits(one, other):
    assert one.outcome == other.outcome
    assert repr(one.metrics) == repr(other.metrics)  # repr, since NaN is not equal to itself
    assert one.trace.keys() == other.trace.keys()
    for name, column in one.trace.items():
        assert column.tobytes() == other.trace[name].tobytes(), name


# Resolution


def test_resolving_makes_every_number_explicit(paper):
    resolved = bk.resolve(paper)
    assert resolved.joint.residual_n == 9.81
    assert resolved.limits.diverged_error_m == 0.05
    assert resolved.limits.diverged_force_n == 9000.0
    assert resolved.limits.breakaway_travel_m == 2 * 450.0 / 3.6e7
    gains = bk.design.pole_placement(
        paper.joint, mass_kg=1.0, settling_time_s=5e-4, damping_ratio=1.0, pole_per_s=200.0
    ).total
    assert resolved.controller.gains == bk.Gains(
        kp_n_per_m=gains.kp, ki_n_per_m_s=gains.ki, kd_n_s_per_m=gains.kd
    )


def test_resolving_keeps_what_is_given(paper):
    given_values = {
        "joint.residual_n": 5.0,
        "limits.diverged_error_m": 0.01,
        "limits.diverged_force_n": 1000.0,
        "limits.breakaway_travel_m": 1e-4,
        "limits.contact_force_n": 2.0,
        "controller.gains": GIVEN,
        "timing.steps_per_period": 1,
    }
    explicit = paper.with_(given_values)
    assert bk.resolve(explicit) == explicit


def test_resolving_again_changes_nothing(paper, vibrating):
    two_step = bk.TwoStep(
        breakaway=paper.controller.model_dump() | {"anti_windup": "conditional"},
        vibration=bk.FmVibration(
            pid=bk.PidSettings(
                gains=bk.PolePlacement(settling_time_s=5.2e-4, damping_ratio=1.2),
                anti_windup="conditional",
            ),
            vibration=PULSES,
        ),
        breakaway_travel_m=3e-5,
    )
    for scenario in (paper, vibrating, paper.with_(controller=two_step)):
        short = scenario.with_({"timing.duration_s": 0.02, "disturbance.var": 0.1})
        resolved = bk.resolve(short)
        assert bk.resolve(resolved) == resolved
        assert resolved == bk.Scenario.parse(resolved.model_dump())  # and is valid
        run = bk.simulate(short)
        assert run.scenario == resolved
        assert_same_bits(run, bk.simulate(resolved))


def test_a_joint_without_a_design_says_why(paper):
    with pytest.raises(
        bk.ScenarioError, match=r"^joint\.coulomb_n: 5\.0 is not > .*give the gains"
    ):
        bk.simulate(paper.with_({"joint.coulomb_n": 5.0}))


# Checks across fields


def refused(scenario, changes, *parts):
    with pytest.raises(bk.ScenarioError) as caught:
        scenario.with_(changes)
    message = str(caught.value)
    for part in parts:
        assert part in message, message
    assert len(message.splitlines()) == 1, message


def test_pulses_are_sampled(vibrating):
    nyquist = {"controller.vibration.frequency_max_hz": 160.0, "timing.control_period_s": 4e-3}
    nyquist["timing.steps_per_period"] = 100
    refused(
        vibrating,
        {**nyquist, "disturbance.hold_s": 4e-3, "controller.vibration.pulse_width_s": 5e-3},
        "controller.vibration.frequency_max_hz: 160.0 is not below the Nyquist frequency 125 Hz",
        "timing.control_period_s",
    )
    refused(
        vibrating,
        {"controller.vibration.pulse_width_s": 1.9e-5},
        "controller.vibration.pulse_width_s: 1.9e-05 is not >= two control periods of 1e-05 s",
    )
    vibrating.with_({"controller.vibration.pulse_width_s": 2e-5})


def test_pulses_do_not_overlap(vibrating):
    refused(
        vibrating,
        {"controller.vibration.pulse_width_s": 6.3e-3},
        "controller.vibration.pulse_width_s: 0.0063 makes pulses overlap",
        "give a width <= 0.00625",
    )
    vibrating.with_({"controller.vibration.pulse_width_s": 6.25e-3})
    refused(
        vibrating,
        {"controller.vibration.frequency_min_hz": 161.0},
        "controller.vibration.frequency_min_hz: 161.0 is not <= frequency_max_hz = 160.0",
    )
    vibrating.with_({"controller.vibration.frequency_min_hz": 160.0})


def test_a_draw_is_held_for_a_period_at_least(paper):
    refused(
        paper,
        {"disturbance.hold_s": 0.9e-5, "disturbance.var": 0.1},
        "disturbance.hold_s: 9e-06 is not >= timing.control_period_s = 1e-05",
    )
    paper.with_({"disturbance.hold_s": 1e-5, "disturbance.var": 0.1})
    paper.with_({"disturbance.hold_s": 0.9e-5, "disturbance.var": 0.0})  # nothing is drawn


def test_a_run_is_whole_periods(paper):
    refused(
        paper,
        {"timing.duration_s": 0.500004},
        "timing.duration_s: 0.500004 is not a whole number of timing.control_period_s = 1e-05",
        "give 0.5",
    )
    assert paper.with_({"timing.duration_s": 0.3}).samples == 30_000  # 0.3 / 1e-5 is not whole
    refused(paper, {"timing.duration_s": 4e-6}, "give 1e-05")


def test_a_run_and_its_trace_are_not_endless(paper):
    refused(paper, {"timing.duration_s": 2e5}, "timing.duration_s: 200000.0 takes 2e+10", "shorten")
    long = {"timing.duration_s": 1e4, "trace.every_samples": 1}
    refused(paper, long, "trace.every_samples: 1 makes 1e+09 rows", "give 100")
    assert paper.with_({**long, "trace.every_samples": 0}).trace.every_samples == 0


def test_a_trapezoid_reaches_its_velocity(paper):
    trapezoid = bk.TrapezoidalVelocity(
        distance_m=0.1, velocity_m_per_s=0.5, acceleration_m_per_s2=2.5
    )
    fits = paper.with_(reference=trapezoid)
    refused(
        fits,
        {"reference.velocity_m_per_s": 0.6},
        "reference.velocity_m_per_s: 0.6 is not reached within distance_m = 0.1",
        "give a velocity <= 0.5",
    )


def test_the_two_region_law_breaks_loose():
    values = {
        "stiffness_n_per_m": 1e6,
        "damping_n_s_per_m": 100.0,
        "engagement_length_m": 0.1,
    }
    bk.TwoRegion(stiction_n=100.0, coulomb_n=100.0, **values)
    with pytest.raises(bk.ScenarioError, match=r"^coulomb_n: 101.0 is not <= stiction_n = 100.0;"):
        bk.TwoRegion(stiction_n=100.0, coulomb_n=101.0, **values)


# The JSON schema


def conforms(value, schema, root):
    """As much of JSON Schema as the scenario's schema uses; unknown words fail the test."""
    if "$ref" in schema:
        assert set(schema) <= {"$ref", "description", "default"}
        return conforms(value, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], root)
    if "type" in schema and not is_of_type(value, schema["type"]):
        return False  # bounds are for values of the type
    about = {"title", "description", "default", "discriminator", "$defs", "type"}
    for word, rule in schema.items():
        if word in about or word in ("properties", "additionalProperties"):
            continue
        checks = {
            "enum": lambda rule=rule: value in rule,
            "const": lambda rule=rule: value == rule,
            "anyOf": lambda rule=rule: any(conforms(value, option, root) for option in rule),
            "oneOf": lambda rule=rule: sum(conforms(value, option, root) for option in rule) == 1,
            "required": lambda rule=rule: set(rule) <= set(value),
            "minimum": lambda rule=rule: value >= rule,
            "maximum": lambda rule=rule: value <= rule,
            "minLength": lambda rule=rule: len(value) >= rule,
            "maxLength": lambda rule=rule: len(value) <= rule,
            "exclusiveMinimum": lambda rule=rule: value > rule,
            "exclusiveMaximum": lambda rule=rule: value < rule,
        }
        if not checks[word]():
            return False
    if schema.get("type") != "object":
        return True
    properties = schema["properties"]
    assert schema["additionalProperties"] is False
    return set(value) <= set(properties) and all(
        conforms(inner, properties[key], root) for key, inner in value.items()
    )


def is_of_type(value, name):
    kinds = {
        "object": dict,
        "string": str,
        "boolean": bool,
        "integer": int,
        "number": int | float,
        "null": type(None),
    }
    return isinstance(value, kinds[name]) and not (
        isinstance(value, bool) and name in ("integer", "number")
    )


@pytest.mark.parametrize("name", bk.preset_names())
def test_the_schema_admits_the_presets(name):
    schema = bk.scenario_schema()
    values = tomllib.loads(scenario_toml(bk.load_scenario(name)))
    assert conforms(values, schema, schema)
    damaged = [
        {**values, "sed": 1},
        {**values, "seed": -1},
        {**values, "part": {"mass_kg": 0.0}},
        {**values, "joint": {**values["joint"], "law": "glue"}},
        {key: value for key, value in values.items() if key != "timing"},
    ]
    assert not any(conforms(value, schema, schema) for value in damaged)


def test_the_schema_describes_every_field(sites):
    schema = bk.scenario_schema()
    for site in sites:
        assert site.field.description, site.label
    assert np.all(
        [definition["additionalProperties"] is False for definition in schema["$defs"].values()]
    )
    assert math.isclose(
        schema["$defs"]["Timing"]["properties"]["control_period_s"]["default"], 1e-5
    )
