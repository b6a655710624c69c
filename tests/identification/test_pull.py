"""A pull to slip becomes a joint: what was seen has intervals, what was not is called assumed."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.identification.pulls import pulled

import breakaway as bk
from breakaway.errors import LogError, ScenarioError
from breakaway.measure.identification import JointFile, RigFile, joint_from_pull
from breakaway.measure.logs import Log

CASES = Path(__file__).parents[2] / "../shared/cases"
AT_PART = RigFile(position_sensor="part")


def machine_log(path: Path) -> Log:
    """Read a log of a German test machine row by row; rows that are no numbers are left out."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines()[7:]:
        try:
            row = [float(cell.replace(",", ".")) for cell in line.split(";")]
        except ValueError:
            continue
        if not rows or row[0] > rows[-1][0]:
            rows.append(row)
    t_s, x_mm, force_kn = np.array(rows).T
    return Log(t_s=t_s, position_m=1e-3 * x_mm, force_n=1e3 * force_kn)


@pytest.mark.parametrize(
    ("file", "stiction_n", "coulomb_n"),
    [("teil_1.csv", 3444.7, 1752.8), ("teil_2.csv", 3377.0, 2221.0)],
)
def test_the_truth_of_a_test_machines_pull_lies_in_the_intervals(
    file: str, stiction_n: float, coulomb_n: float
) -> None:
    if not CASES.is_dir():
        pytest.skip("the cases (../shared/cases) are absent")
    joint = joint_from_pull(machine_log(CASES / file), rig=AT_PART)
    for name, truth in (
        ("stiction_n", stiction_n),
        ("coulomb_n", coulomb_n),
        ("stiffness_n_per_m", 6e7),
    ):
        low, high = joint.interval[name]
        assert low <= truth <= high, name
        assert high - low < 0.08 * truth, name


def test_intervals_of_another_solvers_pulls_hold_their_truth() -> None:
    rng = np.random.default_rng(5)
    held = dict.fromkeys(("stiction_n", "coulomb_n", "stiffness_n_per_m"), 0)
    seen = dict(held)
    for seed in range(60):
        stiction_n = float(np.exp(rng.uniform(*np.log([400.0, 5000.0]))))
        truth = {
            "stiction_n": stiction_n,
            "coulomb_n": stiction_n / rng.uniform(1.2, 2.5),
            "stiffness_n_per_m": float(np.exp(rng.uniform(*np.log([3e7, 1.5e8])))),
        }
        log = pulled(
            **truth,
            weakening_m=float(np.exp(rng.uniform(*np.log([5e-5, 3e-4])))),
            machine_n_per_m=float(np.exp(rng.uniform(*np.log([2e6, 2e7])))),
            mass_kg=rng.uniform(0.5, 10.0),
            seed=seed,
        )
        interval = joint_from_pull(log, rig=AT_PART).interval
        for name in interval.keys() & truth.keys():
            low, high = interval[name]
            seen[name] += 1
            held[name] += low <= truth[name] <= high
    assert min(seen.values()) > 50
    assert all(held[name] >= 0.9 * seen[name] for name in seen), (held, seen)


@pytest.mark.parametrize("law", ["lugre", "elasto_plastic"])
def test_a_simulated_pull_gives_its_joint_and_no_more_than_its_stiction(
    law: str,
) -> None:
    own = {"elastic_share": 0.7} if law == "elasto_plastic" else {}
    method = bk.load_method("steady_feed")
    scenario = bk.load_scenario("paper_as_computed").with_(
        {"timing.duration_s": 1.2, "timing.control_period_s": 5e-5, "trace.every_samples": 10},
        joint={
            "law": law,
            "stiction_n": 900.0,
            "coulomb_n": 500.0,
            "residual_n": 499.9,
            "stribeck_velocity_m_per_s": 1e-3,
            "stiffness_n_per_m": 3.6e7,
            "damping_n_s_per_m": 2000.0,
            "engagement_length_m": 10.0,
            **own,
        },
        actuator=method.actuator.model_dump() | {"stiffness_n_per_m": 3e7},
        controller=method.controller.model_dump() | {"speed_m_per_s": 4e-3, "approach_s": 0.15},
        reference={"kind": "ramp", "distance_m": 4.8e-3, "duration_s": 1.2},
    )
    trace = bk.simulate(scenario).trace
    noise = np.random.default_rng(0).standard_normal((2, len(trace["t_s"])))
    log = Log(
        t_s=trace["t_s"],
        position_m=trace["position_m"] + 1e-7 * noise[0],
        force_n=trace["applied_force_n"] + noise[1],
    )
    joint = joint_from_pull(log, rig=AT_PART)
    peak_n = trace["applied_force_n"].max()
    assert joint.joint.stiction_n == pytest.approx(peak_n, rel=0.01)
    assert peak_n < 900.0  # these laws let go below F_s where friction falls with speed
    assert any("at this loading rate" in note for note in joint.provenance.notes)
    assert joint.joint.coulomb_n == pytest.approx(500.0, rel=0.02)
    assert joint.joint.stiffness_n_per_m == pytest.approx(3.6e7, rel=0.1)


