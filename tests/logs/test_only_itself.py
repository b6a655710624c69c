"""A log names only itself: what points elsewhere is refused by what it is, not by its size."""

import struct
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
FORCE_N = np.ones(50)


def hdf5(path: Path) -> h5py.File:
    file = h5py.File(path, "w")
    file["t_s"], file["position_m"] = T_S, T_S
    return file


def neighbor(folder: Path) -> Path:
    path = folder / "neighbor.h5"
    with h5py.File(path, "w") as file:
        file["force_n"] = FORCE_N
    return path


def assert_refused(path: Path, words: str, **options: Any) -> None:
    with pytest.raises(LogError, match=words):
        read_log(path, **options)


def test_hdf5_external_storage(tmp_path: Path) -> None:
    path, beside = tmp_path / "motor.h5", tmp_path / "beside.bin"
    beside.write_bytes(FORCE_N.tobytes())
    with hdf5(path) as file:
        external = [(str(beside), 0, FORCE_N.nbytes)]
        file.create_dataset("force_n", shape=(50,), dtype="f8", external=external)
    assert_refused(path, r"column 'force_n': is kept in another file \(external storage\)")


def test_hdf5_virtual_arrays(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    layout = h5py.VirtualLayout(shape=(50,), dtype="f8")
    layout[:] = h5py.VirtualSource(neighbor(tmp_path), "force_n", shape=(50,))
    with hdf5(path) as file:
        file.create_virtual_dataset("force_n", layout)
    assert_refused(path, r"column 'force_n': is kept in other arrays \(virtual\)")


def test_hdf5_links(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    with hdf5(path) as file:
        file["force_n"] = h5py.ExternalLink(neighbor(tmp_path), "/force_n")
        file["friction_n"] = h5py.SoftLink("/t_s")
    assert_refused(path, r"column 'force_n': is a link to another file; .* name that file")
    channels = {"force_n": {"from": "friction_n", "unit": "N"}}
    channels |= {"position_m": {"from": "position_m", "unit": "m"}}
    assert_refused(path, "'friction_n': is a link; .* name what it", mapping={"channels": channels})


def test_hdf5_references(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    with hdf5(path) as file:
        file["force_n"] = np.array([file["t_s"].ref] * 50, dtype=h5py.ref_dtype)
    assert_refused(path, r"column 'force_n': is of references to other places")


def test_hdf5_filters_that_are_plugins(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    with hdf5(path) as file:
        plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        plan.set_chunk((50,))
        # Number 32768 is free for tests; optional, or HDF5 would not make it without its code.
        plan.set_filter(32768, h5py.h5z.FLAG_OPTIONAL, (1,))
        space, kind = h5py.h5s.create_simple((50,)), h5py.h5t.NATIVE_DOUBLE
        h5py.h5d.create(file.id, b"force_n", kind, space, plan)
    assert_refused(path, "column 'force_n': goes through filter 32768 of HDF5; only deflate or LZF")


@pytest.mark.parametrize(
    ("options", "is_read"),
    [
        ({"compression": "gzip", "shuffle": True, "fletcher32": True}, True),
        ({"compression": "lzf", "shuffle": True}, True),
        ({"fletcher32": True}, True),
        ({"scaleoffset": 3}, False),
    ],
)
def test_hdf5_filters(tmp_path: Path, options: dict[str, Any], is_read: bool) -> None:
    path = tmp_path / "motor.h5"
    with hdf5(path) as file:
        file.create_dataset("force_n", data=FORCE_N, chunks=(20,), **options)
    if is_read:
        np.testing.assert_array_equal(read_log(path).force_n, FORCE_N)
    else:
        assert_refused(path, "column 'force_n': goes through filter 6 of HDF5")


def test_hdf5_tables_of_numbers_and_texts(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    kinds = [("force_n", "f4"), ("note", h5py.string_dtype()), ("three", "f8", (3,))]
    rows = np.zeros(50, kinds)
    rows["force_n"], rows["note"] = 1.5, "text"
    with hdf5(path) as file:
        file["table"] = rows
    log = read_log(path)
    np.testing.assert_array_equal(log.force_n, 1.5)
    assert set(log.ignored_columns) == {"table/note", "table/three"}


def test_hdf5_groups_too_deep_are_told(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    deep = "/".join("abcdefgh")
    with hdf5(path) as file:
        file[f"{deep}/force_n"] = FORCE_N
    channels = {"force_n": {"from": deep, "unit": "N"}}
    assert_refused(path, f"'{deep}': lies deeper than 8 groups", mapping={"channels": channels})


def test_matlab_73_references_and_handles(tmp_path: Path) -> None:
    path = tmp_path / "motor.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t_s"], file["position_m"] = T_S[None, :], T_S[None, :]
        file["#refs#/a"] = FORCE_N
        cell = np.array([[file["#refs#/a"].ref]], dtype=h5py.ref_dtype)
        file["force_n"] = cell
        file["force_n"].attrs["MATLAB_class"] = np.bytes_("cell")
    with path.open("r+b") as data:
        data.write(b"MATLAB 7.3 MAT-file".ljust(512))
    assert_refused(path, "column 'force_n': is of references to other places")


def element(kind: int, content: bytes) -> bytes:
    return struct.pack("<II", kind, len(content)) + content.ljust(-(-len(content) // 8) * 8, b"\0")


@pytest.mark.parametrize(
    ("number", "words"),
    [(17, "is an object of MATLAB, such as a timeseries"), (16, "is of class function handle")],
)
def test_matlab_5_objects_and_handles(tmp_path: Path, number: int, words: str) -> None:
    path = tmp_path / "motor.mat"
    savemat(path, {"t_s": T_S, "position_m": T_S})
    parts = [element(6, struct.pack("<II", number, 0))]
    if number == 16:
        parts.append(element(5, struct.pack("<ii", 1, 1)))
    parts.append(element(1, b"force_n"))
    with path.open("ab") as file:
        file.write(element(14, b"".join(parts)))
    assert_refused(path, f"column 'force_n': {words}")


def test_matlab_4_text_sparse_and_complex(tmp_path: Path) -> None:
    path = tmp_path / "motor.mat"
    content = {"t_s": T_S, "position_m": T_S, "force_n": FORCE_N * 1j, "note": "a text"}
    savemat(path, content, format="4")
    assert_refused(path, "column 'force_n': is of type complex")
    savemat(path, content | {"force_n": "text"}, format="4")
    assert_refused(path, "column 'force_n': is of class text")


@pytest.mark.parametrize("kind", ["f8", "f4", "i4", "i2", "u2", "u1"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_matlab_4_numbers_of_every_type(tmp_path: Path, kind: str, order: str) -> None:
    path = tmp_path / "motor.mat"
    digit = {"f8": 0, "f4": 1, "i4": 2, "i2": 3, "u2": 4, "u1": 5}[kind]
    data = b""
    for name in (b"t_s", b"position_m", b"force_n"):
        kind_number = 1000 * (order == ">") + 10 * digit
        data += struct.pack(f"{order}5i", kind_number, 1, 50, 0, len(name) + 1) + name + b"\0"
        data += np.arange(50).astype(order + kind).tobytes()
    path.write_bytes(data)
    np.testing.assert_array_equal(read_log(path).force_n, np.arange(50.0))


def test_mcap_attachments_and_metadata_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        writer.add_attachment(0, 0, "../outside.txt", "text/plain", b"MARKER")
        writer.add_metadata("notes", {"who": "MARKER"})
        for k in range(50):
            data = b'{"position_m": 1, "force_n": 2.5}'
            writer.add_message(channel, k * 10_000_000, data, k * 10_000_000)
        writer.finish()
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, T_S)
    np.testing.assert_array_equal(log.force_n, 2.5)
    assert log.ignored_columns == ()
    assert sorted(item.name for item in tmp_path.iterdir()) == ["motor.mcap"]


@pytest.mark.parametrize("compression", list(mcap.writer.CompressionType))
@pytest.mark.parametrize("chunking", [True, False])
def test_mcap_compressions(tmp_path: Path, compression: Any, chunking: bool) -> None:
    path = tmp_path / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(
            stream, compression=compression, use_chunking=chunking, chunk_size=500
        )
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        for k in range(50):
            data = f'{{"position_m": {k}, "force_n": -{k}e-3}}'.encode()
            writer.add_message(channel, k * 10_000_000, data, k * 10_000_000)
        writer.finish()
    log = read_log(path)
    np.testing.assert_allclose(log.t_s, T_S)
    np.testing.assert_allclose(log.force_n, -1e-3 * np.arange(50))
    if chunking and compression is mcap.writer.CompressionType.NONE:
        path.write_bytes(path.read_bytes().replace(b"-11e-3", b"-99e-3"))
        assert_refused(path, "the size or checksum of a chunk does not match its bytes")


def test_parquet_columns_in_another_file(tmp_path: Path) -> None:
    path, beside = tmp_path / "motor.parquet", tmp_path / "beside.parquet"
    found: list[Any] = []
    table = pa.table({"t_s": T_S, "position_m": T_S, "force_n": FORCE_N})
    with pq.ParquetWriter(beside, table.schema, metadata_collector=found) as writer:
        writer.write_table(table)
    found[0].set_file_path("beside.parquet")
    found[0].write_metadata_file(path)
    assert_refused(path, "is damaged, or is not a Parquet file")


def tdms(path: Path, **properties: Any) -> None:
    named = {key.replace("__", "[0]_"): value for key, value in properties.items()}
    waveform = {"wf_start_offset": 0.0, "wf_increment": 0.01}
    channels = [
        ChannelObject("Rig", "position_m", T_S, waveform),
        ChannelObject("Rig", "force_n", np.arange(50, dtype=np.int16), waveform | named),
    ]
    with TdmsWriter(path) as writer:
        writer.write_segment(channels)


def test_tdms_scales_that_are_known(tmp_path: Path) -> None:
    path = tmp_path / "motor.tdms"
    line = {"NI_Scale__Linear_Slope": 2.0, "NI_Scale__Linear_Y_Intercept": 1.0}
    tdms(path, NI_Number_Of_Scales=1, NI_Scale__Scale_Type="Linear", **line)
    np.testing.assert_array_equal(read_log(path).force_n, 1.0 + 2.0 * np.arange(50))


@pytest.mark.parametrize(
    ("properties", "words"),
    [
        (
            {"NI_Number_Of_Scales": 1, "NI_Scale__Scale_Type": "Reciprocal"},
            "by 'Reciprocal', which",
        ),
        ({"NI_Scale__Scale_Type": "Reciprocal"}, "by 'Reciprocal', which is unknown"),
        ({"NI_Number_Of_Scales": 9}, "states 9 scales; at most 8"),
        ({"NI_Scale[12]_Scale_Type": "Linear"}, "has the scale 12; at most 8"),
    ],
)
def test_tdms_raw_counts_are_no_values(
    tmp_path: Path, properties: dict[str, Any], words: str
) -> None:
    path = tmp_path / "motor.tdms"
    tdms(path, **properties)
    assert_refused(path, f"column 'Rig/force_n': .*{words}")
    tdms(path, NI_Scaling_Status="scaled", **properties)
    np.testing.assert_array_equal(read_log(path).force_n, np.arange(50))


def test_tdms_scales_must_be_counted_by_a_number(tmp_path: Path) -> None:
    path = tmp_path / "motor.tdms"
    tdms(path, NI_Number_Of_Scales="many", NI_Scaling_Status="scaled")
    assert_refused(path, "column 'Rig/force_n': states 'many' scales, which is not a number")


def test_tdms_index_files_are_not_opened(tmp_path: Path) -> None:
    path = tmp_path / "motor.tdms"
    tdms(path)
    path.with_suffix(".tdms_index").write_bytes(b"no index")
    np.testing.assert_array_equal(read_log(path).force_n, np.arange(50))
