"""The page of a comparison: self-contained, readable, and its animation moves."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from breakaway.drawing.style import save_figure
from breakaway.model.scenario import Gentleness, load_method, load_population
from breakaway.run.trials import Case
from breakaway.show.plots.comparison import Cloud, Course, plot_course, plot_scatter, plot_shares
from breakaway.show.report.comparison import ShownFigure, comparison_page

pytestmark = pytest.mark.slow

METHODS = ["force_ramp", "paper_pid"]
CASES = [Case("lugre", "field"), Case("gms", "field")]
NAME = "<b>mine & co</b>"
SHARES = ("released", "gentle", "strict")
SPREADS = (
    "time_to_release_s", "largest_jump_m", "peak_over_breakaway", "release_velocity_m_per_s",
    "largest_impact_work_j", "impulse_n_s",
)  # fmt: skip
GENTLE = Gentleness(peak_over_breakaway_max=1.5, jump_max_m=5e-4, release_velocity_max_m_per_s=0.3)
STRICT = Gentleness(
    peak_over_breakaway_max=1.25, jump_max_m=2.5e-4, release_velocity_max_m_per_s=0.1
)


def course(index: int, *, axis: bool = False) -> Course:
    """A part that slips, pushed by a force or by a stack whose tip is 20 um behind in the end."""
    t = np.linspace(0.0, 2.0, 201)
    x = np.where(t < 1.0, 0.0, 0.03 * np.minimum(t - 1.0, 0.5))
    whole = {
        "t_s": t,
        "position_m": x,
        "force_n": np.where(t < 1.5, 400.0 * t, 0.0),
        "breakaway_n": 500.0 - 1e4 * x,
    }
    if axis:
        tip = x + np.where(t < 1.5, 1e-6, -2e-5)
        whole |= {"feed_m": x + 3e-4, "tool_m": tip - 5e-5, "tip_m": tip}
    slip = {name: values[95:160] for name, values in whole.items()}
    return Course(
        run_index=index, released=True, stiction_n=500.0, length_m=0.02, mass_kg=1.0,
        jump_m=0.015, peak_force_n=600.0, peak_over_breakaway=1.2, end_s=2.0,
        slip_s=(1.0, 1.5), whole=whole, slip=slip,
    )  # fmt: skip


def row(case: Case, method: str, gentle: float, *, stack: bool) -> dict[str, object]:
    values: dict[str, object] = {"law": case.law, "variation": case.variation}
    values |= {"method": method, "runs": 100}
    for name in SHARES:
        values |= {name: int(100 * gentle), f"{name}_share": gentle}
        values |= {f"{name}_low": max(0.0, gentle - 0.1), f"{name}_high": min(1.0, gentle + 0.1)}
    values |= {f"{name}_share": gentle for name in ("force", "jump", "velocity")}
    values |= {f"{name}_median": 0.5 for name in SPREADS} | {
        f"{name}_p99": None for name in SPREADS
    }
    wear = ("stack_cycles_median", "rms_current_a_median", "stack_loss_w_median")
    values |= dict.fromkeys(wear, 12345.0 if stack else None)
    return values | {
        "against": "paper_pid", "gentle_only_this": 3, "gentle_only_other": 1200,
        "gentle_p": 1e-300, "best": "gentle_share" if gentle > 0.5 else "",
    }  # fmt: skip


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("figures")
    methods = [load_method(name) for name in METHODS]
    methods[0] = methods[0].model_copy(update={"name": NAME})
    names = [method.name for method in methods]
    rows = [
        row(case, name, gentle, stack=case.law == "gms")
        for case in CASES
        for name, gentle in zip(names, (0.2, 0.9), strict=True)
    ]
    clouds = [
        Cloud(case, name, np.array([1.0, 2.0]), np.array([0.0, 1e-3]),
              np.array([True, False]), np.array([True, False]))
        for case in CASES for name in names
    ]  # fmt: skip
    drawn = {
        "shares": (plot_shares(rows), ""),
        "jump_against_peak": (plot_scatter(clouds, GENTLE, STRICT), ""),
        "course_1": (plot_course(None, course(3)), names[0]),
        "course_2": (plot_course(course(1, axis=True), course(2, axis=True)), names[1]),
    }
    figures = []
    for key, (figure, name) in drawn.items():
        for case in CASES if name else (None,):
            file = folder / f"{key}_{case.key if case else ''}.svg"
            save_figure(figure, file)
            figures.append(ShownFigure(file.stem, f"{key}.", "A caption.", file, name, case))
    return comparison_page(
        population=load_population("seized_parts"),
        methods=methods,
        cases=CASES,
        runs=100,
        seed=0,
        table=rows,
        result=["one & two <three>", "CAUTION, one law only: this"],
        notes=["a note"],
        figures=figures,
        courses={
            case: {names[0]: course(place), names[1]: course(place + 1, axis=True)}
            for place, case in enumerate(CASES)
        },
    )


class Page(HTMLParser):
    """Collects tags and their attributes."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))