def test_the_rigs_stiffness_is_taken_out_where_it_is_known() -> None:
    log = pulled(3000.0, 1500.0, machine_n_per_m=3e7, at_drive=True)
    blind = joint_from_pull(log)
    series = 1.0 / (1.0 / 6e7 + 1.0 / 3e7)
    assert blind.joint.stiffness_n_per_m == pytest.approx(series, rel=0.03)
    assert "series" in blind.at_least["joint.stiffness_n_per_m"]
    assert math.isinf(blind.interval["stiffness_n_per_m"][1])
    told = joint_from_pull(log, rig=RigFile(stiffness_n_per_m=3e7, stiffness_error_n_per_m=1e5))
    low, high = told.interval["stiffness_n_per_m"]
    assert low < 6e7 < high and "joint.stiffness_n_per_m" not in told.at_least


def test_an_uncertain_rig_widens_the_stiffness() -> None:
    log = pulled(3000.0, 1500.0, machine_n_per_m=3e7, at_drive=True)
    widths = []
    for error in (0.0, 1e6):
        rig = RigFile(stiffness_n_per_m=3e7, stiffness_error_n_per_m=error)
        low, high = joint_from_pull(log, rig=rig).interval["stiffness_n_per_m"]
        widths.append(1.0 / low - 1.0 / high)
    assert widths[1] > 2.0 * 1.9 * 1e6 / 3e7**2 > widths[0]


def test_a_peak_beside_a_gap_stays_a_bound() -> None:
    whole = pulled(3000.0, 1500.0)
    peak = int(np.argmax(whole.force_n))
    kept = np.r_[: peak + 1, peak + 60 : len(whole.t_s)]
    log = Log(t_s=whole.t_s[kept], position_m=whole.position_m[kept], force_n=whole.force_n[kept])
    joint = joint_from_pull(log, rig=AT_PART)
    assert "gap" in joint.at_least["joint.stiction_n"]
    assert joint.origin("joint.stiction_n").startswith("at least: ")
    assert math.isinf(joint.interval["stiction_n"][1])
    drawn = np.array(joint.vary()["joint.stiction_n"].values)
    assert drawn.min() >= joint.joint.stiction_n and drawn.max() > 2.0 * joint.joint.stiction_n
    laid = bk.lay_over(bk.load_scenario("paper_as_computed"), joint)
    assert laid.joint_source is not None and "gap" in laid.joint_source.at_least
    warned = bk.simulate(laid.with_({"timing.duration_s": 0.01})).warnings
    assert any("bounds from below" in line and "gap" in line for line in warned)


def test_a_part_that_never_moves_gives_a_bound_and_an_assumed_sliding_friction() -> None:
    log = pulled(3000.0, 1500.0, noise_m=5e-6).between(0.0, 0.35)
    joint = joint_from_pull(log)
    assert "never moves" in joint.at_least["joint.stiction_n"]
    assert "joint.coulomb_n" in joint.assumed and "joint.coulomb_n" in joint.not_identified
    assert joint.origin("joint.coulomb_n").startswith("assumed: ")
    assert "coulomb_n" not in joint.interval and joint.pull is not None
    assert joint.pull.release_speed_m_per_s is None


