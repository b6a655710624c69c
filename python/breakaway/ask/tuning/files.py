"""Tunings in files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from breakaway.ask.studies.files import load_table
from breakaway.ask.tuning.problem import Tuning
from breakaway.base.arguments import check_arguments
from breakaway.base.reading import is_there
from breakaway.errors import StudyError
from breakaway.model.scenario.files import load_population, preset_names
from breakaway.model.scenario.population import PartPopulation
from breakaway.run.overlay import lay_over


def load_tuning(path: str | Path, *, joint: str | Path | None = None) -> Tuning:
    """Load a tuning from a TOML file.

    Population and method are presets, tables of the file, or paths of files, which start at the
    tuning's folder.

    Parameters
    ----------
    path : str or Path
        The file.
    joint : str or Path, optional
        Path of a joint file, laid over the population by `lay_over`: the parts are the joints that
        it draws.

    Returns
    -------
    Tuning

    Raises
    ------
    StudyError
        There is no such file, it is not TOML, a value is not valid, or the tuning contradicts
        itself.

    Examples
    --------
    >>> import tempfile
    >>> text = '''
    ... population = "seized_parts"
    ... method = "steady_feed"
    ... objectives = ["strict_share", "median_time_to_release_s"]
    ... [tune]
    ... "controller.speed_m_per_s" = { low = 0.01, high = 0.03 }
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "tuning.toml"
    ...     _ = path.write_text(text)
    ...     load_tuning(path).evaluations
    100

    """
    check_arguments(load_tuning, locals(), StudyError)
    return load_table(
        path, "tuning", lambda values, at: Tuning.parse(_over(joint, _from_folder(values, at)))
    )


def _over(joint: str | Path | None, values: dict[str, Any]) -> dict[str, Any]:
    """Lay a joint over the population, where both are given; what is no population stays."""
    given = values.get("population")
    if joint is None or not isinstance(given, str | dict):
        return values
    population = load_population(given) if isinstance(given, str) else PartPopulation.parse(given)
    return values | {"population": lay_over(population, joint)}


def _from_folder(values: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Let paths start at the folder of the tuning; what is no file there may be a preset."""
    for key, presets in (("population", "populations"), ("method", "methods")):
        named = values.get(key)
        if isinstance(named, str) and named not in preset_names(presets):
            inside = folder / named
            values[key] = str(inside) if is_there(inside) else named
    return values
