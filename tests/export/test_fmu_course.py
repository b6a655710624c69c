"""FMUs that are run compute what is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import fmpy
import numpy as np
import pytest
from tests.export.kinds import CONTROLLERS
from tests.export.units import VERSIONS, Exported, impacts, paper

import breakaway as bk

pytestmark = pytest.mark.slow

SCENARIOS = {"paper": paper, "impacts": impacts}

COLUMNS = ("position_m", "velocity_m_per_s", "applied_force_n", "joint_force_n")


def course(trace: Mapping[str, np.ndarray], column: str) -> np.ndarray:
    """What a unit shows after each period: a trace has forces in the row where it begins."""
    return trace[column][:-1] if column.endswith("force_n") else trace[column][1:]


def relative(ours: np.ndarray, theirs: np.ndarray) -> float:
    """The largest difference, relative to the largest value."""
    return float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_controller_and_plant_coupled(name: str, fmi: str, tmp_path: Path) -> None:
    scenario = SCENARIOS[name]()
    trace, period = bk.simulate(scenario).trace, scenario.timing.control_period_s
    count = len(trace["t_s"]) - 1
    controller = Exported(scenario, "controller", fmi, tmp_path).instance("controller").start()
    plant = Exported(scenario, "plant", fmi, tmp_path).instance("plant").start()
    rows = []
    for k in range(count):
        for wanted in controller.exported.inputs:
            controller[wanted] = plant[wanted]
        controller.step(k * period, period)
        for wanted in plant.exported.inputs:
            plant[wanted] = controller[wanted]
        plant.step(k * period, period)
        rows.append([plant[column] for column in COLUMNS])
    for column, ours in zip(COLUMNS, np.array(rows).T, strict=True):
        assert relative(ours, course(trace, column)) <= 1e-9, column
    controller.close()
    plant.close()


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_loop(name: str, fmi: str, tmp_path: Path) -> None:
    scenario = SCENARIOS[name]()
    trace, period = bk.simulate(scenario).trace, scenario.timing.control_period_s
    stop = (len(trace["t_s"]) - 1) * period
    path = Exported(scenario, "loop", fmi, tmp_path).path
    found = fmpy.simulate_fmu(str(path), stop_time=stop, step_size=period, output_interval=period)
    assert len(found) == len(trace["t_s"])
    for column in COLUMNS:
        assert relative(found[column][1:], course(trace, column)) <= 1e-12, column


@pytest.mark.parametrize("fmi", VERSIONS)
def test_parameters_are_those_of_another_scenario(fmi: str, tmp_path: Path) -> None:
    scenario = paper()
    other = scenario.with_({"joint.stiction_n": 500.0, "disturbance.var": 0.05}, seed=9)
    trace, period = bk.simulate(other, run_index=3).trace, scenario.timing.control_period_s
    unit = Exported(scenario, "loop", fmi, tmp_path).instance()
    unit.start(**{"joint.stiction_n": 500.0, "disturbance.var": 0.05, "seed": 9, "run": 3})
    rows = unit.run(0, 500, period)
    place = unit.exported.outputs.index("joint_force_n")
    assert np.array_equal(rows[:, place], trace["joint_force_n"][:500])
    assert (unit["seed"], unit["run"], unit["joint.stiction_n"]) == (9, 3, 500.0)
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_plant_shows_its_rest_after_initialization(fmi: str, tmp_path: Path) -> None:
    unit = Exported(impacts(), "plant", fmi, tmp_path).instance().start()
    assert unit["position_m"] == 0.0
    assert np.isfinite(unit.outputs()).all()
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_watch_sees_what_is_no_number(fmi: str, tmp_path: Path) -> None:
    scenario = CONTROLLERS["two_step_impacts"]
    period = scenario.timing.control_period_s
    unit = Exported(scenario, "controller", fmi, tmp_path).instance().start()
    unit.run(0, 3, period)
    assert unit["stop_reason"] == 0.0
    unit["measured_position_m"] = np.nan
    unit.step(3 * period, period)
    assert unit["stop_reason"] == 1.0
    assert "the watch has seen it" in unit.told[-1]
    unit["measured_position_m"] = 0.0
    unit.step(4 * period, period)
    assert (unit["stop_reason"], unit["command_force_n"]) == (1.0, 0.0)
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_course_that_diverges_ends_in_an_error(fmi: str, tmp_path: Path) -> None:
    unit = Exported(paper(), "loop", fmi, tmp_path).instance()
    unit.start(**{"controller.gains.kd_n_s_per_m": -1e300})
    with pytest.raises(Exception, match="status 3"):
        unit.run(0, 100, 1e-5)
    assert "diverged" in unit.told[-1]
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_several_periods_in_one_step(fmi: str, tmp_path: Path) -> None:
    exported = Exported(paper(), "loop", fmi, tmp_path)
    fine, coarse = exported.instance().start(), exported.instance().start()
    rows = fine.run(0, 100, 1e-5)
    for k in range(10):
        coarse.step(k * 1e-4, 1e-4)
        assert np.array_equal(coarse.outputs(), rows[10 * k + 9])
    fine.close()
    coarse.close()