def test_what_the_log_does_not_tell_is_named_with_a_range_and_varied() -> None:
    joint = joint_from_pull(pulled(3000.0, 1500.0), rig=AT_PART)
    usual = bk.load_population("seized_parts").parts
    assert joint.assumed.keys() == {
        "joint.damping_n_s_per_m",
        "joint.viscous_n_s_per_m",
        "joint.stribeck_velocity_m_per_s",
        "part.mass_kg",
    }
    mass = joint.assumed["part.mass_kg"]
    assert (mass.low, mass.high) == (usual.mass_kg.low, usual.mass_kg.high)
    assert joint.assumed.keys() <= joint.not_identified.keys()
    assert any("no measured population" in note for note in joint.provenance.notes)
    for path, one in joint.assumed.items():
        drawn = np.array(joint.vary()[path].values)
        assert one.low <= drawn.min() and drawn.max() <= one.high and np.ptp(drawn) > 0.0
    assert set(joint.scenario_changes()) == {
        "joint.stiction_n",
        "joint.coulomb_n",
        "joint.stiffness_n_per_m",
    }


def test_a_weighed_mass_is_given_not_assumed() -> None:
    joint = joint_from_pull(pulled(3000.0, 1500.0), mass_kg=2.5)
    assert joint.part.mass_kg == 2.5 and "part.mass_kg" not in joint.assumed
    assert joint.origin("part.mass_kg") == "given"
    assert set(joint.vary()["part.mass_kg"].values) == {2.5}


def test_every_draw_slides_with_what_was_seen_and_is_a_valid_joint() -> None:
    joint = joint_from_pull(pulled(3000.0, 1500.0), rig=AT_PART)
    assert joint.draws is not None and joint.pull is not None
    rows = {path: np.array(column) for path, column in joint.draws.values.items()}
    v = joint.pull.sliding_speed_m_per_s
    assert v is not None
    fallen = np.exp(-((v / rows["joint.stribeck_velocity_m_per_s"]) ** 2))
    hold, slide = rows["joint.stiction_n"], rows["joint.coulomb_n"]
    seen = slide + (hold - slide) * fallen + rows["joint.viscous_n_s_per_m"] * v
    low, high = joint.interval["coulomb_n"]
    assert np.mean((seen >= low) & (seen <= high)) > 0.9
    base = bk.load_scenario("paper_as_computed")
    for row in range(0, 200, 10):
        drawn = {path: float(column[row]) for path, column in rows.items()}
        assert base.with_(drawn).joint.stiction_n == drawn["joint.stiction_n"]


def test_a_joint_of_a_pull_comes_back_as_it_was_saved(tmp_path: Path) -> None:
    joint = joint_from_pull(pulled(3000.0, 1500.0), rig=RigFile(stiffness_n_per_m=5e6), mass_kg=1.0)
    joint.save(tmp_path / "joint.toml")
    assert JointFile.load(tmp_path / "joint.toml") == joint
    assert joint.provenance.method == "breakaway event"
    assert joint.provenance.search is not None
    assert joint.provenance.search.rig == RigFile(stiffness_n_per_m=5e6)


def test_a_damaged_range_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "joint.toml"
    joint_from_pull(pulled(3000.0, 1500.0)).save(path)
    text = path.read_text()
    assert "low = 0.2\n" in text
    path.write_text(text.replace("low = 0.2\n", "low = 3.0\n"))
    with pytest.raises(ScenarioError, match=r"assumed.part\.mass_kg.*low <= value <= high"):
        JointFile.load(path)


def test_a_log_without_a_start_from_rest_gives_no_joint() -> None:
    log = pulled(3000.0, 1500.0).between(1.1, 1.5)
    with pytest.raises(LogError, match="no joint comes of this log: is already moving"):
        joint_from_pull(log)


def test_a_force_of_the_wrong_sign_is_named() -> None:
    log = pulled(3000.0, 1500.0)
    turned = Log(t_s=log.t_s, position_m=log.position_m, force_n=-log.force_n)
    with pytest.raises(LogError, match=r"slides against the force.* another sign in the mapping"):
        joint_from_pull(turned)


