"""Limits turn forces into stresses, against what materials bear."""

from __future__ import annotations

from pathlib import Path

import pytest

import breakaway as bk
from breakaway.model.scenario.harm import materials


def test_a_section_bears_its_strength_times_its_area() -> None:
    one = bk.StressLimit(place="neck", section_m2=1.2e-5, material="inconel_718", share=0.5)
    assert one.force_max_n == pytest.approx(0.5 * materials()["inconel_718"].yield_pa * 1.2e-5)
    given = bk.StressLimit(place="fillet", stress_per_newton_pa=2e5, allowed_pa=4e8)
    assert given.force_max_n == pytest.approx(2000.0)


def test_the_weakest_place_counts() -> None:
    places = [
        bk.StressLimit(place="neck", section_m2=1e-5, allowed_pa=3e8),
        bk.StressLimit(place="slot", of="host", bearing_area_m2=2e-5, allowed_pa=1e8),
    ]
    limits = bk.HarmLimits(stresses=places)
    assert limits.weakest is places[1]
    assert limits.force_max_n == pytest.approx(2000.0)
    assert bk.HarmLimits(jump_max_m=1e-4).force_max_n == float("inf")


@pytest.mark.parametrize("name", materials())
def test_every_material_has_a_source_and_a_strength_of_a_metal(name: str) -> None:
    one = materials()[name]
    assert one.source and one.description
    assert 1e8 < one.yield_pa < 3e9
    if one.fatigue_pa is not None:
        assert one.basis and one.fatigue_pa < one.yield_pa


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing is limited"),
        ('[[stresses]]\nplace = "neck"\nallowed_pa = 1e8', "exactly one of section_m2"),
        ('[[stresses]]\nplace = "neck"\nsection_m2 = 1e-5', "either material or allowed_pa"),
        (
            '[[stresses]]\nplace = "neck"\nsection_m2 = 1e-5\nmaterial = "cheese"',
            "'cheese' is not one of .*inconel_718",
        ),
        ("jump_max_mm = 1.0", "jump_max_mm"),
        ("jump_max_m = -1.0", "jump_max_m: -1.0"),
    ],
)
def test_limits_that_say_nothing_are_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "limits.toml"
    path.write_text(text)
    with pytest.raises(bk.ScenarioError, match=words):
        bk.load_limits(path)
