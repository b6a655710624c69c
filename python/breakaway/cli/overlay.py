"""An identified joint laid over a scenario, and which value came from where."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from breakaway.cli.quantity import show
from breakaway.cli.sheet import Sheet
from breakaway.design.pole_placement import residual_n
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario import PolePlacement, Scenario, gain_sets
from breakaway.run.overlay import lay_file_over
from breakaway.run.resolution import resolve

WEIGHT = "left out, so the weight of the identified mass"


@dataclass(frozen=True)
class Overlay:
    """A scenario with an identified joint."""

    path: Path
    """The joint file."""
    joint_file: JointFile
    """What it says."""
    scenario: Scenario
    """The changed scenario."""

    def from_log(self) -> dict[str, float]:
        """Fields that the log gave."""
        return self.joint_file.scenario_changes()

    def weight_n(self) -> float | None:
        """Give the residual force where it follows from the identified mass."""
        if self.scenario.joint.residual_n is not None:
            return None
        return residual_n(self.scenario.joint, self.scenario.part.mass_kg)

    def from_scenario(self) -> dict[str, tuple[float, str]]:
        """Fields that the scenario gave, because the log cannot tell; with the reason."""
        found = {
            field: (_value(self.scenario, field), reason)
            for field, reason in self.joint_file.not_identified.items()
        }
        return {field: (value, why) for field, (value, why) in found.items() if value is not None}

    def unused(self) -> dict[str, tuple[float, str]]:
        """Figures of the log that no scenario has a place for; with the reason."""
        each = self.joint_file.asymmetric
        same = "the friction laws are the same in both directions"
        rig = {
            "rig.offset_n": (self.joint_file.rig.offset_n, "belongs to the rig, not to the joint")
        }
        if each is None:
            return rig
        return (
            rig
            | {"asymmetric.mass_kg": (each.mass_kg, "the symmetric fit's mass is used")}
            | {
                f"asymmetric.{name}": (getattr(each, name), same)
                for name in type(each).model_fields
                if name not in ("mass_kg", "standard_error")
            }
        )

    def gains(self) -> str:
        """Say what becomes of the controller's gains."""
        kinds = {
            "designed" if isinstance(gains, PolePlacement) else "given"
            for gains in gain_sets(self.scenario.controller).values()
        }
        texts = {
            "designed": "redesigned for the identified joint",
            "given": "kept as the scenario gives them: not designed for the identified joint",
        }
        if len(kinds) == 1:
            return f"gains: {texts[kinds.pop()]}"
        return f"gains: where designed, {texts['designed']}; where given, {texts['given']}"

    def notes(self) -> list[str]:
        """Say what to keep in mind about this mixture of log and scenario."""
        notes = [self.gains()]
        joint = self.scenario.joint
        if joint.coulomb_n > joint.stiction_n:
            notes.append(
                f"the log's coulomb_n exceeds the scenario's stiction_n of {joint.stiction_n:g} N: "
                "this joint slides at more than breaks it loose; set joint.stiction_n"
            )
        return notes

    def tables(self) -> list[Sheet | str]:
        """Give the tables that a person reads."""
        log = self.joint_file.provenance.log
        shown = Sheet(
            f"Joint from {self.path}",
            ["field", "value", "from", "why"],
            numbers=["value"],
            prose=["why"],
        )
        for field, value in self.from_log().items():
            shown.add(field, show(field, value), log, "identified")
        if (weight_n := self.weight_n()) is not None:
            shown.add("joint.residual_n", show("residual_n", weight_n), log, WEIGHT)
        for field, (value, reason) in self.from_scenario().items():
            shown.add(field, show(field, value), "scenario", reason)
        for field, (value, reason) in self.unused().items():
            shown.add(field, show(field, value), "not used", reason)
        return [shown, *self.notes(), ""]

    def to_dict(self) -> dict[str, Any]:
        """Give the same for JSON."""
        return {
            "file": str(self.path),
            "log": self.joint_file.provenance.log,
            "from_log": self.from_log(),
            "weight_as_residual_n": self.weight_n(),
            "from_scenario": {
                field: {"value": value, "reason": reason}
                for field, (value, reason) in self.from_scenario().items()
            },
            "not_used": {
                field: {"value": value, "reason": reason}
                for field, (value, reason) in self.unused().items()
            },
            "notes": self.notes(),
        }


def overlay_of(path: Path, scenario: Scenario) -> Overlay:
    """Lay a joint file over a scenario, and keep what is told of it.

    Raises
    ------
    ScenarioError
        As `breakaway.lay_over`, or the controller cannot be designed for the joint.

    """
    joint_file = JointFile.load(path)
    changed = lay_file_over(scenario, joint_file, str(path))
    try:
        resolve(changed)  # finds what cannot be designed while the joint file can be named
    except ScenarioError as error:
        raise ScenarioError(f"{path} laid over {scenario.name}: {error}") from None
    return Overlay(path, joint_file, changed)


def _value(scenario: Scenario, field: str) -> float | None:
    """Value of a field, None where the scenario has no such field."""
    found: object = scenario
    for key in field.split("."):
        found = getattr(found, key, None)
    return found if isinstance(found, float) else None
