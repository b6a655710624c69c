"""What is particular to each format: its units, its time stamps, and what it refuses."""

import datetime
import json
import sys
from pathlib import Path
from typing import Any

import h5py
import mcap.writer
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from breakaway.errors import LogError
from breakaway.measure.logs import read_log

T_S = np.arange(50) / 100.0
NAMED = {"t_s": T_S, "position_m": 2.0 * T_S, "force_n": np.ones(50)}


def test_formats_are_told_by_bytes_then_suffix(tmp_path: Path) -> None:
    path = tmp_path / "log.xyz"
    path.write_bytes(b"t_s,position_m,force_n\n")
    with pytest.raises(LogError, match=r"suffix '\.xyz' tell the format; .*csv, parquet"):
        read_log(path)
    path.write_bytes(b"PAR1")
    with pytest.raises(LogError, match=r"log\.xyz: is damaged, or is not a Parquet file"):
        read_log(path)


@pytest.mark.parametrize(
    ("suffix", "module", "extra"),
    [
        ("tdms", "nptdms", "npTDMS; .*'breakaway.tdms.'"),
        ("h5", "h5py", "h5py; .*'breakaway.hdf5.'"),
    ],
)
def test_names_the_extra_of_a_missing_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, module: str, extra: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    path = tmp_path / f"motor.{suffix}"
    path.write_bytes(b"something")
    with pytest.raises(LogError, match=rf"motor\.{suffix}: reading .* needs {extra}"):
        read_log(path)


# Parquet


def parquet(folder: Path, **changed: Any) -> Path:
    path = folder / "motor.parquet"
    pq.write_table(pa.table(NAMED | changed), path)
    return path


