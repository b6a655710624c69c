"""The figures of breakaway events show what was read, never a line across a gap."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from breakaway.drawing.style import save_figure
from breakaway.errors import LogError
from breakaway.measure.identification.events import find_breakaway_events
from breakaway.measure.logs.log import Log
from breakaway.show.plots.events import plot_breakaway, plot_breakaway_ratios


def start(*, gap: bool = False, sign: float = 1.0, later: bool = False) -> Log:
    t = np.arange(0.0, 3.0, 0.01)
    x = 2e-4 * np.clip(t - 0.5, 0.0, 0.5) + 0.01 * np.maximum(t - 1.0, 0.0)
    force = np.where(t <= 1.0, 180.0 * np.clip(t - 0.5, 0.0, None), 40.0)
    kept = ~((t > 0.975) & (t < 1.3)) if gap else t >= (1.5 if later else 0.0)
    return Log(t_s=t[kept], position_m=sign * x[kept], force_n=sign * force[kept])


def labels(figure: Figure) -> list[str]:
    legend = figure.axes[0].get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def drawn(log: Log) -> Figure:
    return plot_breakaway(log, find_breakaway_events(log))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_shows_loading_peak_and_level(sign: float) -> None:
    figure = drawn(start(sign=sign))
    assert [axes.get_ylabel() for axes in figure.axes] == ["force (N)", "position (mm)"]
    assert labels(figure) == ["loading", "sliding level", "breakaway"]
    peak = next(line for line in figure.axes[0].lines if line.get_label() == "breakaway")
    assert peak.get_ydata() == pytest.approx([90.0 * sign])
    assert "breakaway 90 N, 2.25 times sliding" in figure.get_suptitle()


def test_a_lower_bound_says_so_and_its_gap_stays_empty() -> None:
    figure = drawn(start(gap=True))
    assert "largest recorded load" in labels(figure)
    assert "breakaway at least 84.6 N" in figure.get_suptitle()
    assert "gap of 0.33 s" in [text.get_text() for text in figure.axes[0].texts]
    line = figure.axes[0].lines[0]
    t, force = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.count_nonzero(np.isnan(force)) == 1
    assert not np.any((t > 0.975) & (t < 1.29))


def test_a_refusal_is_drawn_with_its_reason() -> None:
    assert "already moving at 10 mm/s" in drawn(start(later=True)).get_suptitle()


def test_another_event_must_be_there() -> None:
    log = start()
    with pytest.raises(LogError, match="event is 1; it must be 0 to 0"):
        plot_breakaway(log, find_breakaway_events(log), event=1)


def test_ratios_have_a_row_for_each_log(tmp_path: Path) -> None:
    reports = [find_breakaway_events(log) for log in (start(), start(gap=True), start(later=True))]
    figure = plot_breakaway_ratios(reports)
    axes = figure.axes[0]
    assert len(axes.get_yticklabels()) == 3
    assert figure.get_suptitle().endswith("1 seen (dots), 1 lower bounds (arrows)")
    assert any("already moving" in text.get_text() for text in axes.texts)
    with pytest.raises(LogError, match="no reports to plot"):
        plot_breakaway_ratios([])
    save_figure(figure, tmp_path / "ratios.svg")


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_log_gives_the_same_file(tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        save_figure(drawn(start(gap=True)), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()
