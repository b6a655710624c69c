"""The EMPS reader converts volts to newtons, and refuses by name what is no such file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from breakaway.errors import LogError
from breakaway.measure.logs import read_log

EMPS = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"


def variables() -> dict[str, Any]:
    t = np.arange(30) / 1000.0
    return {"t": t[:, None], "qm": 0.1 * t[:, None], "vir": np.full((30, 1), 2.0), "gtau": 35.0}


def save(folder: Path, content: dict[str, Any], **options: Any) -> Path:
    path = folder / "small.mat"
    savemat(path, content, **options)
    return path


@pytest.mark.skipif(not EMPS.is_file(), reason="the measured logs (../shared/data) are absent")
def test_reads_the_measured_log() -> None:
    log = read_log(EMPS)
    assert (log.rows, log.name, log.ignored_columns) == (24841, "DATA_EMPS.mat", ("kp", "kv"))
    assert log.sample_rate_hz == pytest.approx(1000.0, rel=1e-6)
    assert log.reference_m is not None
    assert np.abs(log.position_m - log.reference_m).max() < 5e-3
    assert 10.0 < np.abs(log.force_n).max() <= 10.0 * 35.15065


@pytest.mark.parametrize("version", ["4", "5"])
def test_force_is_gain_times_volts(tmp_path: Path, version: str) -> None:
    log = read_log(save(tmp_path, variables() | {"pulses_N": 1.0}, format=version))
    np.testing.assert_array_equal(log.force_n, 70.0)
    assert (log.reference_m, log.ignored_columns) == (None, ("pulses_N",))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"gtau": 0.0}, "variable 'gtau' is .*not 0"),
        ({"gtau": np.nan}, "variable 'gtau' is .*one finite drive gain"),
        ({"gtau": [1.0, 2.0]}, "variable 'gtau' is .*one finite drive gain"),
        ({"qm": "text"}, "column 'qm': is of class char; it must be a vector of real numbers"),
        ({"qm": np.ones((30, 2))}, r"'position_m' is missing; present are t, qm#1, qm#2"),
        ({"qm": np.ones(30) * 1j}, "column 'qm': is of type complex"),
        ({"qm": np.zeros((0, 0))}, r"column 'qm'.* shape \(0, 0\)"),
        ({"vir": np.full(30, np.nan)}, "column 'force_n', row 1: nan is not a measurement"),
        ({"vir": np.ones(29)}, "column 'force_n' has 29 rows and 't_s' has 30"),
    ],
)
def test_refuses(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(save(tmp_path, variables() | change))


@pytest.mark.parametrize("name", ["t", "qm", "vir", "gtau"])
def test_names_the_missing_variable_and_the_nearest(tmp_path: Path, name: str) -> None:
    content = variables()
    content[f"{name}2"] = content.pop(name)
    with pytest.raises(LogError, match=f"variable '{name}' is missing; the nearest.*'{name}2'"):
        read_log(save(tmp_path, content), format="emps")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "the file is empty"),
        (b"t_s,position_m,force_n\n0,0,0\n", "is not a MATLAB file"),
        (b"\0" * 10, "is not a MATLAB file"),
        (b"MATLAB 7.3 MAT-file, Platform", "is not a MATLAB 7.3 file"),
    ],
)
def test_refuses_other_files(tmp_path: Path, data: bytes, words: str) -> None:
    path = tmp_path / "other.mat"
    path.write_bytes(data)
    with pytest.raises(LogError, match=words):
        read_log(path, format="emps")


def test_refuses_a_file_that_was_cut_off(tmp_path: Path) -> None:
    path = save(tmp_path, variables())
    whole = path.read_bytes()
    for size in range(1, len(whole), 37):
        path.write_bytes(whole[:size])
        with pytest.raises(LogError, match=r"small\.mat"):
            read_log(path, format="emps")


def test_refuses_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="there is no such file"):
        read_log(tmp_path / "none.mat", format="emps")
