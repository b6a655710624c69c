"""`Log` refuses arrays that are not a log, and names what is wrong."""

import dataclasses

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.logs import Log


def arrays(rows: int = 40) -> dict[str, np.ndarray]:
    t_s = np.arange(rows) / 100.0
    return {"t_s": t_s, "position_m": np.sin(t_s), "force_n": np.cos(t_s)}


def test_keeps_what_it_was_given() -> None:
    log = Log(**arrays(), reference_m=np.ones(40))
    assert (log.rows, log.name, log.source, log.sha256) == (40, "log", None, None)
    assert log.sample_rate_hz == pytest.approx(100.0)
    np.testing.assert_array_equal(log.force_n, arrays()["force_n"])
    np.testing.assert_array_equal(log.reference_m, np.ones(40))


def test_can_not_be_changed() -> None:
    given = arrays()
    log = Log(**given)
    given["force_n"][0] = 7.0
    assert log.force_n[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        log.force_n[0] = 2.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        log.force_n = given["force_n"]


@pytest.mark.parametrize("column", ["t_s", "position_m", "force_n", "reference_m"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_refuses_what_is_no_measurement(column: str, value: float) -> None:
    given = arrays() | {"reference_m": np.zeros(40)}
    given[column][16] = value
    with pytest.raises(LogError, match=rf"column '{column}', row 17: .*finite and within"):
        Log(**given)


@pytest.mark.parametrize(
    ("row", "value", "words"),
    [
        (17, 0.15, r"row 17: 0.15 s repeats 0.15 s"),
        (9, 0.01, r"row 9: 0.01 s goes back from 0.07 s.*\(1 such rows\)"),
    ],
)
def test_refuses_time_that_does_not_increase(row: int, value: float, words: str) -> None:
    given = arrays()
    given["t_s"][row - 1] = value
    with pytest.raises(LogError, match=words):
        Log(**given)


def test_refuses_a_log_of_two_rows() -> None:
    with pytest.raises(LogError, match="2 rows; a log needs at least 10: record for longer"):
        Log(**arrays(2))


def test_refuses_unequal_lengths_and_tables() -> None:
    with pytest.raises(LogError, match="'force_n' has 39 rows and 't_s' has 40"):
        Log(**(arrays() | {"force_n": np.zeros(39)}))
    with pytest.raises(LogError, match=r"'position_m' has shape \(40, 1\)"):
        Log(**(arrays() | {"position_m": np.zeros((40, 1))}))
