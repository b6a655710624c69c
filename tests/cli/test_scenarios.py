"""`presets`, `init`, `schema`, help and version; and the scenario templates."""

import itertools
import json
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import breakaway as bk
from breakaway.model.scenario import parse_scenario
from breakaway.model.scenario.template import scenario_template

Call = Callable[..., Any]
COMMANDS = ("run", "design", "identify", "presets", "init", "schema", "reproduce", "study")


def test_presets_are_listed(call: Call) -> None:
    found = json.loads(call("presets", "--json").stdout)
    folders = {
        "scenario": "",
        "method": "methods",
        "population": "populations",
        "rig": "rigs",
        "stack": "stacks",
    }
    listed = [(preset["kind"], preset["name"]) for preset in found]
    assert listed == [(kind, name) for kind in folders for name in bk.preset_names(folders[kind])]
    shown = call("presets").stdout
    for preset in found:
        assert preset["description"]
        assert preset["description"] in shown
        assert all(use in shown for use in preset["used_by"])


def test_schema_is_printed_and_written(call: Call, tmp_path: Path) -> None:
    out = tmp_path / "schema.json"
    assert json.loads(call("schema").stdout) == bk.scenario_schema()
    assert call("schema", "--out", out).exit_code == 0
    assert json.loads(out.read_text()) == bk.scenario_schema()


@pytest.mark.parametrize("preset", bk.preset_names())
def test_init_writes_what_loads_back(call: Call, tmp_path: Path, preset: str) -> None:
    path = tmp_path / "mine.toml"
    assert call("init", path, "--preset", preset).exit_code == 0
    ours = {"name": "mine", "description": f"Made from {preset}"}
    assert bk.load_scenario(path) == bk.load_scenario(preset).with_(ours)
    assert max(len(line) for line in path.read_text().splitlines() if line[:1] == "#") <= 96


@pytest.mark.parametrize("preset", bk.preset_names())
def test_every_key_of_a_template_is_explained(preset: str) -> None:
    lines = scenario_template(bk.load_scenario(preset)).splitlines()
    for before, line in itertools.pairwise(lines):
        key = line.split(" = ")[0]
        if " = " in line and not line.startswith("#") and key not in ("law", "kind"):
            assert before.startswith("# "), line


def test_a_template_keeps_awkward_values() -> None:
    awkward = bk.load_scenario("paper_as_computed").with_(
        {
            "name": 'quotes " \\ and = signs',
            "description": "two\nlines, # no comment",
            "joint.stiction_n": 0.1 + 0.2 + 1e5,
            "part.mass_kg": 1e6,
            "joint.stiffness_n_per_m": 5e-324,
            "joint.residual_n": 1e-22,
            "limits.diverged_force_n": 1.7976931348623157e308,
            "limits.jump_max_m": 1e-3,
            "breakaway_version": "0.0.1",
            "seed": 2**63 - 1,
        }
    )
    assert parse_scenario(scenario_template(awkward), "awkward") == awkward


def test_what_is_left_out_can_be_set_by_uncommenting() -> None:
    text = scenario_template(bk.load_scenario("paper_as_computed"))
    for key in ("residual_n", "jump_max_m", "peak_force_max_n"):
        assert f"\n# {key} =\n" in text
        text = text.replace(f"\n# {key} =\n", f"\n{key} = 12.5\n")
    content = tomllib.loads(text)
    assert content["joint"]["residual_n"] == content["limits"]["jump_max_m"] == 12.5
    assert parse_scenario(text, "text").joint.residual_n == 12.5


def test_a_template_names_the_alternatives() -> None:
    text = scenario_template(bk.load_scenario("paper_as_computed"))
    for choice in ("two_region", "push_only", "ramp", "step", "fm_vibration", "two_step", "given"):
        assert f' "{choice}": ' in text


def test_init_does_not_overwrite(call: Call, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("mine")
    refused = call("init", path)
    assert refused.exit_code == 3
    assert "--force" in refused.stderr
    assert path.read_text() == "mine"
    assert call("init", path, "--force").exit_code == 0
    assert bk.load_scenario(path).name == "mine"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_examples(call: Call, command: str) -> None:
    shown = call(command, "--help")
    assert shown.exit_code == 0
    assert "Examples" in shown.stdout
    assert f"breakaway {command}" in shown.stdout.split("Examples")[1]
    assert call(command, "-h").stdout == shown.stdout


def test_top_help_lists_commands_and_exit_codes(call: Call) -> None:
    shown = call("--help").stdout
    for words in (*COMMANDS, "Exit codes", "130", "invalid input", "not stable"):
        assert words in shown


@pytest.mark.parametrize("option", ["--version", "-V"])
def test_version(call: Call, option: str) -> None:
    assert call(option).stdout == f"breakaway {bk.__version__}\n"


@pytest.mark.slow
def test_starts_without_heavy_imports() -> None:
    script = (
        "import sys\n"
        "from typer.testing import CliRunner\n"
        "from breakaway.cli.app import app\n"
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0\n"
        "heavy = {'numpy', 'scipy', 'matplotlib', 'pyarrow', 'pydantic', 'xarray'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
        "assert CliRunner().invoke(app, ['run', 'paper_as_computed']).exit_code == 0\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["[]", "['numpy', 'pydantic']"]
