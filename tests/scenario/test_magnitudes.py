"""Numbers that no part or rig has are refused, and numbers that do not fit together are told."""

from __future__ import annotations

from typing import Any

import pytest

import breakaway as bk

PAPER = bk.load_scenario("paper_as_computed")


@pytest.mark.parametrize(
    ("path", "value", "most"),
    [
        ("joint.stiction_n", 1e300, "1e+09"),
        ("joint.coulomb_n", 1e10, "1e+09"),
        ("joint.stiffness_n_per_m", 1e13, "1e+12"),
        ("joint.engagement_length_m", 1e10, "1e+09"),
        ("joint.stribeck_velocity_m_per_s", 1e7, "1e+06"),
        ("part.mass_kg", 1e9, "1e+06"),
        ("reference.distance_m", 1e10, "1e+09"),
        ("reference.start_s", 1e9, "1e+06"),
        ("timing.duration_s", 1e9, "1e+06"),
    ],
)
def test_what_no_part_has_is_refused(path: str, value: float, most: str) -> None:
    with pytest.raises(bk.ScenarioError) as no:
        PAPER.with_({path: value})
    assert str(no.value).startswith(f"{path}: {value!r} is not <= {most}; give a number >")


@pytest.mark.parametrize("value", [1e300, 1e16])
@pytest.mark.parametrize("field", ["force_max_n", "bandwidth_hz", "force_rate_max_n_per_s"])
def test_what_no_actuator_has_is_refused(field: str, value: float) -> None:
    usual = {"force_max_n": 900.0, "bandwidth_hz": 100.0, "force_rate_max_n_per_s": 1e6}
    with pytest.raises(bk.ScenarioError, match=rf"^{field}: .* is not <= 1e\+\d\d; give a number"):
        bk.ForceActuator(**(usual | {field: value}))


def test_a_limit_may_be_none() -> None:
    """A bound beyond everything asks for nothing."""
    assert PAPER.with_({"limits.diverged_force_n": 1e300}).limits.diverged_force_n == 1e300


def warnings_of(changes: dict[str, Any], words: str) -> list[str]:
    run = bk.simulate(PAPER.with_({"timing.duration_s": 0.01, "trace.every_samples": 0, **changes}))
    return [one for one in run.warnings if words in one]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"joint.stiction_n": 300.0}, "joint.stiction_n = 300 N is below joint.coulomb_n = 360 N"),
        (
            {"joint.coulomb_n": 20.0},
            "joint.stiction_n = 450 N is more than ten times joint.coulomb_n = 20 N",
        ),
        (
            {"joint.residual_n": 500.0, "controller.gains": bk.resolve(PAPER).controller.gains},
            "joint.residual_n = 500 N is above joint.coulomb_n = 360 N: friction rises",
        ),
        (
            {"part.mass_kg": 95.0, "controller.gains": bk.resolve(PAPER).controller.gains},
            "joint.residual_n = 931.95 N is above joint.coulomb_n = 360 N: friction rises",
        ),
        (
            {"reference.distance_m": 100.0},
            "reference.distance_m = 100 m is more than twice joint.engagement_length_m = 0.1 m",
        ),
        (
            {"reference.start_s": 0.01},
            "reference.start_s = 0.01 s is not before the end of the run at timing.duration_s",
        ),
    ],
)
def test_what_does_not_fit_together_is_told(changes: dict[str, Any], words: str) -> None:
    assert len(warnings_of(changes, words)) == 1
    assert warnings_of({}, words) == []


def test_nothing_is_told_of_the_presets() -> None:
    doubts = ("joint.stiction_n", "joint.residual_n", "reference.")
    for name in bk.preset_names():
        run = bk.simulate(bk.load_scenario(name))
        assert not [one for one in run.warnings if one.startswith(doubts)]
