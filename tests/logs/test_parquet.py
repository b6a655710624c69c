"""Types of Parquet columns beyond plain numbers, against what pandas and pyarrow hold."""

import decimal
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from breakaway.errors import LogError
from breakaway.measure.logs import list_channels, read_log

ROWS = 50
STEP_US = 1250
WHOLE_US = STEP_US * np.arange(ROWS)
T_S = WHOLE_US * 1e-6


def written(folder: Path, time: Any, position: Any = None, force: Any = None) -> Path:
    path = folder / "rig.parquet"
    columns = {
        "t": time,
        "x_m": pa.array(np.arange(ROWS) / 8.0) if position is None else position,
        "force_N": pa.array(np.arange(ROWS) / 4.0) if force is None else force,
    }
    pq.write_table(pa.table(columns), path)
    return path


@pytest.mark.parametrize(
    "kind",
    [
        pa.duration("us"),
        pa.duration("ns"),
        pa.time64("us"),
        pa.time64("ns"),
        pa.timestamp("us"),
        pa.timestamp("ns", tz="UTC"),
    ],
)
def test_times_of_every_kind_are_seconds(tmp_path: Path, kind: pa.DataType) -> None:
    per = 1000 if kind.unit == "ns" else 1
    path = written(tmp_path, pa.array(per * WHOLE_US, pa.int64()).cast(kind))
    log = read_log(path, {"time": {"from": "t"}})
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    assert list_channels(path).channels[0].unit == "s"


def test_times_of_day_in_milliseconds_are_seconds_of_the_day(tmp_path: Path) -> None:
    whole = 8 * 3_600_000 + 5 * np.arange(ROWS)
    path = written(tmp_path, pa.array(whole.astype(np.int32), pa.time32("ms")))
    log = read_log(path, {"time": {"from": "t"}})
    np.testing.assert_allclose(log.t_s, 28800.0 + 0.005 * np.arange(ROWS), atol=1e-9)


def test_decimals_are_numbers(tmp_path: Path) -> None:
    force = pa.array([decimal.Decimal(k) / 8 for k in range(ROWS)], pa.decimal128(12, 3))
    log = read_log(
        written(tmp_path, pa.array(T_S), force=force), {"time": {"from": "t", "unit": "s"}}
    )
    np.testing.assert_array_equal(log.force_n, np.arange(ROWS) / 8.0)


def test_fields_of_structures_are_channels(tmp_path: Path) -> None:
    inner = [{"drive": {"x_mm": k / 2.0}, "load": {"cell": {"kN": -float(k)}}} for k in range(ROWS)]
    path = tmp_path / "rig.parquet"
    pq.write_table(pa.table({"t_s": T_S, "rig": inner}), path)
    mapping = {
        "channels": {
            "position_m": {"from": "rig.drive.x_mm", "unit": "mm"},
            "force_n": {"from": "rig.load.cell.kN", "unit": "kN"},
        }
    }
    log = read_log(path, mapping)
    np.testing.assert_allclose(log.position_m, 5e-4 * np.arange(ROWS))
    np.testing.assert_array_equal(log.force_n, -1e3 * np.arange(ROWS))


def test_a_structure_that_is_missing_in_a_row_is_told(tmp_path: Path) -> None:
    inner = [{"x": float(k)} if k != 7 else None for k in range(ROWS)]
    path = tmp_path / "rig.parquet"
    pq.write_table(pa.table({"t_s": T_S, "force_N": T_S, "rig": inner}), path)
    with pytest.raises(LogError, match=r"'rig\.x': 1 values are missing"):
        read_log(path, {"channels": {"position_m": {"from": "rig.x", "unit": "m"}}})


def test_three_of_many_columns_are_read_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [f"c{k}" for k in range(300)]
    table = {"t_s": T_S, "x_m": T_S, "force_N": T_S, **dict.fromkeys(names, T_S)}
    path = tmp_path / "wide.parquet"
    pq.write_table(pa.table(table), path)
    asked: list[str] = []
    whole = pq.ParquetFile.iter_batches

    def noted(file: Any, *sizes: Any, columns: list[str], **options: Any) -> Any:
        asked.extend(columns)
        return whole(file, *sizes, columns=columns, **options)

    monkeypatch.setattr(pq.ParquetFile, "iter_batches", noted)
    assert read_log(path).rows == ROWS
    assert sorted(asked) == ["force_N", "t_s", "x_m"]
