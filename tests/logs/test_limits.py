"""A log takes no more than it may, and what it claims is asked before it is unpacked."""

import os
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import mcap.writer
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from breakaway.base.free_memory import free_memory_bytes, group_bytes
from breakaway.errors import LogError
from breakaway.measure.logs import read_log
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.csv_rows import LONGEST_ROW
from breakaway.measure.logs.digest import digested
from breakaway.measure.logs.raw import LONGEST_NAME, MOST_NAMES

ROWS = 200_000
ZEROS = {"t_s": np.zeros(ROWS), "position_m": np.zeros(ROWS), "force_n": np.zeros(ROWS)}


def small_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name, values in ZEROS.items():
            file.create_dataset(name, data=values, compression="gzip", shuffle=True)


def small_table(path: Path) -> None:
    with h5py.File(path, "w") as file:
        rows = np.rec.fromarrays(list(ZEROS.values()), names=",".join(ZEROS))
        file.create_dataset("table", data=rows, compression="gzip")


def small_tdms(path: Path) -> None:
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("Rig", n, np.int8(v)) for n, v in ZEROS.items()])


def small_mcap(path: Path) -> None:
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        numbers = ",".join(f'"k{k}": 0' for k in range(500))
        for _ in range(200):
            writer.add_message(channel, 0, f"{{{numbers}}}".encode(), 0)
        writer.finish()


def small_csv(path: Path) -> None:
    path.write_text("t_s,position_m,force_n\n" + "0,0,0\n" * ROWS)


SMALL: dict[str, Callable[[Path], None]] = {
    "small.h5": small_hdf5,
    "table.h5": small_table,
    "small.parquet": lambda path: pq.write_table(pa.table(ZEROS), path),
    "v4.mat": lambda path: savemat(path, ZEROS, format="4"),
    "v5.mat": lambda path: savemat(path, ZEROS, do_compression=True),
    "small.tdms": small_tdms,
    "small.mcap": small_mcap,
    "small.csv": small_csv,
}


@pytest.mark.parametrize("name", SMALL)
def test_a_file_that_takes_more_than_it_may_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    SMALL[name](path)
    remedy = r"or allow more by memory_bytes= \(--memory-gib\)"
    words = (
        rf"{name}: with .* it takes .* MiB of memory, more than the 1 MiB that it may take; "
        rf".*{remedy}"
    )
    with pytest.raises(LogError, match=words):
        read_log(path, memory_bytes=2**20)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SMALL if name != "small.mcap"])
def test_all_channels_of_a_file_count_together(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    SMALL[name](path)
    one = 8 * ROWS
    assert read_log(path, memory_bytes=12 * one).rows == ROWS
    with pytest.raises(LogError, match="it takes"):
        read_log(path, memory_bytes=2.5 * one)


def test_the_budget_keeps_what_is_taken_and_forgets_what_passes() -> None:
    budget = Budget("motor.h5", 100.0)
    budget.take("a", 40, 60)
    budget.take("b", 40, 20)
    with pytest.raises(
        LogError, match=r"motor\.h5: with c it takes 101 bytes of memory, more than"
    ):
        budget.take("c", 10, 11)
    for kept, passing in ((-1, 0), (0, -1), (float("nan"), 0), (10**30, 0)):
        with pytest.raises(LogError, match="it takes"):
            Budget("motor.h5", 100.0).take("d", kept, passing)


def test_a_budget_is_half_of_what_is_free_or_what_is_said(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    assert Budget.of(path, 5.0).most_bytes == 5.0
    assert Budget.of(path, None).most_bytes == pytest.approx(0.5 * free_memory_bytes(), rel=0.5)
    for wrong in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(LogError, match=r"memory_bytes \(--memory-gib\): .* finite number > 0"):
            Budget.of(path, wrong)


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def test_control_groups_of_version_2_limit_what_is_free(tmp_path: Path) -> None:
    write(tmp_path / "proc/self/cgroup", "0::/above/mine\n")
    assert group_bytes(tmp_path) == float("inf")
    groups = tmp_path / "sys/fs/cgroup"
    write(groups / "above/mine/memory.max", "max\n")
    write(groups / "above/mine/memory.current", "10\n")
    assert group_bytes(tmp_path) == float("inf")
    write(groups / "above/memory.max", "1000\n")
    write(groups / "above/memory.current", "700\n")
    write(groups / "above/memory.stat", "anon 400\ninactive_file 200\n")
    assert group_bytes(tmp_path) == 1000 - 700 + 200


def test_control_groups_of_version_1_limit_what_is_free(tmp_path: Path) -> None:
    write(tmp_path / "proc/self/cgroup", "5:cpu:/other\n4:memory:/mine\n")
    top = tmp_path / "sys/fs/cgroup/memory"
    write(top / "memory.limit_in_bytes", "5000\n")
    write(top / "memory.usage_in_bytes", "1000\n")
    assert group_bytes(tmp_path) == 4000  # of the folder above, where its own is not shown
    write(top / "mine/memory.limit_in_bytes", "900\n")
    write(top / "mine/memory.usage_in_bytes", "100\n")
    assert group_bytes(tmp_path) == 800


def test_a_limit_of_the_address_space_counts() -> None:
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31));"
        "from breakaway.base.free_memory import free_memory_bytes as f; print(f())"
    )
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert 0 < float(done.stdout) < 2**31


