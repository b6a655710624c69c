"""Scenarios in files: load, save, presets, schema."""

from __future__ import annotations

import difflib
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

import tomli_w

from breakaway.base.arguments import check_arguments, check_choice
from breakaway.base.output import write_atomically
from breakaway.base.reading import table_of, text_of
from breakaway.errors import ScenarioError
from breakaway.model.scenario.actuator import Piezo
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.harm import HarmLimits
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.model import Model
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.scenario import Scenario

AnyModel = TypeVar("AnyModel", bound=Model)

PRESETS = files("breakaway.model.presets")
FOLDERS = ("", "populations", "methods", "stacks", "rigs")
"""Folders of presets; that of scenarios has no name."""


def preset_names(folder: str = "") -> list[str]:
    """Names of the presets that come with breakaway.

    Parameters
    ----------
    folder : {"", "populations", "methods", "stacks", "rigs"}, optional
        Which presets: scenarios, where it is left out.

    """
    check_choice("folder", folder, FOLDERS, ScenarioError)
    presets = PRESETS / folder if folder else PRESETS
    return sorted(p.name.removesuffix(".toml") for p in presets.iterdir() if p.name[-5:] == ".toml")


def preset_descriptions(folder: str = "") -> dict[str, str]:
    """Names of the presets, each with its description, or else the first line of its file.

    Parameters
    ----------
    folder : {"", "populations", "methods", "stacks", "rigs"}, optional
        Which presets: scenarios, where it is left out.

    Examples
    --------
    >>> preset_descriptions("stacks")["pi_p888_91_pd200"]
    'PI Ceramic PICMA stack P-888.91, 10 x 10 x 36 mm, on a PiezoDrive PD200 amplifier of 150 V.'

    """
    texts = {name: _preset_text(name, folder) for name in preset_names(folder)}
    return {
        name: tomllib.loads(text).get("description") or text.split("\n", 1)[0].lstrip("# ")
        for name, text in texts.items()
    }


def load_scenario(source: str | Path) -> Scenario:
    """Load a scenario: a preset by its name, or a TOML file by its path.

    Parameters
    ----------
    source : str or Path
        The name of a preset, or the path of a file.

    Raises
    ------
    ScenarioError
        There is no such preset or file, it is not TOML, or a value is not valid; the message
        names such fields, ten at most.

    Examples
    --------
    >>> load_scenario("paper_as_computed").joint.stiffness_n_per_m
    36000000.0
    >>> load_scenario("paper_as_computd")
    Traceback (most recent call last):
        ...
    breakaway.errors.ScenarioError: paper_as_computd: ... did you mean paper_as_computed?

    """
    check_arguments(load_scenario, locals(), ScenarioError)
    return _load(Scenario, source, "")


def load_population(source: str | Path) -> PartPopulation:
    """Load a population of parts: a preset by its name, or a TOML file by its path.

    Parameters
    ----------
    source : str or Path
        The name of a preset, such as ``seized_parts``, or the path of a file.

    Raises
    ------
    ScenarioError
        There is no such preset or file, it is not TOML, or a value is not valid.

    Examples
    --------
    >>> load_population("seized_parts").duration_s
    10.0

    """
    check_arguments(load_population, locals(), ScenarioError)
    return _load(PartPopulation, source, "populations")


def load_method(source: str | Path) -> Method:
    """Load a way to free parts: a preset by its name, or a TOML file by its path.

    Parameters
    ----------
    source : str or Path
        The name of a preset, such as ``timed_impacts``, or the path of a file.

    Raises
    ------
    ScenarioError
        There is no such preset or file, it is not TOML, or a value is not valid.

    Examples
    --------
    >>> load_method("steady_feed").actuator.kind
    'feed_axis'

    """
    check_arguments(load_method, locals(), ScenarioError)
    return _load(Method, source, "methods")


