"""Many pulls become a population file: fitted forces, stated ranges for all else."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from tests.identification.pulls import pulled

import breakaway as bk
from breakaway.errors import LogError, ScenarioError
from breakaway.measure.identification import RigFile, fit_population, joint_from_pull
from breakaway.measure.identification.population import Population
from breakaway.measure.logs import Log

AT_PART = RigFile(position_sensor="part")


def forces(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Draw breakaway and sliding forces that go together."""
    rng = np.random.default_rng(seed)
    hold = 2000.0 * np.exp(0.3 * rng.standard_normal(count))
    return hold, hold / (1.7 * np.exp(0.15 * rng.standard_normal(count)))


@pytest.fixture(scope="module")
def logs() -> list[Log]:
    return [pulled(*pair, seed=k) for k, pair in enumerate(zip(*forces(6), strict=True))]


@pytest.fixture(scope="module")
def found(logs: list[Log]) -> Population:
    return fit_population(logs)


def test_numbers_events_reports_and_logs_go_together(logs: list[Log]) -> None:
    report = bk.find_breakaway_events(logs[1])
    event = bk.find_breakaway_events(logs[2]).events[0]
    mixed = fit_population([1500.0, logs[0], report, event, 2500])
    assert mixed.parts == ("1 1500 N", "2 log", "3 log", f"4 event at {event.time_s:.6g} s",
                           "5 2500 N")  # fmt: skip
    seen = mixed.table["breakaway_force_n"]
    assert seen[[0, 4]].tolist() == [1500.0, 2500.0] and np.isfinite(seen).all()
    assert np.isnan(mixed.table["sliding_force_n"][[0, 4]]).all()
    assert not mixed.bounds["breakaway_force_n"].any()


def test_known_forces_alone_give_the_fit_of_their_logarithms() -> None:
    hold, _ = forces(40)
    fit = fit_population(hold.tolist()).fits["breakaway_force_n"]
    assert fit.parameters["median"] == pytest.approx(np.exp(np.log(hold).mean()))
    assert fit.parameters["sigma"] == pytest.approx(np.log(hold).std())


@pytest.mark.parametrize("force_n", [0.0, -5.0, math.nan, math.inf])
def test_an_impossible_force_is_refused_by_its_place(force_n: float) -> None:
    with pytest.raises(LogError, match=r"logs\[1\]: .* is no breakaway force; .* > 0 N"):
        fit_population([100.0, force_n, 300.0])


def test_the_file_has_the_fits_and_names_what_is_assumed(found: Population, tmp_path: Path) -> None:
    parts = bk.parts_of_pulls(found, name="blades")
    law = parts.parts.stiction_n
    assert (law.median, law.sigma) == tuple(found.fits["breakaway_force_n"].parameters.values())
    assert parts.assumed.keys() == set(type(parts.parts).model_fields) - {
        "stiction_n",
        "stiction_ratio",
    }
    assert "95 % interval" in parts.description
    bk.save_population(parts, tmp_path / "parts.toml")
    assert bk.load_population(tmp_path / "parts.toml") == parts


def test_drawn_parts_have_the_fitted_sliding_force_and_its_correlation(found: Population) -> None:
    drawn = bk.draw_parts(bk.parts_of_pulls(found), 20_000, seed=3)
    hold = np.log(drawn["stiction_n"])
    slide = hold - np.log(drawn["stiction_ratio"])
    fit = found.fits["sliding_force_n"].parameters
    assert np.exp(np.median(slide)) == pytest.approx(fit["median"], rel=0.02)
    assert slide.std() == pytest.approx(fit["sigma"], rel=0.05)
    assert np.corrcoef(hold, slide)[0, 1] == pytest.approx(found.correlation, abs=0.02)


def test_a_normal_fit_gives_rows_that_belong_together(logs: list[Log]) -> None:
    parts = bk.parts_of_pulls(fit_population(logs, distribution="normal")).parts
    rows = np.array(parts.stiction_n.values) / np.array(parts.stiction_ratio.values)
    assert parts.stiction_n.rows == parts.stiction_ratio.rows == "shared"
    assert (rows <= np.array(parts.stiction_n.values)).all()


def test_stiffness_of_three_joints_tells_the_presliding_travel(
    logs: list[Log], found: Population
) -> None:
    joints = [joint_from_pull(log, rig=AT_PART) for log in logs]
    parts = bk.parts_of_pulls(found, joints)
    assert "presliding_m" not in parts.assumed
    travel = np.median([j.joint.stiction_n / j.joint.stiffness_n_per_m for j in joints])
    assert parts.parts.presliding_m.median == pytest.approx(travel, rel=0.3)


