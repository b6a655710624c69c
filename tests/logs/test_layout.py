"""The layout of a text file is seen where it can be read in one way, and told; else refused."""

import contextlib
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from breakaway.errors import LogError
from breakaway.measure.logs import Log, list_channels, read_log

ROWS = 40
T_S = np.arange(ROWS) / 100.0
POSITION_MM = np.arange(ROWS) / 8.0
FORCE_N = np.arange(ROWS) / 4.0 - 3.0
HEADER = ("t_s", "position_mm", "force_N")
MAPPING: dict[str, Any] = {
    "time": {"from": "Time"},
    "channels": {"position_m": {"from": "Pos"}, "force_n": {"from": "Force"}},
}

Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def _write(text: str, encoding: str = "utf-8") -> Path:
        path = tmp_path / "motor.csv"
        path.write_bytes(text.encode(encoding))
        return path

    return _write


def rows(mark: str = ",", decimal: str = ".", end: str = "\n") -> str:
    numbers = zip(T_S, POSITION_MM, FORCE_N, strict=True)
    return "".join(
        mark.join(str(float(one)).replace(".", decimal) for one in row) + end for row in numbers
    )


def table(mark: str = ",", decimal: str = ".", end: str = "\n") -> str:
    return mark.join(HEADER) + "\n" + rows(mark, decimal, end)


def check(log: Log, *words: str, newton: float = 1.0) -> None:
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    np.testing.assert_allclose(log.position_m, POSITION_MM * 1e-3, atol=1e-12)
    np.testing.assert_allclose(log.force_n, FORCE_N * newton)
    told = [*log.history, *map(str, log.noticed)]
    for word in words:
        assert any(word in one for one in told), told


@pytest.mark.parametrize(
    ("mark", "decimal", "words"),
    [
        ("\t", ".", "separated by tabs, the decimal mark is '.'"),
        ("\t", ",", "separated by tabs, the decimal mark is ','"),
        (";", ".", "separated by semicolons, the decimal mark is '.'"),
        (";", ",", "separated by semicolons, the decimal mark is ','"),
        (" ", ".", "separated by blanks, the decimal mark is '.'"),
        (" ", ",", "separated by blanks, the decimal mark is ','"),
    ],
)
def test_marks_are_seen(write: Write, mark: str, decimal: str, words: str) -> None:
    path = write(table(mark, decimal))
    check(read_log(path), words)
    by_pandas = pd.read_csv(path, sep=mark, decimal=decimal)
    np.testing.assert_array_equal(by_pandas["force_N"], read_log(path).force_n)


def test_commas_between_cells_and_quoted_decimal_commas(write: Write) -> None:
    quoted = rows(";", ",").replace(";", '","').replace("\n", '"\n')
    quoted = "".join(f'"{line}\n' for line in quoted.splitlines())
    check(read_log(write(",".join(HEADER) + "\n" + quoted)), "commas, the decimal mark is ','")


def test_columns_of_a_fixed_width(write: Write) -> None:
    numbers = zip(T_S, POSITION_MM, FORCE_N, strict=True)
    text = "".join(f"{t:10.3f}{x:12.3f}{force:12.3f}  \r\n" for t, x, force in numbers)
    check(read_log(write("  Time [s]    Pos [mm]   Force [N]\r\n" + text)), "separated by blanks")
    check(read_log(write("# t_s position_mm force_N\n" + text)), "separated by blanks")


def test_a_title_row_in_blanks_that_fits_no_columns_is_not_guessed(write: Write) -> None:
    text = "Time [s] Pos [mm] Force [N]\n" + rows(" ")
    with pytest.raises(LogError, match="row 1: 3 cells where the header has 6"):
        read_log(write(text))


@pytest.mark.parametrize("names", [HEADER, (*HEADER, "")])
def test_a_mark_at_the_end_of_each_row(write: Write, names: tuple[str, ...]) -> None:
    path = write(";".join(names) + "\n" + rows(";", ",", ";\n"))
    check(read_log(path))
    assert [one.name for one in list_channels(path).channels] == list(HEADER)


def test_a_cell_behind_the_last_mark_is_refused(write: Write) -> None:
    text = table(",", ".", ",\n") + "".join(f"{k},0,0,\n" for k in range(1, 300)) + "300,0,0,7\n"
    with pytest.raises(LogError, match=r"row 340: the last cell holds '7', and no column"):
        read_log(write(text))