def load_stack(source: str | Path) -> Piezo:
    """Load a piezo stack with its amplifier: a preset by its name, or a TOML file by its path.

    Each preset says where its figures are from, and which of them are estimates.

    Parameters
    ----------
    source : str or Path
        The name of a preset, such as ``pi_p888_91_pd200``, or the path of a file.

    Raises
    ------
    ScenarioError
        There is no such preset or file, it is not TOML, or a value is not valid.

    Examples
    --------
    >>> stack = load_stack("pi_p888_91_pd200")
    >>> round(stack.stiffness_n_per_m * stack.stroke_m)  # blocking force, N
    3800

    """
    check_arguments(load_stack, locals(), ScenarioError)
    return _load(Piezo, source, "stacks")


def load_rig(source: str | Path) -> ExtractionRig:
    """Load a rig that frees parts: a preset by its name, or a TOML file by its path.

    Each preset says where its figures are from, and which of them are assumed.

    Parameters
    ----------
    source : str or Path
        The name of a preset, such as ``screw_jack``, or the path of a file.

    Raises
    ------
    ScenarioError
        There is no such preset or file, it is not TOML, or a value is not valid.

    Examples
    --------
    >>> load_rig("screw_jack").actuator.kind
    'feed_axis'

    """
    check_arguments(load_rig, locals(), ScenarioError)
    return _load(ExtractionRig, source, "rigs")


def load_limits(path: str | Path) -> HarmLimits:
    """Load what a part and its host may suffer from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    ScenarioError
        There is no such file, it is not TOML, or a value is not valid.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "limits.toml"
    ...     _ = path.write_text("jump_max_m = 2.5e-4")
    ...     load_limits(path).jump_max_m
    0.00025

    """
    check_arguments(load_limits, locals(), ScenarioError)
    path = Path(path)
    return parse_toml(HarmLimits, text_of(path, ScenarioError), path.name)


def _load(model: type[AnyModel], source: str | Path, folder: str) -> AnyModel:
    if isinstance(source, str) and source in preset_names(folder):
        return parse_toml(model, _preset_text(source, folder), source)
    return parse_toml(model, _read(Path(source), preset_names(folder)), str(source))


def _preset_text(name: str, folder: str) -> str:
    return PRESETS.joinpath(*folder.split(), f"{name}.toml").read_text(encoding="utf-8")


def parse_scenario(text: str, source: str) -> Scenario:
    """Build a scenario from TOML; ``source`` names the text in errors."""
    return parse_toml(Scenario, text, source)


def parse_toml(model: type[AnyModel], text: str, source: str) -> AnyModel:
    """Build a model from TOML; ``source`` names the text in errors.

    Raises
    ------
    ScenarioError
        It is not TOML, or a value is not valid; the message names such fields, ten at most.

    """
    values = table_of(text, source, ScenarioError)
    try:
        return model.parse(values)
    except ScenarioError as error:
        raise ScenarioError(
            f"{source}:\n{error}" if "\n" in str(error) else f"{source}: {error}"
        ) from None


def _read(path: Path, presets: list[str]) -> str:
    near = difflib.get_close_matches(str(path), presets, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]}?" if near else f"presets: {', '.join(presets)}"
    return text_of(path, ScenarioError, f"is neither a file nor a preset; {hint}")


def scenario_toml(scenario: Scenario) -> str:
    """The scenario as TOML. Floats are written so that they read back bit for bit."""
    return tomli_w.dumps(scenario.model_dump(exclude_none=True))


def save_scenario(scenario: Scenario, path: str | Path) -> None:
    """Write the scenario as TOML, whole or not at all.

    Parameters
    ----------
    scenario : Scenario
        What is written.
    path : str or Path
        The file; missing folders are made.

    Raises
    ------
    OutputError
        The file cannot be written.

    """
    check_arguments(save_scenario, locals(), ScenarioError)
    write_atomically(Path(path), scenario_toml(scenario).encode())


def save_population(population: PartPopulation, path: str | Path) -> None:
    """Write a population as TOML, whole or not at all.

    Parameters
    ----------
    population : PartPopulation
        What is written.
    path : str or Path
        The file; missing folders are made.

    Raises
    ------
    OutputError
        The file cannot be written.

    """
    check_arguments(save_population, locals(), ScenarioError)
    text = tomli_w.dumps(population.model_dump(exclude_none=True), multiline_strings=True)
    write_atomically(Path(path), text.encode())


def scenario_schema() -> dict[str, Any]:
    """The JSON Schema of a scenario."""
    return Scenario.model_json_schema()
