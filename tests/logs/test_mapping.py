"""Names and units: stated by headers, by the file, or by a mapping; else refused by name."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from breakaway.errors import LogError
from breakaway.measure.logs import read_log
from breakaway.measure.logs.names import read_header
from breakaway.measure.logs.units import si_symbol, stated, unit_named


def write(folder: Path, header: str, scale: float = 1.0) -> Path:
    path = folder / "motor.csv"
    rows = "".join(f"{k / 100},{k * 1e-4 * scale!r},{-k}\n" for k in range(20))
    path.write_text(f"{header}\n{rows}")
    return path


@pytest.mark.parametrize(
    ("symbol", "channel", "value"),
    [
        ("mm", "position_m", 1e-3),
        ("µm", "position_m", 1e-6),
        ("um", "position_m", 1e-6),
        ("nm", "position_m", 1e-9),
        ("in", "position_m", 0.0254),
        ("kN", "force_n", 1e3),
        ("mN", "force_n", 1e-3),
        ("lbf", "force_n", 4.4482216152605),
        ("kgf", "force_n", 9.80665),
        ("min", "t_s", 60.0),
        ("us", "t_s", 1e-6),
        ("mm/s", "velocity_m_per_s", 1e-3),
        ("m/s²", "acceleration_m_per_s2", 1.0),
        ("g", "acceleration_m_per_s2", 9.80665),
        ("bar", "pressure_pa", 1e5),
        ("psi", "pressure_pa", 6894.757293168361),
        ("MPa", "pressure_pa", 1e6),
        ("°C", "temperature_degc", 1.0),
        ("mA", "current_a", 1e-3),
        ("%", "duty_1", 1e-2),
    ],
)
def test_units(symbol: str, channel: str, value: float) -> None:
    assert unit_named(symbol, channel).factor == value
    assert unit_named(si_symbol(channel), channel).factor == 1.0


def test_kelvin_has_an_offset() -> None:
    unit = unit_named("K", "temperature_degc")
    assert unit.factor * 300.0 + unit.offset == pytest.approx(26.85)


@pytest.mark.parametrize(
    ("name", "unit", "channel", "symbol"),
    [
        ("t_s", "", "t_s", "s"),
        ("time_ms", "", "t_s", "ms"),
        ("X_M", "", "position_m", "m"),
        ("pos [mm]", "", "position_m", "mm"),
        ("Force (kN)", "", "force_n", "kN"),
        ("Rig/Force (N)", "", "force_n", "N"),
        ("data.position_um", "", "position_m", "um"),
        ("v_m_s", "", "velocity_m_per_s", "m/s"),
        ("velocity_mm_per_s", "", "velocity_m_per_s", "mm/s"),
        ("v [m/s]", "", "velocity_m_per_s", "m/s"),
        ("normal_force_N", "", "normal_force_n", "N"),
        ("pressure_Pa", "", "pressure_pa", "Pa"),
        ("friction_N", "", "friction_n", "N"),
        ("Rig/force", "kN", "force_n", "kN"),
        ("force_kN", "kN", "force_n", "kN"),
    ],
)
def test_headers_that_state_their_unit(name: str, unit: str, channel: str, symbol: str) -> None:
    found = read_header(name, unit)
    assert found is not None
    assert (found.channel, found.unit.symbol) == (channel, symbol)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("force", ""),
        ("force_mm", ""),
        ("force_mn", ""),  # mN or MN
        ("force_kN", "N"),
        ("position_in", ""),
        ("encoder_m", ""),
        ("", "m"),
        ("[m]", ""),
    ],
)
def test_headers_that_do_not(name: str, unit: str) -> None:
    assert read_header(name, unit) is None
    assert stated("mn", "force_n") is None


def test_converts_what_the_header_states_and_records_it(tmp_path: Path) -> None:
    log = read_log(write(tmp_path, "Time [ms],pos_um,Force (kN)"))
    np.testing.assert_allclose(log.t_s, np.arange(20) * 1e-5)
    np.testing.assert_allclose(log.position_m, np.arange(20) * 1e-10)
    np.testing.assert_allclose(log.force_n, np.arange(20) * -1e3)
    assert len(log.history) == 2
    assert "position_m = 1e-06 * 'pos_um' (in um)" in log.history
    assert (log.channels["force_n"].unit, log.channels["force_n"].from_name) == ("kN", "Force (kN)")


def test_friction_force_stands_for_a_force_only_where_there_is_no_other(tmp_path: Path) -> None:
    log = read_log(write(tmp_path, "t_s,x_m,friction_force_N"))
    assert log.history == ("column 'friction_force_N' is read as force_n",)
    path = tmp_path / "both.csv"
    path.write_text(
        "t_s,x_m,force_N,friction_force_N\n" + "".join(f"{k},1,2,3\n" for k in range(10))
    )
    assert list(read_log(path).channels) == ["position_m", "force_n", "friction_n"]


def test_the_mapping_beside_the_log_is_found(tmp_path: Path) -> None:
    path = write(tmp_path, "clock,encoder,drive")
    path.with_suffix(".toml").write_text(
        """
        format = "csv"
        [channels.position_m]
        from = "encoder"
        unit = "mm"
        sign = -1
        [channels.force_n]
        from = "drive"
        unit = "V"
        scale = 35.0
        [time]
        from = "clock"
        unit = "ms"
        """
    )
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, np.arange(20) * 1e-5)
    np.testing.assert_allclose(log.position_m, np.arange(20) * -1e-7)
    np.testing.assert_allclose(log.force_n, np.arange(20) * -35.0)
    assert log.ignored_columns == ()
    assert log.history[-1] == "channels as motor.toml says"
    with pytest.raises(LogError, match="column 'position_m' is missing"):
        read_log(path, mapping={})


def test_a_toml_file_of_another_kind_is_no_mapping(tmp_path: Path) -> None:
    path = write(tmp_path, "t_s,position_m,force_n")
    path.with_suffix(".toml").write_text("[joint]\ncoulomb_n = 3.0\n")
    assert read_log(path).rows == 20
    path.with_suffix(".toml").write_text("[joint")
    with pytest.raises(LogError, match=r"motor\.toml: is not TOML"):
        read_log(path)
    with pytest.raises(LogError, match=r"other\.toml: there is no such mapping file"):
        read_log(path, tmp_path / "other.toml")


def test_only_what_is_mapped_is_read_beside_position_and_force(tmp_path: Path) -> None:
    path = write(tmp_path, "t_s,supply,velocity_mm/s")
    log = read_log(path, {"channels": {"supply_pa": {"from": "supply", "unit": "bar"}}})
    assert list(log.channels) == ["supply_pa"]
    assert log.ignored_columns == ("velocity_mm/s",)
    np.testing.assert_allclose(log["supply_pa"], np.arange(20) * 10.0)


def test_a_channel_may_have_a_time_column_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "two.csv"
    path.write_text("t,u,x_m,f\n" + "".join(f"{k},{k / 2},{k},{k}\n" for k in range(20)))
    channels = {
        "position_m": {"from": "x_m"},
        "force_n": {"from": "f", "unit": "N", "time": "u"},
    }
    log = read_log(path, {"channels": channels, "time": {"from": "t", "unit": "s"}})
    assert log.channels["position_m"].t_s[-1] == 19.0
    assert log.channels["force_n"].t_s[-1] == 9.5
    assert log.ignored_columns == ()


def keys(**changed: Any) -> dict[str, Any]:
    return {"channels": {"force_n": {"from": "drive", "unit": "N"} | changed}}


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (keys(unit="kp"), "force_n.*unit 'kp' is unknown; it must be one of N, mN, .*scale"),
        (keys(unit="mm"), "force_n.*unit 'mm' measures length, not force; .* one of N, mN"),
        (keys(unit=None), "neither the file nor the name 'drive' states a unit; .*unit = \"N\""),
        (keys(frm="x"), "channels.force_n: frm: is not a known key; did you mean from"),
        (keys(sign=2), "channels.force_n: sign: 2 is not one of 1 or -1"),
        (keys(scale=0.0), "channels.force_n: scale is 0"),
        (keys(scale=float("nan")), "channels.force_n: scale: nan is not finite"),
        (keys(**{"from": "drives"}), "column 'drives' is missing; the nearest present is 'drive'"),
        ({"channels": {"force_n": {"unit": "N"}}}, "channels.force_n: from: is missing"),
        ({"channels": {"force": {"from": "drive"}}}, "'force': the name does not end with its"),
        ({"channels": {"t_s": {"from": "clock"}}}, r"time has a table of its own; write \[time\]"),
        ({"channels": {"force_n": 3}}, "channels.force_n: is not a table"),
        ({"channels": 3}, "channels: is not a table"),
        ({"tiem": {}}, "tiem: is not a known key; did you mean time"),
        ({"time": {"form": "t"}}, "time.form: is not a known key; did you mean from"),
        ({"csv": {"delimiter": ";;"}}, "csv.delimiter"),
        ({"csv": {"skip_rows": -1}}, "csv.skip_rows: -1 is not >= 0"),
        ({"format": "xls"}, "format 'xls' is unknown; it must be one of csv"),
        (keys() | {"time": {"from": "clocks"}}, "column 'clocks' is missing; .*'clock'"),
        (keys() | {"time": {"from": "clock"}}, "channel 't_s': neither .* unit = \"s\""),
        (keys(), 'column .t_s. is missing; .* such as: time = { from = "...", unit = "ms" }'),
    ],
)
def test_refuses(tmp_path: Path, mapping: dict[str, Any], words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(write(tmp_path, "clock,encoder,drive"), mapping)


@pytest.mark.slow
@given(st.sampled_from(["mm", "um", "nm", "cm", "in"]), st.floats(-100.0, 100.0))
def test_the_unit_of_the_file_does_not_matter(unit: str, offset: float) -> None:
    import tempfile

    factor = unit_named(unit, "position_m").factor
    t_s = np.arange(20) / 100.0
    position_m = offset + np.sin(t_s)
    with tempfile.TemporaryDirectory() as folder:
        logs = []
        for name, values in (("x_m", position_m), ("x", position_m / factor)):
            path = Path(folder) / "motor.csv"
            np.savetxt(path, np.c_[t_s, values], "%.17g", ",", header=f"t_s,{name}", comments="")
            keys = {"from": name, "unit": None if name == "x_m" else unit}
            logs.append(read_log(path, {"channels": {"position_m": keys}}))
    np.testing.assert_allclose(logs[1].position_m, logs[0].position_m, rtol=4e-16)


def test_a_mapping_of_one_channel_leaves_the_other_to_its_header(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    rows = "".join(f"{k / 100},{k},{2 * k},{3 * k}\n" for k in range(20))
    path.write_text("t_s,position_mm,force_N,cell_V\n" + rows)
    path.with_suffix(".toml").write_text('[channels.force_n]\nfrom = "cell_V"\nscale = 10.0\n')
    log = read_log(path)
    np.testing.assert_allclose(log.position_m, np.arange(20) / 1e3)
    np.testing.assert_allclose(log.force_n, 30.0 * np.arange(20))
    assert log.ignored_columns == ("force_N",)


def test_a_header_that_two_columns_share_is_not_chosen_from(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    path.write_text("t_s,x_m,position_mm,force_N\n" + "0,1,2,3\n" * 20)
    log = read_log(path, {"channels": {"force_n": {"from": "force_N"}}})
    assert list(log.channels) == ["force_n"]
