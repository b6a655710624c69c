"""What is known of every friction law beside its model."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

import breakaway as bk
from breakaway.model.scenario.joint import AnyJoint
from breakaway.model.scenario.laws import (
    LAW_WORDS,
    LAWS,
    LawNumbers,
    joint_under,
    laws_with,
    numbers_of_parts,
    shared_numbers,
)

PART = {
    "stiction_n": 450.0,
    "stiction_ratio": 1.25,
    "presliding_m": 1.25e-5,
    "bristle_damping_ratio": 0.75,
    "stribeck_velocity_m_per_s": 0.09,
    "mass_kg": 1.0,
    "engagement_length_m": 0.1,
}
MODELS = {model.model_fields["law"].default: model for model in get_args(AnyJoint)}


def test_every_law_of_the_union_is_known() -> None:
    assert set(LAWS) == set(MODELS) == set(LAW_WORDS)
    assert all(LAW_WORDS.values()) and len(set(LAW_WORDS.values())) == len(LAWS)
    schema = bk.scenario_schema()["properties"]["joint"]["discriminator"]["mapping"]
    assert set(schema) == set(LAWS)


@pytest.mark.parametrize("law", LAWS)
def test_a_part_and_the_usual_numbers_make_a_joint(law: str) -> None:
    usual = LawNumbers()
    numbers = {**shared_numbers(law, usual), **numbers_of_parts(law, usual, PART)}
    joint = MODELS[law](**numbers)
    coulomb_n = 360.0 if "coulomb_n" in MODELS[law].model_fields else 450.0
    assert (joint.law, joint.stiction_n, joint.coulomb_n) == (law, 450.0, coulomb_n)
    if joint.stiffness_n_per_m != float("inf"):
        assert joint.stiffness_n_per_m == pytest.approx(3.6e7)
        assert joint.damping_n_s_per_m == pytest.approx(1.5 * np.sqrt(3.6e7))


@pytest.mark.parametrize("law", LAWS)
def test_many_parts_are_each_as_one(law: str) -> None:
    usual = LawNumbers()
    parts = {name: value * np.array([1.0, 1.1, 1.3]) for name, value in PART.items()}
    many = numbers_of_parts(law, usual, parts)
    for i in range(3):
        one = {name: float(values[i]) for name, values in parts.items()}
        assert numbers_of_parts(law, usual, one) == {name: v[i] for name, v in many.items()}


@pytest.mark.parametrize("law", LAWS)
def test_a_joint_under_its_own_law_is_itself(law: str) -> None:
    lugre = bk.load_scenario("paper_as_computed").joint
    joint = joint_under(law, lugre, {})
    assert joint.law == law
    assert joint_under(law, joint, {}) == joint
    for name in set(MODELS[law].model_fields) & set(bk.Lugre.model_fields) - {"law"}:
        assert getattr(joint, name) == getattr(lugre, name)


def test_the_attraction_follows_the_stiction_force() -> None:
    lugre = bk.load_scenario("paper_as_computed").joint
    gms = joint_under("gms", lugre, {})
    assert isinstance(gms, bk.Gms)
    assert gms.attraction_n_per_s == 450.0 / 1e-3
    slower = LawNumbers(gms_lag_s=2e-3)
    assert numbers_of_parts("gms", slower, PART)["attraction_n_per_s"] == 450.0 / 2e-3


def test_laws_with_a_number() -> None:
    assert laws_with({"elastic_share"}) == ["elasto_plastic"]
    given = laws_with({"stiffness_n_per_m", "viscous_n_s_per_m"})
    viscous = ["lugre", "elasto_plastic", "gms"]
    assert [law for law in given if law in (*viscous, "two_region", "coulomb_stiction")] == viscous
    assert laws_with({"stiction_ratio"}) == []


@pytest.mark.parametrize("law", LAWS)
def test_runge_kutta_steps_one_bristle(law: str) -> None:
    scenario = bk.load_scenario("paper_as_computed").with_({"timing.steps_per_period": 100})
    joint = joint_under(law, scenario.joint, {})
    if law in ("gms", "coulomb_stiction"):
        with pytest.raises(bk.ScenarioError, match=f"'rk4' does not step joint.law = '{law}'"):
            scenario.with_({"timing.integrator": "rk4"}, joint=joint)
    else:
        assert scenario.with_({"timing.integrator": "rk4"}, joint=joint).joint == joint
