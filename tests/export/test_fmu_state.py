"""States of FMUs: saved, restored, carried over; instances share nothing."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
from tests.export.units import VERSIONS, Exported, Unit, impacts, paper

pytestmark = pytest.mark.slow

PERIOD = 1e-5


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_state_that_is_restored_goes_on_the_same(fmi: str, tmp_path: Path) -> None:
    scenario = impacts()
    period = scenario.timing.control_period_s
    unit = Exported(scenario, "loop", fmi, tmp_path).instance().start()
    unit.run(0, 300, period)
    state = unit.save()
    once = unit.run(300, 400, period)
    unit.restore(state)
    assert np.array_equal(unit.run(300, 400, period), once)
    unit.drop(state)
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_state_goes_over_to_another_instance(fmi: str, tmp_path: Path) -> None:
    exported = Exported(paper(), "loop", fmi, tmp_path)
    one, two = exported.instance("one"), exported.instance("two")
    one.start(**{"joint.stiction_n": 470.0, "seed": 5})
    two.start()
    one.run(0, 200, PERIOD)
    state = one.save()
    data = one.to_bytes(state)
    one.drop(state)
    taken = two.from_bytes(data)
    two.restore(taken)
    two.drop(taken)
    assert two["joint.stiction_n"] == 470.0
    assert np.array_equal(one.run(200, 200, PERIOD), two.run(200, 200, PERIOD))
    damaged = bytes([*data[:-1], data[-1] ^ 1])
    for wrong in (damaged, data[:-1], b""):
        with pytest.raises(Exception, match="status 3"):
            two.from_bytes(wrong)
    assert "not a state of this unit" in " ".join(two.told)
    one.close()
    two.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_reset_begins_anew(fmi: str, tmp_path: Path) -> None:
    unit = Exported(paper(), "loop", fmi, tmp_path).instance().start()
    once = unit.run(0, 300, PERIOD)
    unit.slave.reset()
    assert np.array_equal(unit.initialize().run(0, 300, PERIOD), once)
    unit.slave.terminate()
    unit.slave.reset()
    unit["joint.stiction_n"] = 470.0
    assert not np.array_equal(unit.initialize().run(0, 300, PERIOD), once)
    unit.close()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_hundred_instances_in_turn_and_in_threads(fmi: str, tmp_path: Path) -> None:
    scenario = paper().with_({"disturbance.var": 0.15})
    exported = Exported(scenario, "loop", fmi, tmp_path)
    units = [exported.instance(f"unit{n}").start(run=n) for n in range(100)]
    for k in range(30):
        for unit in units:
            unit.step(k * PERIOD, PERIOD)
    alone = [exported.instance(f"again{n}").start(run=n) for n in range(100)]

    def work(some: list[Unit]) -> None:
        for unit in some:
            unit.run(0, 30, PERIOD)

    threads = [threading.Thread(target=work, args=(alone[n::4],)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    interleaved, threaded = ([one.outputs() for one in some] for some in (units, alone))
    assert interleaved == threaded
    assert len({tuple(row) for row in interleaved}) == 100
    for unit in units + alone:
        unit.close()
