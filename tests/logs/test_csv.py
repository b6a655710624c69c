"""The CSV reader reads what its header states, and refuses all else by name."""

import hashlib
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from breakaway.errors import LogError
from breakaway.measure.logs import Log, read_log

Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def _write(text: str | bytes) -> Path:
        path = tmp_path / "motor.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return _write


def table(header: str = "t_s,position_m,force_n", **changed: str) -> str:
    """Return 20 good rows, of which ``row5="..."`` changes the fifth."""
    rows = [changed.get(f"row{k}", f"{k / 100},{k * 1e-4},2.5") for k in range(1, 21)]
    return "\n".join([header, *rows]) + "\n"


def test_reads_the_columns(write: Write) -> None:
    path = write(table())
    log = read_log(path, format="csv")
    np.testing.assert_allclose(log.t_s, np.arange(1, 21) / 100)
    np.testing.assert_allclose(log.position_m, np.arange(1, 21) * 1e-4)
    np.testing.assert_array_equal(log.force_n, 2.5)
    assert (log.source, log.ignored_columns, log.reference_m) == (path, (), None)
    assert log.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    "text",
    [
        table("T_s, x_m ,force_N"),
        table().replace("\n", "\r\n"),
        "\ufeff" + table() + "\n\n",
        table('"t_s","position_m","force_n"', row3='"0.03","3e-4"," 2.5 "'),
    ],
    ids=["names", "windows", "bom and empty end", "quotes"],
)
def test_reads_the_same_from_other_spellings(write: Write, text: str) -> None:
    log = read_log(write(text))
    np.testing.assert_allclose(log.position_m, np.arange(1, 21) * 1e-4)
    np.testing.assert_array_equal(log.force_n, 2.5)


