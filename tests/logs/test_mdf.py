"""MDF files: groups and their clocks, raw values of all widths, records, and what is refused."""

import random
import struct
import time
import tracemalloc
import zlib
from pathlib import Path
from typing import Any

import asammdf
import numpy as np
import pytest
from asammdf.blocks import v4_constants as v4c
from asammdf.blocks.v4_blocks import ChannelConversion
from tests.logs.mdf_files import FLOAT, ROWS, SIGNED, T_S, UNSIGNED, Maker, signal, write

from breakaway.errors import LogError
from breakaway.measure.logs import read_log
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mdf import open_mdf
from breakaway.measure.logs.raw import RawFile

HIGHEST_FIRST = 1
TIME = {"kind": 2, "counts": 1}


def read(path: Path, most_bytes: float = 1e8) -> RawFile:
    """Open a file and read all its channels."""
    with open_mdf(path, Budget(path.name, most_bytes)) as raw:
        raw.load(raw.names)
    return raw


def sorted_file(path: Path, size: int, data: bytes, *channels: dict[str, Any], **told: int) -> Path:
    """Write a file of one group, whose channels are called a, b, c."""
    maker, first = Maker(), 0
    for name, channel in reversed([*zip("abc", channels, strict=False)]):
        first = maker.channel(name, first, **channel)
    records = told.pop("records") if "records" in told else len(data) // size
    group = maker.group(first, records, size, **told)
    return maker.finish(path, (group, maker.block("DT", [], data), 0))


def values_of(path: Path, *channels: str) -> list[list[float]]:
    raw = read(path)
    assert raw.unreadable == {}
    return [raw.channels[name].values.tolist() for name in channels]


# Groups


def test_groups_have_clocks_of_their_own(tmp_path: Path) -> None:
    late = 3.0 + np.arange(40) / 50.0
    path = write(
        tmp_path,
        [signal("position", T_S, "mm"), signal("load", T_S, "N")],
        [signal("force", late, "N", 2.0), signal("load", late, "N")],
    )
    log = read_log(path)
    np.testing.assert_allclose(log.channels["position_m"].t_s, T_S)
    np.testing.assert_allclose(log.channels["force_n"].t_s, late)
    np.testing.assert_allclose(log["force_n"], 2.0 * late)
    assert set(log.ignored_columns) == {"0/load", "1/load"}
    channels = {"force_n": {"from": "1/load"}}
    np.testing.assert_allclose(read_log(path, {"channels": channels})["force_n"], late)


def test_the_clock_is_converted_by_our_own_code(tmp_path: Path) -> None:
    maker = Maker()
    formula = maker.text("X1 * 10^-3")
    unit = maker.text("ms")
    conversion = maker.block("CC", [0, unit, 0, 0, formula], bytes([3, 0, 0, 0, 1]) + bytes(19))
    value = maker.channel("a", first_byte=4, bits=32)
    clock = maker.channel("t", value, data=UNSIGNED, bits=32, conversion=conversion, **TIME)
    data = np.rec.fromarrays([np.arange(3) * 5000, np.ones(3)], dtype=[("t", "<u4"), ("a", "<f4")])
    group = maker.group(clock, 3, 8)
    data_block = maker.block("DT", [], data.tobytes())
    path = maker.finish(tmp_path / "clock.mf4", (group, data_block, 0))
    np.testing.assert_allclose(read(path).channels["a"].t_s, [0.0, 0.005, 0.010])


@pytest.mark.parametrize(
    ("counts", "unit", "words"),
    [(2, "rad", "is not time"), (1, "furlong", "'furlong', which is not a known unit")],
)
def test_a_clock_that_is_none(tmp_path: Path, counts: int, unit: str, words: str) -> None:
    maker = Maker()
    value = maker.channel("a")
    told = {"kind": 2, "counts": counts, "unit": maker.text(unit)}
    group = maker.group(maker.channel("t", value, **told), 1, 8)
    path = maker.finish(tmp_path / "clock.mf4", (group, maker.block("DT", [], bytes(8)), 0))
    assert words in read(path).unreadable["a"]


