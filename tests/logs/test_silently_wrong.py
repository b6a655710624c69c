"""Files that were once read as something else: each is now right, refused, or a finding.

Written by the library of the format; values are checked against what was written.
"""

import json
from pathlib import Path
from typing import Any

import h5py
import mcap.writer
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import xarray
from nptdms import ChannelObject, RootObject, TdmsFile, TdmsWriter

from breakaway.errors import LogError
from breakaway.measure.logs import Log, read_log

ROWS = 200
T_S = np.arange(ROWS) / 100.0
POSITION_M = 0.05 * np.sin(2 * T_S)
FORCE_N = 40.0 * np.cos(2 * T_S)
START = np.datetime64("2026-11-30T08:00:00", "ns")


def kinds(log: Log) -> set[str]:
    return {one.kind for one in log.findings}


def waveform(name: str, values: Any, start: np.datetime64, **further: Any) -> ChannelObject:
    unit = {"Position": "m", "Force": "N"}[name]
    told = {"wf_start_time": start, "wf_increment": 0.01, "unit_string": unit, **further}
    return ChannelObject("Rig", name, np.asarray(values), told)


def both(start: np.datetime64, **further: Any) -> list[ChannelObject]:
    return [
        waveform("Position", POSITION_M, start),
        waveform("Force", FORCE_N, start, **further),
    ]


def tdms(path: Path, *segments: list[Any]) -> Path:
    for number, objects in enumerate(segments):
        with TdmsWriter(path, mode="a" if number else "w") as writer:
            writer.write_segment(objects)
    return path


def test_a_scale_that_the_library_does_not_know_is_refused_by_name(tmp_path: Path) -> None:
    scaled = {
        "NI_Number_Of_Scales": 1,
        "NI_Scaling_Status": "unscaled",
        "NI_Scale[0]_Scale_Type": "Logarithm",
    }
    path = tdms(tmp_path / "scaled.tdms", both(START, **scaled))
    with pytest.raises(LogError, match=r"'Rig/Force': is scaled by 'Logarithm', which is unknown"):
        read_log(path)


def test_packed_numbers_are_unpacked_as_xarray_does(tmp_path: Path) -> None:
    path = tmp_path / "packed.h5"
    raw = np.round((FORCE_N - 5.0) / 0.01).astype(np.int16)
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"] = T_S, POSITION_M
        force = file.create_dataset("force_n", data=raw)
        force.attrs["scale_factor"], force.attrs["add_offset"] = 0.01, 5.0
    packed = xarray.Variable("row", raw, {"scale_factor": 0.01, "add_offset": 5.0})
    expected = xarray.conventions.decode_cf_variable("force_n", packed).values
    log = read_log(path)
    np.testing.assert_allclose(log.force_n, expected, rtol=1e-12)
    np.testing.assert_allclose(log.force_n, FORCE_N, atol=0.006)


def test_missing_numbers_are_missing(tmp_path: Path) -> None:
    path = tmp_path / "missing.h5"
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"] = T_S, POSITION_M
        force = file.create_dataset("force_n", data=np.where(np.arange(ROWS) == 7, -99.0, FORCE_N))
        force.attrs["_FillValue"] = -99.0
    with pytest.raises(LogError, match=r"column 'force_n', row 8: is missing, as _FillValue"):
        read_log(path)


def test_stamps_of_several_columns_have_one_zero(tmp_path: Path) -> None:
    path = tmp_path / "stamped.parquet"
    stamps = START + (T_S * 1e9).astype("timedelta64[ns]")
    late = stamps + np.timedelta64(3, "s")
    columns = {
        "tx": pa.array(stamps),
        "tf": pa.array(late.astype("datetime64[ms]")),
        "position_m": POSITION_M,
        "force_n": FORCE_N,
    }
    pq.write_table(pa.table(columns), path)
    mapping = {
        "position_m": {"from": "position_m", "unit": "m", "time": "tx"},
        "force_n": {"from": "force_n", "unit": "N", "time": "tf"},
    }
    log = read_log(path, {"channels": mapping})
    np.testing.assert_allclose(log.channels["position_m"].t_s, T_S, atol=1e-12)
    np.testing.assert_allclose(log.channels["force_n"].t_s, T_S + 3.0, atol=1e-12)


def test_a_recording_that_was_appended_begins_at_its_own_start(tmp_path: Path) -> None:
    again = START + np.timedelta64(60, "s")
    path = tdms(tmp_path / "twice.tdms", both(START), both(again))
    log = read_log(path)
    assert len(TdmsFile.read(path)["Rig"]["Force"]) == 2 * ROWS == log.rows
    np.testing.assert_allclose(log.t_s, np.concatenate([T_S, 60.0 + T_S]), atol=1e-9)
    gap = next(one for one in log.findings if one.kind == "gap")
    assert (gap.count, gap.first_t_s) == (1, pytest.approx(1.99))


def test_segments_of_one_recording_go_on(tmp_path: Path) -> None:
    halves = [
        [waveform("Position", POSITION_M[part], START), waveform("Force", FORCE_N[part], START)]
        for part in (slice(0, 100), slice(100, None))
    ]
    log = read_log(tdms(tmp_path / "on.tdms", *halves))
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    assert "gap" not in kinds(log)


def test_a_start_that_was_never_set_counts_as_none(tmp_path: Path) -> None:
    never = np.datetime64("1904-01-01T00:00:00", "ns")
    objects = [waveform("Position", POSITION_M, never), waveform("Force", FORCE_N, START)]
    log = read_log(tdms(tmp_path / "unset.tdms", objects))
    np.testing.assert_allclose(log.channels["position_m"].t_s, T_S, atol=1e-12)
    np.testing.assert_allclose(log.channels["force_n"].t_s, T_S, atol=1e-12)


