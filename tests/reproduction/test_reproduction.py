"""The reproduction: its figures, its files, its page."""

from __future__ import annotations

import csv
import json
import re
import shutil
import subprocess
from html.parser import HTMLParser

import numpy as np
import pytest

from breakaway.ask.reproduction.readings import READINGS
from breakaway.ask.reproduction.report import reproduce
from breakaway.ask.reproduction.rows import printed_row
from breakaway.ask.reproduction.survey import NAMES, DisturbanceRange
from breakaway.ask.reproduction.tables import TABLE_2, table_2
from breakaway.errors import OutputError

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def out(tmp_path_factory, simulated):
    folder = tmp_path_factory.mktemp("reproduction")
    runs, _ = simulated
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("breakaway.ask.reproduction.report.simulate_all", lambda *_: runs)
        done = reproduce(folder)
    assert done.report_path == folder / "report.html"
    return folder


def test_it_tells_what_it_is_at(simulated):
    _, told = simulated
    assert len(told) > 3


@pytest.fixture(scope="module")
def values(out):
    return json.loads((out / "reproduction.json").read_text(encoding="utf-8"))


def test_all_18_gains_agree(values):
    keys = [
        f"table2.{control}.{kind}.{gain}"
        for control, kinds in TABLE_2.items()
        for kind, gains in kinds.items()
        for gain in gains
    ]
    assert len(keys) == 18
    for key in keys:
        row = values[key]
        assert row["agrees"] is True, key
        assert row["ours"] == pytest.approx(row["printed"], rel=2e-2)


def test_table_1_does_not_give_them(values):
    static = values["table2_from_table1.without_vibration.static.kd"]
    assert static["ours"] == pytest.approx(-47983.8)
    assert static["agrees"] is False
    assert "Table I" in static["reason"]
    assert values["table1.k_e"]["agrees"] is False


def test_agreement_is_within_one_unit_of_the_last_printed_digit():
    assert printed_row("k", "w", "7.2000", 7.2001, "", "").agrees
    assert not printed_row("k", "w", "7.2000", 7.2003, "", "").agrees
    assert printed_row("k", "w", "3655", 3655.9, "", "").agrees
    assert not printed_row("k", "w", "3655", 3656.1, "", "").agrees


def test_findings_carry_the_known_figures(values):
    findings = values["findings"]
    assert "5.486e+08 <= ki = 8.239e+08" in findings["routh_hurwitz_with_vibration"]["ours"]
    assert "2.272e+09 > ki = 1.283e+09" in findings["routh_hurwitz_without_vibration"]["ours"]
    assert "a pole +89.6 1/s" in findings["routh_hurwitz_with_vibration"]["ours"]
    assert "Newton" in findings["routh_hurwitz_with_vibration"]["title"]
    by_13 = findings["equation_13"]
    assert by_13["agrees"] is True
    assert "a pole -625 1/s with" in by_13["ours"] and "vibration released" in by_13["ours"]
    cycle = findings["limit_cycle"]["ours"]
    assert abs(float(re.search(r"about (\d+) Hz", cycle)[1]) - 285) < 10
    assert re.search(r"IAE 6\.9\de-07 m s, peak 44[67] N", cycle)
    known = re.search(r"at 0.1 µs (\S+) m s", findings["iae_without_vibration"]["ours"])[1]
    assert float(known) == pytest.approx(3.0361549e-6, rel=1e-7)
    for finding in findings.values():
        assert finding["title"] and finding["printed"] and finding["ours"]
        assert finding["explanation"]


def test_figure_10_has_a_band_and_its_definition(values):
    data = values["figures"]["figure_10"]["data"]
    plain = data["without_vibration"]
    assert plain["stable"] == [plain["runs"]] * len(plain["var"])
    assert plain["largest_stable_var"] == plain["var"][-1]
    low, median, high = (
        np.array(plain[f"iae_{name}_m_s"]) for name in ("5_percent", "median", "95_percent")
    )
    assert np.all(low <= median) and np.all(median <= high)
    assert np.all(low[1:] < high[1:])
    assert np.all(np.diff(median) > 0)
    explained = values["findings"]["largest_stable_var_without_vibration"]["explanation"]
    assert "diverged" in explained and "uniform" in explained


