"""`breakaway design` shows gains and poles, and judges every gain set of a controller."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import breakaway as bk

Call = Callable[..., Any]
SETTINGS = {"gains": {"kind": "pole_placement", "settling_time_s": 5e-4, "damping_ratio": 1.0}}
PULSES = {"error_full_scale_m": 1e-4, "pulse_width_s": 1e-3}
UNSTABLE = {"kind": "given", "kp_n_per_m": 1e3, "ki_n_per_m_s": 1e9, "kd_n_s_per_m": 1.0}


def save(path: Path, controller: dict[str, Any]) -> Path:
    bk.save_scenario(bk.load_scenario("paper_as_computed").with_(controller=controller), path)
    return path


@pytest.mark.slow
def test_shows_designed_gains_and_verdicts(call: Call) -> None:
    shown = call("design", "paper_as_computed", "--require-stable")
    assert shown.exit_code == 0
    rows = [line.split() for line in shown.stdout.splitlines()]
    assert ["total", "3,137.3", "1,283,290", "724.16"] in rows  # Table II prints 3137.3e3
    assert "Stribeck: steepest fall 857.8 N s/m" in shown.stdout
    verdicts = [row[:2] for row in rows if row[:1] in (["stuck"], ["sliding"])]
    assert verdicts == 2 * [["stuck", "stable"], ["sliding", "stable"]]  # as designed, as it runs
    assert shown.stdout.count("UNSTABLE") == 1  # where friction falls, which is not counted


@pytest.mark.slow
def test_shows_margins_and_the_limit_cycle(call: Call) -> None:
    shown = call("design", "paper_as_computed").stdout
    assert "As pid runs: every 10 µs, held, no delay; loop opened at the force" in shown
    rows = [line.split() for line in shown.splitlines()]
    assert any(row[:6] == ["sliding", "stable", "0.576", "to", "276", "9.89"] for row in rows)
    assert "9.651 samples" in shown
    assert "Limit cycle: falling friction drives one" in shown
    assert ["frequency", "284.91", "Hz", "282.38", "Hz", "+0.9", "%"] in rows


@pytest.mark.slow
def test_json_holds_the_same(call: Call) -> None:
    content = json.loads(call("design", "paper_as_computed", "--json").stdout)
    [gains] = content["gain_sets"]
    assert content["stable"] is True
    assert round(gains["total"]["kp_n_per_m"] / 1e3, 1) == 3137.3
    assert gains["natural_frequency_rad_per_s"] == 8000.0
    for regime in ("stuck", "sliding"):
        assert len(gains[regime]["poles_per_s"]) == 3
        assert all(real < 0.0 for real, _ in gains[regime]["poles_per_s"])


def test_an_unstable_loop_is_a_finding_unless_stability_is_required(
    call: Call, tmp_path: Path
) -> None:
    path = save(tmp_path / "a.toml", {"kind": "pid", "gains": UNSTABLE})
    shown = call("design", path)
    assert shown.exit_code == 0
    assert "UNSTABLE" in shown.stdout
    assert "static" not in shown.stdout
    required = call("design", path, "--json", "--require-stable")
    assert required.exit_code == 4
    assert json.loads(required.stdout)["stable"] is False


@pytest.mark.parametrize(
    ("controller", "roles"),
    [
        ({"kind": "fm_vibration", "pid": SETTINGS, "vibration": PULSES}, ["vibration"]),
        (
            {
                "kind": "two_step",
                "breakaway": {"kind": "pid"} | SETTINGS,
                "vibration": {
                    "kind": "fm_vibration",
                    "pid": {"gains": UNSTABLE},
                    "vibration": PULSES,
                },
                "breakaway_travel_m": 3e-5,
            },
            ["step 1, pid", "step 2, vibration"],
        ),
        (
            {
                "kind": "two_step",
                "breakaway": {"kind": "pid"} | SETTINGS,
                "vibration": {"kind": "timed_impacts", "travel_m": 0.1, "target_s": 8.0},
                "breakaway_travel_m": 3e-5,
            },
            ["step 1, pid"],
        ),
    ],
)
def test_judges_each_gain_set(
    call: Call, tmp_path: Path, controller: dict[str, Any], roles: list[str]
) -> None:
    path = save(tmp_path / "a.toml", controller)
    content = json.loads(call("design", path, "--json").stdout)
    assert [gains["role"] for gains in content["gain_sets"]] == roles
    assert [gains["designed"] for gains in content["gain_sets"]] == [True, False][: len(roles)]
    shown = call("design", path).stdout
    assert all(f"Gains of {role}" in shown for role in roles)


def test_a_joint_that_can_not_be_designed_for_exits_with_2(call: Call, tmp_path: Path) -> None:
    path = tmp_path / "heavy.toml"
    heavy = bk.load_scenario("paper_as_computed").with_({"part.mass_kg": 100.0})
    bk.save_scenario(heavy, path)
    failed = call("design", path)
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert "joint.coulomb_n" in failed.stderr


@pytest.mark.slow
def test_a_loop_that_sampling_undoes_is_not_safe(call: Call, tmp_path: Path) -> None:
    """Stable for Routh and Hurwitz, with kd T_s / m = 2.5 unstable as it runs."""
    gains = {"kind": "given", "kp_n_per_m": 1e5, "ki_n_per_m_s": 1e6, "kd_n_s_per_m": 2500.0}
    slow = bk.load_scenario("paper_as_computed").with_(
        {"timing.control_period_s": 1e-3, "timing.steps_per_period": 100},
        controller={"kind": "pid", "gains": gains},
    )
    bk.save_scenario(slow, tmp_path / "slow.toml")
    shown = call("design", tmp_path / "slow.toml", "--require-stable")
    assert shown.exit_code == 4
    assert (
        "disagree: sliding: stable without sampling and delay, UNSTABLE as it runs" in shown.stdout
    )
    content = json.loads(call("design", tmp_path / "slow.toml", "--json").stdout)
    [one] = content["gain_sets"]
    assert (one["sliding"]["stable"], one["stable"], content["stable"]) == (True, False, False)


@pytest.mark.slow
def test_delay_and_filter_are_named(call: Call, tmp_path: Path) -> None:
    lagged = bk.load_scenario("paper_as_computed").with_(
        {"timing.one_sample_delay": True},
        controller={
            "kind": "pid",
            "velocity_from": "position_difference",
            "derivative_filter_s": 5e-5,
            **SETTINGS,
        },
    )
    bk.save_scenario(lagged, tmp_path / "a.toml")
    shown = call("design", tmp_path / "a.toml").stdout
    assert (
        "every 10 µs, held, 1 sample of delay, velocity differenced, derivative filtered over 50 µs"
        in shown
    )


@pytest.mark.slow
def test_out_holds_document_and_figures(call: Call, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shown = call("design", "paper_as_computed", "--json", "--out", out)
    content = json.loads(shown.stdout)
    figures = {"bode", "nyquist", "root_locus", "limit_cycle"}
    names = {f"{name}.{kind}" for name in figures for kind in ("png", "svg")} | {"design.json"}
    assert {path.name for path in out.iterdir()} == names
    assert [Path(path).name for path in content.pop("files")] == sorted(names)
    assert json.loads((out / "design.json").read_text("utf-8")) == content
    found = content["gain_sets"][0]["limit_cycle"]
    assert found["verdict"] == "agree: oscillation"
    assert abs(found["frequency_error_percent"]) < 2.0
    assert len(found["cycles"]["t_s"]) > 20
    loops = content["gain_sets"][0]["sampled"]["loops"]
    assert [loop["stable"] for loop in loops] == [True, True, False]
    assert loops[2]["phase_margin_deg"] is None


@pytest.mark.slow
def test_a_folder_that_can_not_be_written_exits_with_3(call: Call, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    failed = call("design", "paper_as_computed", "--out", tmp_path / "file")
    assert failed.exit_code == 3 and "file" in failed.stderr


@pytest.mark.parametrize(
    "controller",
    [
        {"kind": "force_ramp", "rate_n_per_s": 100.0, "travel_m": 0.1},
        {"kind": "timed_impacts", "travel_m": 0.1, "target_s": 8.0},
    ],
)
def test_a_controller_without_gains_has_no_loop(
    call: Call, tmp_path: Path, controller: dict[str, Any]
) -> None:
    path = save(tmp_path / "a.toml", controller)
    shown = call("design", path)
    assert shown.exit_code == 0
    assert f"A {controller['kind']} controller has no linear loop" in shown.stdout
    assert "breakaway tune" in shown.stdout and "breakaway compare" in shown.stdout
    content = json.loads(call("design", path, "--json").stdout)
    assert content["stable"] is None and content["gain_sets"] == []
    assert call("design", path, "--require-stable").exit_code == 4  # nothing was shown to be safe


def test_a_rigid_joint_has_no_stuck_loop(call: Call, tmp_path: Path) -> None:
    levels = {"stiction_n": 450.0, "coulomb_n": 360.0, "engagement_length_m": 0.1}
    rigid = {"law": "coulomb_stiction", "stribeck_velocity_m_per_s": 0.09, **levels}
    scenario = bk.load_scenario("paper_as_computed").with_(
        {"joint": rigid, "limits.breakaway_travel_m": 1e-5},
        controller={"kind": "fm_vibration", "pid": {"gains": UNSTABLE}, "vibration": PULSES},
    )
    bk.save_scenario(scenario, tmp_path / "a.toml")
    shown = call("design", tmp_path / "a.toml").stdout
    assert "this law has no stiffness while it is stuck" in shown
    content = json.loads(call("design", tmp_path / "a.toml", "--json").stdout)
    [one] = content["gain_sets"]
    assert one["stuck"] is None
    assert one["sampled"]["loops"][0]["regime"] == "sliding"
