"""The measured positioning system: what was published of it, and what it must predict."""

from pathlib import Path

import pytest

from breakaway.measure.identification import Cascade, Identification, identify
from breakaway.measure.identification.verdicts import stiction_peak
from breakaway.measure.logs import Log, read_log

EMPS = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"
pytestmark = pytest.mark.skipif(
    not EMPS.is_file(), reason="the measured logs (../shared/data) are absent"
)
GAIN_N_PER_V = 35.15065188
CASCADE = Cascade(
    position_gain_per_s=160.18,
    velocity_gain_n_s_per_m=243.45 * GAIN_N_PER_V,
    force_limit_n=10.0 * GAIN_N_PER_V,
)
LAPS = [(0.0, 6.24), (6.24, 12.48), (12.48, 18.72)]
LAP_4 = (18.72, 24.85)


@pytest.fixture(scope="module")
def log() -> Log:
    return read_log(EMPS)


@pytest.fixture(scope="module")
def laps(log: Log) -> Identification:
    return identify(
        log,
        law="lugre",
        asymmetric=True,
        motion="closed_loop",
        controller=CASCADE,
        repeats=LAPS,
        lowpass_hz=100.0,
        starts=2,
    )


def test_three_laps_predict_the_fourth(laps: Identification) -> None:
    free = laps.predict(spans=[LAP_4], motion="free")
    assert free.channel == "position_m"
    assert free.rms_error <= 1.15e-3  # published models: 1.22 mm at best
    assert laps.predict(spans=[LAP_4]).relative_force_error_percent < 3.0


def test_there_is_no_stiction_peak(laps: Identification) -> None:
    told = stiction_peak({one.name: one for one in laps.estimates}, laps.verdicts)
    assert told.startswith("stiction peak: none")
    assert laps["stiction_ratio"].high < 1.0


def test_laps_drift_by_less_than_the_friction(laps: Identification) -> None:
    for name in ("offset_2_n", "offset_3_n"):
        assert abs(laps[name].value) < 1.0


def test_the_whole_record_is_replayed_in_closed_loop(log: Log) -> None:
    found = identify(
        log,
        law="lugre",
        asymmetric=True,
        motion="closed_loop",
        controller=CASCADE,
        lowpass_hz=100.0,
        starts=1,
    )
    assert found.relative_error_percent <= 2.7
    assert found["mass_kg"].value == pytest.approx(95.15, rel=0.02)


def test_least_squares_is_as_published(log: Log) -> None:
    both = identify(log, law="coulomb", method="least_squares")
    for name, value, deviation in (
        ("mass_kg", 95.1089, 0.1085),
        ("viscous_n_s_per_m", 203.5034, 1.146),
        ("coulomb_n", 20.3935, 0.101),
        ("offset_n", -3.1648, 0.044),
    ):
        assert both[name].value == pytest.approx(value, abs=deviation)
    each = identify(log, law="coulomb", method="least_squares", asymmetric=True)
    assert each["viscous_positive_n_s_per_m"].value == pytest.approx(166.71, abs=1.2)
    assert each["viscous_negative_n_s_per_m"].value == pytest.approx(240.42, abs=1.2)
    assert each["coulomb_positive_n"].value == pytest.approx(20.144, abs=0.1)
    assert each["coulomb_negative_n"].value == pytest.approx(20.628, abs=0.1)