def test_the_unit_of_a_channel_is_before_that_of_its_conversion(tmp_path: Path) -> None:
    for unit, expected in ((None, "kN"), ("N", "N"), ("", "")):
        maker = Maker()
        conversion = maker.block("CC", [0, maker.text("kN"), 0, 0], bytes(24))
        told = {} if unit is None else {"unit": maker.text(unit)}
        group = maker.group(maker.channel("a", conversion=conversion, **told), 1, 8)
        path = maker.finish(tmp_path / "unit.mf4", (group, maker.block("DT", [], bytes(8)), 0))
        assert read(path).listed["a"].unit == expected


def test_markup_is_searched_and_no_entity_of_its_own_is_known(tmp_path: Path) -> None:
    markup = '<!DOCTYPE x [<!ENTITY e "MARKER">]><CNunit><TX>m&lt;&amp;lt;&e;</TX></CNunit>'
    maker = Maker()
    unit = maker.block("MD", [], markup.encode())
    group = maker.group(maker.channel("a", unit=unit), 1, 8)
    path = maker.finish(tmp_path / "unit.mf4", (group, maker.block("DT", [], bytes(8)), 0))
    assert read(path).listed["a"].unit == "m<&lt;&e;"


def test_virtual_channels_count_rows(tmp_path: Path) -> None:
    value = {"kind": 6, "data": UNSIGNED, "bits": 0}
    path = sorted_file(tmp_path / "v.mf4", 0, b"", value, records=4)
    assert values_of(path, "a") == [[0.0, 1.0, 2.0, 3.0]]


# Raw values


@pytest.mark.parametrize("bits", [1, 3, 7, 8, 12, 16, 24, 31, 32, 40, 53])
@pytest.mark.parametrize("first_bit", [0, 3])
@pytest.mark.parametrize("is_signed", [False, True])
@pytest.mark.parametrize("order", [0, HIGHEST_FIRST])
def test_integers_of_all_widths(
    tmp_path: Path, bits: int, first_bit: int, is_signed: bool, order: int
) -> None:
    dice = random.Random(bits + first_bit)
    numbers = [dice.randrange(2**bits) for _ in range(30)]
    width = (first_bit + bits + 7) // 8
    data = b""
    for number in numbers:
        noise = dice.randrange(2**first_bit) | dice.getrandbits(8) << (first_bit + bits)
        whole = (number << first_bit | noise) % 2 ** (8 * width)
        data += b"\xaa" + whole.to_bytes(width, "big" if order else "little") + b"\x55"
    told = {"first_byte": 1, "first_bit": first_bit, "bits": bits}
    told["data"] = (SIGNED if is_signed else UNSIGNED) + order
    path = sorted_file(tmp_path / "bits.mf4", width + 2, data, told)
    expected = [n - 2**bits if is_signed and n >= 2 ** (bits - 1) else n for n in numbers]
    assert values_of(path, "a") == [expected]


@pytest.mark.parametrize("kind", ["<u1", "<u2", ">u4", "<u8", "<i1", ">i2", "<i4", ">i8"])
def test_numbers_as_asammdf_reads_them(tmp_path: Path, kind: str) -> None:
    dtype = np.dtype(kind)
    data = np.array([0, 1, 100, 127, -1 if dtype.kind == "i" else 255], dtype)
    told = {"data": {"u": UNSIGNED, "i": SIGNED}[dtype.kind] + (kind[0] == ">")}
    told["bits"] = 8 * dtype.itemsize
    path = sorted_file(tmp_path / "n.mf4", dtype.itemsize, data.tobytes(), told)
    with asammdf.MDF(path) as file:
        assert file.get("a").samples.tolist() == data.tolist()
    assert values_of(path, "a") == [data.tolist()]


