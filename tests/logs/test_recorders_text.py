"""Text exports are read by the mappings that their sections of docs/recorders.md print."""

from pathlib import Path

import numpy as np
import pytest
from tests.logs.recorders import printed_mapping

from breakaway.measure.logs import Log, list_channels, read_log

ROWS = 40
T_S = np.arange(ROWS) / 50.0
POSITION_MM = np.arange(ROWS) / 8.0
FORCE = 1.25 - np.arange(ROWS) / 4.0


def lines(mark: str, decimal: str, *columns: np.ndarray, quote: str = "") -> str:
    rows = zip(*columns, strict=True)
    cells = [[f"{quote}{one:.6f}{quote}".replace(".", decimal) for one in row] for row in rows]
    return "".join(mark.join(row) + "\r\n" for row in cells)


def check(log: Log, newton: float = 1.0) -> None:
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)
    np.testing.assert_allclose(log.position_m, POSITION_MM * 1e-3, atol=1e-9)
    np.testing.assert_allclose(log.force_n, FORCE * newton, atol=1e-6)


@pytest.mark.parametrize(("mark", "decimal"), [("\t", "."), ("\t", ","), (";", ",")])
def test_testxpert(tmp_path: Path, mark: str, decimal: str) -> None:
    path = tmp_path / "Specimen_1.TXT"
    top = [
        ['"Prüfinstitut"', '"institute"'],
        ['"Datum/Uhrzeit"', "44335", '""'],
        ['"Vorkraft"', "2", '"MPa"'],
        ['"Temperatur"', "22", '"°C"'],
        ['"Bemerkung"', '""'],
        ['"Prüfzeit"', '"Standardkraft"', '"Traversenweg absolut"', '"Standardweg"'],
        ['"s"', '"N"', '"mm"', '"mm"'],
    ]
    text = "".join(mark.join(row) + "\r\n" for row in top)
    text += lines(mark, decimal, T_S, FORCE, POSITION_MM, POSITION_MM)
    path.write_bytes(text.encode("cp1252"))
    log = read_log(path, printed_mapping("Zwick/Roell testXpert"))
    check(log)
    assert "5 lines above the header left out" in log.history
    assert "the text is read as cp1252" in log.history


def test_testxpert_with_three_columns(tmp_path: Path) -> None:
    path = tmp_path / "Specimen_1.TXT"
    top = '"Vorkraft"\t2\t"MPa"\r\n"Prüfzeit"\t"Standardkraft"\t"Traversenweg absolut"\r\n'
    text = f'{top}"s"\t"kN"\t"mm"\r\n' + lines("\t", ",", T_S, FORCE, POSITION_MM)
    path.write_bytes(text.encode("cp1252"))
    check(read_log(path, printed_mapping("Zwick/Roell testXpert")), newton=1e3)


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize(
    "above",
    [
        'Specimen properties : Area,"100",mm^2\r\nSpecimen properties : Label,""\r\n\r\n',
        "Results Table 1\r\n\r\n\r\nResults Table 2\r\n\r\n\r\n\r\n",
        "",
    ],
)
def test_bluehill(tmp_path: Path, above: str, decimal: str) -> None:
    path = tmp_path / "Specimen_RawData_1.csv"
    text = f"{above}Time,Extension,Load,Cycle count\r\n(s),(mm),(kN),\r\n"
    path.write_text(text + lines(",", decimal, T_S, POSITION_MM, FORCE, 0 * T_S, quote='"'))
    check(read_log(path, printed_mapping("Instron Bluehill")), newton=1e3)


def test_dewesoft(tmp_path: Path) -> None:
    path = tmp_path / "pull_3.csv"
    text = "File name;pull_3.dxd\nSample rate;50\n\nTime;Force;Position\ns;kN;mm\n"
    path.write_text(text + lines(";", ",", T_S, FORCE, POSITION_MM))
    check(read_log(path, printed_mapping("DEWESoft")), newton=1e3)


