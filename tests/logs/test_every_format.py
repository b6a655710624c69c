"""Every reader gives the same log of the same motion, and refuses damaged files by name."""

import gc
import random
import shutil
from pathlib import Path

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.logs import Log, read_log

FLIPS = 60
"""Damaged copies of each file in one test."""


def test_reads_the_motion(every_file: Path, motion: dict[str, np.ndarray]) -> None:
    log = read_log(every_file)
    assert set(log.channels) == {"position_m", "force_n"}
    assert (log.source, log.history) == (every_file, ())
    np.testing.assert_allclose(log.t_s, motion["t_s"], atol=1e-12)
    np.testing.assert_array_equal(log.position_m, motion["position_m"])
    np.testing.assert_array_equal(log.force_n, motion["force_n"])


def test_the_first_bytes_count_before_the_suffix(every_file: Path, tmp_path: Path) -> None:
    if every_file.suffix in (".csv", ".h5") or every_file.name == "v4.mat":
        pytest.skip("has no bytes or a layout of its own")
    other = tmp_path / "log.csv"
    shutil.copyfile(every_file, other)
    assert read_log(other).rows == 200


def test_refuses_a_file_that_was_cut_off(every_file: Path, tmp_path: Path) -> None:
    whole = every_file.read_bytes()
    for part in range(1, 20):
        assert_is_a_log(whole[: len(whole) * part // 20], tmp_path / every_file.name)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_reads_or_refuses_flipped_bits(
    every_file: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], seed: int
) -> None:
    whole = every_file.read_bytes()
    dice = random.Random(seed)
    for _ in range(FLIPS):
        data = bytearray(whole)
        for _ in range(dice.choice((1, 3, 20))):
            place = dice.randrange(len(data) if dice.random() < 0.5 else min(len(data), 2048))
            data[place] ^= 1 << dice.randrange(8)
        assert_is_a_log(bytes(data), tmp_path / every_file.name)
    gc.collect()  # so that what was left open is noticed here
    assert capfd.readouterr() == ("", "")


def test_reads_or_refuses_noise_behind_a_good_beginning(every_file: Path, tmp_path: Path) -> None:
    whole = every_file.read_bytes()
    dice = random.Random(3)
    for _ in range(20):
        good = dice.choice((0, 8, 64, 600, len(whole) // 2))
        data = whole[:good] + dice.randbytes(dice.choice((10, 500, 5000)))
        assert_is_a_log(data, tmp_path / every_file.name)


def assert_is_a_log(data: bytes, path: Path) -> None:
    """Fail unless the bytes are a log or are refused; with `LogError`, and without warnings."""
    path.write_bytes(data)
    try:
        log = read_log(path)
    except LogError as error:
        refusal = str(error)
    else:
        refusal = ""
    if refusal:
        assert path.name in refusal
        return
    assert isinstance(log, Log)
    assert all(np.all(np.isfinite(c.values)) and c.rows >= 10 for c in log.channels.values())
