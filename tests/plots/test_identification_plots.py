"""The figures of an identification draw what was measured and identified, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from scipy.stats import chi2

from breakaway.drawing.style import COLORS
from breakaway.errors import LogError
from breakaway.measure.identification.comparison import compare_laws
from breakaway.measure.identification.friction import (
    measured_friction,
    simulated_friction,
    steady_friction,
)
from breakaway.measure.identification.identify import identify
from breakaway.measure.identification.laws import SHARED, Law
from breakaway.measure.identification.record import RunSettings, core_record, measured_rows
from breakaway.measure.identification.result import Identification
from breakaway.measure.logs import read_log
from breakaway.measure.logs.log import Log
from breakaway.show.plots.friction import plot_friction_velocity, plot_hysteresis
from breakaway.show.plots.identification import (
    plot_drift,
    plot_fit,
    plot_laws,
    plot_posterior,
    plot_profiles,
    plot_residual,
)

DATA = Path(__file__).parents[3] / "shared" / "data"
TRUE = {
    "coulomb_positive_n": 5.0,
    "coulomb_negative_n": 6.0,
    "viscous_positive_n_s_per_m": 20.0,
    "viscous_negative_n_s_per_m": 25.0,
    "stiction_ratio": 1.4,
    "stribeck_velocity_m_per_s": 0.03,
    "stiffness_n_per_m": 2000.0,
    "damping_n_s_per_m": 5.0,
}
NOISE_N = 0.05
REPEATS = [(0.0, 2.0), (2.0, 4.0)]


def synthetic(rows: int = 4000, noise_n: float = NOISE_N) -> Log:
    """A log of a part with known LuGre friction that moves to and fro, from rest."""
    t_s = np.arange(rows) / 1000.0
    x = -0.1 * np.cos(3 * t_s) - 0.02 * np.cos(11 * t_s)
    motion = Log(t_s=t_s, position_m=x, force_n=np.zeros(rows))
    settings = RunSettings("imposed")
    record = core_record(measured_rows(motion, settings), [(0, rows)], Law("lugre"), settings)
    numbers = [TRUE.get(name, 0.0) for name in SHARED] + [0.0]
    force = np.frombuffer(record.simulate(numbers)[1])
    noise = noise_n * np.random.default_rng(0).standard_normal(rows)
    return Log(t_s=t_s, position_m=x, force_n=force + noise)


@pytest.fixture(scope="module")
def found() -> Identification:
    return identify(synthetic(), law="lugre", asymmetric=True, repeats=REPEATS, starts=4)


@pytest.fixture(scope="module")
def simple() -> Identification:
    return identify(synthetic(), law="coulomb", starts=1)


def line(figure: Figure, label: str, panel: int = 0) -> tuple[np.ndarray, np.ndarray]:
    one = next(one for one in figure.axes[panel].lines if one.get_label() == label)
    return np.asarray(one.get_xdata()), np.asarray(one.get_ydata())


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_measured_and_simulated_are_those_of_the_fit(found):
    figure = plot_fit(found.fit, found.spans)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "force (N)", "residual (mN)", "force (N)"
    ]  # fmt: skip
    for label, source in (
        ("measured", found.fit.measured_force_n),
        ("simulated", found.fit.force_n),
    ):
        t_s, force = line(figure, label)
        assert np.count_nonzero(np.isnan(t_s)) == 1  # no line from one repeat to the next
        drawn = ~np.isnan(t_s)
        places = np.searchsorted(found.fit.t_s, t_s[drawn])
        assert force[drawn] == pytest.approx(source[places])
        assert force[drawn].max() == source.max() and force[drawn].min() == source.min()
    t_s, residual = (np.asarray(v) for v in figure.axes[1].lines[1].get_data())
    drawn = ~np.isnan(t_s)
    places = np.searchsorted(found.fit.t_s, t_s[drawn])
    assert residual[drawn] == pytest.approx(1e3 * found.fit.error[places])
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts == ["repeat 1", "repeat 2"]


def test_a_peak_of_one_row_is_drawn_however_long_the_log(simple):
    rows = 200_000
    force = np.zeros(rows)
    force[123_456] = 7.0
    long = replace(
        simple.fit,
        t_s=np.arange(rows) / 1000.0,
        force_n=np.zeros(rows),
        measured_force_n=force,
        measured_velocity_m_per_s=np.ones(rows),
        segment=np.zeros(rows, dtype=int),
    )
    t_s, drawn = line(plot_fit(long), "measured")
    assert len(drawn) < 4000
    assert t_s[np.argmax(drawn)] == 123.456 and drawn.max() == 7.0


def test_a_position_is_drawn_where_the_fit_compares_positions():
    found = identify(synthetic(), law="coulomb", fixed={"mass_kg": 1.0}, starts=1)
    figure = plot_fit(found.predict(spans=[(3.0, 4.0)], motion="free"))
    assert figure.axes[0].get_ylabel().startswith("position (")


def test_the_residual_of_white_noise_is_white(found):
    figure = plot_residual(found)
    spread, memory = figure.axes
    assert spread.get_xlabel().startswith("residual (mN)")
    lag, correlation = line(figure, "residual", panel=1)
    assert lag[0] == 0.0 and correlation[0] == 1.0
    assert correlation[1] == pytest.approx(found.residual_autocorrelation, abs=0.01)
    assert np.abs(correlation[1:]).max() < 0.1
    assert memory.get_xlabel() == "lag (ms)"


def test_measured_friction_is_force_less_the_rig(found):
    path = measured_friction(found)
    offset = np.where(found.fit.segment == 0, 0.0, found.values["offset_2_n"])
    assert path.friction_n == pytest.approx(found.fit.measured_force_n - offset)
    assert path.velocity_m_per_s == pytest.approx(found.fit.measured_velocity_m_per_s)


def test_steady_friction_is_the_law(found):
    speeds = np.array([-0.2, -0.03, -1e-4, 1e-4, 0.03, 0.2])
    numbers = np.array([TRUE.get(name, 0.0) for name in SHARED])
    sliding = np.where(speeds > 0, 5.0, -6.0) * (1 + 0.4 * np.exp(-((speeds / 0.03) ** 2)))
    expected = sliding + np.where(speeds > 0, 20.0, 25.0) * speeds
    assert steady_friction(found, speeds, numbers) == pytest.approx(expected, rel=1e-6)


def test_friction_over_velocity_has_the_points_and_the_curve(found):
    figure = plot_friction_velocity(found)
    assert legend(figure) == ["measured, every row", "95 % band", "steady curve"]
    axes = figure.axes[0]
    assert axes.get_xlabel() == "velocity (mm/s)" and axes.get_ylabel() == "friction force (N)"
    path = measured_friction(found)
    quiet = len(line(figure, "measured, every row")[0])
    assert 3900 < quiet < 4000
    at, friction = line(figure, "steady curve")
    numbers = found.internals.problem.layout.numbers(found.internals.best)
    assert friction == pytest.approx(steady_friction(found, at / 1e3, numbers))
    sliding = (path.velocity_m_per_s > 0.1) & (np.gradient(path.position_m) > 1e-4)
    expected = np.interp(1e3 * path.velocity_m_per_s[sliding], at, friction)
    assert np.median(np.abs(expected - path.friction_n[sliding])) < 2 * NOISE_N


def test_slow_motion_is_enlarged_for_a_stribeck_peak(found, simple):
    assert len(plot_friction_velocity(found).axes) == 2
    assert len(plot_friction_velocity(simple).axes) == 1


def test_one_speed_gives_no_curve():
    t_s = np.arange(4000) / 1000.0
    way = np.abs(np.mod(t_s, 2.0) - 1.0)
    log = Log(t_s=t_s, position_m=0.1 * way, force_n=5.0 * np.sign(np.gradient(way)) + 0.01 * way)
    one_speed = identify(log, law="coulomb", starts=1)
    with pytest.raises(LogError, match="nearly one speed, 100 to 100 mm/s"):
        plot_friction_velocity(one_speed)


def test_hysteresis_counts_position_from_each_turn(found):
    figure = plot_hysteresis(found)
    assert legend(figure) == ["measured", "simulated"]
    upper, lower = figure.axes
    assert upper.get_xlabel() == "position from the upper turn (mm)"
    assert lower.get_xlabel() == "position from the lower turn (mm)"
    for axes, side in ((upper, 1.0), (lower, -1.0)):
        for one in axes.lines[:-1]:
            x = np.asarray(one.get_xdata())
            assert np.max(side * x) == 0.0
            assert np.abs(x).max() <= 5e3 * 11.0 / found.values["stiffness_n_per_m"] * 1.001


def test_simulated_friction_follows_the_simulated_path(found):
    imposed = simulated_friction(found)
    true = synthetic(noise_n=0.0).force_n
    assert imposed.friction_n == pytest.approx(true, abs=5 * NOISE_N)
    still = 0.05 * np.cos(2 * np.pi * found.fit.t_s)
    free = replace(
        found,
        settings=RunSettings("free"),
        fit=replace(found.fit, position_m=still, force_n=np.zeros(len(still))),
    )
    path = simulated_friction(free)
    assert path.position_m == pytest.approx(still)
    middle = slice(500, 1500)
    speed = -0.1 * np.pi * np.sin(2 * np.pi * found.fit.t_s)
    assert path.velocity_m_per_s[middle] == pytest.approx(speed[middle], abs=1e-3)


def test_a_law_without_bristle_has_no_hysteresis(simple):
    with pytest.raises(LogError, match="law 'coulomb' has no presliding"):
        plot_hysteresis(simple)


def test_a_part_that_never_turns_has_no_hysteresis(found):
    one_way = replace(found, fit=found.predict(spans=[(2.2, 2.9)]), spans=((2.2, 2.9),))
    with pytest.raises(LogError, match="does not reverse within a repeat"):
        plot_hysteresis(one_way)


@pytest.mark.slow
def test_the_posterior_shows_six_parameters_with_their_estimates(found):
    draws = found.draws(500)
    figure = plot_posterior(found, draws)
    assert len(figure.axes) == 21
    chosen = plot_posterior(found, draws, names=["coulomb_positive_n", "stiffness_n_per_m"])
    shown = chosen.axes
    assert [axes.get_xlabel() for axes in shown] == [
        "", "Coulomb\npositive\n(N)", "stiffness\n(kN/m)"
    ]  # fmt: skip
    marked = [axes.lines[0].get_xdata()[0] for axes in shown]
    coulomb, stiffness = (found.values[n] for n in ("coulomb_positive_n", "stiffness_n_per_m"))
    assert marked == pytest.approx([coulomb, coulomb, stiffness / 1e3])
    assert shown[1].lines[1].get_ydata()[0] == pytest.approx(stiffness / 1e3)


def test_a_posterior_needs_two_parameters_that_were_drawn(found):
    with pytest.raises(LogError, match="'nothing' was not drawn"):
        plot_posterior(found, found.draws(50), names=["nothing"])
    with pytest.raises(LogError, match="fewer than two"):
        plot_posterior(found, {"coulomb_positive_n": np.arange(5.0)})


def test_profiles_show_deviance_level_and_interval(simple):
    one = simple.profile("coulomb_n")
    axes = plot_profiles(simple, [one]).axes[0]
    drawn = next(each for each in axes.lines if each.get_label() == "profile")
    assert np.asarray(drawn.get_xdata()) == pytest.approx(one.values)
    assert np.asarray(drawn.get_ydata()) == pytest.approx(one.deviance)
    level = next(each for each in axes.lines if each.get_label() == "95 % quantile of χ²")
    assert level.get_ydata()[0] == pytest.approx(chi2.ppf(0.95, 1))
    assert axes.get_xlabel() == "Coulomb (N)"
    with pytest.raises(LogError, match="no profiles"):
        plot_profiles(simple, [])


def test_laws_that_do_not_pay_are_gray():
    t_s = np.arange(3000) / 1000.0
    x, v = 0.1 * np.sin(3 * t_s), 0.3 * np.cos(3 * t_s)
    noise = 0.1 * np.random.default_rng(0).standard_normal(3000)
    log = Log(t_s=t_s, position_m=x, force_n=5.0 * np.sign(v) + 20.0 * v + noise)
    laws = compare_laws(log, held_out=(2.0, 3.0), laws=["coulomb", "stribeck"], starts=1)
    error, aic = plot_laws(laws).axes
    assert [tick.get_text() for tick in error.get_yticklabels()] == ["Coulomb", "Stribeck"]
    assert error.get_xlabel() == "held-out error (mN)"
    for one, place in (("pays", 0), ("does not pay", 1)):
        dot = next(each for each in error.lines if each.get_label() == one)
        assert dot.get_xdata() == pytest.approx([1e3 * laws[place].held_out_error])
        assert list(dot.get_ydata()) == [place]
    colors = [to_hex(each.get_color()) for each in error.lines]
    assert colors == [COLORS["ours"].lower(), COLORS["reference"].lower()]
    assert min(each.get_xdata()[0] for each in aic.lines) == 0.0
    with pytest.raises(LogError, match="fewer than two laws"):
        plot_laws(laws[:1])


def test_drift_shows_each_offset_with_its_interval(found, simple):
    axes = plot_drift(found).axes[0]
    estimate = found["offset_2_n"]
    bar = axes.containers[0]
    assert bar.lines[0].get_ydata() == pytest.approx([estimate.value])
    segment = bar.lines[2][0].get_segments()[0]
    assert segment[:, 1] == pytest.approx([estimate.low, estimate.high])
    assert [text.get_text() for text in axes.texts] == ["0 by definition"]
    with pytest.raises(LogError, match="one repeat"):
        plot_drift(simple)


@pytest.mark.slow
@pytest.mark.skipif(not (DATA / "tribometer").exists(), reason="the measured log is not here")
def test_a_tribometer_shows_whole_loops_and_no_curve():
    log = read_log(DATA / "tribometer" / "tribometer.csv")
    real = identify(log, law="elasto_plastic", repeats=[(0.0, 35.0)], starts=1)
    figure = plot_hysteresis(real)
    assert [axes.get_xlabel() for axes in figure.axes] == ["position (µm)"]
    x, friction = line(figure, "measured")
    assert x == pytest.approx(1e6 * real.fit.measured_position_m)
    assert friction == pytest.approx(real.fit.measured_force_n - real.values["offset_n"])
    with pytest.raises(LogError, match="nearly one speed"):
        plot_friction_velocity(real)
