"""What is in an FMU, and whether others find it valid."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from tests.export.compiling import FLAGS
from tests.export.kinds import CONTROLLERS, PLANTS
from tests.export.units import VERSIONS, WHATS, Exported, impacts, paper

import breakaway as bk

pytestmark = pytest.mark.slow

SCENARIOS = {
    "paper": paper,
    "vibration": lambda: bk.load_scenario("paper_as_computed_vibration"),
    "impacts": impacts,
    "axis": lambda: PLANTS["axis_stack_sensed"],
    "gms": lambda: PLANTS["axis_gms"],
    "watched": lambda: CONTROLLERS["two_step_impacts"],
}


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("what", WHATS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_valid_and_compiled_without_a_warning(
    name: str, what: str, fmi: str, tmp_path: Path
) -> None:
    exported = Exported(SCENARIOS[name](), what, fmi, tmp_path)
    assert validate_fmu(str(exported.path)) == []
    assert exported.written.note == ""
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs gcc")
    command = [compiler, *FLAGS, "-fPIC", "-shared", "fmu.c", f"{what}.c", "-lm", "-o", "library"]
    done = subprocess.run(
        command, cwd=exported.folder / "sources", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("what", WHATS)
def test_two_exports_are_the_same_bytes(what: str, fmi: str, tmp_path: Path) -> None:
    one, two = tmp_path / "one.fmu", tmp_path / "two.fmu"
    for path in (one, two):
        bk.export_fmu(impacts(), what=what, fmi=fmi, out=path)
    assert one.read_bytes() == two.read_bytes()
    other = tmp_path / "other.fmu"
    bk.export_fmu(impacts().with_({"timing.duration_s": 1.0}), what=what, fmi=fmi, out=other)
    tokens = [fmpy.read_model_description(str(path)).guid for path in (one, other)]
    assert tokens[0] != tokens[1]


@pytest.mark.parametrize("fmi", VERSIONS)
def test_every_parameter_has_what_the_scenario_says(fmi: str, tmp_path: Path) -> None:
    exported = Exported(paper(), "loop", fmi, tmp_path)
    told = {one.name: one for one in exported.described.modelVariables}
    stiction = told["joint.stiction_n"]
    assert (stiction.causality, stiction.variability, stiction.unit) == (
        "parameter",
        "tunable",
        "N",
    )
    assert (float(stiction.start), float(stiction.min)) == (450.0, 0.0)
    assert "F_s0" in stiction.description
    assert told["timing.control_period_s"].variability == "fixed"
    assert {"seed", "run", "time", "disturbance.var", "controller.gains.kp_n_per_m"} <= set(told)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_links_nothing_but_mathematics(fmi: str, tmp_path: Path) -> None:
    reader = shutil.which("readelf")
    if reader is None:
        pytest.skip("needs readelf")
    exported = Exported(paper(), "loop", fmi, tmp_path)
    assert exported.written.binary is not None
    library = exported.folder / exported.written.binary
    done = subprocess.run([reader, "-d", library], capture_output=True, text=True, check=True)
    needed = set(re.findall(r"Shared library: \[(\w+)", done.stdout))
    assert needed <= {"libm", "libc"}
    done = subprocess.run(
        [reader, "-W", "--dyn-syms", library], capture_output=True, text=True, check=True
    )
    shown = re.findall(r"GLOBAL +DEFAULT +\d+ (\w+)", done.stdout)
    assert shown
    assert all(name.startswith(f"fmi{fmi}") for name in shown)


def test_without_a_compiler_there_are_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", str(tmp_path / "nothing"))
    written = bk.export_fmu(paper(), fmi="3", out=tmp_path / "rig.fmu")
    assert written.binary is None
    assert "no binary" in written.note
    names = zipfile.ZipFile(written.path).namelist()
    assert "sources/buildDescription.xml" in names
    assert not any(name.startswith("binaries") for name in names)


def test_what_can_not_be_written_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(bk.ScenarioError, match="fmi: '4' is not one of 2, 3"):
        bk.export_fmu(paper(), fmi="4", out=tmp_path / "rig.fmu")
    with pytest.raises(bk.ScenarioError, match=r"seed: .* take a smaller seed or FMI 3"):
        bk.export_fmu(paper().with_(seed=2**40), what="loop", fmi="2", out=tmp_path / "rig.fmu")
    with pytest.raises(bk.OutputError, match="is a folder; name a file in it"):
        bk.export_fmu(paper(), out=tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(bk.OutputError, match="give a folder"):
        bk.export_fmu(paper(), out=tmp_path / "file" / "rig.fmu")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_missing_folders_are_made(tmp_path: Path) -> None:
    written = bk.export_fmu(paper(), out=tmp_path / "deep" / "down" / "rig.fmu")
    assert [*(tmp_path / "deep" / "down").iterdir()] == [written.path]