def test_a_unit_that_changes_within_a_channel_is_refused(tmp_path: Path) -> None:
    path = tdms(tmp_path / "units.tdms", both(START), both(START, unit_string="kN"))
    with pytest.raises(LogError, match=r"changes its unit within the file, from 'N' to 'kN'"):
        read_log(path)


def test_a_recording_that_is_cut_off_is_said_to_be(tmp_path: Path) -> None:
    path = tdms(tmp_path / "cut.tdms", both(START))
    whole = read_log(path)
    path.write_bytes(path.read_bytes()[:-800])
    log = read_log(path)
    assert "cut_off" in kinds(log) and "cut_off" not in kinds(whole)
    assert "cut off within its last segment" in str(log.findings[0])


@pytest.mark.parametrize("kind", ["h5", "parquet", "csv"])
def test_whole_stamps_are_subtracted_before_they_become_seconds(tmp_path: Path, kind: str) -> None:
    stamps = 1_700_000_000_000_000_000 + 10_000 * np.arange(ROWS, dtype=np.int64)
    path = tmp_path / f"fast.{kind}"
    columns = {"time_ns": stamps, "position_m": POSITION_M, "force_n": FORCE_N}
    if kind == "h5":
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                file[name] = values
    elif kind == "parquet":
        pq.write_table(pa.table(columns), path)
    else:
        rows = zip(*(values.tolist() for values in columns.values()), strict=True)
        text = "\n".join(",".join(map(str, row)) for row in rows)
        path.write_text(",".join(columns) + "\n" + text + "\n")
    log = read_log(path)
    np.testing.assert_allclose(np.diff(log.t_s), 1e-5, rtol=1e-9)
    assert not {"jitter", "repeated_stamps"} & kinds(log)


def test_a_point_between_thousands_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "thousands.csv"
    rows = "".join(f"{k}e-2;0,{k:03};1.{k:03}\n" for k in range(100, 130))
    path.write_text("t_s;position_m;force_n\n" + rows)
    with pytest.raises(LogError, match=r"'1\.100' is not a number \(or '\.' stands between thous"):
        read_log(path, {"csv": {"delimiter": ";", "decimal": ","}})


def test_a_unit_that_contradicts_the_file_is_a_finding(tmp_path: Path) -> None:
    path = tdms(tmp_path / "unit.tdms", both(START, unit_string="kN"))
    mapping = {
        "position_m": {"from": "Position", "unit": "m"},
        "force_n": {"from": "Force", "unit": "N"},
    }
    log = read_log(path, {"channels": mapping})
    said = next(str(one) for one in log.findings if one.kind == "unit")
    assert said == ("'Rig/Force': the file states the unit 'kN', the mapping 'N', which is taken")
    np.testing.assert_array_equal(log.force_n, FORCE_N)
    agreed = read_log(path, {"channels": mapping | {"force_n": {"from": "Force", "unit": "kN"}}})
    assert "unit" not in kinds(agreed)


def test_a_table_without_a_header_keeps_its_first_row(tmp_path: Path) -> None:
    path = tmp_path / "bare.csv"
    np.savetxt(path, np.column_stack([T_S, POSITION_M, FORCE_N]), "%.17g", ",")
    with pytest.raises(LogError, match=r"'position_m' is missing; present are column_1, column_2"):
        read_log(path)
    mapping: dict[str, Any] = {
        "time": {"from": "column_1", "unit": "s"},
        "channels": {
            "position_m": {"from": "column_2", "unit": "m"},
            "force_n": {"from": "column_3", "unit": "N"},
        },
    }
    for layout in ({}, {"csv": {"header": False}}):
        log = read_log(path, mapping | layout)
        assert log.rows == ROWS
        np.testing.assert_array_equal(log.force_n, FORCE_N)
    assert "there is no header" in str(read_log(path, mapping).findings[0])


def test_one_message_without_a_time_of_publishing_changes_the_clock_of_all(tmp_path: Path) -> None:
    path = tmp_path / "clocks.mcap"
    logged = 1_700_000_000 * 10**9
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        schema = writer.register_schema("", "", b"")
        channel = writer.register_channel("rig", "json", schema)
        for row in range(ROWS):
            content = {"position_m": POSITION_M[row], "force_n": FORCE_N[row]}
            writer.add_message(
                channel_id=channel,
                log_time=logged + row * 10**7,
                publish_time=0 if row == 0 else row * 10**7,
                data=json.dumps(content).encode(),
            )
        writer.finish()
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)


def test_columns_that_nobody_wants_are_not_read(tmp_path: Path) -> None:
    """A column of texts beside the others was once the end of a whole file."""
    path = tmp_path / "wide.csv"
    rows = zip(T_S, POSITION_M, FORCE_N, strict=True)
    text = "".join(f"{t},{x},{f},note {t},{'' if t else 1}\n" for t, x, f in rows)
    path.write_text("t_s,position_m,force_n,remark,slow_v\n" + text)
    log = read_log(path)
    np.testing.assert_array_equal(log.force_n, FORCE_N)
    assert log.ignored_columns == ("remark", "slow_v")


def test_a_root_that_is_scaled_is_no_channel(tmp_path: Path) -> None:
    path = tdms(tmp_path / "root.tdms", [RootObject({"unit_string": "N"}), *both(START)])
    np.testing.assert_array_equal(read_log(path).force_n, FORCE_N)
