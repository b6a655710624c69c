"""``breakaway init`` and ``schema``: files to start from, and what their keys may be."""

from __future__ import annotations

import json as json_text
import os
import shlex
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.base.reading import is_file
from breakaway.cli.completion import any_preset
from breakaway.cli.show import say, say_json
from breakaway.cli.starts import (
    PRESET,
    PRESET_OF_OTHERS,
    USE,
    USE_OF_STUDIES,
    StartKind,
    start,
)
from breakaway.errors import OutputError

if TYPE_CHECKING:
    from breakaway.model.scenario.model import Model


class SchemaKind(StrEnum):
    """Kinds of files that have a JSON Schema."""

    SCENARIO = "scenario"
    POPULATION = "population"
    METHOD = "method"
    RIG = "rig"
    LIMITS = "limits"
    STUDY = "study"
    TUNING = "tuning"


def schema(
    kind: Annotated[
        SchemaKind, typer.Option(help="Kind of file; study covers every kind of study.")
    ] = SchemaKind.SCENARIO,
    out: Annotated[
        Path | None, typer.Option(help="File to write, instead of printing.", metavar="FILE")
    ] = None,
) -> None:
    """Print the JSON Schema of a kind of file, for editors that check and complete TOML."""
    from breakaway.base.output import write_atomically

    content = _schema(kind)
    if out is None:
        say_json(content)
        return
    write_atomically(out, (json_text.dumps(content, indent=2) + "\n").encode())
    say(f"wrote {out}")


def _schema(kind: SchemaKind) -> dict[str, Any]:
    from breakaway.model.scenario import (
        ExtractionRig,
        HarmLimits,
        Method,
        PartPopulation,
        scenario_schema,
    )

    models: dict[SchemaKind, type[Model]] = {
        SchemaKind.METHOD: Method,
        SchemaKind.POPULATION: PartPopulation,
        SchemaKind.RIG: ExtractionRig,
        SchemaKind.LIMITS: HarmLimits,
    }
    if kind is SchemaKind.SCENARIO:
        return scenario_schema()
    if kind in models:
        return models[kind].model_json_schema()
    if kind is SchemaKind.TUNING:
        from breakaway.ask.tuning import Tuning

        return Tuning.model_json_schema()
    from breakaway.ask.studies.study import study_schema

    return study_schema()


def init(
    file: Annotated[Path, typer.Argument(help="TOML file to write.")],
    kind: Annotated[StartKind, typer.Option(help="What the file is.")] = StartKind.SCENARIO,
    preset: Annotated[
        str | None,
        typer.Option(
            help="Preset or file that the values come from: a scenario, population, method or rig; "
            "for a study the scenario, and for a tuning the method, that it is about.",
            metavar="NAME_OR_FILE",
            show_default="paper_as_computed, seized_parts, steady_feed or screw_jack",
            autocompletion=any_preset,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
) -> None:
    """Write a commented file to edit: every key with its meaning, unit and valid range.

    It writes a scenario unless --kind asks for a population, a method, a rig,
    limits, a study (sweep, robustness, sensitivity, compare, agreement) or a
    tuning. The file runs as it is; the last line of the output says how.
    """
    from breakaway.base.output import write_atomically
    from breakaway.model.scenario.template import template

    source = preset or PRESET.get(kind, PRESET_OF_OTHERS)
    made = start(kind, source, file.stem)
    named = {key: _seen_from(file, name) for key, name in made.named.items()}
    use = USE.get(kind, USE_OF_STUDIES)
    content = template(made.model, made.what, f"Use: {use.format(file='FILE')}", named)
    if is_file(file) and not force:
        raise OutputError(f"{file}: exists; give another name, or --force to overwrite it")
    write_atomically(file, content.encode())
    say(f"wrote {file}; edit it, then: {use.format(file=shlex.quote(str(file)))}")


def _seen_from(file: Path, name: str) -> str:
    """Name a preset, or a file as it is found from the folder of another."""
    return os.path.relpath(name, file.parent) if is_file(Path(name)) else name
