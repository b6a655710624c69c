"""Figures show what tables say, whatever these say."""

import pytest

from breakaway.show.plots.tuning import plot_history, plot_pareto, plot_slices

NAMES = {"strict_share": False, "median_time_to_release_s": True, "p99_impacts": True}
SPANS = {"controller.speed_m_per_s": (0.01, 0.05, True), "actuator.gap_m": (0.0, 1e-3, False)}


def row(number, state, share, time):
    return {
        "evaluation": number, "state": state, "recommended": number == 1,
        "controller.speed_m_per_s": 0.01 + 0.005 * number, "actuator.gap_m": 1e-4 * number,
        "strict_share": share, "median_time_to_release_s": time, "p99_impacts": 3.0,
    }  # fmt: skip


EVALUATIONS = [
    row(0, "feasible", 0.5, 0.3),
    row(1, "feasible", 0.6, 0.2),
    row(2, "infeasible", 0.7, None),
    row(3, "infeasible", 0.9, 0.1),
    row(4, "refused", None, None),
    row(5, "feasible", 0.4, 0.1),
]
FRONT = [
    EVALUATIONS[i]
    | {f"{n}_{on}": EVALUATIONS[i][n] for n in NAMES for on in ("training", "unseen")}
    for i in (1, 5)
]
START = {"strict_share": 0.5, "median_time_to_release_s": float("inf"), "p99_impacts": 1.0}


@pytest.mark.parametrize("evaluations", [EVALUATIONS, EVALUATIONS[4:5], EVALUATIONS[:1]])
def test_history(evaluations):
    figure = plot_history("a", evaluations, NAMES)
    assert len(figure.axes) == 3
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels[0] == "strict share" and labels[2] == "p99 impacts"
    figure.canvas.draw()


def test_the_best_so_far_is_of_feasible_trials():
    axes = plot_history("a", EVALUATIONS, NAMES).axes[0]
    (line,) = [line for line in axes.lines if line.get_label() == "best so far"]
    assert line.get_ydata().tolist() == [0.5, 0.6, 0.6, 0.6, 0.6, 0.6]


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("front", [FRONT, FRONT[:1], []])
def test_front(count, front):
    less = dict(list(NAMES.items())[:count])
    figure = plot_pareto("a", EVALUATIONS, front, less, START)
    assert len(figure.axes) == count - 1
    assert figure.axes[0].get_xlabel() == "median time to release (ms); less is better"
    figure.canvas.draw()


@pytest.mark.parametrize("evaluations", [EVALUATIONS, EVALUATIONS[4:5]])
@pytest.mark.parametrize("objective", NAMES)
def test_slices(evaluations, objective):
    figure = plot_slices("a", evaluations, objective, SPANS)
    figure.canvas.draw()
    assert [axes.get_xlabel() for axes in figure.axes] == ["speed (mm/s)", "gap (mm)"]
    assert figure.axes[0].get_xscale() == "log"
