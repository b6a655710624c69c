"""The joint file keeps what was identified, whole or not at all, and refuses damage by name."""

import os
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import breakaway as bk
from breakaway.errors import LogError, OutputError, ScenarioError
from breakaway.measure.identification import (
    Cascade,
    Identification,
    InertiaFrictionFit,
    JointFile,
    identify,
    identify_inertia_friction,
)
from breakaway.measure.logs import Log


@pytest.fixture(scope="module")
def log() -> Log:
    t_s = np.arange(4000) / 1000.0
    v = 0.3 * np.cos(3 * t_s) + 0.35 * np.cos(7 * t_s + 1)
    a = -0.9 * np.sin(3 * t_s) - 2.45 * np.sin(7 * t_s + 1)
    return Log(
        t_s=t_s,
        position_m=0.1 * np.sin(3 * t_s) + 0.05 * np.sin(7 * t_s + 1),
        force_n=5.0 * a + 20.0 * v + 4.0 * np.sign(v) + 1.0,
        source=Path("some/where/motor.csv"),
        sha256="ab" * 32,
    )


@pytest.fixture(scope="module")
def fit(log: Log) -> InertiaFrictionFit:
    return identify_inertia_friction(log)


@pytest.fixture(scope="module")
def joint(fit: InertiaFrictionFit, log: Log) -> JointFile:
    return JointFile.from_fit(fit, log)


def test_gathers_the_fit(joint: JointFile, fit: InertiaFrictionFit) -> None:
    assert joint.part.mass_kg == fit.symmetric.mass_kg
    assert joint.rig.offset_n == fit.symmetric.offset_n
    assert joint.standard_error["coulomb_n"] == fit.symmetric.standard_error["coulomb_n"]
    assert joint.asymmetric is not None and joint.relative_force_error_percent is not None
    assert joint.provenance.settings is not None
    assert joint.asymmetric.coulomb_negative_n == fit.asymmetric.coulomb_negative_n
    assert joint.asymmetric.standard_error.mass_kg == fit.asymmetric.standard_error["mass_kg"]
    assert joint.relative_force_error_percent.asymmetric == (
        fit.asymmetric.relative_force_error_percent
    )
    assert joint.provenance.log == "motor.csv"
    assert joint.provenance.log_sha256 == "ab" * 32
    assert joint.provenance.settings.lowpass_hz == 100.0
    assert joint.not_identified == fit.not_identified


def test_changes_three_fields_of_a_scenario(joint: JointFile, fit: InertiaFrictionFit) -> None:
    assert joint.scenario_changes() == {
        "part.mass_kg": fit.symmetric.mass_kg,
        "joint.coulomb_n": fit.symmetric.coulomb_n,
        "joint.viscous_n_s_per_m": fit.symmetric.viscous_n_s_per_m,
    }
    assert not set(joint.scenario_changes()) & set(joint.not_identified)


def test_comes_back_as_it_was_saved(joint: JointFile, tmp_path: Path) -> None:
    path = tmp_path / "joint.toml"
    joint.save(path)
    joint.save(str(path))
    assert JointFile.load(path) == joint
    assert [entry.name for entry in tmp_path.iterdir()] == ["joint.toml"]
    assert "some/where" not in path.read_text()
    assert tomllib.loads(path.read_text())["not_identified"]["joint.stiction_n"]


def test_a_log_without_a_file_has_no_digest(
    fit: InertiaFrictionFit, log: Log, tmp_path: Path
) -> None:
    joint = JointFile.from_fit(fit, replace(log, source=None, sha256=None))
    joint.save(tmp_path / "joint.toml")
    assert "log_sha256" not in (tmp_path / "joint.toml").read_text()
    assert JointFile.load(tmp_path / "joint.toml").provenance.log_sha256 is None


def test_names_the_version(joint: JointFile) -> None:
    assert joint.provenance.breakaway_version == bk.__version__


