"""A joint file laid over a scenario; without one, nothing of identification is imported."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from breakaway.cli.overlay import Overlay
    from breakaway.model.scenario import Scenario


def laid(scenario: Scenario, path: Path | None) -> tuple[Scenario, Overlay | None]:
    """Lay a joint file over a scenario where one is given.

    Raises
    ------
    ScenarioError
        As `overlay_of`.

    """
    if path is None:
        return scenario, None
    from breakaway.cli.overlay import overlay_of

    overlay = overlay_of(path, scenario)
    return overlay.scenario, overlay