# Claims that the file cannot hold


def test_hdf5_chunks_that_grow_beyond_their_claim(tmp_path: Path) -> None:
    path = tmp_path / "grows.h5"
    with h5py.File(path, "w") as file:
        for name in ZEROS:
            file.create_dataset(name, shape=(100,), dtype="f8", chunks=(100,), compression="gzip")
            file[name].id.write_direct_chunk((0,), zlib.compress(bytes(100_000)))
    with pytest.raises(LogError, match=r"a chunk of '.*' does not hold the 800 bytes"):
        read_log(path)


def test_matlab_elements_that_claim_more_than_they_hold(tmp_path: Path) -> None:
    path = tmp_path / "claims.mat"
    savemat(path, {"t_s": np.zeros(100)}, do_compression=True)
    whole = path.read_bytes()
    unpacked = bytearray(zlib.decompress(whole[136:]))
    for size, words in ((10**9, "claims 1000000000 bytes behind"), (2000, "claims 2000 bytes of")):
        unpacked[4:8] = size.to_bytes(4, "little")
        packed = zlib.compress(unpacked)
        tag = whole[128:132] + len(packed).to_bytes(4, "little")
        path.write_bytes(whole[:128] + tag + packed)
        with pytest.raises(LogError, match=words):
            read_log(path)


def test_matlab_4_matrices_that_claim_more_than_the_file(tmp_path: Path) -> None:
    path = tmp_path / "claims.mat"
    savemat(path, {"t_s": np.zeros(100)}, format="4")
    data = bytearray(path.read_bytes())
    data[4:8] = (10**9).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(LogError, match=r"'t_s' claims 800000000000 bytes of 800"):
        read_log(path)


def test_mcap_chunks_that_hold_other_than_they_claim(tmp_path: Path) -> None:
    path = tmp_path / "claims.mcap"
    small_mcap(path)
    data = bytearray(path.read_bytes())
    place = data.index(b"zstd") - 4 - 4 - 8  # of the size, before the sum and the text's length
    size = int.from_bytes(data[place : place + 8], "little")
    for claim in (size - 1, size + 1, 10**6):
        data[place : place + 8] = claim.to_bytes(8, "little")
        path.write_bytes(data)
        with pytest.raises(LogError, match="size or checksum of a chunk does not match its bytes"):
            read_log(path)
    data[place : place + 8] = (2**60).to_bytes(8, "little")
    path.write_bytes(data)
    with pytest.raises(LogError, match=r"with a chunk it takes .* GiB of memory"):
        read_log(path)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ("[" * 10**5 + "]" * 10**5, "is nested too deeply"),
        (
            '{"ten_letter":' * 200 + "1" + "}" * 200,
            "the path of a field has more than 1,000 characters",
        ),
        ('{"a": 1', "a message is not readable JSON"),
        ('{"a": ' + "1" * 5000 + "}", "row 1: inf is not a measurement"),
    ],
)
def test_mcap_messages_beyond_a_limit(tmp_path: Path, data: str, words: str) -> None:
    path = tmp_path / "motor.mcap"
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        for k in range(20):
            writer.add_message(channel, k, data.encode(), k)
        writer.finish()
    channels = {"position_m": {"from": "rig/a", "unit": "m"}}
    with pytest.raises(LogError, match=words):
        read_log(path, {"channels": channels})


