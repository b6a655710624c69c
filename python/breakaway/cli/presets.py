"""``breakaway presets``: what comes with breakaway, and which command takes it."""

from __future__ import annotations

from dataclasses import dataclass

from breakaway.cli.options import Json
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import say, say_json


@dataclass(frozen=True)
class Room:
    """Presets of one kind."""

    kind: str
    """What they are."""
    folder: str
    """Where they are kept."""
    title: str
    """What they are, for people."""
    used_by: tuple[str, ...]
    """What takes them by name."""


ROOMS = (
    Room("scenario", "", "Scenarios", ("run", "design", "export", "study", "init")),
    Room("method", "methods", "Methods", ("compare --method", "tune", "init --kind method")),
    Room("population", "populations", "Populations", ("compare", "tune", "init --kind population")),
    Room("rig", "rigs", "Rigs", ("advise --rig",)),
    Room("stack", "stacks", "Piezo stacks for a method's [actuator.tip]", ()),
)


def presets(
    json: Json = False,
) -> None:
    """List what comes with breakaway: scenarios, methods, populations, rigs and piezo stacks."""
    from breakaway.model.scenario.files import preset_descriptions

    found = {room: preset_descriptions(room.folder) for room in ROOMS}
    if json:
        say_json(
            [
                {"name": name, "description": text, "kind": room.kind, "used_by": room.used_by}
                for room, described in found.items()
                for name, text in described.items()
            ]
        )
        return
    for room, described in found.items():
        used_by = ", ".join(room.used_by) or "load_stack in Python"
        shown = Sheet(f"{room.title} ({used_by})", ["name", "description"], prose=["description"])
        for name, text in described.items():
            shown.add(name, text)
        say(shown)