@pytest.mark.parametrize("kind", ["<f2", ">f2", "<f4", ">f4", "<f8", ">f8"])
def test_floating_point_numbers(tmp_path: Path, kind: str) -> None:
    data = np.array([0.5, -1.25, 1024.0], kind)
    told = {"data": FLOAT + (kind[0] == ">"), "bits": 8 * data.itemsize}
    path = sorted_file(tmp_path / "f.mf4", data.itemsize, data.tobytes(), told)
    assert values_of(path, "a") == [[0.5, -1.25, 1024.0]]


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"data": 7}, "is text; it must be real numbers"),
        ({"data": 10}, "is bytes;"),
        ({"data": 13}, "is a date;"),
        ({"data": 15}, "is complex;"),
        ({"data": 99}, "is kind 99;"),
        ({"data": FLOAT, "bits": 24}, "is a floating-point number of 24 bits"),
        ({"data": UNSIGNED, "bits": 64, "first_bit": 1}, "has 64 bits from bit 1"),
        ({"data": UNSIGNED, "bits": 0}, "has 0 bits"),
        ({"kind": 1, "data": UNSIGNED}, "has samples of variable length"),
        ({"flags": 1}, "all its samples are marked invalid"),
    ],
)
def test_what_is_no_number(tmp_path: Path, told: dict[str, int], words: str) -> None:
    path = sorted_file(tmp_path / "n.mf4", 16, bytes(32), told, {})
    raw = read(path)
    assert words in raw.unreadable["a"]
    assert list(raw.channels) == ["b"]


def test_samples_that_are_marked_invalid_are_left_out_and_told(tmp_path: Path) -> None:
    marked = np.isin(np.arange(ROWS), [7, 8])
    force = asammdf.Signal(T_S, T_S, unit="N", name="force", invalidation_bits=marked)
    path = write(tmp_path, [force, signal("position", T_S, "m")])
    log = read_log(path, {"channels": {"force_n": {"from": "force", "unit": "N"}}})
    found = log.channels["force_n"]
    assert found.values.tolist() == np.delete(T_S, [7, 8]).tolist() == found.t_s.tolist()
    assert str(log.findings[0]) == "'force': 2 samples marked invalid left out"
    assert "gap" in {one.kind for one in log.findings}


def test_parts_of_a_structure_are_channels_and_arrays_are_not(tmp_path: Path) -> None:
    maker = Maker()
    parts = maker.channel("x", maker.channel("y", first_byte=8))
    array = maker.channel("list", parts=maker.block("CA", [0], bytes(16)))
    whole = maker.channel("point", array, data=10, bits=128, parts=parts)
    data = maker.block("DT", [], np.arange(4.0).tobytes())
    path = maker.finish(tmp_path / "parts.mf4", (maker.group(whole, 2, 16), data, 0))
    raw = read(path)
    assert raw.channels["x"].values.tolist() == [0.0, 2.0]
    assert raw.channels["y"].values.tolist() == [1.0, 3.0]
    assert "is bytes" in raw.unreadable["point"]
    assert "is an array or a union" in raw.unreadable["list"]


# Records


@pytest.mark.slow
@pytest.mark.parametrize("compression", [0, 1, 2])
def test_records_in_many_slices_packed_or_not(tmp_path: Path, compression: int) -> None:
    rows = 700_000
    t_s = np.arange(rows) / 1e4
    raw = (np.arange(rows) * 7919 % 65521).astype(np.uint16)
    force = asammdf.Signal(raw, t_s, unit="N", name="force")
    path = write(tmp_path, [force, signal("position", t_s, "m")], compression=compression)
    found = read(path)
    np.testing.assert_array_equal(found.channels["force"].values, raw)
    np.testing.assert_array_equal(found.channels["position"].values, t_s)
    np.testing.assert_array_equal(found.channels["position"].t_s, t_s)


def unsorted_file(path: Path, id_bytes: int) -> Path:
    """Write three groups in one block: a of 30 rows, b of 20, texts of any length between."""
    maker = Maker()
    texts = maker.group(0, 10, 0, record_id=3, flags=1)
    b = maker.channel("b", data=SIGNED, bits=16)
    second = maker.group(b, 20, 2, record_id=9, following=texts)
    first = maker.group(maker.channel("a"), 30, 8, record_id=7, following=second)
    data = b""
    for k in range(30):
        data += (7).to_bytes(id_bytes, "little") + np.float64(k).tobytes()
        if k % 3:
            data += (9).to_bytes(id_bytes, "little") + np.int16(-k).tobytes()
        else:
            length = (k * 5).to_bytes(4, "little")
            data += (3).to_bytes(id_bytes, "little") + length + b"\7" * 5 * k
    return maker.finish(path, (first, maker.block("DT", [], data), id_bytes))