@pytest.mark.parametrize("name", ["coulomb_n", "viscous_n_s_per_m"])
def test_refuses_negative_friction(fit: InertiaFrictionFit, log: Log, name: str) -> None:
    symmetric = replace(fit.symmetric, **{name: -3.0})
    with pytest.raises(LogError, match=rf"motor\.csv: {name} comes out as -3 ± .*wider range"):
        JointFile.from_fit(replace(fit, symmetric=symmetric), log)


def test_refuses_to_save_where_it_can_not(joint: JointFile, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    for place in ("file/joint.toml", "file/none/joint.toml", "folder"):
        with pytest.raises(OutputError, match="cannot be written"):
            joint.save(tmp_path / place)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["file", "folder"]


def test_a_failed_save_leaves_the_old_file(
    joint: JointFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "joint.toml"
    path.write_text("old")
    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OutputError, match="No space left on device"):
        joint.save(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "[part]\nmass_kg = ",
            "[part]\nmass_kg = -",
            r"part\.mass_kg: -\S+ is not > 0; give",
        ),
        (
            "[part]\nmass_kg = ",
            "[part]\nmass = 1\nmass_kg = ",
            r"part\.mass: .*did you mean mass_kg",
        ),
        ("[rig]\noffset_n", "[rig]\nother_n", r"rig\.offset_n: is missing; give a number"),
        (
            "decimation = 10",
            'decimation = "10"',
            r"decimation: .*give a whole number >= 1",
        ),
        (
            "lowpass_hz = 100.0",
            "lowpass_hz = nan",
            r"lowpass_hz: nan is not finite; give a",
        ),
        ("[part]", "[part", "is not TOML"),
    ],
)
def test_refuses_a_damaged_file(
    joint: JointFile, tmp_path: Path, old: str, new: str, words: str
) -> None:
    path = tmp_path / "joint.toml"
    joint.save(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(ScenarioError, match=rf"(?s)joint\.toml:.*{words}"):
        JointFile.load(path)


def test_refuses_what_is_no_joint_file(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="there is no such file"):
        JointFile.load(tmp_path / "none.toml")
    with pytest.raises(ScenarioError, match="cannot be read"):
        JointFile.load(tmp_path)
    (tmp_path / "joint.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(ScenarioError, match="cannot be read as text"):
        JointFile.load(tmp_path / "joint.toml")


# From an identification by simulation.


def told(found: Identification) -> dict[str, float]:
    return {one.name: one.value for one in found.estimates if one.identifiable}


@pytest.fixture(scope="module")
def by_law(rich_fit: Identification) -> JointFile:
    return JointFile.from_identification(rich_fit, seed=7)


def test_gathers_an_identification(by_law: JointFile, rich_fit: Identification) -> None:
    values = told(rich_fit)
    assert by_law.scenario_changes() == {
        "joint.coulomb_n": values["coulomb_n"],
        "joint.viscous_n_s_per_m": values["viscous_n_s_per_m"],
        "joint.stiction_n": pytest.approx(values["stiction_ratio"] * values["coulomb_n"]),
        "joint.stiffness_n_per_m": values["stiffness_n_per_m"],
        "joint.damping_n_s_per_m": values["damping_n_s_per_m"],
        "joint.stribeck_velocity_m_per_s": values["stribeck_velocity_m_per_s"],
    }
    assert by_law.rig.offset_n == values["offset_n"]
    one = rich_fit["stiffness_n_per_m"]
    assert by_law.interval[one.name] == [one.low, one.high]
    assert by_law.standard_error[one.name] == one.standard_error
    assert by_law.provenance.method == "output error, LuGre, imposed motion"
    assert by_law.provenance.fit is not None
    assert (by_law.provenance.fit.law, by_law.provenance.fit.starts) == ("lugre", 4)
    assert by_law.provenance.fit.complete
    assert any(note.startswith("stiction peak: ") for note in by_law.provenance.notes)
    assert set(by_law.not_identified) == {"part.mass_kg", "joint.engagement_length_m"}


def test_an_identification_comes_back_as_it_was_saved(by_law: JointFile, tmp_path: Path) -> None:
    path = tmp_path / "joint.toml"
    by_law.save(path)
    assert JointFile.load(path) == by_law
    assert by_law.draws is not None and by_law.draws.source == "normal"
    assert {len(column) for column in by_law.draws.values.values()} == {200}


def test_draws_lie_about_the_values_and_are_chosen_by_the_seed(
    by_law: JointFile, rich_fit: Identification
) -> None:
    assert by_law.draws is not None
    for path, value in by_law.scenario_changes().items():
        column = np.array(by_law.draws.values[path])
        assert abs(column.mean() - value) < 0.3 * column.std()
    assert JointFile.from_identification(rich_fit, seed=7) == by_law
    assert JointFile.from_identification(rich_fit, seed=8).draws != by_law.draws


def test_every_draw_is_a_valid_scenario(by_law: JointFile) -> None:
    assert by_law.draws is not None
    base = bk.load_scenario("paper_as_computed")
    for row in range(0, 200, 20):
        drawn = {path: column[row] for path, column in by_law.draws.values.items()}
        assert base.with_(drawn).joint.coulomb_n == drawn["joint.coulomb_n"]


def test_what_the_log_does_not_tell_stays_out(rich: Log) -> None:
    found = identify(rich, law="coulomb", starts=1, fixed={"mass_kg": 2.0})
    joint = JointFile.from_identification(found)
    assert set(joint.scenario_changes()) == {"joint.coulomb_n", "joint.viscous_n_s_per_m"}
    assert joint.not_identified["joint.stiction_n"] == "law 'coulomb' does not have it"
    assert joint.not_identified["joint.stiffness_n_per_m"] == "law 'coulomb' does not have it"
    assert "part.mass_kg" in joint.not_identified
    assert set(joint.vary()) == set(joint.scenario_changes())


def test_sides_give_the_positive_one(log: Log) -> None:
    found = identify(log, law="coulomb", asymmetric=True, fixed={"mass_kg": 5.0}, starts=1)
    joint = JointFile.from_identification(found)
    assert joint.joint.coulomb_n == found["coulomb_positive_n"].value
    assert joint.joint.viscous_n_s_per_m == found["viscous_positive_n_s_per_m"].value


def test_a_mass_comes_from_a_log_that_tells_it(looped: Log) -> None:
    cascade = Cascade(position_gain_per_s=60.0, velocity_gain_n_s_per_m=400.0, force_limit_n=100.0)
    found = identify(looped, law="coulomb", motion="closed_loop", controller=cascade, starts=1)
    joint = JointFile.from_identification(found)
    assert joint.part.mass_kg == found["mass_kg"].value
    assert "part.mass_kg" in joint.vary()


@pytest.mark.slow
def test_a_posterior_is_kept_as_draws(log: Log) -> None:
    pytest.importorskip("emcee")
    cut = log.between(0.0, 1.0).resampled(rate_hz=100.0)
    found = identify(cut, law="coulomb", fixed={"mass_kg": 5.0}, steps_per_row=1, starts=1)
    joint = JointFile.from_identification(found, found.posterior(400))
    assert joint.draws is not None
    assert joint.draws.source == "posterior"
    assert len(joint.draws.values["joint.coulomb_n"]) == 200


def test_varies_rows_together(by_law: JointFile, joint: JointFile) -> None:
    varied = by_law.vary()
    assert set(varied) == set(by_law.scenario_changes())
    assert {one.rows for one in varied.values()} == {"shared"}
    assert set(joint.vary()) == set(joint.scenario_changes())
    assert all(min(one.values) > 0.0 for one in joint.vary().values())


def test_a_file_without_draws_has_no_spread(joint: JointFile) -> None:
    bare = joint.model_copy(update={"draws": None})
    with pytest.raises(ScenarioError, match="has no draws, so its spread is not"):
        bare.vary()


def test_a_joint_without_its_level_is_refused(rich: Log) -> None:
    found = identify(rich, law="coulomb", fixed={"coulomb_n": 20.0}, starts=1)
    with pytest.raises(LogError, match=r"coulomb_n .*no\s+joint to write"):
        JointFile.from_identification(found)
