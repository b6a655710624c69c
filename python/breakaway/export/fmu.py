"""Export a controller, a plant or a loop as a functional mock-up unit (FMU)."""

from __future__ import annotations

import hashlib
import io
import re
import uuid
import zipfile
from dataclasses import dataclass
from math import isinf
from pathlib import Path
from typing import Any, Literal, get_args

from breakaway import _core
from breakaway.base.arguments import check_arguments, check_choice
from breakaway.base.output import write_atomically
from breakaway.base.reading import is_folder
from breakaway.base.text import c_identifier
from breakaway.errors import OutputError, ScenarioError
from breakaway.export.c_files import TITLES, c_texts, draws
from breakaway.export.fmi_absent import absent
from breakaway.export.fmu_build import build
from breakaway.export.interface import Variable, What
from breakaway.export.recording import Recording, record
from breakaway.export.templating import fill
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.units import unit_with
from breakaway.run.resolution import resolve

Fmi = Literal["2", "3"]
"""Version of the standard."""

_PERIOD = "timing_control_period_s"
_LARGEST_INTEGER = 2**31 - 1
_EARLIEST = (1980, 1, 1, 0, 0, 0)
"""The date of every file in a unit: the first that a zip file can tell."""


@dataclass(frozen=True)
class ExportedFmu:
    """What was written."""

    what: What
    fmi: Fmi
    path: Path
    binary: str | None
    """Where the library for this host is in the unit; None where it could not be compiled."""
    note: str
    """Why there is no library; empty where there is one."""


@dataclass(frozen=True)
class _Told:
    """A variable of a unit."""

    name: str
    reference: int
    causality: str
    variability: str
    initial: str
    description: str
    unit: str
    minimum: str | None
    maximum: str | None
    start: str | None
    whole: bool = False


def export_fmu(
    scenario: Scenario,
    *,
    what: What = "controller",
    fmi: Fmi | int = "3",
    out: str | Path,
) -> ExportedFmu:
    """Write a part of a scenario as an FMU for co-simulation.

    The unit holds the C of `export_c` in double with a wrapper, and the library for this host
    where a C compiler is found. A communication step is a whole number of control periods; any
    other is refused. Two exports of the same scenario are the same, byte for byte.

    Parameters
    ----------
    scenario : Scenario
        What is exported. Its numbers, once resolved, are parameters of the unit, under their paths.
    what : {"controller", "plant", "loop"}
        Reference, controller and watch; or actuator, joint, part and sensors; or both.
    fmi : {"2", "3"}
        Version of the standard.
    out : path
        The file, such as ``rig.fmu``. It is replaced, whole or not at all; missing folders are
        made.

    Returns
    -------
    ExportedFmu

    Raises
    ------
    ScenarioError
        It is not a scenario, `what` or `fmi` is not known, the controller cannot be designed for
        this joint, or the seed is beyond the integers of FMI 2.
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = bk.export_fmu(scenario, what="loop", out=f"{folder}/loop.fmu")
    ...     written.path.name, written.fmi
    ('loop.fmu', '3')

    """
    check_arguments(export_fmu, locals(), ScenarioError)
    check_choice("fmi", str(fmi), get_args(Fmi), ScenarioError)
    version: Fmi = "2" if str(fmi) == "2" else "3"
    path = Path(out)
    if is_folder(path):
        raise OutputError(f"{path}: is a folder; name a file in it, such as {path / what}.fmu")
    recording = record(resolve(scenario), what, "double")
    if version == "2" and draws(recording) and recording.scenario.seed > _LARGEST_INTEGER:
        raise ScenarioError(
            f"seed: {recording.scenario.seed} is beyond the integers of FMI 2, which end at "
            f"{_LARGEST_INTEGER}; take a smaller seed or FMI 3"
        )
    files = texts(recording, version)
    sources = {
        name.removeprefix("sources/"): text
        for name, text in files.items()
        if name.endswith((".c", ".h"))
    }
    built = build(sources, _identifier(recording), version)
    content = {name: text.encode() for name, text in files.items()}
    if built.place is not None:
        content[built.place] = built.library
    write_atomically(path, _packed(content))
    return ExportedFmu(what, version, path, built.place, built.note)


def texts(recording: Recording, fmi: Fmi) -> dict[str, str]:
    """Compose the files of a unit, without its library, by name."""
    prefix = recording.what
    code = c_texts(recording)
    context = _context(recording, fmi)
    files = {
        f"sources/{prefix}.c": code[f"{prefix}.c"],
        f"sources/{prefix}.h": code[f"{prefix}.h"],
        f"sources/fmi{fmi}.h": fill(f"fmi{fmi}.h.j2"),
    }
    if fmi == "3":
        files["sources/buildDescription.xml"] = fill("buildDescription.xml.j2", **context)
    made = {
        "modelDescription.xml": f"modelDescription{fmi}.xml.j2",
        "sources/fmu.c": f"fmi{fmi}.c.j2",
    }
    tokenless = {name: fill(one, **context, token="") for name, one in made.items()}
    token = _token({**files, **tokenless})
    return {**files, **{name: fill(one, **context, token=token) for name, one in made.items()}}


