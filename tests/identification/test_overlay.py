"""An identified joint laid over a scenario: what changes, what stays, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import breakaway as bk
from breakaway.model.scenario.laws import joint_under

SCENARIO = bk.load_scenario("paper_as_computed")


@pytest.fixture(scope="module")
def log() -> bk.Log:
    """Give a record of 3 kg that slide at 60 N + 200 N s/m v."""
    t_s = np.arange(4000) / 1000.0
    x = 0.02 * np.sin(5 * t_s) + 0.01 * np.sin(13 * t_s + 1)
    v = 0.1 * np.cos(5 * t_s) + 0.13 * np.cos(13 * t_s + 1)
    a = -0.5 * np.sin(5 * t_s) - 1.69 * np.sin(13 * t_s + 1)
    return bk.Log(t_s=t_s, position_m=x, force_n=3.0 * a + 60.0 * np.sign(v) + 200.0 * v)


@pytest.fixture(scope="module")
def joint(log: bk.Log) -> bk.JointFile:
    return bk.JointFile.from_fit(bk.identify_inertia_friction(log), log)


def test_what_the_log_tells_changes_and_the_rest_stays(joint: bk.JointFile) -> None:
    over = bk.lay_over(SCENARIO, joint)
    changes = joint.scenario_changes()
    assert set(changes) == {"part.mass_kg", "joint.coulomb_n", "joint.viscous_n_s_per_m"}
    assert over.part.mass_kg == changes["part.mass_kg"] == pytest.approx(3.0, rel=0.02)
    assert over.joint.coulomb_n == changes["joint.coulomb_n"] == pytest.approx(60.0, rel=0.02)
    left = {"joint.residual_n": over.joint.residual_n, "joint_source": over.joint_source}
    assert over == SCENARIO.with_(changes | left)
    back = {path: value_at(path) for path in changes} | dict.fromkeys(left)
    assert over.with_(back) == SCENARIO
    assert bk.load_scenario("paper_as_computed") == SCENARIO


def value_at(path: str) -> float:
    table, field = path.split(".")
    return float(getattr(getattr(SCENARIO, table), field))


def test_a_file_is_as_good_as_what_it_holds(joint: bk.JointFile, tmp_path: Path) -> None:
    joint.save(tmp_path / "joint.toml")
    over = bk.lay_over(SCENARIO, joint)
    assert bk.lay_over(SCENARIO, tmp_path / "joint.toml") == over
    assert bk.lay_over(SCENARIO, str(tmp_path / "joint.toml")) == over


def test_an_identification_is_as_good_as_its_file(log: bk.Log) -> None:
    found = bk.identify(log, law="coulomb", starts=1)
    as_file = bk.JointFile.from_identification(found)
    over = bk.lay_over(SCENARIO, found)
    assert over == bk.lay_over(SCENARIO, as_file) != SCENARIO


def test_a_study_lays_over_the_same(log: bk.Log) -> None:
    file = bk.JointFile.from_identification(bk.identify(log, law="coulomb", starts=1))
    study = bk.SweepStudy(scenario=SCENARIO, joint=file, runs=4)
    assert study.base == bk.lay_over(SCENARIO, file)


def test_a_law_without_a_place_is_named_and_one_that_has_it(
    joint: bk.JointFile, tmp_path: Path
) -> None:
    two_region = SCENARIO.with_(joint=joint_under("two_region", SCENARIO.joint, {}))
    joint.save(tmp_path / "joint.toml")
    told = (
        r": sets joint\.viscous_n_s_per_m, which the scenario's law = 'two_region' does not have; "
        r"give the scenario a joint with law = 'lugre'$"
    )
    for given, name in ((joint, "joint file"), (tmp_path / "joint.toml", r".*joint\.toml")):
        with pytest.raises(bk.ScenarioError, match=f"^{name}{told}"):
            bk.lay_over(two_region, given)
    rigid = SCENARIO.with_(joint=joint_under("coulomb_stiction", SCENARIO.joint, {}))
    assert bk.lay_over(rigid, joint).joint.law == "coulomb_stiction"


def test_a_joint_that_can_not_be_is_named_with_its_field(joint: bk.JointFile) -> None:
    rigid = SCENARIO.with_(joint=joint_under("coulomb_stiction", SCENARIO.joint, {}))
    strong = joint.model_copy(update={"joint": joint.joint.model_copy(update={"coulomb_n": 500.0})})
    words = (
        r"^joint file laid over paper_as_computed: joint\.coulomb_n: 500\.0 is not <= stiction_n"
    )
    with pytest.raises(bk.ScenarioError, match=words):
        bk.lay_over(rigid, strong)


@pytest.mark.parametrize("given", [None, 5, {"coulomb_n": 1.0}, SCENARIO.joint])
def test_what_is_no_joint_is_refused(given: object) -> None:
    with pytest.raises(
        bk.ScenarioError,
        match=r"^joint: .* is not a JointFile or an Identification or a path; give",
    ) as no:
        bk.lay_over(SCENARIO, given)
    assert "\n" not in str(no.value)


def test_what_is_no_scenario_or_no_file_is_refused(joint: bk.JointFile, tmp_path: Path) -> None:
    with pytest.raises(bk.ScenarioError, match=r"^scenario: 'paper_as_computed' is not a Sc"):
        bk.lay_over("paper_as_computed", joint)
    with pytest.raises(bk.ScenarioError, match=r"none\.toml: there is no such file"):
        bk.lay_over(SCENARIO, tmp_path / "none.toml")


@pytest.fixture(scope="module")
def sided_joint(
    rig: Any, lugre: dict[str, float], sided: Callable[..., dict[str, float]]
) -> bk.JointFile:
    """Give a joint of 20 N forward and 26 N backward that is elastic up to 0.6 of its level."""
    truth = sided(lugre | {"elastic_share": 0.6})
    log = rig(**truth).moved(1500, 1000.0, force_noise_n=0.05)
    found = bk.identify(log, law="elasto_plastic", asymmetric=True, starts=1)
    return bk.JointFile.from_identification(found)


def test_law_elastic_share_and_direction_come_along(
    sided_joint: bk.JointFile, tmp_path: Path
) -> None:
    sided_joint.save(tmp_path / "j.toml")
    over = bk.lay_over(SCENARIO, tmp_path / "j.toml")
    assert isinstance(over.joint, bk.ElastoPlastic)
    assert over.joint.elastic_share == pytest.approx(0.6, abs=0.05)
    assert over.joint.coulomb_n == pytest.approx(20.0, rel=0.01)
    assert over.joint.backward_ratio == pytest.approx(1.3, rel=0.01)
    assert over.joint.viscous_n_s_per_m == pytest.approx(60.0, rel=0.05)
    assert set(sided_joint.vary()) == set(sided_joint.scenario_changes())
    assert {"joint.elastic_share", "joint.backward_ratio"} < set(sided_joint.vary())
    study = bk.SweepStudy(scenario=SCENARIO, joint=sided_joint, runs=4)
    assert study.base.joint.law == "elasto_plastic"


def test_what_has_no_place_is_listed_and_warned_of(sided_joint: bk.JointFile) -> None:
    value, why = sided_joint.dropped()["viscous_negative_n_s_per_m"]
    assert value == pytest.approx(90.0, rel=0.05) and "the same in both directions" in why
    over = bk.lay_over(SCENARIO, sided_joint)
    assert over.joint_source is not None
    assert over.joint_source.dropped.startswith("viscous_negative_n_s_per_m = ")
    told = [one for one in bk.simulate(over).warnings if one.startswith("joint_source: ")]
    assert len(told) == 1 and "viscous_negative_n_s_per_m = " in told[0]
    replaced = over.with_(joint=SCENARIO.joint)
    assert replaced == SCENARIO.with_({"part.mass_kg": over.part.mass_kg})


def test_position_dependence_is_listed(sided_joint: bk.JointFile) -> None:
    sloped = sided_joint.model_copy(update={"unplaced": {"coulomb_slope_n_per_m": 3.0}})
    assert "residual_n" in sloped.dropped()["coulomb_slope_n_per_m"][1]
    source = bk.lay_over(SCENARIO, sloped).joint_source
    assert source is not None and source.dropped.startswith("coulomb_slope_n_per_m = 3 (")


def test_a_light_joint_of_a_heavy_part_runs(joint: bk.JointFile) -> None:
    """95 kg with 20.4 N of friction: the weight, 933 N, says nothing of it."""
    heavy = joint.model_copy(
        update={
            "part": joint.part.model_copy(update={"mass_kg": 95.0}),
            "joint": joint.joint.model_copy(update={"coulomb_n": 20.4}),
        }
    )
    over = bk.lay_over(SCENARIO, heavy)
    assert over.joint.residual_n == pytest.approx(20.4 * 9.81 / 360.0)
    assert over.joint_source is not None
    assert over.joint_source.residual == (
        "2.73 % of the identified coulomb_n, as in paper_as_computed (9.81 N of 360 N): a log does "
        "not tell it; joint.residual_n states it"
    )
    assert bk.simulate(over).outcome == "released"


def test_friction_that_is_stated_at_the_end_stays(joint: bk.JointFile) -> None:
    over = bk.lay_over(SCENARIO.with_({"joint.residual_n": 7.0}), joint)
    assert over.joint.residual_n == 7.0
    assert over.joint_source is not None and over.joint_source.residual == ""


def test_a_number_that_the_law_needs_and_nobody_has_is_named(sided_joint: bk.JointFile) -> None:
    rigid = SCENARIO.with_(joint=joint_under("coulomb_stiction", SCENARIO.joint, {}))
    soft = sided_joint.joint.model_copy(update={"stiffness_n_per_m": None})
    with pytest.raises(
        bk.ScenarioError, match=r"laid over paper_as_computed: joint\.stiffness_n_per_m: is missing"
    ):
        bk.lay_over(rigid, sided_joint.model_copy(update={"joint": soft}))
