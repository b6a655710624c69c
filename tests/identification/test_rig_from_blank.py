"""Blank pulls tell the rig's stiffness and mass, with intervals that hold them."""

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.identification.blank import rig_from_blank
from breakaway.measure.logs import Log

STIFFNESS_N_PER_M = 3e6
MASS_KG = 4.2
T_S = np.arange(3000) / 1000.0


def held(
    seed: int = 0, *, play_m: float = 0.0, bend: float = 0.0, stiffness: float = STIFFNESS_N_PER_M
) -> Log:
    """A pull to 2 kN and back against a part that is held, after some play."""
    rng = np.random.default_rng(seed)
    load = 2000.0 * np.sin(np.pi * np.clip((T_S - 0.3) / 2.4, 0.0, 1.0))
    taken = np.clip(T_S / 0.3, 0.0, 1.0)
    x = play_m * taken + load / stiffness * (1.0 - bend * load / 2000.0)
    x = x + 2e-7 * rng.standard_normal(len(T_S))
    return Log(t_s=T_S, position_m=x, force_n=load + 2.0 * rng.standard_normal(len(T_S)))


def free(seed: int = 0, mass: float = MASS_KG) -> Log:
    """A pull to and fro without a part; the guide has friction of its own."""
    rng = np.random.default_rng(seed)
    w, u = 2 * np.pi * 1.1, 2 * np.pi * 4.3
    x = 0.02 * np.sin(w * T_S) + 0.003 * np.sin(u * T_S)
    v = 0.02 * w * np.cos(w * T_S) + 0.003 * u * np.cos(u * T_S)
    a = -0.02 * w**2 * np.sin(w * T_S) - 0.003 * u**2 * np.sin(u * T_S)
    force = mass * a + 3.0 * np.tanh(v / 1e-3) + 12.0 * v + 1.5
    x = x + 1e-6 * rng.standard_normal(len(T_S))
    return Log(t_s=T_S, position_m=x, force_n=force + 0.5 * rng.standard_normal(len(T_S)))


def test_intervals_of_the_stiffness_hold_it() -> None:
    inside = 0
    for seed in range(100):
        (figure,) = rig_from_blank([held(seed)]).figures
        assert figure.value == pytest.approx(STIFFNESS_N_PER_M, rel=1e-3)
        inside += figure.low < STIFFNESS_N_PER_M < figure.high
    assert 88 <= inside <= 100


def test_intervals_of_the_mass_hold_it() -> None:
    inside = 0
    for seed in range(60):
        (figure,) = rig_from_blank([free(seed)]).figures
        assert figure.name == "mass_kg"
        assert figure.value == pytest.approx(MASS_KG, rel=0.02)
        inside += figure.low < MASS_KG < figure.high
    assert 51 <= inside <= 60


def test_both_pulls_make_one_rig() -> None:
    blank = rig_from_blank([free(), held()])
    rig = blank.rig
    assert rig.stiffness_n_per_m == pytest.approx(STIFFNESS_N_PER_M, rel=1e-3)
    assert rig.mass_kg == pytest.approx(MASS_KG, rel=0.02)
    assert 0.0 < rig.stiffness_error_n_per_m < 0.01 * STIFFNESS_N_PER_M
    assert 0.0 < rig.mass_error_kg < 0.05 * MASS_KG
    assert (rig.filter_hz, rig.force_calibration_percent, rig.position_sensor) == (
        None,
        0.0,
        "drive",
    )


def test_play_is_told_and_leaves_the_stiffness_alone() -> None:
    blank = rig_from_blank([held(play_m=1e-4)])
    assert blank.figures[0].value == pytest.approx(STIFFNESS_N_PER_M, rel=2e-3)
    (note,) = [note for note in blank.notes if "play" in note]
    assert float(note.split(" moves ")[1].split(" m ")[0]) == pytest.approx(1e-4, rel=0.05)


def test_a_stiffness_that_bends_has_an_error_that_says_so() -> None:
    blank = rig_from_blank([held(bend=0.15)])
    (figure,) = blank.figures
    assert any("the stiffness grows with the load" in note for note in blank.notes)
    assert figure.low < STIFFNESS_N_PER_M / (1.0 - 0.15) and figure.high > STIFFNESS_N_PER_M
    assert figure.standard_error > 20.0 * rig_from_blank([held()]).figures[0].standard_error


def test_a_rig_that_is_too_stiff_to_show_is_a_bound() -> None:
    blank = rig_from_blank([held(stiffness=1e13)])
    assert blank.figures == () and blank.rig.stiffness_n_per_m is None
    assert any("position_sensor = 'part'" in note for note in blank.notes)


def test_a_mass_that_does_not_show_is_not_told() -> None:
    blank = rig_from_blank([free(mass=0.0)])
    assert blank.figures == () and blank.rig.mass_kg == 0.0
    assert any("is not distinct from 0; accelerate harder" in note for note in blank.notes)


def test_what_is_no_blank_pull_is_refused() -> None:
    with pytest.raises(LogError, match="none is given; give a pull against a held part"):
        rig_from_blank([])
    with pytest.raises(LogError, match="two are pulls against a held part; give one of each"):
        rig_from_blank([held(0), held(1)])
    log = held()
    slips = log.position_m + 8e-4 * np.cumsum(T_S > 1.2) / len(T_S)
    with pytest.raises(LogError, match=r"correlate by 0\.\d+, .* so that it does not slip"):
        rig_from_blank([Log(t_s=T_S, position_m=slips, force_n=log.force_n)])