@pytest.mark.parametrize("id_bytes", [1, 2, 4, 8])
def test_records_of_several_groups_in_one_block(tmp_path: Path, id_bytes: int) -> None:
    path = unsorted_file(tmp_path / "unsorted.mf4", id_bytes)
    a, b = values_of(path, "a", "b")
    assert a == list(range(30))
    assert b == [-k for k in range(30) if k % 3]


def test_more_or_fewer_records_than_claimed(tmp_path: Path) -> None:
    for records, words in ((9, "holds fewer"), (7, "holds more")):
        path = sorted_file(tmp_path / "few.mf4", 8, bytes(64), {}, records=records)
        with pytest.raises(LogError, match=f"claims {records} records; its data {words}"):
            read(path)
    path = sorted_file(tmp_path / "part.mf4", 8, bytes(66), {})
    with pytest.raises(LogError, match="ends within a record of 8 bytes"):
        read(path)
    path = unsorted_file(tmp_path / "other.mf4", 1)
    path.write_bytes(path.read_bytes().replace(b"\x09\xff\xff", b"\x08\xff\xff"))
    with pytest.raises(LogError, match="holds a record of an unknown group 8"):
        read(path)


def test_records_by_columns_are_refused(tmp_path: Path) -> None:
    maker = Maker()
    group = maker.group(maker.channel("a"), 1, 8)
    path = maker.finish(tmp_path / "columns.mf4", (group, maker.block("DV", [], bytes(8)), 0))
    with pytest.raises(LogError, match="stores its records by column"):
        read(path)


def packed_file(path: Path, claimed: int, way: int = 0) -> Path:
    """Write 100 records packed, that claim to be more or fewer bytes than 800."""
    plain = path.with_suffix(".plain")
    sorted_file(plain, 8, bytes(800), {})
    maker = Maker()
    group = maker.group(maker.channel("a"), 100, 8)
    packed = zlib.compress(bytes(800))
    head = b"DT" + bytes([way, 0]) + (8).to_bytes(4, "little")
    head += claimed.to_bytes(8, "little") + len(packed).to_bytes(8, "little")
    return maker.finish(path, (group, maker.block("DZ", [], head + packed), 0))


def test_packed_blocks_hold_what_they_claim(tmp_path: Path) -> None:
    assert values_of(packed_file(tmp_path / "good.mf4", 800), "a") == [[0.0] * 100]
    for claimed in (0, 799, 801, 10**6):
        with pytest.raises(LogError, match=rf"claims {claimed} bytes, but holds more or fewer"):
            read(packed_file(tmp_path / "bad.mf4", claimed))
    with pytest.raises(LogError, match="is packed by method 2, which is not supported"):
        read(packed_file(tmp_path / "new.mf4", 800, way=2))


# What is refused, or never looked at


def test_mdf_3_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [signal("position", T_S, "m")], version="3.30")
    with pytest.raises(LogError, match=r"is MDF version 3\.\d+; only version 4 is read: convert"):
        read_log(path)


def test_a_file_that_was_not_finished_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [signal("position", T_S, "m")])
    data = bytearray(path.read_bytes())
    data[60] = 1
    path.write_bytes(data)
    with pytest.raises(LogError, match="is not a finalized MDF file"):
        read(path)


@pytest.mark.parametrize("kind", [b"##DG", b"##CG", b"##CN"])
def test_blocks_in_a_ring_are_refused(tmp_path: Path, kind: bytes) -> None:
    path = write(tmp_path, [signal("position", T_S, "m")])
    data = bytearray(path.read_bytes())
    place = data.index(kind)
    data[place + 24 : place + 32] = place.to_bytes(8, "little")  # the next is this one
    path.write_bytes(data)
    with pytest.raises(LogError, match=rf"the block at byte {place} belongs to two places"):
        read(path)


