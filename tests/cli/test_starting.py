"""`init` and `schema` know every kind of file: what is written loads, runs, and fits its schema."""

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import breakaway as bk
from breakaway.ask.studies import load_study
from breakaway.ask.studies.study import KINDS
from breakaway.ask.tuning import load_tuning
from breakaway.cli.starting import SchemaKind
from breakaway.cli.starts import StartKind

pytestmark = pytest.mark.slow

Call = Callable[..., Any]
EXAMPLES = Path(__file__).parents[2] / "examples"
LOAD: dict[str, Callable[[Path], Any]] = {
    "scenario": bk.load_scenario,
    "population": bk.load_population,
    "method": bk.load_method,
    "rig": bk.load_rig,
    "limits": bk.load_limits,
    "tuning": load_tuning,
    **dict.fromkeys(KINDS, load_study),
}
SMALL = {
    StartKind.TUNING: {" = 100\n": " = 3\n", " = 16\n": " = 2\n", " = 200\n": " = 8\n"},
    StartKind.POPULATION: {"duration_s = 10.0": "duration_s = 0.02"},
}
"""Changes with which a test takes seconds."""


def schema_kind(kind: str) -> str:
    return "study" if kind in KINDS else kind


def written(call: Call, path: Path, *options: object) -> str:
    """Write a file; gives the command that the output names."""
    shown = call("init", path, *options)
    assert shown.exit_code == 0, shown.stderr
    said = re.fullmatch(r"wrote (.*); edit it, then: breakaway (.*)\n", shown.stdout)
    assert said
    assert said[1] == str(path)
    return said[2]


def test_every_kind_of_study_has_a_start() -> None:
    assert {kind.value for kind in StartKind} == set(LOAD)


@pytest.mark.parametrize("kind", list(StartKind))
def test_what_init_writes_runs_at_once(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: StartKind
) -> None:
    if kind is StartKind.SENSITIVITY:
        pytest.importorskip("SALib")
    path = tmp_path / "mine.toml"
    command = written(call, path, "--kind", kind)
    text = path.read_text()
    for usual, small in SMALL.get(kind, {}).items():
        assert usual in text
        text = text.replace(usual, small)
    path.write_text(text)
    monkeypatch.chdir(tmp_path)
    command = command.replace("--runs 100", "--runs 2 --laws lugre")
    command = command.replace("--budget-s 30", "--budget-s 1 --parts-max 16")
    if kind is StartKind.POPULATION:
        command += " --method force_ramp"
    done = call(*shlex.split(command))
    assert done.exit_code == 0, done.stderr
    ends = ("summary.json", "advice.json")
    ended = kind is StartKind.SCENARIO or any((tmp_path / "result" / one).exists() for one in ends)
    assert ended, done.stdout


@pytest.mark.parametrize("kind", list(StartKind))
def test_what_init_writes_loads_and_fits_its_schema(
    call: Call, tmp_path: Path, kind: StartKind
) -> None:
    path = tmp_path / "mine.toml"
    written(call, path, "--kind", kind)
    assert LOAD[kind](path).name == "mine"
    schema = json.loads(call("schema", "--kind", schema_kind(kind)).stdout)
    content = tomllib.loads(path.read_text())
    jsonschema.validate(content, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**content, "no_such_key": 1}, schema)
    assert max(len(line) for line in path.read_text().splitlines() if line[:1] == "#") <= 96


@pytest.mark.parametrize("kind", ["scenario", "method", "population", "rig", "tuning"])
def test_init_starts_from_every_preset(call: Call, tmp_path: Path, kind: str) -> None:
    folders = {"scenario": "", "method": "methods", "tuning": "methods", "rig": "rigs"}
    folder = folders.get(kind, "populations")
    for preset in bk.preset_names(folder):
        path = tmp_path / f"{preset}.toml"
        written(call, path, "--kind", kind, "--preset", preset)
        made = LOAD[kind](path)
        if kind == "tuning":
            assert made.method == bk.load_method(preset)
        else:
            ours = {"name", "description"}
            assert made.model_dump(exclude=ours) == LOAD[kind](preset).model_dump(exclude=ours)


@pytest.mark.parametrize("kind", [*KINDS, "tuning"])
def test_a_file_is_named_from_the_folder_of_what_is_about_it(
    call: Call, tmp_path: Path, kind: str
) -> None:
    source = tmp_path / "own.toml"
    written(call, source, "--kind", "method" if kind == "tuning" else "scenario")
    path = tmp_path / "deeper" / "mine.toml"
    path.parent.mkdir()
    written(call, path, "--kind", kind, "--preset", source)
    made = LOAD[kind](path)
    about = made.method if kind == "tuning" else made.scenario
    assert about.name == "own"
    assert os.path.join("..", "own.toml") in path.read_text()  # noqa: PTH118


@pytest.mark.parametrize(
    ("file", "kind"),
    [
        ("03_own_joint/bolt.toml", "scenario"),
        ("04_how_much_uncertainty/spread.toml", "study"),
        ("04_how_much_uncertainty/dampings.toml", "study"),
        ("09_does_it_survive_the_law/disturbance.toml", "study"),
        ("08_gentle_tuning/quick.toml", "tuning"),
        ("08_gentle_tuning/timed_impacts.toml", "tuning"),
        ("08_gentle_tuning/timed_impacts_anew.toml", "tuning"),
        ("08_gentle_tuning/soft_axis.toml", "tuning"),
        ("09_does_it_survive_the_law/waiting.toml", "study"),
        ("08_gentle_tuning/quick_parts.toml", "population"),
    ],
)
def test_examples_fit_their_schemas(call: Call, file: str, kind: str) -> None:
    schema = json.loads(call("schema", "--kind", SchemaKind(kind)).stdout)
    jsonschema.validate(tomllib.loads((EXAMPLES / file).read_text()), schema)


def test_an_unknown_preset_or_kind_is_named(call: Call, tmp_path: Path) -> None:
    failed = call("init", tmp_path / "a.toml", "--kind", "method", "--preset", "stedy_feed")
    assert (failed.exit_code, "did you mean steady_feed?" in failed.stderr) == (2, True)
    failed = call("init", tmp_path / "a.toml", "--kind", "study")
    assert (failed.exit_code, "'sweep'" in failed.stderr) == (2, True)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("run paper_as_pr", ["paper_as_printed", "paper_as_printed_vibration"]),
        ("compare seiz", ["seized_parts"]),
        ("compare --method steady", ["steady_feed", "steady_feed_soft"]),
        ("compare --laws lugre,el", ["lugre,elasto_plastic"]),
        ("init --kind sw", ["sweep"]),
    ],
)
def test_a_shell_completes_names(words: str, completed: list[str]) -> None:
    told = {
        "_BREAKAWAY_COMPLETE": "complete_bash",
        "COMP_WORDS": f"breakaway {words}",
        "COMP_CWORD": str(len(words.split())),
    }
    script = "import sys; sys.argv[0] = 'breakaway'; from breakaway.cli.main import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | told,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == completed
