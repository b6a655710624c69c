"""Figures of studies show what the tables say, in bytes that do not change."""

import numpy as np
import pytest

from breakaway.drawing.style import save_figure
from breakaway.show.plots.study import plot_compare, plot_robustness, plot_sensitivity, plot_sweep

pytestmark = pytest.mark.slow


def point(labels, shift=0.0):
    row = dict(labels)
    for name, value in (("peak_force_n", 500.0), ("time_to_release_s", 0.2)):
        row |= {f"{name}_median": value + shift}
        row |= {f"{name}_p05": value + shift - 0.1, f"{name}_p95": value + shift + 0.1}
    return row | {
        "released": 9, "released_share": 0.9, "released_low": 0.8, "released_high": 0.95
    }  # fmt: skip


def drawn(figure, tmp_path):
    """Assert that a figure can be saved, twice to the same bytes."""
    for suffix in ("png", "svg"):
        save_figure(figure, tmp_path / f"figure.{suffix}")
    first = (tmp_path / "figure.svg").read_bytes()
    save_figure(figure, tmp_path / "figure.svg")
    assert (tmp_path / "figure.svg").read_bytes() == first
    return figure


def test_a_sweep_over_numbers_has_lines_of_medians(tmp_path):
    rows = [
        point({"joint.stiction_n": x, "disturbance.law": law}, x)
        for x in (100.0, 200.0, 400.0, 800.0)
        for law in ("uniform", "gaussian")
    ]
    paths = ["disturbance.law", "joint.stiction_n"]
    figure = drawn(plot_sweep("s", rows, paths, ["peak_force_n", "time_to_release_s"]), tmp_path)
    force, release, share = figure.axes
    assert [a.get_ylabel() for a in figure.axes] == [
        "peak force (kN)", "time to release (s)", "share released"
    ]  # fmt: skip
    assert share.get_xlabel() == "joint.stiction_n (N)"
    assert share.get_xscale() == "log"
    assert [line.get_label() for line in force.lines] == [
        "disturbance.law = uniform", "disturbance.law = gaussian"
    ]  # fmt: skip
    np.testing.assert_allclose(force.lines[0].get_ydata(), [0.6, 0.7, 0.9, 1.3])
    assert len(release.lines) == 2


def test_a_sweep_over_texts_has_points(tmp_path):
    rows = [point({"disturbance.law": law}) for law in ("uniform", "gaussian")]
    figure = drawn(plot_sweep("s", rows, ["disturbance.law"], ["peak_force_n"]), tmp_path)
    assert [t.get_text() for t in figure.axes[-1].get_xticklabels()] == ["uniform", "gaussian"]


def test_metrics_that_no_run_has_are_left_out(tmp_path):
    rows = [point({"part.mass_kg": m}) | {"peak_force_n_median": None} for m in (1.0, 2.0)]
    figure = drawn(plot_sweep("s", rows, ["part.mass_kg"], ["peak_force_n"]), tmp_path)
    assert [a.get_ylabel() for a in figure.axes] == ["share released"]


def test_more_series_than_colors_are_told(tmp_path):
    rows = [
        point({"part.mass_kg": float(m), "joint.stiction_n": float(s)})
        for m in range(1, 8)
        for s in range(1, 10)
    ]
    figure = drawn(
        plot_sweep("s", rows, ["part.mass_kg", "joint.stiction_n"], ["peak_force_n"]), tmp_path
    )
    assert "5 of 7 series" in figure.get_suptitle()


@pytest.mark.parametrize("failures", [[0], [0, 50, 3], [100, 100]])
def test_robustness_shows_the_trail(tmp_path, failures):
    trail = [
        {
            "disturbance.var": 0.1 * k,
            "runs": 100,
            "failures": n,
            "failure_probability": n / 100,
            "upper_bound": min(1.0, n / 100 + 0.03),
            "survived": n < 4,
        }
        for k, n in enumerate(failures)
    ]
    figure = plot_robustness("r", trail, "disturbance.var", "a [b] $c", 0.05, (0.0, 0.5))
    axes = drawn(figure, tmp_path).axes[0]
    assert axes.get_yscale() == "log"
    steps = {text.get_text() for text in axes.texts}
    assert {str(k + 1) for k in range(len(failures))} | {"asked for: 0.05"} == steps
    assert r"a [b] \$c" in figure.get_suptitle()


def test_sensitivity_has_bars_for_each_input(tmp_path):
    rows = [
        {
            "metric": metric,
            "input": name,
            "first_order": 0.3,
            "first_order_error": 0.05,
            "total_order": 0.5,
            "total_order_error": 0.05,
        }
        for metric in ("peak_force_n", "iae_m_s")
        for name in ("joint.stiction_n", "disturbance draws")
    ]
    figure = drawn(plot_sensitivity("s", rows), tmp_path)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["peak force", "IAE"]
    assert len(figure.axes[0].patches) == 4


def test_a_comparison_without_pairs_says_so(tmp_path):
    shares = {f"{name}_share": 0.0 for name in ("not_released", "diverged", "limit_exceeded")}
    outcomes = [
        {"controller": name, "runs": 10, "released_share": 1.0, **shares}
        for name in ("a", "b", "c")
    ]
    keys = ("difference", "difference_low", "difference_high", "difference_p05", "difference_p95")
    differences = [
        {"controller": "b", "metric": "peak_force_n", "pairs": 0, **dict.fromkeys(keys)},
        {"controller": "c", "metric": "peak_force_n", "pairs": 3}
        | dict(zip(keys, (5.0, None, None, 4.0, 6.0), strict=True)),
    ]
    figure = drawn(plot_compare("c", outcomes, differences), tmp_path)
    assert [text.get_text() for text in figure.axes[1].texts] == ["no pairs"]