def test_the_page_needs_nothing_else(page):
    parsed = Page(page)
    names = ("href", "src", "xlink:href")
    targets = [v[n] for _, v in parsed.tags for n in names if n in v]
    assert all(target.startswith(("#", "data:image/png;base64,")) for target in targets)
    ids = [values["id"] for _, values in parsed.tags if "id" in values]
    assert sorted(ids) == sorted(set(ids))
    assert {target[1:] for target in targets if target[0] == "#"} <= set(ids)
    assert set(re.findall(r'https?://[^"\s<]+', page)) <= {
        "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
    }  # fmt: skip


def test_names_are_escaped(page):
    assert "<b>mine" not in page
    assert "&lt;b&gt;mine &amp; co&lt;/b&gt;" in page
    assert "one &amp; two &lt;three&gt;" in page
    data = re.search(r'<script type="application/json" id="courses">(.*?)</script>', page)
    assert data is not None
    scenes = json.loads(data[1])
    assert [(scene["case"], scene["method"]) for scene in scenes] == [
        ("lugre_field", NAME), ("lugre_field", "paper_pid"), ("gms_field", NAME),
        ("gms_field", "paper_pid"),
    ]  # fmt: skip
    assert scenes[0]["slip"]["x"][-1] == 15.0


def test_positions_of_an_axis_are_told_where_there_is_one(page):
    data = re.search(r'<script type="application/json" id="courses">(.*?)</script>', page)
    assert data is not None
    force, axis = json.loads(data[1])[:2]
    assert not {"drive", "tool", "tip"} & set(force["slip"])
    for kept in (axis["slip"], axis["whole"]):
        assert kept["drive"][0] == 0.3
        assert kept["tip"][0] - kept["tool"][0] == pytest.approx(0.05)
        assert kept["x"][-1] - kept["tip"][-1] == pytest.approx(0.02)


def test_there_is_a_figure_of_each_method_under_each_law(page):
    shown = [v for tag, v in Page(page).tags if tag == "figure" and v.get("data-case")]
    assert [(v["id"], v["data-case"]) for v in shown] == [
        ("course_1_lugre_field", "lugre_field"), ("course_1_gms_field", "gms_field"),
        ("course_2_lugre_field", "lugre_field"), ("course_2_gms_field", "gms_field"),
    ]  # fmt: skip
    assert not any("hidden" in v for v in shown)  # all are there without JavaScript


def test_the_table_marks_the_best_and_shows_wear_where_there_is_a_stack(page):
    lugre, gms = page[page.index('id="table-lugre_field"') : page.index('id="figures"')].split(
        'id="table-gms_field"'
    )
    assert lugre.count('<span class="best">90</span>') == 1
    assert "stack loss" not in lugre
    assert "stack loss" in gms and "12,345" not in lugre
    assert "p &lt; 1e-12" in lugre
    assert '<li class="flag">CAUTION' in page


def test_the_page_can_be_read_without_seeing(page):
    parsed = Page(page)
    assert ("html", {"lang": "en"}) in parsed.tags
    pictures = [values for _, values in parsed.tags if values.get("role") == "img"]
    assert len(pictures) == page.count("<figure") + 1  # the animation
    assert all(len(values["aria-label"] or "") > 15 for values in pictures)
    assert all("scope" in values for tag, values in parsed.tags if tag == "th")