def scope(mark: str, decimal: str) -> str:
    """Return an export of two channels, the second at a quarter of the rate of the first."""
    header = [
        ["Name", "pull_3", ""],
        ["Starttime of export", "132959733843760000", "Montag, 2. Mai 2022", "15:56:24.376"],
        [],
        ["Name", "Force", "Name", "Position"],
        ["SymbolComment", "", "SymbolComment"],
        ["Data-Type", "REAL64", "Data-Type", "REAL64"],
        ["SampleTime[ms]", "20", "SampleTime[ms]", "80"],
        ["Port", "851", "Port", "851"],
        ["Offset", "0", "Offset", "0"],
        ["Unit", "N (Force)", "Unit", "mm (Length)"],
        ["Unit ScaleFactor", "1", "Unit ScaleFactor", "1"],
        [],
    ]
    rows = [[1e3 * T_S[k], FORCE[k]] for k in range(ROWS)]
    for k in range(ROWS // 4):
        rows[k] += [4e3 * T_S[k], POSITION_MM[4 * k]]
    cells = [[f"{one:g}".replace(".", decimal) for one in row] for row in rows]
    return "".join(mark.join(row) + "\n" for row in [*header, *cells]) + "EOF\n"


@pytest.mark.parametrize(("mark", "decimal"), [("\t", "."), ("\t", ","), (";", ".")])
def test_twincat_scope(tmp_path: Path, mark: str, decimal: str) -> None:
    path = tmp_path / "scope.csv"
    path.write_text(scope(mark, decimal))
    listed = {one.name: one.unit for one in list_channels(path).channels}
    assert listed == {"Time#1": "ms", "Force": "N", "Time#2": "ms", "Position": "mm"}
    log = read_log(path, printed_mapping("TwinCAT Scope"))
    force, position = log.channels["force_n"], log.channels["position_m"]
    np.testing.assert_allclose(force.t_s, T_S, atol=1e-12)
    np.testing.assert_allclose(force.values, FORCE)
    np.testing.assert_allclose(position.t_s, T_S[::4], atol=1e-12)
    np.testing.assert_allclose(position.values, POSITION_MM[::4] * 1e-3)
    assert {one.kind for one in log.noticed} == {"footer", "ends"}
    assert log.resampled(rate_hz=50.0).rows == 37


def test_twincat_scope_with_one_time_column(tmp_path: Path) -> None:
    path = tmp_path / "scope.csv"
    keys = ["SampleTime[ms];20;20", "Unit;N (Force);mm (Length)", "Unit Offset;0;0"]
    top = "Name;pull_3;\n\n" + "\n".join(["Name;Force;Position", *keys]) + "\n\n"
    path.write_text(top + lines(";", ".", 1e3 * T_S, FORCE, POSITION_MM))
    channels = printed_mapping("TwinCAT Scope")["channels"]
    for one in channels.values():
        del one["time"]
    check(read_log(path, {"channels": channels}))


LVM = (
    "LabVIEW Measurement\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\n"
    "Decimal_Separator\t,\r\nMulti_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tRelative\r\n"
    "Date\t2019/07/22\r\nTime\t17:18:18,938945770263671875\r\n***End_of_Header***\r\n\r\n"
    "Channels\t2\r\nSamples\t40\t40\r\nDate\t2019/07/22\t2019/07/22\r\n"
    "X_Dimension\tTime\tTime\r\nX0\t0,0000000000000000E+0\t0,0000000000000000E+0\r\n"
    "Delta_X\t0,020000\t0,020000\r\n***End_of_Header***\r\nX_Value\tForce\tPosition\tComment\r\n"
)


def test_labview_with_x_values(tmp_path: Path) -> None:
    path = tmp_path / "pull_3.lvm"
    path.write_text(LVM + lines("\t", ",", T_S, FORCE, POSITION_MM), newline="")
    check(read_log(path, printed_mapping("LabVIEW")))


def test_labview_without_x_values(tmp_path: Path) -> None:
    path = tmp_path / "pull_3.lvm"
    rows = lines("\t", ",", FORCE, POSITION_MM)
    path.write_text(LVM + "".join(f"\t{row}\r\n" for row in rows.splitlines()), newline="")
    check(read_log(path, printed_mapping("LabVIEW") | {"time": {"rate_hz": 50.0}}))


def test_labview_with_a_second_recording_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "pull_3.lvm"
    rows = lines("\t", ",", T_S, FORCE, POSITION_MM)
    path.write_text(LVM + rows + "\r\n" + LVM.partition("\r\n\r\n")[2] + rows, newline="")
    with pytest.raises(Exception, match="row 41: 2 cells where the header has 3"):
        read_log(path, printed_mapping("LabVIEW"))