def test_tdms_lists_of_objects_count(tmp_path: Path) -> None:
    path = tmp_path / "segments.tdms"
    with TdmsWriter(path) as writer:
        for k in range(200):
            changed = {"number": k}  # so that each segment has a list of its own
            writer.write_segment(
                [ChannelObject("Rig", f"c{c}", np.zeros(1), changed) for c in range(20)]
            )
    with pytest.raises(LogError, match="with its segments it takes"):
        read_log(path, memory_bytes=100_000)
    with pytest.raises(LogError, match="column 'position_m' is missing"):
        read_log(path)


def test_tdms_segments_are_told_by_their_tag(tmp_path: Path) -> None:
    path = tmp_path / "motor.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("Rig", "force_n", np.zeros(100))])
    path.write_bytes(path.read_bytes() + bytes(2 * 10**7))
    begin = time.perf_counter()
    with pytest.raises(LogError, match="a segment begins with"):
        read_log(path)
    assert time.perf_counter() - begin < 1.0


# Many names, and long ones


def test_columns_beyond_a_limit_are_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "wide.csv"
    path.write_text(",".join(f"c{k}" for k in range(10**5)) + "\n")
    begin = time.perf_counter()
    with pytest.raises(LogError, match=f"more than {MOST_NAMES:,} channels"):
        read_log(path)
    path.write_text("t_s," + "a_" * 50_000 + "\n")
    with pytest.raises(
        LogError, match=f"100,000 characters; it must have at most {LONGEST_NAME:,}"
    ):
        read_log(path)
    path.write_text("t_s," + "a" * LONGEST_ROW + "\n")
    with pytest.raises(LogError, match=f"a row has more than {LONGEST_ROW:,} characters"):
        read_log(path)
    assert time.perf_counter() - begin < 2.0


def test_rows_that_never_end_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "endless.csv"
    path.write_text("t_s,position_m,force_n\n" + '"\n",' * 2 * 10**6)
    with pytest.raises(LogError, match="a row has more than"):
        read_log(path)


@pytest.mark.parametrize("length", [401, 10**5, 10**6])
def test_csv_cells_of_many_digits_are_no_numbers(tmp_path: Path, length: int) -> None:
    path = tmp_path / "digits.csv"
    path.write_text("t_s,position_m,force_n\n" + f"0,0,{'1' * length}\n" * 2 + "0,0,0\n" * 20)
    words = "larger than field limit" if length > 2**17 else "column 'force_n', row 1: '1+' is not"
    with pytest.raises(LogError, match=words):
        read_log(path)


@pytest.mark.slow
def test_as_many_columns_as_are_allowed_are_read(tmp_path: Path) -> None:
    path = tmp_path / "wide.csv"
    names = ["t_s", "position_m", "force_n", *(f"c{k}" for k in range(MOST_NAMES - 3))]
    path.write_text(",".join(names) + "\n" + (",".join(["1"] * MOST_NAMES) + "\n") * 12)
    log = read_log(path)
    assert (log.rows, len(log.ignored_columns)) == (12, MOST_NAMES - 3)


@pytest.mark.slow
def test_a_name_that_is_missing_among_many_is_told(tmp_path: Path) -> None:
    path = tmp_path / "many.h5"
    with h5py.File(path, "w") as file:
        for k in range(5000):
            file[f"position_{k}"] = 0.0
    with pytest.raises(LogError, match=r"column 'position_x' is missing; the nearest present"):
        read_log(path, {"channels": {"position_m": {"from": "position_x", "unit": "m"}}})


@pytest.mark.slow
def test_parquet_columns_beyond_a_limit_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "wide.parquet"
    pq.write_table(pa.table({f"c{k}": [0.0] for k in range(MOST_NAMES + 1)}), path)
    with pytest.raises(LogError, match=f"more than {MOST_NAMES:,} channels"):
        read_log(path)


# The file that was digested is the one that was read


def test_a_log_that_changes_while_it_is_read_is_refused(tmp_path: Path) -> None:
    path, other = tmp_path / "motor.csv", tmp_path / "other.csv"
    small_csv(path)
    small_csv(other)
    words = r"motor\.csv: changed while it was read"
    with digested(path) as digest:
        assert len(digest) == 64
    with pytest.raises(LogError, match=words), digested(path):
        other.replace(path)  # the same bytes, but who knows
    with pytest.raises(LogError, match=words), digested(path), path.open("a") as file:
        file.write("0,0,0\n")
    with pytest.raises(LogError, match=words), digested(path):
        path.unlink()