def test_conversions_that_lead_to_each_other_come_to_an_end(tmp_path: Path) -> None:
    maker = Maker()
    body = bytes([7, 0, 0, 0, 1]) + bytes(19)
    conversion = maker.block("CC", [0, 0, 0, 0, 0], body)
    maker.link(conversion, 4, conversion)
    group = maker.group(maker.channel("a", conversion=conversion), 1, 8)
    path = maker.finish(tmp_path / "ring.mf4", (group, maker.block("DT", [], bytes(8)), 0))
    assert read(path).unreadable["a"] == "more than 8 conversions lead on to each other"


def test_attachments_are_not_looked_at(tmp_path: Path) -> None:
    beside = tmp_path / "beside.txt"
    beside.write_text("MARKER")
    with asammdf.MDF(version="4.10") as file:
        file.append([signal("position", T_S, "m")])
        file.attach(b"MARKER", file_name="within.txt", embedded=True)
        file.attach(b"MARKER 2", file_name=str(beside), embedded=False)
        path = Path(file.save(tmp_path / "motor", overwrite=True))
    expected = read(path).channels["position"].values
    beside.unlink()
    data = bytearray(path.read_bytes())
    assert data.count(b"##AT") == 2
    path.write_bytes(data.replace(b"##AT", b"##??"))  # nobody minds what they are
    np.testing.assert_array_equal(read(path).channels["position"].values, expected)


def test_claims_are_asked_of_the_budget_before_memory_is_taken(tmp_path: Path) -> None:
    virtual = {"kind": 6, "data": UNSIGNED, "bits": 0}
    path = sorted_file(tmp_path / "huge.mf4", 0, b"", virtual, virtual, records=10**12)
    with pytest.raises(LogError, match=r"with group 0 it takes .*iB of memory, more"):
        read(path)
    path = packed_file(tmp_path / "packed.mf4", 10**12)
    with pytest.raises(LogError, match=r"with the packed block at byte \d+ it takes .*iB"):
        read(path)


def test_the_budget_counts_the_whole_file(tmp_path: Path) -> None:
    path = write(tmp_path, *([signal(f"x{k}", T_S)] for k in range(10)))
    assert len(read(path, 8.0 * ROWS * 20).channels) == 10
    with pytest.raises(LogError, match="with group 9 it takes"):
        read(path, 8.0 * ROWS * 20 - 1)


def test_memory_is_little_more_than_the_values(tmp_path: Path) -> None:
    t_s = np.arange(1_000_000) / 1e4
    formula = ChannelConversion(conversion_type=v4c.CONVERSION_TYPE_ALG, formula="(X1+1)*(X1-1)")
    raw = np.arange(1_000_000).astype(np.uint8)
    signals = [
        asammdf.Signal(raw, t_s, unit="N", name=f"f{k}", conversion=formula) for k in range(4)
    ]
    path = write(tmp_path, signals)
    tracemalloc.start()
    try:
        read(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    values = 8 * len(t_s) * 5
    assert peak < 1.4 * values + 40e6


@pytest.mark.slow
@pytest.mark.parametrize("id_bytes", [0, 1])
def test_memory_for_one_large_packed_block(tmp_path: Path, id_bytes: int) -> None:
    rows, size = 250_000, 80
    data = bytes(rows * (id_bytes + size))
    packed = zlib.compress(data)
    maker = Maker()
    group = maker.group(maker.channel("a"), rows, size)
    told = struct.pack("<2sBxIQQ", b"DT", 0, 0, len(data), len(packed))
    block = maker.block("DZ", [], told + packed)
    path = maker.finish(tmp_path / "packed.mf4", (group, block, id_bytes))
    tracemalloc.start()
    try:
        read(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    asked = 8 * rows + 2 * len(data) + len(packed)
    assert peak < asked + 50e6


@pytest.mark.slow
def test_many_channels_are_read_in_time(tmp_path: Path) -> None:
    maker, following = Maker(), 0
    for k in range(16_000):
        following = maker.channel(f"c{k}", following, first_byte=0)
    group = maker.group(following, 20, 8)
    path = maker.finish(tmp_path / "many.mf4", (group, maker.block("DT", [], bytes(160)), 0))
    begin = time.process_time()
    assert len(read(path).channels) == 16_000
    assert time.process_time() - begin < 5.0