def _token(files: dict[str, str]) -> str:
    """A name for exactly this content, in the form that FMI 2 asks for."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{files[name]}\0".encode())
    return f"{{{uuid.UUID(bytes=digest.digest()[:16], version=4)}}}"


def _identifier(recording: Recording) -> str:
    """A name that C and files allow."""
    name = c_identifier(recording.scenario.name)
    return f"breakaway_{name}_{recording.what}" if name else f"breakaway_{recording.what}"


def _context(recording: Recording, fmi: Fmi) -> dict[str, Any]:
    scenario, prefix = recording.scenario, recording.what
    seeds = _seeds(recording)
    groups = {
        "parameters": recording.parameters,
        "seeds": seeds,
        "inputs": recording.inputs,
        "outputs": recording.outputs,
    }
    labelled = {
        name: [{"label": _label(one, prefix, name), "name": one.name} for one in group]
        for name, group in groups.items()
    }
    names = [one.name for one in recording.parameters]
    units = {one.unit for group in groups.values() for one in group} - {"1"} | {"s"}
    return {
        "prefix": prefix,
        "fmi": fmi,
        "identifier": _identifier(recording),
        "title": f"{TITLES[prefix]} of {scenario.name}",
        "description": " ".join(scenario.description.split()),
        "version": _core.__version__,
        **labelled,
        "limits": [repr(one.range.maximum) for one in recording.inputs],
        "watched": scenario.watch is not None and prefix == "controller",
        "period_reference": 1 + names.index(_PERIOD),
        "period_name": _PERIOD,
        "period_s": repr(scenario.timing.control_period_s),
        "stop_s": repr(scenario.timing.duration_s),
        "units": {_fmi_unit(unit): unit_with(unit).base for unit in sorted(units)},
        "variables": _variables(groups, prefix, fmi),
        "sources": ["fmu.c", f"{prefix}.c"],
        "absent": absent(fmi),
    }


def _seeds(recording: Recording) -> list[Variable]:
    """The whole numbers that random draws depend on."""
    if not draws(recording):
        return []
    seed = recording.scenario.seed
    return [
        Variable("seed", "seed", "1", "Seed of all random draws.", seed),
        Variable("run", "run", "1", "Number of the run among the runs of that seed.", 0),
    ]


_COMMANDS = ("force_n", "feed_m_per_s", "stack_share")


def _label(one: Variable, what: What, group: str) -> str:
    """The name of a variable in the unit.

    Parameters are called by their path, with numbers as indices. What goes from a controller to
    a plant and back has one name on both sides, and as an output of a loop.
    """
    if (what, group) == ("controller", "inputs"):
        return f"measured_{one.name}"
    if (what, group) in (("controller", "outputs"), ("plant", "inputs")):
        return f"command_{one.name}" if one.name in _COMMANDS else one.name
    return re.sub(r"\.(\d+)(?=\.|$)", r"[\1]", one.path)


def _variables(groups: dict[str, list[Variable]], what: What, fmi: Fmi) -> list[_Told]:
    told: list[_Told] = []
    for group, variables in groups.items():
        for one in variables:
            name = _label(one, what, group)
            told.append(_told(one, name, group, 1 + len(told), fmi))
    return told


_ROLES = {
    "parameters": ("parameter", "tunable", "exact"),
    "seeds": ("parameter", "fixed", "exact"),
    "inputs": ("input", "discrete", ""),
    "outputs": ("output", "discrete", "calculated"),
}
"""Group -> causality, variability and initial."""


def _told(one: Variable, name: str, group: str, reference: int, fmi: Fmi) -> _Told:
    causality, variability, initial = _ROLES[group]
    whole = group == "seeds"
    bounds = one.range
    low, high = bounds.minimum, bounds.maximum
    minimum = None if low is None else repr(float(low))
    maximum = None if high is None else repr(float(high))
    if whole:
        minimum, maximum = "0", str(_LARGEST_INTEGER if fmi == "2" else 2**64 - 1)
    start = str(int(one.value)) if whole else _number(one.value)
    return _Told(
        name=name,
        reference=reference,
        causality=causality,
        variability="fixed" if one.name == _PERIOD else variability,
        initial=initial,
        description=one.description + _bounds_told(one),
        unit="" if one.unit == "1" else _fmi_unit(one.unit),
        minimum=minimum,
        maximum=maximum,
        start=None if causality == "output" else start,
        whole=whole,
    )


def _fmi_unit(symbol: str) -> str:
    """A unit as Modelica spells it: ``m/s2``."""
    return symbol.replace("^", "")


def _number(value: float) -> str:
    return ("INF" if value > 0 else "-INF") if isinf(value) else repr(float(value))


def _bounds_told(one: Variable) -> str:
    """Say which bounds are not allowed themselves: the standard has no attribute for that."""
    told = []
    if one.range.above:
        told.append(f"more than {one.range.minimum:g}")
    if one.range.below:
        told.append(f"less than {one.range.maximum:g}")
    if one.range.infinite:
        told.append("INF for no limit")
    return f" ({', '.join(told)})" if told else ""


def _packed(files: dict[str, bytes]) -> bytes:
    """Pack files into a zip that depends on nothing else."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            entry.create_system = 3
            archive.writestr(entry, files[name])
    return packed.getvalue()
