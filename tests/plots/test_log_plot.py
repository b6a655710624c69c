"""The figure of a log: every sample, broken at gaps, findings where they are."""

import numpy as np

import breakaway as bk
from breakaway.show.plots.log import BINS, _kept, plot_log


def _log() -> bk.Log:
    t_s = np.r_[np.arange(100) / 100.0, 2.0 + np.arange(100) / 100.0]
    force = 5.0 * np.sin(7.0 * t_s)
    return bk.Log(t_s=t_s, position_m=1e-3 * t_s, force_n=force, channels={"pressure_pa": 0 * t_s})


def test_lines_break_at_gaps_and_nothing_is_left_out() -> None:
    log = _log()
    figure = plot_log(log)
    force, position, pressure = figure.axes
    assert [axes.get_ylabel().split(" (")[0] for axes in figure.axes] == [
        "force",
        "position",
        "pressure",
    ]
    solid = [line for line in force.lines if line.get_linestyle() == "-"]
    assert [len(line.get_xdata()) for line in solid] == [100, 100]
    drawn = np.concatenate([np.asarray(line.get_ydata(), float) for line in solid])
    np.testing.assert_array_equal(drawn, log.force_n)
    assert len(position.patches) == 1
    assert [note.get_text() for note in force.texts] == ["gap"]
    assert not pressure.texts
    for axes in figure.axes:
        (mark,) = [line for line in axes.lines if line.get_linestyle() == "--"]
        assert mark.get_xdata()[0] == 0.99


def test_the_extremes_of_a_long_log_are_kept() -> None:
    values = np.random.default_rng(0).standard_normal(100_000)
    values[[777, 55_555]] = 9.0, -9.0
    kept = _kept(values)
    assert len(kept) <= 2 * BINS
    assert {777, 55_555} <= set(kept.tolist())
    assert values[kept].max() == values.max() and values[kept].min() == values.min()