def test_a_slow_pull_without_a_peak_still_has_draws() -> None:
    t_s = np.arange(4000) / 100.0
    noise = np.random.default_rng(0).standard_normal((2, 4000))
    log = Log(
        t_s=t_s,
        position_m=1e-5 * np.maximum(t_s - 10.0, 0.0) + 1e-8 * noise[0],
        force_n=50.0 * np.minimum(t_s, 10.0) + noise[1],
    )
    joint = joint_from_pull(log)
    assert "does not exceed that of sliding" in joint.at_least["joint.stiction_n"]
    rows = {path: np.array(one.values) for path, one in joint.vary().items()}
    assert all((column > 0.0).all() for column in rows.values())
    assert (rows["joint.stiction_n"] >= rows["joint.coulomb_n"]).all()


@settings(max_examples=60, deadline=None)
@given(
    ways=st.lists(st.floats(-1e-3, 1e-3), min_size=3, max_size=6),
    loads=st.lists(st.floats(-1e4, 1e4), min_size=3, max_size=6),
    noise=st.sampled_from([0.0, 1e-9, 1e-4]),
)
def test_any_log_gives_a_joint_that_can_be_kept_or_is_refused(
    ways: list[float], loads: list[float], noise: float
) -> None:
    t_s = np.linspace(0.0, 2.0, 400)
    rng = np.random.default_rng(1)
    x, force = (
        np.interp(t_s, np.linspace(0.2, 2.0, len(knots)), knots)
        + noise * scale * rng.standard_normal(400)
        for knots, scale in ((ways, 1.0), (loads, 1e6))
    )
    try:
        joint = joint_from_pull(Log(t_s=t_s, position_m=x, force_n=force), mass_kg=1.0)
    except LogError:
        return
    assert JointFile.parse(joint.model_dump(mode="json")) == joint
    for path, one in joint.vary().items():
        values = np.array(one.values)
        assert np.isfinite(values).all() and (values >= 0.0).all(), path
    for low, high in joint.interval.values():
        assert 0.0 <= low <= high


@pytest.mark.parametrize("mass_kg", [0.0, -1.0, math.nan, 1e7])
def test_an_impossible_mass_is_refused(mass_kg: float) -> None:
    with pytest.raises(LogError, match=r"mass_kg: .* is not > 0 and <= 1e6"):
        joint_from_pull(pulled(3000.0, 1500.0), mass_kg=mass_kg)


def test_the_report_of_another_log_is_refused() -> None:
    one = pulled(3000.0, 1500.0)
    named = Log(force_n=one.force_n, channels=one.channels, source=Path("other.csv"))
    with pytest.raises(LogError, match=r"report: is of other\.csv"):
        joint_from_pull(one, report=bk.find_breakaway_events(named))
    with pytest.raises(LogError, match="rig: the report was made with its own"):
        joint_from_pull(one, report=bk.find_breakaway_events(one), rig=AT_PART)


@settings(max_examples=20, deadline=None)
@given(
    stiction_n=st.floats(500.0, 5000.0),
    ratio=st.floats(1.3, 2.5),
    factor=st.floats(0.1, 10.0),
    shift_m=st.floats(-0.1, 0.1),
    shift_s=st.floats(-100.0, 100.0),
    flipped=st.booleans(),
)
def test_a_joint_does_not_depend_on_where_when_or_in_which_direction_it_was_pulled(
    stiction_n: float, ratio: float, factor: float, shift_m: float, shift_s: float, flipped: bool
) -> None:
    log = pulled(stiction_n, stiction_n / ratio)
    sign = -1.0 if flipped else 1.0
    other = Log(
        t_s=log.t_s + shift_s,
        position_m=sign * (log.position_m + shift_m),
        force_n=sign * factor * log.force_n,
    )
    first, second = joint_from_pull(log, rig=AT_PART), joint_from_pull(other, rig=AT_PART)
    for path, value in first.scenario_changes().items():
        assert second.scenario_changes()[path] == pytest.approx(factor * value, rel=1e-3)
    for name in ("stiction_n", "coulomb_n", "stiffness_n_per_m"):
        low, high = (factor * end for end in first.interval[name])
        assert second.interval[name] == pytest.approx([low, high], rel=2e-3)
