"""Harmless markers in every text, through every output: what is shown is text and nothing else."""

import csv
import importlib
import json
import os
import pkgutil
import re
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import tomli_w
from markdown_it import MarkdownIt
from pydantic import TypeAdapter, ValidationError
from typer.testing import CliRunner

import breakaway as bk
from breakaway.base import text
from breakaway.cli.app import app
from breakaway.drawing.style import save_figure
from breakaway.model.scenario.model import Model, Name
from breakaway.show.plots.design import plot_bode

pytestmark = pytest.mark.slow

CODE = '*/ int marker; /* ??/ "; marker \\'
MARKUP = "=1+1 <marker a='b'> ]]>$\\marker{ $${m}[bold]m[/] | m | `m` *m* &amp; µ"
NAMES = {"code": CODE, "markup": MARKUP}
NOTE = "one\n[marker]\nmarker = 1\x1b]0;marker\x07\u202e <marker> */ ]]> $\\marker{ -- #"
HIDDEN = ["\n", "\r", "\t", "\x00", "\x1b", "\x7f", "\x9b", "\u202e", "\u2066", "\u2028", "\ufeff"]
PLAIN = {"NO_COLOR": "1", "_TYPER_FORCE_DISABLE_TERMINAL": "1", "TERMINAL_WIDTH": "100"}
HOSTILE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""What no terminal may be given; colors come on top of it, in no pipe."""


def call(*args: object) -> Any:
    """Run the command in a pipe; what it prints is harmless."""
    done = CliRunner().invoke(app, [str(arg) for arg in args], env=PLAIN)
    assert done.exception is None or isinstance(done.exception, SystemExit), done
    assert not HOSTILE.search(done.output), done.output
    return done


def succeed(*args: object) -> str:
    done = call(*args)
    assert done.exit_code == 0, done.output
    return str(done.stdout)


# What is named


def models() -> Iterator[type[Model]]:
    for found in pkgutil.walk_packages(bk.__path__, "breakaway."):
        importlib.import_module(found.name)
    left = list(Model.__subclasses__())
    while left:
        yield (model := left.pop())
        left += model.__subclasses__()


def open_texts(schema: Any, path: str) -> Iterator[str]:
    """Give the places of a JSON schema that hold texts of any length."""
    if isinstance(schema, dict):
        chosen = {"enum", "const", "maxLength"} & set(schema)
        if schema.get("type") == "string" and not chosen:
            yield path
        for key, inner in schema.items():
            yield from open_texts(inner, f"{path}.{key}")
    if isinstance(schema, list):
        for inner in schema:
            yield from open_texts(inner, path)


def test_every_text_of_every_model_is_a_name_or_a_text() -> None:
    found = {model.__name__: model for model in models()}
    assert {"Scenario", "Method", "Tuning", "Asked", "JointFile", "ChannelMapping"} <= set(found)
    left = [
        place
        for name, one in found.items()
        for place in open_texts(one.model_json_schema(mode="serialization"), name)
    ]
    assert left == []


@pytest.mark.parametrize("mark", [*HIDDEN, "\ud800"])
def test_names_refuse_what_nobody_can_see(mark: str) -> None:
    with pytest.raises(ValidationError):
        TypeAdapter(Name).validate_python(f"a{mark}b")


def test_a_refused_name_is_explained() -> None:
    scenario = bk.load_scenario("paper_as_computed")
    with pytest.raises(bk.ScenarioError) as raised:
        scenario.with_(name="two\nlines\x1b[31m")
    assert str(raised.value) == (
        r"name: 'two\nlines\x1b[31m' is not one line without control characters; give a text of 1 "
        "to 100 characters: A name for tables and figures"
    )
    with pytest.raises(bk.ScenarioError, match=r"^name: 'x+'\.\.\. \(of 300 characters\) is not a"):
        scenario.with_(name="x" * 300)


def test_a_long_wrong_value_makes_a_short_error(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text(f'name = "a"\n"{"k" * 300}" = "{"v" * 10**6}"\n')
    failed = call("run", path)
    assert failed.exit_code == 2
    assert max(map(len, failed.stderr.splitlines())) <= 2100


# Runs, designs, exports


@pytest.fixture(params=NAMES, scope="module")
def scenario(request: pytest.FixtureRequest) -> bk.Scenario:
    changes = {"timing.duration_s": 0.01, "trace.every_samples": 10}
    short = bk.load_scenario("paper_as_computed").with_(changes)
    return short.with_(name=NAMES[request.param], description=NOTE)


@pytest.fixture(scope="module")
def scenario_file(scenario: bk.Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "scenario.toml"
    bk.save_scenario(scenario, path)
    return path


def check_folder(folder: Path) -> None:
    """Every file of a folder reads as its kind, and holds no marker that got out of its place."""
    for path in (path for path in folder.rglob("*") if path.is_file()):
        match path.suffix:
            case ".svg":
                tags = [one.tag for one in ElementTree.parse(path).iter()]
                assert not [tag for tag in tags if "marker" in str(tag)]
            case ".json":
                json.loads(path.read_bytes())
            case ".toml":
                assert "marker" not in tomllib.loads(path.read_text("utf-8"))
            case ".csv":
                check_table(path)
            case ".html":
                check_page(path)


def check_table(path: Path) -> None:
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert {len(row) for row in rows} == {len(rows[0])}
    for cell in (cell for row in rows for cell in row):
        assert not re.match(r"\s*[=+@]|\s*-[^\d.i]", cell), cell


def check_page(path: Path) -> str:
    """Give the text of a page that has neither elements nor attributes of a marker."""

    class Page(HTMLParser):
        seen = ""

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            assert "marker" not in tag and not {"a", "m"} & {name for name, _ in attrs}

        def handle_data(self, data: str) -> None:
            self.seen += data

    page = Page()
    page.feed(path.read_text("utf-8"))
    page.close()
    assert not HOSTILE.search(page.seen)
    return page.seen


def test_run(scenario: bk.Scenario, scenario_file: Path, tmp_path: Path) -> None:
    said = succeed("run", scenario_file, "--out", tmp_path)
    assert said.startswith(f"{scenario.name}: ")
    again = bk.load_scenario(tmp_path / "scenario.toml")
    assert (again.name, again.description) == (scenario.name, NOTE)
    assert json.loads((tmp_path / "metrics.json").read_text())["scenario"] == scenario.name
    check_folder(tmp_path)


def test_design(tmp_path: Path) -> None:
    scenario = bk.load_scenario("paper_as_computed_vibration").with_(name=MARKUP)
    bk.save_scenario(scenario, tmp_path / "scenario.toml")
    assert MARKUP in succeed("design", tmp_path / "scenario.toml")
    pid = bk.design.SampledPid(bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2), 1e-5)
    loops = bk.design.sampled_loops(pid, scenario.joint, 1.0)
    save_figure(plot_bode(loops, f"{MARKUP}: {CODE}"), tmp_path / "bode.svg")
    check_folder(tmp_path)


def test_c(scenario: bk.Scenario, scenario_file: Path, tmp_path: Path) -> None:
    succeed("export", "c", scenario_file, "--what", "loop", "--out", tmp_path)
    compiled = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-trigraphs", "-c", "loop.c"]
    subprocess.run(compiled, cwd=tmp_path, check=True)
    assert (
        "marker"
        not in subprocess.run(
            ["nm", "loop.o"], cwd=tmp_path, check=True, capture_output=True, text=True
        ).stdout
    )
    for path in tmp_path.glob("*.[ch]"):
        code = re.sub(r"/\*.*?\*/", "", path.read_text("ascii"), flags=re.DOTALL)
        assert "marker" not in code
    assert "marker" not in (tmp_path / "CMakeLists.txt").read_text()
    page = MarkdownIt("commonmark").enable("table").parse((tmp_path / "README.md").read_text())
    heading = page[1].children or []
    assert {token.type for token in heading} <= {"text", "text_special"}
    assert "".join(token.content for token in heading) == f'Loop of "{scenario.name}"'
    check_folder(tmp_path)


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_fmu(scenario: bk.Scenario, scenario_file: Path, tmp_path: Path, fmi: str) -> None:
    path = tmp_path / "unit.fmu"
    succeed("export", "fmu", scenario_file, "--fmi", fmi, "--out", path)
    with zipfile.ZipFile(path) as unit:
        assert all(re.fullmatch(r"[\w./-]+", name) for name in unit.namelist())
        told = ElementTree.fromstring(unit.read("modelDescription.xml"))
        sources = [unit.read(name).decode("ascii") for name in unit.namelist() if ".c" in name]
    assert told.get("modelName") == f"Controller of {scenario.name}"
    assert "\x1b" not in str(told.get("description")) and "<marker>" in str(told.get("description"))
    assert not ["marker" for code in sources if "marker" in re.sub(r"(?s)/\*.*?\*/", "", code)]


def test_a_name_of_no_letters_is_still_a_unit(tmp_path: Path) -> None:
    scenario = bk.load_scenario("paper_as_computed").with_(name="摩擦" * 50)
    written = bk.export_fmu(scenario, out=tmp_path / "unit.fmu")
    assert written.path.exists()


# Studies, tunings, comparisons


def population(name: str) -> dict[str, Any]:
    def between(low: float, high: float) -> dict[str, Any]:
        return {"distribution": "uniform", "low": low, "high": high}

    return {
        "name": name,
        "description": NOTE,
        "duration_s": 0.4,
        "control_period_s": 1e-4,
        "parts": {
            "stiction_n": between(100.0, 400.0),
            "stiction_ratio": between(1.1, 2.0),
            "presliding_m": between(20e-6, 30e-6),
            "bristle_damping_ratio": between(0.5, 1.0),
            "stribeck_velocity_m_per_s": between(0.05, 0.1),
            "mass_kg": between(1.0, 1.5),
            "engagement_length_m": between(0.001, 0.002),
            "var": between(0.0, 0.2),
            "hold_s": between(1e-3, 1e-2),
            "correlation_length_m": between(1e-5, 1e-3),
        },
    }


def feed(name: str) -> dict[str, Any]:
    method = bk.load_method("steady_feed").model_dump(exclude_none=True)
    return {**method, "name": name, "description": NOTE}


def write_toml(path: Path, content: dict[str, Any]) -> Path:
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path


STUDY = {
    "name": MARKUP,
    "description": NOTE,
    "scenario": "paper_as_computed",
    "runs": 2,
    "changes": {"disturbance.var": 0.1, "timing.duration_s": 0.01},
    "metrics": ["peak_force_n"],
}


def test_study(tmp_path: Path) -> None:
    controllers = [
        {"name": MARKUP},
        {"name": CODE, "changes": {"controller.derivative_filter_s": 1e-4}},
    ]
    study = {"kind": "compare", **STUDY, "compare": {"controllers": controllers}}
    file = write_toml(tmp_path / "study.toml", study)
    out = tmp_path / "out"
    said = succeed("study", file, "--out", out)
    assert all(one["name"] in said for one in controllers)
    again = bk.load_study(out / "study.toml")
    assert (again.name, again.description) == (MARKUP, NOTE)
    with (out / "outcomes.csv").open(encoding="utf-8", newline="") as table:
        names = [row["controller"] for row in csv.DictReader(table)]
    assert names == [f"'{MARKUP}", CODE]
    check_folder(out)


def test_agreement(tmp_path: Path) -> None:
    variants = [
        {"name": MARKUP},
        {"name": CODE, "changes": {"controller.derivative_filter_s": 1e-4}},
    ]
    asked = {"laws": ["lugre", "coulomb_stiction"], "variants": variants}
    study = {"kind": "agreement", **STUDY, "runs": 6, "agreement": asked}
    out = tmp_path / "out"
    succeed("study", write_toml(tmp_path / "study.toml", study), "--out", out)
    check_folder(out)


def tuning(name: str) -> dict[str, Any]:
    return {
        "name": MARKUP,
        "description": NOTE,
        "population": population(MARKUP),
        "method": feed(name),
        "objectives": ["median_time_to_release_s"],
        "tune": {"controller.speed_m_per_s": {"low": 0.01, "high": 0.04}},
        "training_runs": 4,
        "test_runs": {"first": 1000, "runs": 4},
        "evaluations": 2,
    }


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_tune(name: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    succeed("tune", write_toml(tmp_path / "tuning.toml", tuning(name)), "--out", out)
    assert bk.load_method(out / "best.toml").name == f"{name}_tuned"
    check_folder(out)


def test_a_name_too_long_for_a_tuned_one_is_refused_first(tmp_path: Path) -> None:
    out = tmp_path / "out"
    failed = call("tune", write_toml(tmp_path / "t.toml", tuning("x" * 90)), "--out", out)
    assert failed.exit_code == 2 and "give a name of at most 88 characters" in failed.stderr
    assert not out.exists()


def test_compare(tmp_path: Path) -> None:
    methods = []
    for key, name in NAMES.items():
        methods += ["--method", write_toml(tmp_path / f"{key}.toml", feed(name))]
    parts = write_toml(tmp_path / "parts.toml", population(MARKUP))
    out = tmp_path / "out"
    said = succeed("compare", parts, *methods, "--laws", "lugre", "--runs", 4, "--out", out)
    seen = check_page(out / "index.html")
    assert all(name in said and name in seen for name in NAMES.values())
    assert tomllib.loads((out / "comparison.toml").read_text("utf-8"))["methods"][0]["name"] == CODE
    check_folder(out)


# Logs

LOG = "=1+1 <marker> $\\marker{ $[bold] \x1b]0;marker\x07\u202e\n`m`.csv"
COLUMN = "=x <marker> $\\marker{ $ | \x1b]0;marker\x07\u202e (V)"


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a log whose file and columns are named by markers, with a mapping beside it."""
    t_s = np.arange(4000) / 1000.0
    v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    a = -1.5 * np.sin(5 * t_s) - 0.4 * np.sin(2 * t_s)
    x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    force = 3.0 * a + 25.0 * v + 300.0 * np.sign(v) + 2.0
    path = tmp_path_factory.mktemp("log") / LOG
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["t_s", "x", COLUMN, f"other {COLUMN}"])
        table.writerows(np.column_stack([t_s, x, force / 50.0, force]).tolist())
    channels = {
        "position_m": {"from": "x", "unit": "m"},
        "force_n": {"from": COLUMN, "unit": "<marker>", "scale": 50.0},
    }
    write_toml(path.with_suffix(".toml"), {"channels": channels})
    return path