def browse(page: str, folder: Path, script: str, *options: str) -> tuple[str, str]:
    """Open a page with one more script in headless Chromium; give its end and its console."""
    file = folder / "page.html"
    file.write_text(page.replace("</body>", f"<script>{script}</script></body>"), encoding="utf-8")
    shown = subprocess.run(
        [
            "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--enable-logging=stderr", f"--user-data-dir={folder / 'profile'}",
            "--virtual-time-budget=4000", "--window-size=1100,900", *options, "--dump-dom",
            file.as_uri(),
        ],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return shown.stdout, shown.stderr


def said(dom: str) -> dict[str, object]:
    found = re.search(r'data-said="(.*?)"', dom)
    assert found is not None
    told: dict[str, object] = json.loads(found[1].replace("&quot;", '"'))
    return told


browser = pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is not on the path")

MOVES = """
const stage = document.getElementById("stage"), seen = [];
const look = () => seen.push([Number(stage.dataset.time), stage.toDataURL().length,
  Number(document.getElementById("seek").value), document.getElementById("told").textContent]);
look();
const one = stage.toDataURL();
document.getElementById("play").click();
setTimeout(() => {
  look();
  document.getElementById("play").click();
  const paused = Number(stage.dataset.time);
  setTimeout(() => {
    document.body.dataset.said = JSON.stringify({
      seen, paused, after: Number(stage.dataset.time), differs: stage.toDataURL() !== one,
      frames: Number(stage.dataset.frames), label: document.getElementById("play").textContent });
  }, 500);
}, 1500);
"""


@browser
def test_the_animation_moves_and_pauses(page, tmp_path):
    dom, console = browse(page, tmp_path, MOVES)
    assert "CONSOLE" not in console
    told = said(dom)
    before, after = told["seen"]
    assert after[0] > before[0]
    assert after[2] > before[2]
    assert after[3] != before[3]
    assert told["differs"]
    assert told["frames"] > 1
    assert told["after"] == told["paused"]
    assert told["label"] == "Play"


KEYS = """
const stage = document.getElementById("stage"), choice = document.getElementById("scene");
const press = (key) => stage.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const time = () => Number(stage.dataset.time);
const found = { options: choice.length, start: time() };
press("ArrowRight"); found.right = time();
press("End"); found.end = time();
press("Home"); found.home = time();
document.querySelector('input[value="whole"]').click(); found.whole = time();
press("End"); found.wholeEnd = time();
const seek = document.getElementById("seek");
const words = () => document.getElementById("told").textContent;
const chosen = document.querySelector("#methods select.case"), hidden = () =>
  [...document.querySelectorAll("figure[data-case]")].filter((f) => f.hidden).map((f) => f.id);
found.hidden = hidden();
chosen.value = "gms_field"; chosen.dispatchEvent(new Event("change")); found.hiddenThen = hidden();
found.cases = [...document.querySelectorAll("select.case")].map((select) => select.value);
found.partThen = document.getElementById("told").textContent.split(",")[0];
choice.value = 1; choice.dispatchEvent(new Event("change"));
press("Home"); found.pressed = Number(stage.dataset.gap); found.touches = words();
press("End"); found.gap = Number(stage.dataset.gap); found.apart = words();
seek.value = 600; seek.dispatchEvent(new Event("input")); found.pushes = words();
chosen.value = "lugre_field"; chosen.dispatchEvent(new Event("change"));
found.told = document.getElementById("told").textContent;
seek.value = 500; seek.dispatchEvent(new Event("input")); found.middle = time();
press(" "); found.playing = document.getElementById("play").getAttribute("aria-pressed");
found.calm = !document.getElementById("calm").hidden;
document.body.dataset.said = JSON.stringify(found);
"""


@browser
def test_keys_slider_and_choice_work(page, tmp_path):
    dom, console = browse(page, tmp_path, KEYS)
    assert "CONSOLE" not in console
    told = said(dom)
    assert told["options"] == 2
    assert told["start"] == pytest.approx(0.95)
    assert told["right"] == pytest.approx(0.95 + 0.01 * 0.64)
    assert told["end"] == pytest.approx(1.59)
    assert told["home"] == told["start"]
    assert (told["whole"], told["wholeEnd"], told["middle"]) == (0.0, 2.0, 1.0)
    assert str(told["told"]).startswith("Part no. 1, 1 kg, breaks loose at 500 N; jumps 15 mm")
    assert (told["playing"], told["calm"]) == ("true", False)
    assert told["hidden"] == ["course_1_gms_field", "course_2_gms_field"]
    assert told["hiddenThen"] == ["course_1_lugre_field", "course_2_lugre_field"]
    assert (told["cases"], told["partThen"]) == (["gms_field", "gms_field"], "Part no. 1")
    axis = "drive 349 µm ahead of the tool, stack 50.0 µm longer."
    assert told["pressed"] == pytest.approx(-1.0)
    assert str(told["touches"]).endswith(f"; tip touches, {axis}")
    assert "force 480 N" in str(told["pushes"]) and "; tip pushes, " in str(told["pushes"])
    assert told["gap"] == pytest.approx(20.0)
    axis = "drive 370 µm ahead of the tool, stack 50.0 µm longer."
    assert str(told["apart"]).endswith(f"; tip 20.0 µm apart, {axis}")


STEPS = """
const stage = document.getElementById("stage");
const before = Number(stage.dataset.frames);
document.getElementById("play").click();
setTimeout(() => {
  document.body.dataset.said = JSON.stringify({
    frames: Number(stage.dataset.frames) - before, calm: !document.getElementById("calm").hidden });
}, 2200);
"""


@browser
def test_reduced_motion_is_respected(page, tmp_path):
    dom, console = browse(page, tmp_path, STEPS, "--force-prefers-reduced-motion")
    assert "CONSOLE" not in console
    told = said(dom)
    assert told["calm"]
    assert 1 <= told["frames"] <= 5
