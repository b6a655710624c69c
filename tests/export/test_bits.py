"""Exported C gives the bits of the core: a million random steps over every kind."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from tests.export.compiling import compiled, same_bits
from tests.export.kinds import CONTROLLERS, LENGTH_M, LOOPS, PLANTS, VARYING

import breakaway as bk
from breakaway.model.scenario.actuator import Actuator
from breakaway.model.scenario.controller import Controller
from breakaway.model.scenario.disturbance import Disturbance
from breakaway.model.scenario.joint import AnyJoint
from breakaway.model.scenario.reference import Reference

REALS = ("double", "float")
CONTROLLER_STEPS = 13_000
PLANT_STEPS = 10_000
LOOP_STEPS = 2_000

EXTREME = np.array([0.0, -0.0, 5e-324, -1e-310, 1e-45, -1e-38, 1e-300, 1.0, -1.0])


def courses(rng: np.random.Generator, steps: int, scales: tuple[float, ...]) -> np.ndarray:
    """Numbers that walk, stand still, jump, and now and then are extreme."""
    columns = []
    for scale in scales:
        walk = np.cumsum(rng.normal(scale=0.004, size=steps)) % 2.0 - 0.5
        jumps = rng.uniform(-1.5, 1.5, steps)
        kind = np.repeat(rng.integers(0, 3, steps // 50 + 1), 50)[:steps]
        still = np.repeat(rng.uniform(0.0, 1.0, steps // 50 + 1), 50)[:steps]
        column = scale * np.select([kind == 0, kind == 1], [walk, jumps], still)
        places = rng.integers(0, steps, steps // 100)
        column[places] = rng.choice(EXTREME, len(places))
        columns.append(column)
    return np.column_stack(columns)


def measured(rng: np.random.Generator, steps: int) -> np.ndarray:
    inputs = courses(rng, steps, (LENGTH_M, 1.0, 500.0))
    inputs[:, 0] = np.clip(inputs[:, 0], -900.0, 900.0)
    return inputs


@pytest.mark.slow
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_controllers(name: str, real: str, tmp_path: Path) -> None:
    code = compiled(CONTROLLERS[name], "controller", real, tmp_path)
    inputs = measured(np.random.default_rng(7), CONTROLLER_STEPS)
    if CONTROLLERS[name].watch is not None:
        # A watch may stop for good early: it also sees a course that it trusts for a while.
        inputs[: CONTROLLER_STEPS // 2, 0] = LENGTH_M * np.linspace(0.0, 1.2, CONTROLLER_STEPS // 2)
        inputs[: CONTROLLER_STEPS // 2, 1:] = 0.1
        inputs[-5] = np.nan
        inputs[-3] = np.inf
    ours, theirs = code.run(inputs), code.expected(inputs)
    assert same_bits(ours, theirs)
    assert len(np.unique(ours[:, 0])) > 1


@pytest.mark.slow
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", PLANTS)
def test_plants(name: str, real: str, tmp_path: Path) -> None:
    code = compiled(PLANTS[name], "plant", real, tmp_path, run=3)
    inputs = courses(np.random.default_rng(8), PLANT_STEPS, (600.0, 0.2, 1.0))
    inputs[:, 2] = np.clip(inputs[:, 2], 0.0, 1.0)
    ours, theirs = code.run(inputs), code.expected(inputs, run=3)
    assert same_bits(ours, theirs)
    assert len(np.unique(ours[:, 0])) > 100


@pytest.mark.slow
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", LOOPS)
def test_loops(name: str, real: str, tmp_path: Path) -> None:
    code = compiled(LOOPS[name], "loop", real, tmp_path, run=5)
    inputs = np.zeros((LOOP_STEPS, 3))
    ours, theirs = code.run(inputs), code.expected(inputs, run=5)
    assert same_bits(ours, theirs)
    assert np.isfinite(ours[:400]).all()


@pytest.mark.slow
@pytest.mark.parametrize("what", ["plant", "loop"])
@pytest.mark.parametrize("name", VARYING)
def test_varying_friction(name: str, what: str, tmp_path: Path) -> None:
    """The field of the first run of the seed is part of the code: it is what its parameters say."""
    code = compiled(VARYING[name], what, "double", tmp_path)
    steps = PLANT_STEPS if what == "plant" else LOOP_STEPS
    inputs = courses(np.random.default_rng(9), steps, (600.0, 0.2, 1.0))
    ours, theirs = code.run(inputs), code.expected(inputs)
    assert same_bits(ours, theirs)
    assert len(np.unique(ours[:, 0])) > 100


@pytest.mark.parametrize("what", ["plant", "loop"])
def test_single_precision_has_no_field(what: str, tmp_path: Path) -> None:
    with pytest.raises(bk.ScenarioError, match=r"^disturbance\.kind: 'field' is a hash .* double"):
        bk.export_c(VARYING["lugre_varying"], what=what, real="float", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
    bk.export_c(VARYING["lugre_varying"], what="controller", real="float", out=tmp_path / "out")


def test_every_kind_is_among_them() -> None:
    """A kind that is new in a scenario model has to be exported, too."""

    def kinds(union: object) -> set[type]:
        if isinstance(union, type):
            return {union}
        return {kind for part in get_args(union) for kind in kinds(part) if isinstance(kind, type)}

    scenarios = [*CONTROLLERS.values(), *PLANTS.values(), *VARYING.values()]
    controllers = {type(one.controller) for one in scenarios}
    two_steps = [one.controller for one in scenarios if isinstance(one.controller, bk.TwoStep)]
    for found, union in (
        (controllers, Controller),
        ({type(one.joint) for one in scenarios}, kinds(AnyJoint)),
        ({type(one.reference) for one in scenarios}, Reference),
        ({type(one.actuator) for one in scenarios}, Actuator),
        ({type(one.disturbance) for one in scenarios}, Disturbance),
        ({type(one.breakaway) for one in two_steps}, {bk.Pid, bk.ForceRamp}),
        ({type(one.vibration) for one in two_steps}, {bk.FmVibration, bk.TimedImpacts}),
    ):
        wanted = union if isinstance(union, set) else kinds(get_args(union)[0])
        assert found == wanted
    assert any(one.sensors for one in scenarios)
    assert any(one.watch for one in scenarios)


def test_there_are_a_million_steps() -> None:
    steps = (
        len(CONTROLLERS) * CONTROLLER_STEPS + len(PLANTS) * PLANT_STEPS + len(LOOPS) * LOOP_STEPS
    )
    assert len(REALS) * steps >= 1_000_000
