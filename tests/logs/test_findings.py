"""Findings are known answers on made-up and on measured logs."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from breakaway.measure.logs import Finding, Log, read_log
from breakaway.measure.logs.findings import quantum

DATA = Path(__file__).parents[2] / "../shared/data"
measured = pytest.mark.skipif(
    not DATA.is_dir(), reason="the measured logs (../shared/data) are absent"
)

T_S = np.arange(2000) / 1000.0
NOISE = np.random.default_rng(5).standard_normal(2000)


def findings(values: np.ndarray = NOISE, t_s: np.ndarray = T_S) -> dict[str, Finding]:
    return {f.kind: f for f in Log(t_s=t_s, force_n=values).findings}


def test_a_clean_log_has_none() -> None:
    assert findings() == {}
    assert findings(np.sin(3 * T_S)) == {}


def test_a_gap() -> None:
    found = findings(t_s=np.where(np.arange(2000) < 500, T_S, T_S + 0.27))["gap"]
    assert (found.channel, found.count, found.first_t_s) == ("t_s", 1, pytest.approx(0.499))
    assert (
        str(found) == "t_s: 1 gap of up to 0.271 s, first after 0.499 s; the median step is 0.001 s"
    )


def test_jitter_is_no_gap() -> None:
    t_s = T_S + np.cumsum(np.arange(2000) % 100 == 50) * 0.001
    found = findings(t_s=t_s)
    assert set(found) == {"jitter"}
    assert found["jitter"].count == 20
    assert "20 uneven steps of 0.002 to 0.002 s" in found["jitter"].message
    tiny = np.random.default_rng(1).uniform(-0.004, 0.004, 2000) * 0.001
    assert findings(t_s=T_S + tiny) == {}


def test_repeated_and_unordered_stamps() -> None:
    t_s = T_S.copy()
    t_s[10], t_s[20] = t_s[9], t_s[3]
    found = findings(t_s=t_s)
    assert (found["repeated_stamps"].count, found["unordered_stamps"].count) == (1, 1)
    assert "go back, first row 21, from 0.019 s to 0.003 s" in found["unordered_stamps"].message


def test_all_stamps_equal() -> None:
    assert findings(t_s=np.zeros(2000))["repeated_stamps"].count == 1999


def test_a_constant_channel() -> None:
    found = findings(np.full(2000, 3.0))
    assert set(found) == {"constant"}
    assert str(found["constant"]) == "force_n: all 2000 values are 3"


def test_saturation() -> None:
    found = findings(np.clip(20.0 * np.sin(20 * T_S) + 0.01 * NOISE, -10.0, 12.0))
    assert found["saturation"].message.startswith("force_n: ")
    log = Log(t_s=T_S, force_n=np.clip(20.0 * np.sin(20 * T_S), -10.0, 12.0))
    words = [str(f) for f in log.findings]
    assert [w.split(" as if")[0].split(" at ")[1] for w in words] == [
        "the smallest value -10",
        "the largest value 12",
    ]


@given(st.floats(0.5, 40.0), st.floats(1e-4, 0.05), st.floats(0.0, 6.0))
def test_a_quantized_turning_point_is_no_saturation(rate: float, step: float, phase: float) -> None:
    values = np.round(np.sin(rate * T_S + phase) / step) * step
    assert "saturation" not in findings(values)


def test_a_rest_at_the_end_of_the_travel_is_no_saturation() -> None:
    share = np.clip(T_S / 0.5, 0.0, 1.0)
    smooth = 0.1 * (10 * share**3 - 15 * share**4 + 6 * share**5)
    assert "saturation" not in findings(np.round(smooth / 1e-5) * 1e-5)


@pytest.mark.parametrize("step", [1e-6, 4.4e-5, 0.001, 0.0153])
def test_quantization(step: float) -> None:
    values = np.round((np.sin(7 * T_S) + 0.01 * NOISE) / step) * step
    if step == 1e-6:  # seldom shown twice: 2000 samples on 2 million levels
        assert "quantization" not in findings(values)
        return
    found = findings(values)["quantization"]
    assert quantum(values) == pytest.approx(step, rel=1e-3)
    assert found.count == len(np.unique(values))


def test_quantization_survives_a_unit_and_another_rounding() -> None:
    levels = np.round(NOISE * 300)
    assert quantum(levels * 4.4e-3 * 0.001) == pytest.approx(4.4e-6, rel=1e-6)
    assert quantum(np.round(levels * 4.4e-6, 6)) == pytest.approx(4.4e-6, rel=0.02)
    assert quantum(np.array([0.0, 1.0] * 10)) is None


@pytest.mark.slow
@measured
def test_seals_have_a_gap_and_uneven_steps() -> None:
    for path in sorted((DATA / "seals").glob("*.csv")):
        log = read_log(path)
        assert (list(log.channels), log.ignored_columns, log.history) == (
            ["position_m", "pressure_pa", "force_n", "friction_n"],
            (),
            (),
        )
        found = {f.kind: f for f in log.findings if f.channel == "t_s"}
        assert set(found) == {"gap", "jitter"}, path
        assert 1 <= found["gap"].count <= 6
        assert 0.2 < np.diff(log.t_s).max() < 0.3
        quanta = {f.channel: f for f in log.findings if f.kind == "quantization"}
        assert "in steps of 100," in quanta["pressure_pa"].message
        assert quantum(log.position_m) == pytest.approx(4.4e-6, rel=0.02)
        assert not any(f.kind == "saturation" for f in log.findings)


@measured
def test_tribometer_has_179_long_steps() -> None:
    log = read_log(DATA / "tribometer/tribometer.csv")
    assert list(log.channels) == ["position_m", "velocity_m_per_s", "normal_force_n", "force_n"]
    assert log.history == ("column 'friction_force_N' is read as force_n",)
    found = [f for f in log.findings if f.channel == "t_s"]
    assert [(f.kind, f.count) for f in found] == [("jitter", 179)]
    assert "of 0.009 to 0.01 s" in str(found[0])
    assert quantum(log.position_m) == pytest.approx(1e-7)
    assert not any(f.kind == "saturation" for f in log.findings)


@measured
def test_emps_is_quantized() -> None:
    log = read_log(DATA / "emps/DATA_EMPS.mat")
    assert [(f.kind, f.channel) for f in log.findings] == [("quantization", "position_m")]
    assert quantum(log.position_m) == pytest.approx(5e-8)
