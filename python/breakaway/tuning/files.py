"""Tunings in files."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from breakaway.errors import ScenarioError, StudyError
from breakaway.scenario.files import preset_names
from breakaway.tuning.problem import Tuning


def load_tuning(path: str | Path) -> Tuning:
    """Load a tuning from a TOML file.

    Population and method are presets, tables of the file, or paths of files, which start at the
    tuning's folder.

    Parameters
    ----------
    path : str or Path
        The file.

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
    ...     load_tuning(path).trials
    100

    """
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise StudyError(f"{file}: there is no such file; give the path of a tuning") from None
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"{file}: can not be read as text: {error}") from None
    if text.startswith("\ufeff"):
        raise StudyError(f"{file}: starts with a byte order mark; save it as plain UTF-8")
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise StudyError(f"{file}: is not TOML: {error}") from None
    try:
        return Tuning.parse(_from_folder(values, file.parent))
    except (StudyError, ScenarioError) as error:
        separator = "\n" if "\n" in str(error) else " "
        raise StudyError(f"{file}:{separator}{error}") from None


def _from_folder(values: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Let paths start at the folder of the tuning; what is no file there may be a preset."""
    for key, presets in (("population", "populations"), ("method", "methods")):
        named = values.get(key)
        if isinstance(named, str) and named not in preset_names(presets):
            inside = folder / named
            values[key] = str(inside) if inside.exists() else named
    return values
