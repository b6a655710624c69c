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


def test_shows_designed_gains_and_verdicts(call: Call) -> None:
    shown = call("design", "paper_as_computed", "--require-stable")
    assert shown.exit_code == 0
    rows = [line.split() for line in shown.stdout.splitlines()]
    assert ["total", "3,137.3", "1,283,290", "724.16"] in rows  # Table II prints 3137.3e3
    assert "Stribeck: steepest fall 857.8 N s/m" in shown.stdout
    assert shown.stdout.count(" stable ") == 2


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
                "pid": SETTINGS,
                "vibration": PULSES,
                "vibration_gains": UNSTABLE,
                "breakaway_travel_m": 3e-5,
            },
            ["step 1, pid", "step 2, vibration"],
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
