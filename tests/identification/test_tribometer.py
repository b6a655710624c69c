"""The measured tribometer: one speed, so presliding and the level show, and no peak."""

from pathlib import Path

import pytest

from breakaway.measure.identification import ComparedLaw, compare_laws
from breakaway.measure.logs import read_log

TRIBOMETER = Path(__file__).parents[2] / "../shared/data/tribometer/tribometer.csv"
pytestmark = pytest.mark.skipif(
    not TRIBOMETER.is_file(), reason="the measured logs (../shared/data) are absent"
)


@pytest.fixture(scope="module")
def compared() -> tuple[ComparedLaw, ...]:
    return compare_laws(
        read_log(TRIBOMETER),
        held_out=(35.0, 70.1),
        asymmetric=True,
        position_dependent=True,
        starts=2,
    )


@pytest.mark.slow
def test_the_chosen_law_predicts_what_it_has_not_seen(compared: tuple[ComparedLaw, ...]) -> None:
    chosen = [one for one in compared if one.pays][-1]
    assert chosen.fit.law.has_bristle
    assert chosen.held_out_error <= 0.20  # LuGre as published with the log: 0.243 N
    assert chosen.held_out_error < compared[0].held_out_error


def test_one_speed_tells_no_peak(compared: tuple[ComparedLaw, ...]) -> None:
    for one in compared[1:]:
        told = {verdict.parameter: verdict for verdict in one.fit.verdicts}
        for name in ("stiction_ratio", "stribeck_velocity_m_per_s"):
            assert not told[name].identifiable
            assert "nearly one speed" in told[name].because
            assert told[name].remedy


def test_the_stiffness_is_that_of_the_machine(compared: tuple[ComparedLaw, ...]) -> None:
    lugre = next(one.fit for one in compared if one.fit.law.name == "lugre")
    assert lugre["stiffness_n_per_m"].value == pytest.approx(3.65e4, rel=0.3)