def test_parquet_units_in_metadata_and_date_time(tmp_path: Path) -> None:
    start = datetime.datetime(2024, 5, 1, tzinfo=datetime.UTC)
    moments = [start + datetime.timedelta(milliseconds=10 * k) for k in range(50)]
    fields = [
        pa.field("time", pa.timestamp("us", tz="UTC")),
        pa.field("position", pa.float32(), metadata={"unit": "mm"}),
        pa.field("force_N", pa.int32()),
        pa.field("remark", pa.string()),
    ]
    columns = [moments, np.arange(50, dtype=np.float32), range(50), ["on"] * 50]
    path = tmp_path / "motor.parquet"
    pq.write_table(pa.table(columns, schema=pa.schema(fields)), path)
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    np.testing.assert_allclose(log.position_m, np.arange(50) * 1e-3)
    np.testing.assert_array_equal(log.force_n, np.arange(50))
    assert log.ignored_columns == ("remark",)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (["on"] * 50, "column 'force_n': is of type string; it must be real numbers"),
        ([None] * 5 + [1.0] * 45, "column 'force_n': 5 values are missing"),
        ([[1.0]] * 50, "column 'force_n': is of type list"),
        ([float("nan")] * 50, "column 'force_n', row 1: nan is not a measurement"),
    ],
)
def test_parquet_refuses(tmp_path: Path, values: list[Any], words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(parquet(tmp_path, force_n=values))


def test_parquet_refuses_an_empty_table(tmp_path: Path) -> None:
    path = tmp_path / "empty.parquet"
    pq.write_table(pa.table({name: pa.array([], pa.float64()) for name in NAMED}), path)
    with pytest.raises(LogError, match="vector of real numbers"):
        read_log(path)


# MATLAB and HDF5


@pytest.mark.parametrize("packed", [False, True])
def test_matlab_structure(tmp_path: Path, packed: bool) -> None:
    path = tmp_path / "s.mat"
    table = {"t_s": T_S[:, None], "pos_mm": 2000.0 * T_S, "f": np.arange(50, dtype=np.int16)}
    content = {"s": table | {"note": "a text", "inner": {"x": 1.0}}, "cells": np.array(["a", "b"])}
    savemat(path, content, do_compression=packed)
    channels = {
        "position_m": {"from": "s.pos_mm"},
        "force_n": {"from": "f", "unit": "kN"},
    }
    log = read_log(path, {"channels": channels})
    np.testing.assert_allclose(log.position_m, 2.0 * T_S)
    np.testing.assert_array_equal(log.force_n, 1e3 * np.arange(50))
    assert set(log.ignored_columns) == {"s.note", "s.inner.x", "cells"}
    channels["force_n"]["from"] = "note"
    with pytest.raises(LogError, match=r"column 's\.note': is of class char"):
        read_log(path, {"channels": channels})


def test_matlab_in_the_other_order_of_bytes(tmp_path: Path) -> None:
    path = tmp_path / "s.mat"
    savemat(path, {name: values.astype(">f8") for name, values in NAMED.items()})
    assert read_log(path).rows == 50


def test_hdf5_groups_units_and_tables(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    with h5py.File(path, "w") as file:
        file["Rig/time"], file["Rig/position"] = 1e3 * T_S, 2.0 * T_S
        file["Rig/time"].attrs["units"], file["Rig/position"].attrs["unit"] = "ms", b"m"
        file["table"] = np.rec.fromarrays([np.ones(50)], names="force_kN")
        file["note"], file["picture"] = "text", np.zeros((3, 3))
        file["elsewhere"] = h5py.ExternalLink("/etc/none.h5", "/x")
        file["ring"] = h5py.SoftLink("/ring")
        file["again"] = file["Rig"]
        file.create_group("empty")
        file.create_dataset("nothing", data=h5py.Empty("f8"))
    with pytest.raises(LogError, match="columns 'Rig/position' and 'again/position' both give"):
        read_log(path)
    with h5py.File(path, "r+") as file:
        del file["again"]
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, T_S)
    np.testing.assert_array_equal(log.force_n, 1e3)
    assert set(log.ignored_columns) == {"note", "picture", "nothing", "elsewhere", "ring"}


def test_hdf5_refuses_claims_without_data(tmp_path: Path) -> None:
    path = tmp_path / "huge.h5"
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"] = T_S, T_S
        file.create_dataset("force_n", shape=(10**12,), dtype="f8", chunks=(1000,))
    with pytest.raises(LogError, match=r"'force_n': was never written .* 0 of 1,000,000,000 piec"):
        read_log(path)


@pytest.mark.parametrize("chunks", [None, (10,)])
def test_hdf5_arrays_that_were_never_written_matter_only_where_wanted(
    tmp_path: Path, chunks: tuple[int] | None
) -> None:
    path = tmp_path / "motor.h5"
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"], file["force_n"] = T_S, T_S, T_S
        file.create_dataset("spare", shape=T_S.shape, dtype="f8", chunks=chunks)
    np.testing.assert_array_equal(read_log(path).force_n, T_S)
    with h5py.File(path, "a") as file:
        del file["force_n"]
        file.move("spare", "force_n")
        if chunks:
            file["force_n"][:30] = 1.0
    told = rf"3 of {len(T_S) // 10} pieces" if chunks else "0 of 1 pieces"
    with pytest.raises(LogError, match=f"column 'force_n': was never written in full: .* {told}"):
        read_log(path)


def test_hdf5_types_that_are_not_known_matter_only_where_wanted(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    when = h5py.h5t.UNIX_D64LE
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"], file["force_n"] = T_S, T_S, T_S
        rows = h5py.h5s.create_simple(T_S.shape)
        h5py.h5d.create(file.id, b"when", when, rows)
        row = h5py.h5t.create(h5py.h5t.COMPOUND, 8)
        row.insert(b"when", 0, when)
        h5py.h5d.create(file.id, b"table", row, rows)
        h5py.h5a.create(file["force_n"].id, b"unit", when, h5py.h5s.create(h5py.h5s.SCALAR))
    np.testing.assert_array_equal(read_log(path).force_n, T_S)
    channels = {"force_n": {"from": "when", "unit": "N"}}
    with pytest.raises(LogError, match=r"column 'when': is of a type that is not known"):
        read_log(path, {"channels": channels})


def test_hdf5_filters_the_wrong_way_around_matter_only_where_wanted(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((10,))
    plan.set_deflate(4)
    plan.set_shuffle()
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"], file["force_n"] = T_S, T_S, T_S
        rows = h5py.h5s.create_simple(T_S.shape)
        made = h5py.h5d.create(file.id, b"spare", h5py.h5t.NATIVE_DOUBLE, rows, plan)
        h5py.Dataset(made)[:] = T_S
    np.testing.assert_array_equal(read_log(path).force_n, T_S)
    channels = {"force_n": {"from": "spare", "unit": "N"}}
    with pytest.raises(LogError, match=r"column 'spare': is deflated before it is shuffled"):
        read_log(path, {"channels": channels})


def test_hdf5_refuses_complex_numbers_and_text(tmp_path: Path) -> None:
    for values, words in ((T_S * 1j, "is of type complex"), (b"text", "is of type")):
        path = tmp_path / "motor.h5"
        with h5py.File(path, "w") as file:
            file["t_s"], file["position_m"], file["force_n"] = T_S, T_S, values
        with pytest.raises(LogError, match=f"column 'force_n': {words}"):
            read_log(path)


def test_matlab_73_text_is_no_channel(tmp_path: Path) -> None:
    path = tmp_path / "s.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in NAMED.items():
            file[f"s/{name}"] = values[None, :]
        file["note"] = np.frombuffer(b"a text", np.uint8).astype(np.uint16)[:, None]
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
        file["#refs#/a"] = np.ones(3)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(512))
    log = read_log(path)
    assert (log.channels["force_n"].from_name, log.ignored_columns) == ("s.force_n", ("note",))


# TDMS


def tdms(folder: Path, *channels: ChannelObject) -> Path:
    path = folder / "motor.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(channels)
    return path


def waveform(step: float, **more: Any) -> dict[str, Any]:
    return {"wf_increment": step, "wf_start_offset": 0.0} | more


def test_tdms_waveforms_of_different_start_and_rate(tmp_path: Path) -> None:
    start = np.datetime64("2024-05-01T10:00:00", "us")
    fast = waveform(0.001, wf_start_time=start, unit_string="mm")
    late = waveform(0.005, wf_start_time=start + np.timedelta64(3, "s"), unit_string="kN")
    offset = waveform(0.5, wf_start_offset=0.25, wf_start_time=start, unit_string="degC")
    path = tdms(
        tmp_path,
        ChannelObject("Rig", "position", np.arange(6000.0), fast),
        ChannelObject("Rig", "force", np.arange(500.0), late),
        ChannelObject("Rig", "temp", np.arange(20.0), offset),
        ChannelObject("Rig", "note", ["a", "b"]),
        ChannelObject("Other", "empty", np.zeros(0)),
    )
    log = read_log(path)
    assert (log.channels["force_n"].t_s[0], log.channels["temperature_degc"].t_s[0]) == (3.0, 0.25)
    np.testing.assert_allclose(log["position_m"], np.arange(6000) * 1e-3)
    np.testing.assert_allclose(log["force_n"], np.arange(500) * 1e3)
    words = "position_m starts 3 s before force_n .* sampled at 1000 Hz against 200 Hz"
    with pytest.raises(LogError, match=words):
        log.t_s  # noqa: B018
    assert log.resampled(like="force_n").rows == 500
    assert set(log.ignored_columns) == {"Rig/note", "Other/empty"}


def test_tdms_with_a_time_channel_and_a_mapping(tmp_path: Path) -> None:
    path = tdms(
        tmp_path,
        ChannelObject("Rig", "Clock", np.arange(50.0)),
        ChannelObject("Rig", "Encoder", np.arange(50.0)),
    )
    channels = {"position_m": {"from": "Encoder", "unit": "mm", "sign": -1}}
    log = read_log(path, {"channels": channels, "time": {"from": "Rig/Clock", "unit": "ms"}})
    np.testing.assert_allclose(log.t_s, np.arange(50) * 1e-3)
    np.testing.assert_allclose(log.position_m, np.arange(50) * -1e-3)
    with pytest.raises(LogError, match=r"column 't_s' is missing; .*Rig/Clock"):
        read_log(path, {"channels": channels})


# MCAP


def write_messages(folder: Path, encoding: str, *messages: tuple[int, Any]) -> Path:
    path = folder / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("/rig/state", encoding, 0)
        for stamp, content in messages:
            writer.add_message(channel, stamp, json.dumps(content).encode(), stamp)
        writer.finish()
    return path


def test_mcap_nested_fields(tmp_path: Path) -> None:
    messages = [
        (10**18 + k * 10**7, {"x_m": k / 2, "cell": {"force_N": -k}, "ok": True, "list": [1]})
        for k in range(50)
    ]
    log = read_log(write_messages(tmp_path, "json", *messages))
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    np.testing.assert_array_equal(log.force_n, -np.arange(50.0))
    assert log.channels["force_n"].from_name == "rig/state/cell.force_N"


def test_lists_in_mcap_messages_are_read_by_place(tmp_path: Path) -> None:
    messages = [
        (10**18 + k * 10**7, {"position": [k / 2, -k / 4], "effort": [k, 2 * k], "map": [0] * 300})
        for k in range(50)
    ]
    path = write_messages(tmp_path, "json", *messages)
    channels = {
        "position_m": {"from": "position[1]", "unit": "m"},
        "force_n": {"from": "rig/state/effort[0]", "unit": "N"},
    }
    log = read_log(path, {"channels": channels})
    np.testing.assert_array_equal(log.position_m, -np.arange(50.0) / 4)
    np.testing.assert_array_equal(log.force_n, np.arange(50.0))
    assert not any("map" in name for name in log.ignored_columns)


def test_one_bad_mcap_message_is_left_out_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        for k in range(30):
            data = json.dumps({"x_m": float(k), "force_n": 1.0}) if k != 7 else '{"x_m": 7.0, '
            writer.add_message(channel, k * 10**7, data.encode(), k * 10**7)
        writer.finish()
    log = read_log(path)
    assert log.position_m.tolist() == [float(k) for k in range(30) if k != 7]
    assert any(
        one.kind == "invalid" and one.count == 1 and "not readable JSON" in str(one)
        for one in log.findings
    )


def test_an_mcap_recording_that_a_crash_cut_off_is_read_up_to_there(tmp_path: Path) -> None:
    path = tmp_path / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream, chunk_size=400)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        for k in range(200):
            data = json.dumps({"x_m": float(k), "force_n": 1.0}).encode()
            writer.add_message(channel, k * 10**7, data, k * 10**7)
        writer.finish()
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 3])
    log = read_log(path)
    assert 10 <= log.rows < 200
    assert log.position_m.tolist() == [float(k) for k in range(log.rows)]
    assert [one.kind for one in log.findings].count("cut_off") == 1


@pytest.mark.parametrize(
    ("encoding", "content", "words"),
    [
        ("protobuf", {}, "topic 'rig/state': its messages are encoded as 'protobuf'; only json"),
        ("json", "text", "column 'position_m' is missing; present are none"),
        ("json", {"x_m": 1, "force_n": 1}, "1 rows; a log needs at least 10"),
    ],
)
def test_mcap_refuses(tmp_path: Path, encoding: str, content: Any, words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(write_messages(tmp_path, encoding, (1, content)))
