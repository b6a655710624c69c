"""The figure of a run shows what happened, keeps every peak, and is the same every time."""

from pathlib import Path
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

import breakaway as bk
from breakaway.drawing.run import BINS, plot_run
from breakaway.drawing.style import house_style, save_figure, scaled
from breakaway.model.scenario.laws import LAWS

BASE = bk.load_scenario("paper_as_computed")


@pytest.fixture(scope="module")
def run() -> bk.Run:
    return bk.simulate(BASE)


def events(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.axes[0].texts]


def test_shows_position_error_and_forces(run: bk.Run) -> None:
    figure = plot_run(run)
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["position (mm)", "error (µm)", "force (N)"]
    assert figure.axes[-1].get_xlabel() == "time (ms)"
    assert events(figure) == ["breakaway", "release"]
    forces = {line.get_label(): line for line in figure.axes[2].lines}
    loose = np.asarray(forces["breakaway force $F_s(x)$"].get_ydata())
    assert loose[0] == pytest.approx(450.0)
    assert loose[-1] == pytest.approx(9.81, rel=1e-2)


def test_a_long_trace_keeps_its_peaks_and_stays_small() -> None:
    long = bk.simulate(BASE.with_({"trace.every_samples": 1}))
    applied = next(line for line in plot_run(long).axes[2].lines if line.get_label() == "applied")
    drawn = np.asarray(applied.get_ydata())
    assert len(drawn) == 2 * BINS < len(long.trace["t_s"])
    assert drawn.max() == long.trace["applied_force_n"].max()
    assert np.all(np.diff(np.asarray(applied.get_xdata())) >= 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("force_n", [400.0, 1e-9])
def test_a_diverged_run_is_drawn_as_far_as_it_goes(force_n: float, tmp_path: Path) -> None:
    run = bk.simulate(BASE.with_({"limits.diverged_force_n": force_n}))
    assert run.outcome == "diverged"
    figure = plot_run(run)
    assert events(figure)[-1] == "diverged"
    save_figure(figure, tmp_path / "figure.png")


def test_gaps_stand_for_what_is_not_finite(run: bk.Run, tmp_path: Path) -> None:
    trace = {name: column[:50].copy() for name, column in run.trace.items()}
    trace["applied_force_n"][-2:] = [np.inf, np.nan]
    wild = bk.Run(
        run.outcome, run.metrics, MappingProxyType(trace), run.scenario, run.seed, run.run_index
    )
    save_figure(plot_run(wild), tmp_path / "figure.svg")


def test_a_run_without_a_trace_names_the_remedy() -> None:
    run = bk.simulate(BASE.with_({"trace.every_samples": 0}))
    with pytest.raises(bk.ScenarioError, match=r"trace\.every_samples"):
        run.plot()


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_run_gives_the_same_file(run: bk.Run, tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        save_figure(plot_run(run), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


@pytest.mark.slow
def test_the_users_own_style_neither_leaks_in_nor_is_lost(run: bk.Run, tmp_path: Path) -> None:
    save_figure(plot_run(run), tmp_path / "plain.svg")
    with mpl.rc_context({"axes.facecolor": "black", "font.size": 30.0, "lines.linewidth": 9.0}):
        before = dict(mpl.rcParams)
        save_figure(plot_run(run), tmp_path / "odd.svg")
        assert dict(mpl.rcParams) == before
    assert (tmp_path / "odd.svg").read_bytes() == (tmp_path / "plain.svg").read_bytes()
    with house_style():
        assert mpl.rcParams["svg.hashsalt"] == "breakaway"


@pytest.mark.parametrize(
    ("values", "unit", "expected"),
    [
        ([], "m", (1.0, "m")),
        ([0.0], "m", (1.0, "m")),
        ([np.nan, 2e-3], "m", (1e3, "mm")),
        ([1e-3], "m", (1e3, "mm")),
        ([-5e-13], "m", (1e9, "nm")),
        ([4000.0], "s", (1.0, "s")),
        ([-2e7, 1.0], "N", (1e-6, "MN")),
    ],
)
def test_axes_take_readable_units(
    values: list[float], unit: str, expected: tuple[float, str]
) -> None:
    factor, name = scaled(values, unit)
    assert factor == pytest.approx(expected[0])
    assert name == expected[1]


@pytest.mark.parametrize("law", LAWS)
def test_every_law_is_drawn(law: str) -> None:
    parts = bk.load_population("seized_parts").model_copy(update={"duration_s": 0.01})
    trial = bk.run_trial(parts, bk.load_method("steady_feed"), law=law, runs=range(1), seed=1)
    assert len(trial.replay(0, trace_every=20).plot().axes) >= 2
