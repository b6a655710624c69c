"""A second importer, libcosim, gives what the simulation gives (skipped where it is missing)."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.export.units import Exported, paper

import breakaway as bk


def test_libcosim_agrees_with_the_simulation(tmp_path: Path) -> None:
    pytest.importorskip("libcosimpy")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    scenario = paper()
    trace = bk.simulate(scenario).trace
    exported = Exported(scenario, "loop", "2", tmp_path)
    execution = CosimExecution.from_step_size(10_000)  # nanoseconds
    unit = execution.add_local_slave(
        CosimLocalSlave(fmu_path=str(exported.path), instance_name="loop")
    )
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    references = [exported.references[name] for name in ("position_m", "velocity_m_per_s")]
    for k in range(1, 2001):
        assert execution.step()
        position_m, velocity_m_per_s = observer.last_real_values(unit, references)
        assert position_m == trace["position_m"][k]
        assert velocity_m_per_s == trace["velocity_m_per_s"][k]
