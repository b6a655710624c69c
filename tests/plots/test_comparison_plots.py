"""Figures of comparisons."""

from __future__ import annotations

import numpy as np
import pytest

from breakaway.model.scenario import Gentleness
from breakaway.run.trials import Case
from breakaway.show.plots.comparison import JUMP_FLOOR_M, Cloud, plot_scatter

GENTLE = Gentleness(peak_over_breakaway_max=1.5, jump_max_m=5e-4, release_velocity_max_m_per_s=0.3)
STRICT = Gentleness(
    peak_over_breakaway_max=1.25, jump_max_m=2.5e-4, release_velocity_max_m_per_s=0.1
)


@pytest.mark.parametrize("jump_m", [(0.0, 0.0, 0.0), (0.0, 2e-5, 1e-3)])
def test_parts_that_do_not_jump_are_in_the_picture(jump_m):
    yes = np.ones(3, dtype=bool)
    cloud = Cloud(
        Case("lugre", "field"), "feed", np.array([0.9, 1.1, 1.2]), np.array(jump_m), yes, yes
    )
    figure = plot_scatter([cloud], GENTLE, STRICT)
    figure.canvas.draw()  # a warning fails the test
    (axes,) = figure.axes
    low, high = axes.get_ylim()
    drawn = np.concatenate([np.atleast_1d(line.get_ydata()) for line in axes.lines])
    assert len(drawn) == 3
    assert drawn.min() == 1e3 * JUMP_FLOOR_M
    assert ((low < drawn) & (drawn < high)).all()
