"""Other importers: libcosim runs a unit (skipped where it is missing), FMPy builds its sources."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from tests.export.units import Exported, paper

import breakaway as bk

pytestmark = pytest.mark.slow


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


@pytest.mark.skipif(shutil.which("cmake") is None, reason="CMake builds the sources")
@pytest.mark.parametrize("fmi", ["2", "3"])
def test_an_importer_builds_the_sources(fmi: str, tmp_path: Path) -> None:
    exported = Exported(paper(), "loop", fmi, tmp_path)
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(exported.path) as unit:
        sources = [name for name in unit.namelist() if not name.startswith("binaries/")]
        unit.extractall(folder, sources)
    build = tmp_path / "build"
    build.mkdir()
    build_platform_binary(folder, build_dir=build)
    rebuilt = Path(shutil.make_archive(str(tmp_path / "rebuilt"), "zip", folder))
    ours, theirs = (
        fmpy.simulate_fmu(path, stop_time=1e-3, step_size=1e-5, output_interval=1e-5)
        for path in (exported.path, rebuilt)
    )
    assert np.array_equal(ours["position_m"], theirs["position_m"])
    assert ours["position_m"][-1] > 0.0