def test_bounds_of_the_stiffness_end_the_range_of_the_presliding_travel(
    logs: list[Log], found: Population
) -> None:
    joints = [joint_from_pull(log) for log in logs]
    parts = bk.parts_of_pulls(found, joints)
    assert "no part slid further" in parts.assumed["presliding_m"]
    most = max(j.joint.stiction_n / j.interval["stiffness_n_per_m"][0] for j in joints)
    assert parts.parts.presliding_m.high == pytest.approx(most)


def test_a_population_says_only_its_own_quantities_are_assumed(found: Population) -> None:
    parts = bk.parts_of_pulls(found)
    with pytest.raises(ScenarioError, match=r"assumed: 'stiffness' is not one of stiction_n"):
        type(parts)(**{**dict(parts), "assumed": {"stiffness": "?"}})


@settings(max_examples=30, deadline=None)
@example(hold=[100.0, 101.0, 100.00000000000001], mass_kg=1.0)
@given(
    hold=st.lists(st.floats(100.0, 5000.0), min_size=3, max_size=12, unique=True),
    mass_kg=st.floats(0.01, 100.0),
)
def test_any_known_forces_make_a_population_that_draws(hold: list[float], mass_kg: float) -> None:
    assume(np.unique(np.log(hold)).size > 1)
    parts = bk.parts_of_pulls(fit_population(hold), mass_kg=mass_kg)
    drawn = bk.draw_parts(parts, 50, seed=0)
    assert (drawn["mass_kg"] == mass_kg).all()
    assert (drawn["stiction_n"] > 0.0).all() and "stiction_ratio" in parts.assumed


def test_parts_of_a_joint_are_its_draws(logs: list[Log]) -> None:
    joint = joint_from_pull(logs[0], rig=AT_PART)
    usual = bk.load_population("seized_parts")
    laid = bk.lay_over(usual, joint)
    drawn = bk.draw_parts(laid, 500, seed=1)
    rows = {path: np.array(one.values) for path, one in joint.vary().items()}
    places = [int(np.flatnonzero(rows["joint.stiction_n"] == f)[0]) for f in drawn["stiction_n"]]
    slide = drawn["stiction_n"] / drawn["stiction_ratio"]
    assert slide == pytest.approx(rows["joint.coulomb_n"][places])
    stiffness = drawn["stiction_n"] / drawn["presliding_m"]
    assert stiffness == pytest.approx(rows["joint.stiffness_n_per_m"][places])
    damping = 2.0 * drawn["bristle_damping_ratio"] * np.sqrt(stiffness * drawn["mass_kg"])
    assert damping == pytest.approx(rows["joint.damping_n_s_per_m"][places])
    assert drawn["mass_kg"] == pytest.approx(rows["part.mass_kg"][places])
    assert laid.parts.engagement_length_m == usual.parts.engagement_length_m
    assert "stribeck_velocity_m_per_s" in laid.assumed and "stiction_n" not in laid.assumed
    assert bk.load_population("seized_parts") == usual


def test_a_joint_without_a_peak_keeps_the_populations_ratio() -> None:
    t_s = np.arange(4000) / 1000.0
    x = 0.02 * np.sin(5 * t_s) + 0.01 * np.sin(13 * t_s + 1)
    v = 0.1 * np.cos(5 * t_s) + 0.13 * np.cos(13 * t_s + 1)
    a = -0.5 * np.sin(5 * t_s) - 1.69 * np.sin(13 * t_s + 1)
    log = Log(t_s=t_s, position_m=x, force_n=3.0 * a + 60.0 * np.sign(v) + 200.0 * v)
    joint = bk.JointFile.from_fit(bk.identify_inertia_friction(log), log)
    drawn = bk.draw_parts(bk.lay_over(bk.load_population("seized_parts"), joint), 500, seed=1)
    assert drawn["stiction_ratio"].min() >= 1.1 and drawn["stiction_ratio"].max() <= 3.0
    slide = drawn["stiction_n"] / drawn["stiction_ratio"]
    assert slide == pytest.approx(np.full(500, 60.0), rel=0.1)


def test_a_joint_without_draws_makes_no_parts(logs: list[Log]) -> None:
    bare = joint_from_pull(logs[0]).model_copy(update={"draws": None})
    with pytest.raises(ScenarioError, match=r"joint file: .*has no draws"):
        bk.lay_over(bk.load_population("seized_parts"), bare)
