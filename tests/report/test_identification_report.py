"""The page of an identification: all that is known, nothing from outside, nothing unescaped."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from breakaway._core import __version__
from breakaway.errors import OutputError
from breakaway.measure.identification.cascade import Cascade
from breakaway.measure.identification.comparison import compare_laws
from breakaway.measure.identification.events import find_breakaway_events
from breakaway.measure.identification.identify import identify
from breakaway.measure.identification.laws import SHARED, Law
from breakaway.measure.identification.record import RunSettings, core_record, measured_rows
from breakaway.measure.identification.uncertainty import Posterior
from breakaway.measure.identification.verdicts import stiction_peak
from breakaway.measure.logs import read_log
from breakaway.measure.logs.log import Log
from breakaway.model.units import unit_of, words_of
from breakaway.show.report.identification import (
    identification_report,
    save_identification_report,
    uncertain,
)

pytestmark = pytest.mark.slow

DATA = Path(__file__).parents[3] / "shared" / "data"
SHA = "0123456789abcdef" * 4
NAME = "<b>rig & co.csv"
HISTORY = "cut & <i>dried"


TRUE = {
    "coulomb_positive_n": 5.0,
    "coulomb_negative_n": 5.0,
    "viscous_positive_n_s_per_m": 20.0,
    "viscous_negative_n_s_per_m": 20.0,
    "stiction_ratio": 1.4,
    "stribeck_velocity_m_per_s": 0.03,
    "stiffness_n_per_m": 2000.0,
    "damping_n_s_per_m": 5.0,
}


def synthetic(rows: int = 3000) -> Log:
    """A log of a part with known LuGre friction, with names that would break a page."""
    t_s = np.arange(rows) / 1000.0
    x = -0.1 * np.cos(3 * t_s) - 0.02 * np.cos(11 * t_s)
    motion = Log(t_s=t_s, position_m=x, force_n=np.zeros(rows))
    settings = RunSettings("imposed")
    record = core_record(measured_rows(motion, settings), [(0, rows)], Law("lugre"), settings)
    numbers = [TRUE.get(name, 0.0) for name in SHARED] + [0.0]
    noise = 0.1 * np.random.default_rng(0).standard_normal(rows)
    force = np.frombuffer(record.simulate(numbers)[1]) + noise
    source = Path(NAME)
    return Log(t_s=t_s, position_m=x, force_n=force, source=source, sha256=SHA, history=[HISTORY])


@pytest.fixture(scope="module")
def found():
    return identify(synthetic(), law="lugre", repeats=[(0.0, 1.0), (1.0, 2.0)], starts=4)


@pytest.fixture(scope="module")
def page(found):
    log = found.log
    pays, not_paying = compare_laws(
        log, held_out=(2.0, 3.0), laws=["coulomb", "stribeck"], starts=1
    )
    return identification_report(
        found,
        profiles=[found.profile("coulomb_n")],
        compared=[pays, replace(not_paying, pays=False)],
        held_out=found.predict(spans=[(2.0, 3.0)]),
        events=find_breakaway_events(log),
    )


@pytest.fixture(scope="module")
def simple():
    return identify(synthetic(), law="coulomb", starts=1)


@pytest.fixture(scope="module")
def simple_page(simple):
    return identification_report(simple)


class Page(HTMLParser):
    """Collects what a page refers to and defines, and the text of its rows and headings."""

    def __init__(self, text: str):
        super().__init__()
        self.ids: list[str] = []
        self.targets: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.tags.append((tag, values))
        if "id" in values:
            self.ids.append(values["id"])
        self.targets += [values[name] for name in ("href", "src", "xlink:href") if name in values]
        if tag == "tr":
            self.rows.append("")

    def handle_data(self, data):
        if self.rows:
            self.rows[-1] += data + " "


def test_every_parameter_has_its_row(found, page):
    rows = Page(page).rows
    for one in found.estimates:
        row = next(row for row in rows if row.strip().startswith(words_of(one.name)))
        assert unit_of(one.name).shown in row
        assert (" yes " if one.identifiable else " no ") in row
    coulomb = next(row for row in rows if row.strip().startswith("Coulomb "))
    estimate = found["coulomb_n"]
    value, error = uncertain(estimate.value, estimate.standard_error)
    assert f"{value} ± {error}" in coulomb
    assert coulomb.count(" to ") == 2  # from the errors, and from the profile
    mass = next(row for row in rows if row.strip().startswith("mass"))
    assert "held at 0: inertia is too small" in mass


def test_every_verdict_that_is_negative_has_its_reason_and_remedy(simple, simple_page):
    text = " ".join(Page(simple_page).rows)
    negative = [one for one in simple.verdicts if not one.identifiable]
    assert len(negative) == 5
    for one in negative:
        assert one.because in text
        assert one.remedy in text


def test_the_stiction_peak_is_told(found, page, simple_page):
    peak = stiction_peak({one.name: one for one in found.estimates}, found.verdicts)
    assert peak.startswith("stiction peak: seen")
    assert peak[1:] in page
    assert "Stiction peak: not identified" in simple_page


def test_a_peak_whose_curve_leaves_the_dots_is_doubtful(found):
    """The same fit, shown with a log whose friction is 40 % of what was fitted."""
    log = found.log
    weaker = Log(t_s=log.t_s, position_m=log.position_m, force_n=0.4 * log.force_n)
    page = identification_report(replace(found, log=weaker))
    said = re.search(r"Stiction peak: doubtful; [^<]*", page)
    assert said is not None and "steady curve leaves the measured friction by" in said[0]
    share = float(re.search(r"by (\d+) % at", said[0])[1])
    assert share > 100.0 * (1.0 / 0.4 - 1.0) - 30.0


def test_a_prefix_is_that_of_the_largest_of_value_error_and_ends(found):
    viscous = replace(
        found["viscous_n_s_per_m"],
        value=1e-9, standard_error=1600.0, low=0.0, high=3200.0, identifiable=False,
        remark="not distinct from 0",
    )  # fmt: skip
    estimates = [viscous if one.name == viscous.name else one for one in found.estimates]
    page = identification_report(replace(found, estimates=tuple(estimates)))
    row = next(row for row in Page(page).rows if row.strip().startswith("viscous"))
    assert "0.0 ± 1.6" in row and "0 to 3.2" in row and "kN s/m" in row


def test_provenance_is_complete(found, page):
    assert page.count(SHA) == 2
    for said in (
        f"breakaway {__version__}",
        "cut &amp; &lt;i&gt;dried",
        "agree; seed 0",
    ):
        assert said in page
    assert "1 s to 2 s" in page
    for note in found.notes:
        assert note in unescape(page)
    assert "On rows that were not fitted, 2 s to 2.999 s, the predicted force is" in page


def test_laws_say_whether_they_pay(page):
    rows = Page(page).rows
    assert any("Coulomb" in row and "the first law" in row and " yes " in row for row in rows)
    assert any("Stribeck" in row and "against Coulomb" in row and " no " in row for row in rows)


def test_names_are_escaped(page):
    assert "<b>" not in page
    assert "<i>" not in page
    assert "&lt;b&gt;rig &amp; co.csv: friction identified</h1>" in page


def test_the_page_needs_nothing_else(page):
    parsed = Page(page)
    inside = ("#", "data:image/png;base64,")
    assert all(target.startswith(inside) for target in parsed.targets)
    assert {t[1:] for t in parsed.targets if t[0] == "#"} <= set(parsed.ids)
    assert len(parsed.ids) == len(set(parsed.ids))
    assert "<script" not in page
    assert "@import" not in page
    # What is left are the names of XML's namespaces, which nobody fetches.
    assert set(re.findall(r'https?://[^"\s<]+', page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }


def test_the_page_can_be_read_without_seeing(page):
    parsed = Page(page)
    assert ("html", {"lang": "en"}) in parsed.tags
    pictures = [values for tag, values in parsed.tags if values.get("role") == "img"]
    figures = [values for tag, values in parsed.tags if tag == "figure"]
    assert len(pictures) == len(figures) >= 8
    assert all(len(values["aria-label"]) > 20 for values in pictures)
    assert all("scope" in values for tag, values in parsed.tags if tag == "th")
    levels = [int(tag[1]) for tag, _ in parsed.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))


def test_what_can_not_be_drawn_is_left_out_with_a_reason(simple_page):
    text = simple_page
    left_out = text[text.index("<h3>Left out</h3>") :]
    assert "Offset of each repeat: " in left_out and "one repeat was fitted" in left_out
    assert "law &#39;coulomb&#39; has no presliding" in left_out
    assert 'id="drift"' not in text and 'id="laws"' not in text and 'id="events"' not in text


def test_a_fit_that_was_stopped_says_so(simple):
    text = identification_report(replace(simple, complete=False))
    assert "The fit was stopped before it finished" in text


def test_a_stiction_ratio_that_was_held_is_no_peak():
    held = identify(synthetic(), law="stribeck", fixed={"stiction_ratio": 1.2}, starts=1)
    assert "Stiction peak: not identified (F_s / F_c was held)" in identification_report(held)


def test_a_posterior_is_drawn_and_described(simple):
    draws = Posterior(simple.draws(200), 31.4, 0.5, walkers=64, steps=40, weight=0.25)
    text = identification_report(simple, posterior=draws)
    assert "Draws from the posterior" in text
    assert "200 draws, 64 walkers, 40 steps, autocorrelation time 31.4 steps, 50 %" in text


def test_a_closed_loop_names_its_controller():
    cascade = Cascade(position_gain_per_s=50.0, velocity_gain_n_s_per_m=300.0, force_limit_n=1e3)
    t_s = np.arange(2000) / 1000.0
    x = -0.1 * np.cos(3 * t_s) - 0.02 * np.cos(11 * t_s)
    v = np.gradient(x, t_s)
    force = 5.0 * np.sign(v) + 20.0 * v + 2.0 * np.gradient(v, t_s)
    reference = x + (force / 300.0 + v) / 50.0
    loop = Log(t_s=t_s, position_m=x, force_n=force, reference_m=reference)
    settings = {"motion": "closed_loop", "controller": cascade, "lowpass_hz": 50.0}
    text = identification_report(identify(loop, law="coulomb", starts=1, **settings))
    assert "position_gain_per_s = 50" in text
    assert "in closed loop with its controller" in text
    assert "given as arrays; it has no digest" in text


def test_saved_whole_or_not_at_all(simple, simple_page, tmp_path):
    save_identification_report(tmp_path / "report.html", simple)
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == simple_page
    with pytest.raises(OutputError, match="cannot be written"):
        save_identification_report(tmp_path / "report.html" / "report.html", simple)
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def browse(page: Path, profile: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Open a page in headless Chromium, with its console on standard error."""
    common = [
        "chromium",
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--enable-logging=stderr",
        f"--user-data-dir={profile}",
        "--virtual-time-budget=5000",
    ]
    return subprocess.run(
        [*common, *options, page.as_uri()], capture_output=True, text=True, check=True
    )


@pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is not on the path")
def test_the_page_shows_in_a_browser(page, tmp_path):
    file = tmp_path / "report.html"
    file.write_text(page, encoding="utf-8")
    shown = browse(file, tmp_path / "profile", "--window-size=1000,800", "--dump-dom")
    assert shown.stdout.count("<figure") == page.count("<figure")
    assert "CONSOLE" not in shown.stderr
    picture = tmp_path / "page.png"
    browse(file, tmp_path / "profile", "--window-size=400,800", f"--screenshot={picture}")
    assert picture.stat().st_size > 10_000


@pytest.mark.skipif(not (DATA / "emps").exists(), reason="the measured log is not here")
def test_a_measured_log_has_its_page():
    log = read_log(DATA / "emps" / "DATA_EMPS.mat")
    real = identify(log, law="coulomb", motion="free", repeats=[(0.0, 6.24)], starts=1)
    text = identification_report(real, held_out=real.predict(spans=[(18.72, 24.9)]))
    assert log.sha256 is not None and log.sha256 in text
    assert "DATA_EMPS.mat: friction identified</h1>" in text
    assert 'id="friction_velocity"' in text and 'id="held_out"' in text