def test_lists_the_columns_that_it_does_not_read(write: Write) -> None:
    rows = "".join(f"off,{k},{k / 9},{-k},{2 * k}\n" for k in range(12))
    log = read_log(write("state,x_m,t_s,force_n,reference_m\n" + rows))
    assert log.ignored_columns == ("state",)
    np.testing.assert_array_equal(log.force_n, -np.arange(12.0))
    np.testing.assert_array_equal(log.reference_m, 2.0 * np.arange(12.0))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "motor.csv: the file is empty"),
        ("\n\r\n", "holds only empty lines"),
        (b"t_s,position_m,force_n\n\xff\xfe", "byte 24 is not UTF-8"),
        (table("clock,position_m,force_n"), "column 't_s' is missing; .*clock, .*time = { from"),
        (table("t_s,positions,force_n"), "'position_m' is missing; the nearest .*'positions'"),
        (table("t_s,position_m,Force_mm"), "'force_n' is missing; the nearest .*'Force_mm'"),
        (table("t_s,position_m,force"), r"motor.toml, such as: channels.force_n = { from = "),
        (table("t_s,x_m,position_m"), "columns 'x_m' and 'position_m' both give 'position_m'"),
        ("t_s;position_m;force_n\n0;1;2\n", "one cell; columns must be separated by commas"),
        (
            "t_s,x_m,force_n,force_n\n" + "0,1,2,3\n" * 10,
            "columns 'force_n#1' and 'force_n#2' both give 'force_n'",
        ),
        (table(row5="0.05,n/a,2.5"), "column 'position_m', row 5: 'n/a' is not a number"),
        (table(row5="0.05,,2.5"), "column 'position_m', row 5: '' is not a number"),
        (table(row5="0.05,1_0,2.5"), "row 5: '1_0' is not a number"),
        (table(row5="0.05,٣,2.5"), "row 5: '٣' is not a number"),
        (table(row7="0.07,0.1,nan"), "column 'force_n', row 7: 'nan' is not finite"),
        (table(row7="0.07,0.1,-inf"), "column 'force_n', row 7: '-inf' is not finite"),
        (table(row7="1e999,0.1,1"), "column 't_s', row 7: '1e999' is not finite"),
        (table(row7="0.07,1e15,1"), r"column 'position_m', row 7: 1e\+15 is not a measurement"),
        (table(row9="0.09,0.1"), "row 9: 2 cells where the header has 3"),
        (table(row9="0.09,0.1,1,2"), "row 9: 4 cells where the header has 3"),
        (table(row9='0.09,0.1,"2'), "is not comma-separated text"),
        ("t_s,position_m,force_n\n0,0,0\n1,1,1\n", "2 rows; a log needs at least 10"),
        ("t_s,position_m,force_n\n", "0 rows; a log needs at least 10"),
    ],
)
def test_refuses(write: Write, text: str | bytes, words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(write(text))


def test_refuses_what_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(LogError, match=r"none\.csv: there is no such file"):
        read_log(tmp_path / "none.csv")
    with pytest.raises(LogError, match="cannot be read"):
        read_log(tmp_path)
    with pytest.raises(LogError, match="cannot be read"):
        read_log(Path("nul\0.csv"))


def test_refuses_an_unknown_format(write: Write) -> None:
    with pytest.raises(LogError, match="format 'tdsm' is unknown; it must be one of csv, parquet"):
        read_log(write(table()), format="tdsm")


def test_reads_the_layout_that_a_mapping_states(write: Write) -> None:
    rows = "".join(f"{k},{k}; 0,{k:02d};-1,5e3\n" for k in range(20))
    path = write("made by a rig\nTime;Position;Force\n[s];[mm];(N)\n" + rows)
    layout = {"delimiter": ";", "decimal": ",", "skip_rows": 1, "units_row": True}
    log = read_log(path, {"csv": layout})
    np.testing.assert_allclose(log.t_s, [float(f"{k}.{k}") for k in range(20)])
    np.testing.assert_allclose(log.position_m, np.arange(20) * 1e-5)
    np.testing.assert_array_equal(log.force_n, -1500.0)
    with pytest.raises(LogError, match="no header below 99 skipped lines"):
        read_log(path, {"csv": layout | {"skip_rows": 99}})


def test_repeated_stamps_are_a_finding(write: Write) -> None:
    log = read_log(write(table(row9="0.08,0.1,1")))
    assert next(f.kind for f in log.findings if f.channel == "t_s") == "repeated_stamps"


def read(data: bytes) -> Log | None:
    """Return the log in ``data``, or None where it is refused; anything else escapes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzz.csv"
        path.write_bytes(data)
        try:
            return read_log(path)
        except LogError:
            return None


def assert_is_a_log(log: Log | None) -> None:
    if log is not None:
        assert log.rows >= 10
        assert np.all(np.isfinite(log.position_m) & np.isfinite(log.force_n))


@pytest.mark.slow
@given(st.binary(max_size=300))
@example(b"\0")
@example(b"\xef\xbb\xbf")
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    assert_is_a_log(read(data))


CELL = st.one_of(
    st.floats().map(repr), st.integers().map(str), st.sampled_from(["", '"', "1_0", "x", "\r"])
)


@pytest.mark.slow
@given(st.lists(st.lists(CELL, min_size=2, max_size=4), max_size=14))
def test_any_table_is_read_or_refused(rows: list[list[str]]) -> None:
    text = "\n".join(["t_s,position_m,force_n", *(",".join(row) for row in rows)])
    assert_is_a_log(read(text.encode()))


@pytest.mark.slow
@given(st.lists(st.tuples(*[st.floats(-1e9, 1e9)] * 3), min_size=10, max_size=30))
def test_what_was_written_is_read(rows: list[tuple[float, float, float]]) -> None:
    text = "t_s,position_m,force_n\n"
    text += "".join(f"{k},{x!r},{force!r}\n" for k, (_, x, force) in enumerate(rows))
    log = read(text.encode())
    assert log is not None
    np.testing.assert_array_equal(log.position_m, [x for _, x, _ in rows])
    np.testing.assert_array_equal(log.force_n, [force for _, _, force in rows])


def test_a_point_is_no_decimal_mark_beside_a_comma(write: Write) -> None:
    layout = {"delimiter": ";", "decimal": ","}
    for force in ("1.500", "1.500,5", "2.5"):
        text = table("t_s;position_m;force_n").replace(",", ";").replace(".", ",")
        path = write(text.replace(";2,5", f";{force}"))
        words = rf"column 'force_n', row 1: '{force}' is not a number .*thousands.* such as -1,5e-3"
        with pytest.raises(LogError, match=words):
            read_log(path, {"csv": layout})


@pytest.mark.parametrize(
    "above", ['"a" rig\n"open\n', "\n\n", 'a;"b";\r\n3/4" tube\r\n', "a,b\rc\r"]
)
def test_lines_above_the_header_may_hold_anything(write: Write, above: str) -> None:
    log = read_log(write(above + table()), {"csv": {"skip_rows": 2}})
    np.testing.assert_allclose(log.position_m, np.arange(1, 21) * 1e-4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y,z\n" + table(), "'position_m' is missing; present are x, y, z"),
        ("t_s\tx_m\tforce_n\n0\t1\t2\n", r'delimiter = "\\t"'),
        ("t_s;x_m;force_n\n0;1;2\n", 'delimiter = ";"'),
    ],
)
def test_a_layout_that_needs_a_mapping_is_told(write: Write, text: str, words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(write(text))


def test_a_cell_that_is_no_number_is_told_also_where_a_row_holds_the_units(write: Write) -> None:
    path = write(table("Zeit,Weg,Kraft\n[s],[mm],[kN]", row7="0.07,OVL,2.5"))
    channels = {"position_m": {"from": "Weg"}, "force_n": {"from": "Kraft"}}
    mapping = {"channels": channels, "time": {"from": "Zeit"}, "csv": {"units_row": True}}
    with pytest.raises(LogError, match="column 'Weg', row 7: 'OVL' is not a number"):
        read_log(path, mapping)


def test_a_layout_with_the_wrong_delimiter_is_told_one_that_reads_it(write: Write) -> None:
    path = write(table())
    with pytest.raises(LogError, match=r'csv = { delimiter = ",", decimal = "\." }'):
        read_log(path, {"csv": {"delimiter": ";", "decimal": ","}})
    assert read_log(path, {"csv": {"delimiter": ",", "decimal": "."}}).rows == read_log(path).rows