@pytest.mark.parametrize(
    ("below", "count"),
    [
        ("\nMax;3;4\nMean;2;3;5\n", 2),
        ("EOF\n", 1),
        (";;\n;;\n", 2),
        ("0,4;5", 1),
        ("Statistik\nMax 3\n\n", 2),
    ],
)
def test_what_stands_below_the_table_is_left_out_and_counted(
    write: Write, below: str, count: int
) -> None:
    log = read_log(write(table(";", ",") + below))
    words = f"{count} row{'s' if count > 1 else ''} below the table left out"
    check(log, words)
    footer = next(one for one in log.findings if one.kind == "footer")
    assert footer.count == count


@pytest.mark.parametrize(
    ("below", "words"),
    [
        ("0,4;5;OVL\n", "column 'force_N', row 41: 'OVL' is not a number"),
        ("0,4;;3\n0,41;5;3\n", "column 'position_mm', row 41: '' is not a number"),
        ("0,4;5;3;7\n", "row 41: 4 cells where the header has 3"),
        ("0,4;5\n0,41;5;3\n", "row 41: 2 cells where the header has 3"),
        ("Max;1;2\n" * 30, "column 't_s', row 41: 'Max' is not a number"),
    ],
)
def test_a_damaged_row_is_no_footer(write: Write, below: str, words: str) -> None:
    with pytest.raises(LogError, match=words):
        read_log(write(table(";", ",") + below))


@pytest.mark.parametrize("end", ["\n", "", "\n\n\n"])
def test_blank_lines_are_counted(write: Write, end: str) -> None:
    text = table().rstrip("\n")
    text = text.replace("\n0.1,", "\n\n\n0.1,") + end
    log = read_log(write(text))
    check(log)
    blank = next(one for one in log.findings if one.kind == "blank")
    assert blank.count == 2 + max(0, len(end) - 1)


@pytest.mark.parametrize("units", ["s;mm;kN", "[s];[mm];[kN]", "(sec);(mm);(kN)"])
def test_a_row_of_units_is_seen(write: Write, units: str) -> None:
    path = write(f"Time;Pos;Force\n{units}\n" + rows(";", ","))
    check(read_log(path, MAPPING), "the units stand below the header", newton=1e3)


def test_units_stay_where_a_later_cell_is_bad(write: Write) -> None:
    path = write("Time;Pos;Force\n[s];[mm];[kN]\n" + rows(";", ",") + "0,4;5;OVL\n0,5;5;1\n")
    with pytest.raises(LogError, match="column 'Force', row 41: 'OVL' is not a number"):
        read_log(path)
    check(
        read_log(path, MAPPING | {"time": {"from": "Time"}}, drop_bad_rows=True).between(0, 0.39),
        newton=1e3,
    )


def test_a_row_of_words_below_the_header_is_no_row_of_units(write: Write) -> None:
    path = write("Time;Pos;Force\nleft;mm;kN\n" + rows(";", ","))
    with pytest.raises(LogError, match=r"column 'Pos', row 1: 'mm' is not a number"):
        read_log(path, {"channels": {"position_m": {"from": "Pos", "unit": "mm"}}})


@pytest.mark.parametrize(
    "above",
    ["made by a rig\n", "Operator;Müller\nDate;1.2.2026\n", "Operator;Müller;x\n\n", "a;b;c;d\n"],
)
def test_lines_above_the_header_are_left_out(write: Write, above: str) -> None:
    count = above.count("\n")
    log = read_log(write(above + table(";", ","), "cp1252"))
    check(log, f"{count} line{'s' if count > 1 else ''} above the header left out")


def test_units_tell_the_header_from_lines_above_it(write: Write) -> None:
    path = write("Temperature;22;degC\nPreload;2;N\nTime;Pos;Force\ns;mm;N\n" + rows(";", ","))
    check(read_log(path, MAPPING), "2 lines above the header left out")
    path = write("Temperature;22;degC\nTime [s];Pos [mm];Force [N]\n" + rows(";", ","))
    check(read_log(path), "1 line above the header left out")


def test_two_rows_of_names_are_not_chosen_from(write: Write) -> None:
    path = write("left;right;right\nt_s;x_m;force_n\n" + rows(";", ","))
    with pytest.raises(LogError, match="column 'position_m' is missing; present are left"):
        read_log(path)


