"""An identified joint laid over a scenario, and which value came from where."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from breakaway.cli.quantity import show
from breakaway.cli.sheet import Sheet
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario import PolePlacement, Scenario, gain_sets
from breakaway.run.overlay import lay_file_over
from breakaway.run.resolution import resolve


@dataclass(frozen=True)
class Overlay:
    """A scenario with an identified joint."""

    path: Path
    """The joint file."""
    joint_file: JointFile
    """What it says."""
    before: Scenario
    """The scenario as it was."""
    scenario: Scenario
    """The changed scenario."""

    def from_log(self) -> dict[str, float]:
        """Fields that the log gave."""
        return self.joint_file.scenario_changes()

    def law(self) -> tuple[str, str]:
        """Give what the friction law is from, and why."""
        if self.joint_file.joint.law is None:
            return "scenario", "the fit does not tell how a stuck joint yields"
        return self.joint_file.provenance.log, "the fit was made with it"

    def residual(self) -> tuple[float | None, str]:
        """Give the friction left at the end of the guide, in N, and why where none stated it."""
        source = self.scenario.joint_source
        return self.scenario.joint.residual_n, source.residual if source else ""

    def from_scenario(self) -> dict[str, tuple[float, str]]:
        """Fields that the scenario gave, because the log cannot tell; with the reason."""
        found = {
            field: (_value(self.scenario, field), reason)
            for field, reason in self.joint_file.not_identified.items()
        }
        return {field: (value, why) for field, (value, why) in found.items() if value is not None}

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
            shown.add(field, show(field, value), log, self.joint_file.origin(field))
        shown.add("joint.law", self.scenario.joint.law, *self.law())
        left_n, because = self.residual()
        if because and left_n is not None:
            shown.add("joint.residual_n", show("residual_n", left_n), "share", because)
        for field, (value, reason) in self.from_scenario().items():
            own = _value(self.before, field) is not None
            shown.add(field, show(field, value), "scenario" if own else "usual", reason)
        for field, (value, reason) in self.joint_file.dropped().items():
            shown.add(field, show(field, value), "not used", reason)
        return [shown, self.gains(), ""]

    def to_dict(self) -> dict[str, Any]:
        """Give the same for JSON."""
        return {
            "file": str(self.path),
            "log": self.joint_file.provenance.log,
            "from_log": self.from_log(),
            "origin": {field: self.joint_file.origin(field) for field in self.from_log()},
            "law": {"value": self.scenario.joint.law, "reason": self.law()[1]},
            "residual_n": {"value": self.residual()[0], "reason": self.residual()[1]},
            "from_scenario": {
                field: {"value": value, "reason": reason}
                for field, (value, reason) in self.from_scenario().items()
            },
            "not_used": {
                field: {"value": value, "reason": reason}
                for field, (value, reason) in self.joint_file.dropped().items()
            },
            "gains": self.gains(),
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
    return Overlay(path, joint_file, scenario, changed)


def _value(scenario: Scenario, field: str) -> float | None:
    """Value of a field, None where the scenario has no such field."""
    found: object = scenario
    for key in field.split("."):
        found = getattr(found, key, None)
    return found if isinstance(found, float) else None
