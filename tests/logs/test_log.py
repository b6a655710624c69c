"""`Log` refuses arrays that are not a log, and names what is wrong."""

import dataclasses

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.logs import Channel, Log


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
        log.channels = {}


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
        (9, 0.01, r"row 9: 0.01 s goes back from 0.07 s.*\(1 such rows\).*log.sorted_by_time"),
    ],
)
def test_checks_on_request_that_time_increases(row: int, value: float, words: str) -> None:
    given = arrays()
    given["t_s"][row - 1] = value
    with pytest.raises(LogError, match=words):
        Log(**given).check_increasing()


def test_a_rate_needs_time_that_goes_on() -> None:
    with pytest.raises(LogError, match=r"log: .*a sample rate needs a last stamp after the first"):
        Log(**(arrays() | {"t_s": np.zeros(40)})).sample_rate_hz  # noqa: B018


def test_further_channels_have_names_with_units() -> None:
    log = Log(**arrays(), channels={"pressure_pa": np.arange(40.0)}, velocity_m_per_s=np.ones(40))
    np.testing.assert_array_equal(log["pressure_pa"], np.arange(40.0))
    np.testing.assert_array_equal(log.velocity_m_per_s, 1.0)
    assert log.channels["pressure_pa"].t_s is log.t_s
    with pytest.raises(LogError, match=r"channel 'pressure': the name does not end with its unit"):
        Log(**arrays(), channels={"pressure": np.ones(40)})
    with pytest.raises(LogError, match="channel 'force_n' is given twice"):
        Log(**arrays(), channels={"force_n": np.ones(40)})
    with pytest.raises(LogError, match="no channel besides time"):
        Log(t_s=np.arange(40.0))


def test_names_the_remedy_for_an_absent_channel() -> None:
    log = Log(t_s=np.arange(40.0), channels={"friction_n": np.ones(40)}, ignored_columns=("load",))
    assert (log.rows, log.reference_m, log.velocity_m_per_s) == (40, None, None)
    words = r"no channel 'force_n'; present are friction_n .*load.*--use force_n=friction_n \(log"
    with pytest.raises(LogError, match=words):
        log.force_n  # noqa: B018


def test_channels_of_different_stamps() -> None:
    fast, slow = np.arange(5000) / 1000.0, 3.0 + np.arange(400) / 200.0
    position, force = Channel("position_m", fast, fast), Channel("force_n", slow, slow)
    log = Log.from_channels([position, force, Channel("pressure_pa", slow, slow)])
    words = (
        r"log: position_m starts 3 s before force_n and position_m is sampled at 1000 Hz against "
        r"200 Hz; .*log.resampled\(rate_hz=...\)"
    )
    for name in ("t_s", "position_m", "force_n", "rows", "sample_rate_hz"):
        with pytest.raises(LogError, match=words):
            getattr(log, name)
    np.testing.assert_array_equal(log["pressure_pa"], slow)


def test_replace_changes_what_is_given_and_keeps_the_rest() -> None:
    log = Log(**arrays(), channels={"pressure_pa": np.arange(40.0)}, history=("made up",))
    later = dataclasses.replace(log, t_s=log.t_s + 3.0)
    assert (later.t_s[0], later.history, list(later.channels)) == (
        3.0,
        ("made up",),
        [*log.channels],
    )
    moved = dataclasses.replace(log, position_m=log.position_m + 1.0, source=None)
    np.testing.assert_array_equal(moved.position_m, log.position_m + 1.0)
    np.testing.assert_array_equal(moved.t_s, log.t_s)
    assert moved["pressure_pa"] is log["pressure_pa"]
    with pytest.raises(LogError, match="column 't_s' is missing"):
        Log(position_m=np.ones(40))


def test_a_slow_channel_does_not_hide_position_and_force() -> None:
    slow = Channel("temperature_degc", np.arange(10.0), np.ones(10))
    log = Log(**arrays())
    both = Log.from_channels([slow, *log.channels.values()])
    np.testing.assert_array_equal(both.position_m, log.position_m)
    assert both.sample_rate_hz == pytest.approx(100.0)


def test_refuses_a_log_of_two_rows() -> None:
    with pytest.raises(LogError, match="2 rows; a log needs at least 10: record for longer"):
        Log(**arrays(2))


def test_refuses_unequal_lengths_and_tables() -> None:
    with pytest.raises(LogError, match="'force_n' has 39 rows and 't_s' has 40"):
        Log(**(arrays() | {"force_n": np.zeros(39)}))
    with pytest.raises(LogError, match=r"'position_m' has shape \(40, 1\)"):
        Log(**(arrays() | {"position_m": np.zeros((40, 1))}))
