"""What is in a file is listed without reading it, and a mapping is guessed from it."""

import tomllib
from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.logs.conftest import ROWS

from breakaway.errors import LogError
from breakaway.measure.logs import ListedChannel, list_channels, read_log
from breakaway.measure.logs.guess import guess, unit_for
from breakaway.measure.logs.raw import RawFile

T_S = np.arange(50) / 100.0


def test_every_format_lists_its_channels(every_file: Path) -> None:
    found = {one.name.rpartition("/")[2]: one for one in list_channels(every_file).channels}
    assert {name.partition("_")[0] for name in found} >= {"position", "force"}
    assert not any(one.unreadable for one in found.values())
    for one in found.values():
        assert one.samples in (ROWS, None)


def test_listing_reads_nothing(every_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(RawFile, "load", _no_reading)
    assert list_channels(every_file).channels


def _no_reading(_: RawFile, wanted: Iterable[str]) -> None:
    raise AssertionError(f"{list(wanted)} were read")


def test_only_what_is_wanted_is_read(every_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    load = RawFile.load

    def note(raw: RawFile, wanted: Iterable[str]) -> None:
        names = list(wanted)
        asked.extend(names)
        load(raw, names)

    monkeypatch.setattr(RawFile, "load", note)
    listed = [one.name for one in list_channels(every_file).channels]
    name = next(name for name in listed if "position" in name)
    channels = {"position_m": {"from": name, "unit": "m"}, "force_n": {"from": name, "unit": "N"}}
    log = read_log(every_file, {"channels": channels})
    assert log.channels["position_m"].rows == ROWS
    assert asked and not [name for name in asked if "force" in name]


def test_a_channel_that_cannot_be_read_matters_only_where_it_is_wanted(tmp_path: Path) -> None:
    path = tmp_path / "motor.h5"
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"], file["force_n"] = T_S, T_S, T_S
        file["spare"] = T_S * 1j
    listed = {one.name: one for one in list_channels(path).channels}
    assert "is of type complex" in listed["spare"].unreadable
    assert read_log(path).rows == 50
    with pytest.raises(LogError, match="column 'spare': is of type complex"):
        read_log(path, {"channels": {"force_n": {"from": "spare", "unit": "N"}}})


@pytest.mark.parametrize(
    ("name", "channel", "unit"),
    [
        ("Time (sec)", "t_s", "s"),
        ("Zeit", "t_s", ""),
        ("Force/N", "force_n", "N"),
        ("Kraft in N", "force_n", "N"),
        ("Standardkraft in kN", "force_n", "kN"),
        ("Load (daN)", "force_n", "daN"),
        ("Load Cell [Newtons]", "force_n", "N"),
        ("Weg", "position_m", ""),
        ("Traversenweg [mm]", "position_m", "mm"),
        ("Extension (Millimeters)", "position_m", "mm"),
        ("Drehmoment [Nm]", "torque_n_m", "N m"),
        ("angle (deg)", "angle_rad", "deg"),
        ("Reibkraft_N", "friction_n", "N"),
    ],
)
def test_names_are_known_in_english_and_german(name: str, channel: str, unit: str) -> None:
    listed = ListedChannel(name)
    assert [one.channel for one in guess([listed])] == [channel]
    assert unit_for(channel, listed) == unit


@pytest.mark.parametrize("name", ["ok", "supply", "note", "N", "x", "Kanal 3"])
def test_other_names_are_not_guessed(name: str) -> None:
    assert guess([ListedChannel(name)]) == []


def test_a_guessed_mapping_reads_the_log(every_file: Path) -> None:
    text = list_channels(every_file).mapping_text()
    mapping = tomllib.loads(text)
    for name, keys in mapping["channels"].items():
        keys.setdefault("unit", {"position_m": "m", "force_n": "N"}[name])
    log = read_log(every_file, mapping)
    assert set(log.channels) == {"position_m", "force_n"}
    assert log.rows == ROWS


def test_a_guess_takes_a_column_once_and_lists_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "motor.csv"
    path.write_text("Time (sec),Load [N],Load 2 [N],note\n" + "0,1,2,on\n" * 20)
    text = list_channels(path).mapping_text()
    assert tomllib.loads(text) == {
        "time": {"from": "Time (sec)", "unit": "s"},
        "channels": {"force_n": {"from": "Load [N]", "unit": "N"}},
    }
    assert "#   'Load 2 [N]'\n#   'note'\n" in text


def test_a_listing_refuses_what_is_no_log(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="there is no such file"):
        list_channels(tmp_path / "none.csv")
    path = tmp_path / "motor.mf4"
    path.write_bytes(b"MDF     4.10".ljust(100, b"\0"))
    with pytest.raises(LogError, match=r"motor\.mf4: is damaged"):
        list_channels(path)