def test_no_reading_of_m2_gives_the_printed_limits(out, values):
    page = (out / "report.html").read_text(encoding="utf-8")
    for key, reading in READINGS.items():
        assert values["findings"][f"reading_{key}"]["agrees"] is False
        tried = values["readings"][key]
        for control, name in NAMES.items():
            assert f"{name}, {reading.name}: 32 runs" in page
            rows = tried[control]
            assert [row["var"] for row in rows] == [0.085, 0.125, 0.9]
            all_diverge = control == "with_vibration"
            assert [row["diverged"] for row in rows] == [32 * all_diverge] * 3
            assert [row["released"] for row in rows] == [32 * (not all_diverge)] * 3


def test_figure_10_is_a_table_too(out, values):
    text = (out / "figure_10.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    data = values["figures"]["figure_10"]["data"]
    assert set(data) == {row["control"] for row in rows}
    for control, column in data.items():
        ours = [row for row in rows if row["control"] == control]
        assert [float(row["var"]) for row in ours] == column["var"]
        for name in ("released", "diverged", "iae_median_m_s", "diverged_upper_bound"):
            shown = ["" if value is None else str(value) for value in column[name]]
            assert [row[name] for row in ours] == shown
    literal = data["with_vibration"]
    assert literal["diverged"] == [literal["runs"]] * len(literal["var"])
    assert set(literal["iae_median_m_s"]) == {None}


def test_simulated_curves_lie_on_the_equations(values):
    figures = values["figures"]
    assert figures["figure_2b"]["data"]["largest_relative_difference"] < 1e-6
    assert figures["figure_4"]["data"]["largest_relative_difference"] < 2e-3


def test_every_figure_is_there(out, values):
    names = {"figure_2b", "figure_4", "figure_7", "figure_8", "figure_9", "figure_10"}
    assert set(values["figures"]) == names
    for name in names:
        assert (out / f"{name}.svg").stat().st_size > 5000
        assert (out / f"{name}.png").read_bytes().startswith(b"\x89PNG")


class Links(HTMLParser):
    """Collects what a page refers to and what it defines."""

    def __init__(self):
        super().__init__()
        self.ids: list[str] = []
        self.targets: list[str] = []

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        if "id" in values:
            self.ids.append(values["id"])
        for name in ("href", "src", "xlink:href"):
            if name in values:
                self.targets.append(values[name])


def test_the_page_needs_nothing_else(out):
    page = Links()
    text = (out / "report.html").read_text(encoding="utf-8")
    page.feed(text)
    outside = [t for t in page.targets if not t.startswith("#")]
    assert not outside
    sections = {"glance", "figures", "levels", "tables", "disagree", "made"}
    assert sections <= set(page.ids)
    for target in page.targets:
        assert target[1:] in page.ids, target
    # A second figure must not take the clip paths and glyphs of the first.
    assert len(page.ids) == len(set(page.ids))
    assert "<script" not in text


@pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is not on the path")
def test_the_page_shows_in_a_browser(out, tmp_path):
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        f"--user-data-dir={tmp_path / 'profile'}",
        "--window-size=1000,800",
        "--virtual-time-budget=5000",
    ]
    page = (out / "report.html").as_uri()
    shown = subprocess.run(
        ["chromium", *options, "--dump-dom", page], capture_output=True, text=True, check=True
    ).stdout
    assert shown.count("<svg") == 6
    assert "Where the paper and the equations disagree" in shown
    picture = tmp_path / "page.png"
    subprocess.run(
        ["chromium", *options, f"--screenshot={picture}", page], capture_output=True, check=True
    )
    assert picture.stat().st_size > 20_000


def test_an_unwritable_folder_is_told_and_left_alone(tmp_path):
    file = tmp_path / "file"
    file.write_text("kept")
    with pytest.raises(OutputError, match="cannot be written"):
        reproduce(file / "inside")
    assert file.read_text() == "kept"


def test_an_interrupted_reproduction_leaves_nothing_behind(tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("breakaway.ask.reproduction.report.simulate_all", interrupted)
    with pytest.raises(KeyboardInterrupt):
        reproduce(tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_range_is_not_stable_beyond_its_first_failure():
    var = np.array([0.0, 0.1, 0.2])

    def survey(stable):
        diverged = 5 - np.array(stable)
        counts = {"diverged": diverged, "released": 5 - diverged}
        return DisturbanceRange(var, *(np.zeros((3, 5)),) * 3, counts, 5)

    assert survey([5, 5, 5]).largest_stable_var == 0.2
    assert survey([5, 4, 5]).largest_stable_var == 0.0
    assert survey([4, 5, 5]).largest_stable_var is None


def test_rows_of_both_presets_have_the_same_names():
    ours, printed = table_2(), table_2("paper_as_printed", "table2")
    assert [row.key for row in ours] == [row.key for row in printed]
