"""Draw the picture of the README: the paper's extraction."""

from __future__ import annotations

from pathlib import Path

import breakaway as bk
from breakaway.plots.style import save_figure

IMAGES = Path(__file__).parents[1] / "docs" / "images"


def main() -> None:
    """Simulate the preset and save its figure."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    run = bk.simulate(bk.load_scenario("paper_as_computed"))
    save_figure(run.plot(), IMAGES / "extraction.png")


if __name__ == "__main__":
    main()