def test_identify(log: Path, tmp_path: Path) -> None:
    joint = tmp_path / "joint.toml"
    succeed("identify", log, "--out", joint, "--report")
    assert bk.JointFile.load(joint).provenance.log == text.visible(LOG)
    assert text.visible(LOG) in check_page(tmp_path / "joint.html")
    assert text.visible(LOG) in succeed("run", "paper_as_computed", "--joint", joint)


def test_events(log: Path) -> None:
    succeed("events", log)


def test_an_error_about_a_column_is_harmless(log: Path, tmp_path: Path) -> None:
    channels = {"position_m": {"from": f"no {COLUMN}", "unit": "m"}}
    mapping = write_toml(tmp_path / "mapping.toml", {"channels": channels})
    failed = call("identify", log, "--mapping", mapping)
    assert failed.exit_code == 2 and "is missing; the nearest present is" in failed.stderr


# A terminal


@pytest.mark.skipif(sys.platform == "win32", reason="terminals of POSIX")
def test_a_terminal_is_given_colors_and_nothing_else(log: Path, tmp_path: Path) -> None:
    scenario = bk.load_scenario("paper_as_computed").with_(name=MARKUP)
    bk.save_scenario(scenario, tmp_path / "scenario.toml")
    for args in (
        ["identify", log],
        ["run", tmp_path / "scenario.toml"],
        ["run", f"{COLUMN}.toml"],
    ):
        told = on_terminal(*map(str, args))
        told = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|[\r\n]", "", told)  # colors, and what moves a bar
        assert "marker" in told and not HOSTILE.search(told), told


def on_terminal(*args: str) -> str:
    ours, theirs = os.openpty()
    command = [sys.executable, "-m", "breakaway.cli.main", *args]
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    read = b""
    try:
        while piece := os.read(ours, 65536):
            read += piece
    except OSError:  # how Linux says that the other end is closed
        pass
    finally:
        os.close(ours)
        process.wait()
    return read.decode()
