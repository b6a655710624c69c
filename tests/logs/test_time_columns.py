"""Time as tables state it: in words, as numbers of samples, by a rate; and slower columns."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from tests.logs.recorders import printed_mapping

from breakaway.errors import LogError
from breakaway.measure.logs import Log, read_log

ROWS = 200
FORCE_N = np.arange(ROWS) / 8.0


def table(path: Path, time: Callable[[int], str], delimiter: str = ",", name: str = "time") -> Path:
    rows = [f"{time(k)}{delimiter}{k}{delimiter}{FORCE_N[k]}" for k in range(ROWS)]
    header = delimiter.join((name, "position_mm", "force_N"))
    path.write_text(header + "\n" + "\n".join(rows) + "\n")
    return path


def check(log: Log, stamps: Any) -> None:
    np.testing.assert_allclose(log.t_s, stamps, atol=1e-9)
    np.testing.assert_array_equal(log.force_n, FORCE_N)


@pytest.mark.parametrize(
    "stamp",
    [
        lambda k: f"2026-11-30T08:00:{k // 100:02}.{k % 100:02}",
        lambda k: f"2026-11-30 08:00:{k // 100:02}.{k % 100:02}0000Z",
        lambda k: f"30.11.2026 08:00:{k // 100:02}.{k % 100:02}",
        lambda k: f"8:00:{k // 100:02}.{k % 100:02}",
    ],
)
def test_stamps_in_words_count_from_the_first(tmp_path: Path, stamp: Callable[[int], str]) -> None:
    check(read_log(table(tmp_path / "words.csv", stamp)), np.arange(ROWS) / 100.0)


def test_german_stamps_have_a_comma(tmp_path: Path) -> None:
    path = table(
        tmp_path / "words.csv", lambda k: f"30.11.2026 08:00:0{k // 100},{k % 100:02}", ";"
    )
    log = read_log(path, {"csv": {"delimiter": ";"}})
    check(log, np.arange(ROWS) / 100.0)


def test_a_cell_that_is_no_stamp_is_refused(tmp_path: Path) -> None:
    path = table(tmp_path / "words.csv", lambda k: "pause" if k == 7 else f"08:00:{k / 100:05.2f}")
    with pytest.raises(LogError, match=r"column 'time': holds cells that are no time stamp"):
        read_log(path)


def test_numbers_of_samples_have_a_rate(tmp_path: Path) -> None:
    path = table(tmp_path / "samples.csv", str, name="No")
    check(read_log(path, {"time": {"from": "No", "rate_hz": 50.0}}), np.arange(ROWS) / 50.0)


def test_no_time_column_has_a_rate(tmp_path: Path) -> None:
    path = table(tmp_path / "samples.csv", lambda _: "x", name="remark")
    check(read_log(path, {"time": {"rate_hz": 50.0}}), np.arange(ROWS) / 50.0)


def test_time_in_a_unit_of_its_own_has_a_scale(tmp_path: Path) -> None:
    path = table(tmp_path / "ticks.csv", lambda k: str(3 * k), name="ticks")
    check(read_log(path, {"time": {"from": "ticks", "scale": 1e-3}}), 3e-3 * np.arange(ROWS))


def test_a_mapping_beside_the_log_may_have_time_alone(tmp_path: Path) -> None:
    path = table(tmp_path / "ticks.csv", lambda k: str(3 * k), name="ticks")
    path.with_suffix(".toml").write_text('[time]\nfrom = "ticks"\nunit = "ms"\n')
    check(read_log(path), 3e-3 * np.arange(ROWS))


def test_time_says_once_what_its_numbers_are(tmp_path: Path) -> None:
    path = table(tmp_path / "ticks.csv", str, name="ticks")
    with pytest.raises(LogError, match=r"time: has several of unit, rate_hz and scale"):
        read_log(path, {"time": {"from": "ticks", "unit": "ms", "rate_hz": 50.0}})


def test_a_slower_channel_has_blank_cells(tmp_path: Path) -> None:
    path = tmp_path / "slow.csv"
    rows = [f"{k / 100},{k},{FORCE_N[k] if k % 10 == 3 else ''}" for k in range(ROWS)]
    path.write_text("t_s,position_mm,force_N\n" + "\n".join(rows) + "\n")
    log = read_log(path)
    force = log.channels["force_n"]
    np.testing.assert_allclose(force.t_s, np.arange(3, ROWS, 10) / 100.0)
    np.testing.assert_array_equal(force.values, FORCE_N[3::10])
    assert "'force_N': one cell in 10 holds a value" in str(log.findings[0])


def test_a_blank_cell_alone_is_refused(tmp_path: Path) -> None:
    path = table(tmp_path / "lost.csv", lambda k: "" if k == 7 else str(k / 100), name="t_s")
    with pytest.raises(LogError, match=r"column 't_s', row 8: '' is not a number"):
        read_log(path)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16", "utf-8-sig"])
def test_text_of_other_encodings(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "kraft.csv"
    rows = "".join(f"{k / 100},{k},{FORCE_N[k]}\n" for k in range(ROWS))
    path.write_bytes(f"t_s,Weg µm,force_N\n{rows}".encode(encoding))
    mapping: dict[str, Any] = {
        "channels": {
            "position_m": {"from": "Weg µm", "unit": "µm"},
            "force_n": {"from": "force_N", "unit": "N"},
        }
    }
    log = read_log(path, mapping)
    check(log, np.arange(ROWS) / 100.0)
    assert ("the text is read as cp1252" in log.history) == (encoding == "cp1252")
    assert log.position_m[-1] == pytest.approx(199e-6)


def test_tdms_dates_with_times_are_a_time_column(tmp_path: Path) -> None:
    start = np.datetime64("2026-03-01T08:00:00", "us")
    moments = start + 1250 * np.arange(50).astype("timedelta64[us]")
    path = tmp_path / "rig.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject("Rig", "Clock", moments),
                ChannelObject("Rig", "x_m", np.arange(50.0)),
                ChannelObject("Rig", "force_N", -np.arange(50.0)),
            ]
        )
    log = read_log(path, {"time": {"from": "Clock"}})
    np.testing.assert_allclose(log.t_s, 1.25e-3 * np.arange(50), atol=1e-12)
    assert log.force_n.tolist() == (-np.arange(50.0)).tolist()


def test_a_tdms_start_that_was_never_set_is_told(tmp_path: Path) -> None:
    told = {"wf_start_time": np.datetime64("1904-01-01T00:00:00", "us"), "wf_increment": 0.01}
    path = tmp_path / "rig.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("Rig", name, np.arange(50.0), told) for name in ("x_m", "force_N")]
        )
    log = read_log(path)
    assert log.t_s[0] == 0.0
    (found,) = [one for one in log.findings if one.kind == "unset_start"]
    assert found.count == 2 and "1904" in str(found)


def test_the_mapping_for_labview_tdms_works_as_printed(tmp_path: Path) -> None:
    moments = np.datetime64("2026-03-01T08:00:00", "us") + 1250 * np.arange(50)
    path = tmp_path / "rig.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject("Rig", "Clock", moments),
                ChannelObject("Rig", "Encoder", np.arange(50.0)),
                ChannelObject("Rig", "Load cell", np.arange(50.0) / 8.0),
            ]
        )
    log = read_log(path, printed_mapping("LabVIEW TDMS"))
    np.testing.assert_allclose(log.t_s, 1.25e-3 * np.arange(50), atol=1e-12)
    np.testing.assert_allclose(log.position_m, 1e-3 * np.arange(50), atol=1e-15)
    np.testing.assert_allclose(log.force_n, 125.0 * np.arange(50), atol=1e-9)
