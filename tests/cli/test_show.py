"""What is shown is whole on any terminal, and readable."""

import io
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from breakaway.cli.quantity import show_uncertain, show_value, split_unit
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import plain, say
from breakaway.run.finished import RunMetrics

Call = Callable[..., Any]


class Terminal(io.StringIO):
    """A terminal of 30 columns."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    made = Terminal()
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "30")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    return made


def shown_at(width: int, sheet: Sheet, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    made = Terminal()
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setattr(sys, "stdout", made)
    say(sheet)
    lines = re.sub(r"\x1b\[[0-9;]*m", "", made.getvalue()).splitlines()
    assert max(map(len, lines)) <= width
    return lines


@pytest.mark.usefixtures("terminal")
@pytest.mark.parametrize("width", range(24, 80, 7))
def test_no_width_breaks_a_number(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = Sheet("Title", ["name", "value", "why"], numbers=["value"], prose=["why"])
    sheet.add("a long name", "-1234567.891 kN", "because of this and that")
    sheet.add("another", "1", "")
    shown = "\n".join(shown_at(width, sheet, monkeypatch))
    for words in ("Title", "a long name", "-1234567.891 kN", "because", "that", "another"):
        assert words in shown
    assert "…" not in shown


@pytest.mark.usefixtures("terminal")
def test_a_table_that_is_too_wide_becomes_tables_with_the_same_labels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sheet = Sheet("", ["law", "force", "speed"], numbers=["force", "speed"])
    sheet.add("lugre", "1234567890 N", "0.25 mm/s")
    sheet.add("gms", "2 N", "0.5 mm/s")
    rows = [line.split() for line in shown_at(30, sheet, monkeypatch) if line.strip()]
    assert [row for row in rows if row[0].isalpha()] == [
        ["law", "force"],
        ["lugre", "1234567890", "N"],
        ["gms", "2", "N"],
        ["law", "speed"],
        ["lugre", "0.25", "mm/s"],
        ["gms", "0.5", "mm/s"],
    ]
    whole = [line.split() for line in shown_at(60, sheet, monkeypatch) if line.strip()]
    assert ["lugre", "1234567890", "N", "0.25", "mm/s"] in whole


@pytest.mark.usefixtures("terminal")
def test_labels_that_leave_no_room_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = Sheet("", ["law", "quantity", "value"], numbers=["value"])
    sheet.add("elasto_plastic", "time to release", "495.03 ms")
    rows = [line.split() for line in shown_at(34, sheet, monkeypatch) if line.strip()]
    assert rows == [
        ["law", "elasto_plastic"],
        ["quantity", "time", "to", "release"],
        ["value", "495.03", "ms"],
    ]


def test_a_row_has_a_cell_for_every_column() -> None:
    with pytest.raises(ValueError, match="1 cells in a table of 2 columns"):
        Sheet("", ["a", "b"]).add("1")


def test_text_is_not_markup(terminal: Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", terminal)
    sheet = Sheet("", ["a"])
    sheet.add("[bold]x[/nothing]")
    say(sheet, "[red]y[/blue]")
    assert "[bold]x[/nothing]" in terminal.getvalue()
    assert "[red]y[/blue]" in terminal.getvalue()


def test_an_old_encoding_is_no_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding="ascii"))
    sheet = Sheet("", ["a"])
    sheet.add("1")
    say("3 µm ± 1", sheet)
    assert raw.getvalue() == b"3 um +/- 1\n+---+\n| a |\n|---|\n| 1 |\n+---+\n"


def test_every_metric_but_counts_and_ratios_has_a_unit() -> None:
    without = {field.name for field in fields(RunMetrics) if not split_unit(field.name)[1]}
    assert without == {"impacts", "peak_over_breakaway", "stack_cycles", "stop_reason"}


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("time_s", 0.49503, ("495.03", "ms")),
        ("time_s", 7200.0, ("7200", "s")),
        ("force_n", 999.999, ("1", "kN")),
        ("force_n", 0.0, ("0", "N")),
        ("force_n", -12500.0, ("-12.5", "kN")),
        ("travel_m", 1e-15, ("1e-15", "m")),
        ("work_j", float("inf"), ("inf", "J")),
        ("ise_m2_s", 1.1e-10, ("1.1e-10", "m² s")),
        ("velocity_m_per_s", None, ("none", "")),
        ("var", 0.05, ("0.05", "")),
    ],
)
def test_values_read_well(name: str, value: float | None, shown: tuple[str, str]) -> None:
    assert show_value(name, value) == shown


@pytest.mark.parametrize(
    ("value", "error", "shown"),
    [
        (1.0, 0.0996, ("1.00", "0.10")),
        (1.0, 0.0, ("1", "0")),
        (20.0, float("nan"), ("20", "nan")),
        (1.5, 1e-12, ("1.5", "1e-12")),
        (-123456.0, 7654.0, ("-123500", "7700")),
    ],
)
def test_errors_have_two_digits(value: float, error: float, shown: tuple[str, str]) -> None:
    assert show_uncertain(value, error) == shown


def test_json_has_null_for_what_is_not_finite() -> None:
    assert plain({"a": [float("nan"), 1.0], "b": "x"}) == {"a": [None, 1.0], "b": "x"}


@dataclass
class Reproduced:
    header = ("question", "paper", "ours", "")
    table = (["peak force", "600 N", "601.4 N", "differs"],)
    report_path = Path("report.html")


def test_reproduce_shows_the_table_and_the_report_last(
    call: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fake(out: Path, progress: Callable[[str], None]) -> Reproduced:
        progress(f"into {out}")
        return Reproduced()

    module = ModuleType("breakaway.ask.reproduction.report")
    module.__dict__["reproduce"] = fake
    monkeypatch.setitem(sys.modules, module.__name__, module)
    shown = call("reproduce", "--out", tmp_path / "paper")
    assert shown.exit_code == 0
    assert "peak force" in shown.stdout
    assert shown.stdout.splitlines()[-1] == "report.html"
    assert shown.stderr == f"into {tmp_path / 'paper'}\n"