def test_what_a_mapping_gives_counts(write: Write) -> None:
    path = write(table(";", "."))
    with pytest.raises(
        LogError, match=r"'0\.0' is not a number \(or '\.' stands between thousands"
    ):
        read_log(path, {"csv": {"delimiter": ";", "decimal": ","}})
    check(read_log(path, {"csv": {"delimiter": ";"}}))
    path = write("Time;Pos;Force\ns;mm;kN\n" + rows(";", "."))
    check(read_log(path, MAPPING | {"csv": {"units_row": True}}), newton=1e3)
    with pytest.raises(LogError, match="neither the file nor the name 'Pos' states a unit"):
        read_log(path, MAPPING | {"csv": {"units_row": False}})


@pytest.mark.parametrize("mark", [";", "\t", " "])
def test_a_mark_that_may_stand_between_thousands_is_asked_for(write: Write, mark: str) -> None:
    text = (
        mark.join(HEADER) + "\n" + "".join(f"{k}{mark}1.{k}{mark}2.{k}\n" for k in range(100, 140))
    )
    path = write(text)
    with pytest.raises(LogError, match=r"'1\.100' has a decimal mark or one between thousands"):
        read_log(path)
    log = read_log(path, {"csv": {"delimiter": mark, "decimal": "."}})
    assert log.force_n[0] == 2.1


def test_texts_that_no_encoding_tells_are_refused(write: Write) -> None:
    path = write("t_s,x_m,force_n,Сила\n" + rows(end=",1\n"), "cp1251")
    with pytest.raises(LogError, match=r'not UTF-8 text; .* csv = \{ encoding = "cp1252" \}'):
        read_log(path)


def test_a_column_that_ends_early_ends(write: Write) -> None:
    lines = table().splitlines()
    text = "\n".join(
        line if k <= 30 else f"{line.rpartition(',')[0]}," for k, line in enumerate(lines)
    )
    log = read_log(write(text + "\n"))
    np.testing.assert_array_equal(log.channels["force_n"].values, FORCE_N[:30])
    np.testing.assert_allclose(log.channels["force_n"].t_s, T_S[:30])
    assert log.channels["position_m"].rows == ROWS
    assert "the last 10 cells hold nothing" in str(log.findings[0])


WORDS = ["1", "1.5", "2,5", "1.100", "t_s", "x_m", "force_n", "s", "mm", "[N]", "8:00:00", "nan"]
MARKS = [",", ";", "\t", " ", "  ", "\n", "\r\n", "\r", "\n\n", "#", "Name", "EOF", "µ", "\0", '"']
PIECE = st.sampled_from([*WORDS, *MARKS])
CELL = st.sampled_from(["1", "2.5", "-3,5", "", "x", '"a"'])


@pytest.mark.slow
@given(st.lists(PIECE, max_size=120).map("".join), st.sampled_from(["utf-8", "cp1252", "utf-16"]))
def test_any_text_is_read_or_refused(text: str, encoding: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzz.csv"
        path.write_bytes(text.encode(encoding))
        for drops in (False, True):
            with contextlib.suppress(LogError):
                assert read_log(path, drop_bad_rows=drops).channels


@pytest.mark.slow
@given(
    st.lists(
        st.lists(st.sampled_from(["1", "2.5", "-3,5", "", "x", '"a"']), max_size=4), max_size=15
    ),
    st.sampled_from([",", ";", "\t", " "]),
    st.sampled_from(["", "Max;1\n", "EOF\n", "made by a rig\n"]),
)
def test_any_rows_are_read_or_refused(table: list[list[str]], mark: str, around: str) -> None:
    rows = [mark.join(row) for row in [["t_s", "x_m", "force_n"], *table * 3]]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzz.csv"
        path.write_text(around + "\n".join(rows) + "\n" + around)
        for drops in (False, True):
            with contextlib.suppress(LogError):
                log = read_log(path, drop_bad_rows=drops)
                assert all(np.isfinite(one.values).all() for one in log.channels.values())


def test_what_is_seen_is_told_also_where_a_mapping_says_what_stands_above(write: Write) -> None:
    path = write("µ-Labor\n" + table(";", ","), "cp1252")
    log = read_log(path, {"csv": {"skip_rows": 1}})
    check(log, "separated by semicolons", "the text is read as cp1252")
