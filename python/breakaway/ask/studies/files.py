"""Studies in files."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from breakaway.ask.studies.study import KINDS, Study
from breakaway.base.arguments import check_arguments
from breakaway.base.reading import is_there, table_of, text_of
from breakaway.base.text import shown
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.files import preset_names

Built = TypeVar("Built")


def load_study(path: str | Path, *, joint: str | Path | None = None) -> Study:
    """Load a study from a TOML file.

    Scenarios are named as in ``load_scenario``; paths of files start at the study's folder.

    Parameters
    ----------
    path : str or Path
        The file.
    joint : str or Path, optional
        Path of a joint file, for the study's ``joint``; it replaces the one that the file names.

    Returns
    -------
    SweepStudy, RobustnessStudy, SensitivityStudy, CompareStudy or AgreementStudy

    Raises
    ------
    StudyError
        There is no such file, it is not TOML, a value is not valid, or the study contradicts
        itself.

    Examples
    --------
    >>> import tempfile
    >>> text = '''
    ... kind = "sweep"
    ... scenario = "paper_as_computed"
    ... runs = 1
    ... [sweep.grid]
    ... "joint.stiction_n" = [400.0, 450.0, 500.0]
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "study.toml"
    ...     _ = path.write_text(text)
    ...     load_study(path).runs
    1

    """
    check_arguments(load_study, locals(), StudyError)
    own = {} if joint is None else {"joint": str(joint)}
    return load_table(path, "study", lambda values, at: parse_study(_from_folder(values, at) | own))


def load_table(
    path: str | Path, what: str, build: Callable[[dict[str, Any], Path], Built]
) -> Built:
    """Build what a TOML file describes from its values and its folder; errors name the file.

    Raises
    ------
    StudyError
        There is no such file, it is not TOML, or what it describes cannot be built.

    """
    check_arguments(load_table, locals(), StudyError)
    file = Path(path)
    missing = f"there is no such file; give the path of a {what}"
    values = table_of(text_of(file, StudyError, missing), file, StudyError)
    try:
        return build(values, file.parent)
    except (StudyError, ScenarioError) as error:
        separator = "\n" if "\n" in str(error) else " "
        raise StudyError(f"{file}:{separator}{error}") from None


def parse_study(values: Mapping[str, Any]) -> Study:
    """Build a study of the kind that it says.

    Raises
    ------
    StudyError
        A value is not valid, or the study contradicts itself.

    """
    kind = values.get("kind")
    known = ", ".join(repr(name) for name in KINDS)
    if kind is None:
        raise StudyError(f"kind: is missing; give one of {known}")
    if not isinstance(kind, str) or kind not in KINDS:
        near = difflib.get_close_matches(shown(kind), KINDS, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise StudyError(f"kind: {shown(kind)} is not one of {known}{hint}")
    for other in KINDS:
        if other != kind and other in values:
            raise StudyError(
                f"{other}: is a table of another kind, but kind = {kind!r}; leave one out"
            )
    return KINDS[kind].parse(values)


def _from_folder(values: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Let paths of scenarios and joints start at the folder of the study."""
    if isinstance(values.get("joint"), str):
        values["joint"] = str(folder / values["joint"])
    compare = values.get("compare")
    controllers = compare.get("controllers") if isinstance(compare, dict) else None
    for table in [values, *(controllers if isinstance(controllers, list) else [])]:
        named = table.get("scenario") if isinstance(table, dict) else None
        if isinstance(named, str) and named not in preset_names():
            inside = folder / named
            # What is no file there either keeps its name, so that the error can guess a preset.
            table["scenario"] = str(inside) if is_there(inside) else named
    return values
