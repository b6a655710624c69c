"""The figures of a design name what they show, and are the same every time."""

import numpy as np
import pytest

import breakaway as bk
from breakaway.drawing.style import save_figure
from breakaway.show.plots.design import plot_bode, plot_limit_cycle, plot_nyquist, plot_root_locus

BASE = bk.load_scenario("paper_as_computed")
PID = bk.design.SampledPid(bk.design.PidGains(kp=3137.3e3, ki=1283289e3, kd=724.2), 1e-5)
LOOPS = bk.design.sampled_loops(PID, BASE.joint, 1.0)


def texts(axes):
    return [text.get_text() for text in axes.texts]


def test_bode_marks_the_margins():
    gain, phase = plot_bode(LOOPS, "title").axes
    assert {"94.5°", "9.9°"} <= set(texts(phase))
    assert {"×0.58", "×276"} <= set(texts(gain))
    labels = [line.get_label() for line in gain.lines if not line.get_label().startswith("_")]
    assert labels == [
        "stuck (stable)",
        "sliding (stable)",
        "sliding, falling friction at 0.0636 m/s (UNSTABLE)",
    ]
    low, high = gain.get_xlim()
    assert low < 0.1 and high > 0.5 / 1e-5


def test_nyquist_shows_the_point_and_the_circle():
    [axes] = plot_nyquist(LOOPS).axes
    assert "modulus margin 0.17" in texts(axes)
    assert any(
        line.get_marker() == "+" and line.get_xydata().tolist() == [[-1, 0]] for line in axes.lines
    )


def test_root_locus_has_a_panel_for_each_loop():
    *panels, bar = plot_root_locus(LOOPS).axes
    assert [axes.get_title("left").split("\n")[0] for axes in panels] == [
        one.regime for one in LOOPS
    ]
    assert bar.get_ylabel() == "factor on all gains"
    crosses = panels[1].lines[-1].get_xydata()  # 1/ms
    assert np.min(np.abs(crosses @ [1.0, 1j] - (-0.1428 + 1.734j))) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("kd", [724.2, 2500.0])
def test_limit_cycle_is_drawn_with_and_without_one(kd):
    gains = {"kind": "given", "kp_n_per_m": 3137.3e3, "ki_n_per_m_s": 1283289e3, "kd_n_s_per_m": kd}
    run = bk.simulate(BASE.with_(controller={"kind": "pid", "gains": gains}))
    columns = {key: run.trace[key] for key in ("t_s", "reference_m", "velocity_m_per_s")}
    pid = bk.design.SampledPid(bk.design.PidGains(3137.3e3, 1283289e3, kd), 1e-5)
    figure = plot_limit_cycle(bk.design.compare_limit_cycle(pid, BASE.joint, 1.0, **columns))
    assert len(figure.axes) == 3


@pytest.mark.slow
def test_the_same_figure_gives_the_same_bytes(tmp_path):
    for name in ("a.svg", "b.svg"):
        save_figure(plot_root_locus(LOOPS), tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
