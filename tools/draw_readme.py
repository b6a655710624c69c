"""Draw the pictures of the README: the paper's extraction, an advice, figure 10 of a full run."""

from __future__ import annotations

import sys
from pathlib import Path

import breakaway as bk
from breakaway.ask.advice.content import figures_of
from breakaway.ask.reproduction.figure_10 import draw_figure_10
from breakaway.ask.reproduction.survey import read_survey
from breakaway.drawing.style import save_figure

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
FULL_RUN = ROOT / "out" / "reproduction"


def main(full_run: Path) -> None:
    """Simulate the preset, ask for advice, and save both; draw figure 10 where there is its data.

    ``full_run`` is what ``breakaway reproduce --full --out`` was given.
    """
    IMAGES.mkdir(parents=True, exist_ok=True)
    run = bk.simulate(bk.load_scenario("paper_as_computed"))
    save_figure(run.plot(), IMAGES / "extraction.png")
    advice = bk.advise("seized_parts", "piezo_tip", budget_s=1e6, parts_max=128)
    save_figure(figures_of(advice)["spared"], IMAGES / "advice.png")
    try:
        ranges = read_survey(full_run / "figure_10")
    except bk.StudyError as error:
        print(f"figure_10.png stays as it is: {error}")
        return
    save_figure(draw_figure_10(ranges), IMAGES / "figure_10.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FULL_RUN)
