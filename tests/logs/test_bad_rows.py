"""Bad rows are dropped where that is asked for: counted, told, the same in every format."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.logs import Log, read_log

ROWS = 40
T_S = np.arange(ROWS) / 100.0
FORCE_N = np.arange(ROWS) / 4.0


def csv(path: Path, changed: dict[int, str], end: str = "") -> Path:
    lines = [changed.get(k, f"{T_S[k]},{k / 8},{FORCE_N[k]},on") for k in range(ROWS)]
    path.write_text("t_s,position_mm,force_N,state\n" + "\n".join(lines) + "\n" + end)
    return path


def dropped(log: Log) -> int:
    return sum(one.count for one in log.findings if one.kind == "dropped")


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("0.07,OVL,1.75,on", "1 with a cell missing or no finite number, 0 whose stamp"),
        ("0.07,,1.75,on", "1 with a cell"),
        ("x,0.875,1.75,on", "1 with a cell"),
        ("0.07,0.875,nan,on", "1 with a cell"),
        ("0.07,0.875,1e999,on", "1 with a cell"),
        ("0.07,0.8_75,1.75,on", "1 with a cell"),
        ("0.07,0.875", "1 with a cell"),
        ("0.07,0.875,1,2,3", "1 with a cell"),
        ("0.06,0.875,1.75,on", "0 with a cell missing or no finite number, 1 whose stamp"),
    ],
)
def test_a_bad_row_is_dropped_and_counted(tmp_path: Path, row: str, words: str) -> None:
    path = csv(tmp_path / "motor.csv", {7: row})
    log = read_log(path, drop_bad_rows=True)
    np.testing.assert_array_equal(log.t_s, np.delete(T_S, 7))
    np.testing.assert_array_equal(log.force_n, np.delete(FORCE_N, 7))
    assert dropped(log) == 1
    assert any(one.startswith(f"1 bad row dropped as asked for: {words}") for one in log.history)


def test_bad_rows_are_refused_where_it_is_not_asked_for(tmp_path: Path) -> None:
    path = csv(tmp_path / "motor.csv", {7: "0.07,OVL,1.75,on"})
    with pytest.raises(LogError, match=r"'OVL' is not a number.*--drop-bad-rows"):
        read_log(path)
    path = csv(tmp_path / "motor.csv", {7: "0.07,OVL"})
    with pytest.raises(LogError, match=r"row 8: 2 cells.*--drop-bad-rows"):
        read_log(path)


def test_nothing_is_dropped_from_a_good_log(tmp_path: Path) -> None:
    log = read_log(csv(tmp_path / "motor.csv", {}), drop_bad_rows=True)
    np.testing.assert_array_equal(log.force_n, FORCE_N)
    assert dropped(log) == 0
    assert any(one.startswith("0 bad rows dropped as asked for") for one in log.history)


def test_a_bad_cell_of_a_column_that_nobody_wants_drops_nothing(tmp_path: Path) -> None:
    log = read_log(csv(tmp_path / "motor.csv", {7: "0.07,0.875,1.75,"}), drop_bad_rows=True)
    assert (log.rows, dropped(log)) == (ROWS, 0)


def test_a_stamp_repeats_the_last_row_that_is_kept(tmp_path: Path) -> None:
    rows = {7: "0.07,OVL,1,on", 8: "0.06,1,2,on", 9: "0.06,1,2,on"}
    log = read_log(csv(tmp_path / "motor.csv", rows), drop_bad_rows=True)
    np.testing.assert_array_equal(log.t_s, np.delete(T_S, [7, 8, 9]))
    assert dropped(log) == 3


def test_stamps_in_words_and_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    lines = [f"8:00:{k:02},5;{k},25;+{k},5e0" for k in range(ROWS)]
    lines[5], lines[9] = "pause;5,25;5,5", "8:00:09,5;1.500;9,5"
    path.write_text("time;position_mm;force_N\n" + "\n".join(lines) + "\n")
    log = read_log(path, drop_bad_rows=True)
    np.testing.assert_allclose(log.t_s, np.delete(np.arange(float(ROWS)), [5, 9]))
    np.testing.assert_allclose(log.force_n, np.delete(np.arange(ROWS) + 0.5, [5, 9]))


def test_slower_channels_stay_slower(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    lines = [f"{T_S[k]},{k},{FORCE_N[k] if k % 4 == 0 else ''}" for k in range(ROWS)]
    lines[6] = "0.06,OVL,"
    path.write_text("t_s,position_mm,force_N\n" + "\n".join(lines) + "\n")
    log = read_log(path, drop_bad_rows=True)
    np.testing.assert_array_equal(log.channels["force_n"].values, FORCE_N[::4])
    assert log.channels["position_m"].rows == ROWS - 1


def test_other_formats_drop_the_same_rows(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    stamps = T_S.copy()
    stamps[20] = stamps[19]
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"] = stamps, np.where(np.arange(ROWS) == 3, np.nan, T_S)
        file["force_n"] = np.where(np.arange(ROWS) == 5, np.inf, FORCE_N)
    with pytest.raises(LogError, match=r"row 6: inf is not a measurement; .*--drop-bad-rows"):
        read_log(path)
    log = read_log(path, drop_bad_rows=True)
    np.testing.assert_array_equal(log.force_n, np.delete(FORCE_N, [3, 5, 20]))
    assert dropped(log) == 3


def test_too_few_rows_that_are_left_are_refused(tmp_path: Path) -> None:
    path = csv(tmp_path / "motor.csv", {k: f"{T_S[k]},OVL,1,on" for k in range(5, ROWS)})
    with pytest.raises(LogError, match="5 rows; a log needs at least 10"):
        read_log(path, drop_bad_rows=True)
