"""``breakaway presets``, ``init`` and ``schema``: scenarios to start from."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

import typer

from breakaway.base.reading import is_file
from breakaway.cli.show import Sheet, say, say_json
from breakaway.errors import OutputError


def presets(
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """List the scenarios that come with breakaway."""
    from breakaway.model.scenario import load_scenario, preset_names

    found = {name: load_scenario(name).description for name in preset_names()}
    if json:
        say_json([{"name": name, "description": text} for name, text in found.items()])
        return
    shown = Sheet("", ["preset", "description"], prose=["description"])
    for name, text in found.items():
        shown.add(name, text)
    say(shown)


def schema(
    out: Annotated[
        Path | None, typer.Option(help="File to write, in place of printing.", metavar="FILE")
    ] = None,
) -> None:
    """Print the JSON Schema of a scenario, for editors that check and complete TOML."""
    from breakaway.base.output import write_atomically
    from breakaway.model.scenario import scenario_schema

    content = scenario_schema()
    if out is None:
        say_json(content)
        return
    write_atomically(out, (json_text.dumps(content, indent=2) + "\n").encode())
    say(f"wrote {out}")


def init(
    file: Annotated[Path, typer.Argument(help="TOML file to write.")],
    preset: Annotated[
        str, typer.Option(help="Preset, or scenario file, whose values it gets.")
    ] = "paper_as_computed",
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
) -> None:
    """Write a commented scenario to edit: every key with its meaning, unit and valid range."""
    from breakaway.base.output import write_atomically
    from breakaway.model.scenario import load_scenario
    from breakaway.model.scenario.template import scenario_template

    values = load_scenario(preset).with_(name=file.stem, description=f"Made from {preset}")
    content = scenario_template(values)
    if is_file(file) and not force:
        raise OutputError(f"{file}: exists; give another name, or --force to overwrite it")
    write_atomically(file, content.encode())
    say(f"wrote {file}; edit it, then: breakaway run {file}")
