"""What a pull tells, as tables and files: a joint of one log, a population of several."""

from __future__ import annotations

from collections.abc import Sequence
from math import isinf
from pathlib import Path
from typing import TYPE_CHECKING

from breakaway.cli.quantity import show
from breakaway.cli.sheet import Sheet
from breakaway.cli.targets import check_target

if TYPE_CHECKING:
    from breakaway.measure.identification import BreakawayReport, JointFile, Population
    from breakaway.measure.logs import Log
    from breakaway.model.scenario import PartPopulation


def check_pulled_target(logs: Sequence[Path], out: Path) -> None:
    """Refuse to write over a log, or over anything but a joint file, or a population of several."""
    from breakaway.measure.identification import JointFile
    from breakaway.model.scenario import load_population

    if len(logs) == 1:
        check_target(logs, out, JointFile.load, "joint file")
    else:
        check_target(logs, out, load_population, "population")


def joint_tables(file: JointFile) -> list[Sheet | str]:
    """Give what a pull tells of a joint, and what is assumed of it."""
    seen = Sheet(
        f"Joint from {file.provenance.log}",
        ["figure", "", "value", "95 % from", "to", "why"],
        numbers=["value", "95 % from", "to"],
        prose=["why"],
    )
    known = {path.split(".")[1]: value for path, value in file.scenario_changes().items()}
    for name, (low, high) in file.interval.items():
        value = known.get(name, getattr(file.pull, name, None))
        why = file.at_least.get(f"joint.{name}", "")
        end = "" if isinf(high) else show(name, high)
        if value is not None:
            bound = "at least" if why else ""
            seen.add(name, bound, show(name, value), show(name, low), end, why)
    rest = Sheet(
        "Not told by the log: assumed",
        ["field", "usual", "from", "to", "why"],
        numbers=["usual", "from", "to"],
        prose=["why"],
    )
    for path, one in file.assumed.items():
        name = path.split(".")[1]
        rest.add(path, *(show(name, v) for v in (one.value, one.low, one.high)), one.why)
    return [seen, rest, *(f"- {note}" for note in file.provenance.notes)]


def write_joint(log: Log, report: BreakawayReport, out: Path, mass_kg: float | None) -> JointFile:
    """Write the joint file of one log."""
    from breakaway.measure.identification import joint_from_pull

    file = joint_from_pull(log, report=report, mass_kg=mass_kg)
    file.save(out)
    return file


def write_parts(
    logs: Sequence[Log],
    reports: Sequence[BreakawayReport],
    found: Population,
    out: Path,
    mass_kg: float | None,
) -> PartPopulation:
    """Write the population of several logs, each a part."""
    from breakaway.measure.identification import joint_from_pull, parts_of_pulls
    from breakaway.model.scenario import save_population

    joints = [
        joint_from_pull(log, report=report)
        for log, report in zip(logs, reports, strict=True)
        if report.events
    ]
    parts = parts_of_pulls(found, joints, name=_name_of(out), mass_kg=mass_kg)
    save_population(parts, out)
    return parts


def _name_of(out: Path) -> str:
    from breakaway.base.text import LONGEST_NAME, shown

    stem = out.stem
    return stem if stem.isprintable() and 0 < len(stem) <= LONGEST_NAME else shown(stem)


def parts_table(parts: PartPopulation) -> Sheet:
    """Give where each distribution of a population is from."""
    sheet = Sheet(f"Population {parts.name}", ["quantity", "distribution", "from"], prose=["from"])
    for name in type(parts.parts).model_fields:
        law = getattr(parts.parts, name).model_dump(exclude_none=True)
        kind = law.pop("distribution")
        numbers = ", ".join(f"{k} {v:.4g}" for k, v in law.items() if isinstance(v, float))
        values = law.get("values", ())
        numbers = f"{values[0]:.4g}" if len(values) == 1 else numbers
        origin = "given" if name == "mass_kg" else "the logs"
        sheet.add(name, f"{kind} {numbers}".strip(), parts.assumed.get(name, origin))
    return sheet
