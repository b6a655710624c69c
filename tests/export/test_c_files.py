"""What is written: strict C99 with a test program, the same bytes each time, checks that work."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from tests.export.compiling import compile_c
from tests.export.kinds import BASE, CONTROLLERS, NERVOUS, PLANTS

import breakaway as bk
from breakaway.errors import ScenarioError

WHATS = ("controller", "plant", "loop")
REALS = ("double", "float")
PRESETS = (
    "paper_as_computed",
    "paper_as_computed_vibration",
    "paper_as_computed_vibration_bounded",
)


def exported(scenario: bk.Scenario, what: str, real: str, folder: Path) -> Path:
    bk.export_c(scenario, what=what, out=folder, real=real)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("what", WHATS)
@pytest.mark.parametrize("real", REALS)
def test_the_test_program_passes(what: str, real: str, tmp_path: Path) -> None:
    for preset in PRESETS:
        folder = exported(bk.load_scenario(preset), what, real, tmp_path / preset)
        program = compile_c(folder, [f"{what}.c", f"test_{what}.c"], "test", "-O2")
        done = subprocess.run([program], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout
        assert re.fullmatch(r"30[01] passed, 0 failed\n", done.stdout)


def test_the_test_program_fails_where_a_number_differs(tmp_path: Path) -> None:
    folder = exported(BASE, "controller", "double", tmp_path)
    source = folder / "controller.c"
    source.write_text(source.read_text().replace("+ 1.0;", "+ 2.0;"))
    program = compile_c(folder, ["controller.c", "test_controller.c"], "test")
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "0 failed" not in done.stdout


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")
def test_cmake_builds_and_tests_it(tmp_path: Path) -> None:
    folder = exported(BASE, "controller", "float", tmp_path)
    for command in (
        ["cmake", "-S", ".", "-B", "build"],
        ["cmake", "--build", "build"],
        ["ctest", "--test-dir", "build", "--output-on-failure"],
    ):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("what", WHATS)
def test_two_exports_are_the_same_bytes(what: str, tmp_path: Path) -> None:
    scenario = PLANTS["axis_stack_sensed"]
    one, two = (exported(scenario, what, "float", tmp_path / name) for name in ("one", "two"))
    names = sorted(path.name for path in one.iterdir())
    assert names == sorted(path.name for path in two.iterdir())
    for name in names:
        assert (one / name).read_bytes() == (two / name).read_bytes()


def test_the_code_needs_nothing_but_mathematics(tmp_path: Path) -> None:
    allowed = {"float.h", "math.h", "stdbool.h", "stdint.h"}
    for what in WHATS:
        folder = exported(PLANTS["force_sensed"], what, "double", tmp_path / what)
        text = (folder / f"{what}.c").read_text() + (folder / f"{what}.h").read_text()
        assert set(re.findall(r"#include <(.*?)>", text)) <= allowed
        assert not re.search(r"\b(malloc|calloc|free|printf|memcpy)\b", text)


def test_lines_name_what_they_compute(tmp_path: Path) -> None:
    """Of all intermediate quantities of a paper's controller, most have a name of the field."""
    folder = exported(bk.load_scenario(PRESETS[1]), "loop", "double", tmp_path)
    text = (folder / "loop.c").read_text()
    names = re.findall(r"const (?:loop_real|bool) (\w+) =", text)
    numbered = [name for name in names if re.fullmatch(r"[a-z_]+_\d+", name)]
    nameless = [name for name in numbered if name.rpartition("_")[0] not in names]
    assert len(nameless) < 0.35 * len(names), nameless
    for said in (
        "error_m",
        "proportional_n",
        "level_n",
        "equation (3)",
        "PID: F = kp e + I + kd d",
    ):
        assert said in text


# --- checks ---------------------------------------------------------------------------------------

CHECK = """
#include "controller.h"
#include <math.h>
#include <stdio.h>
int main(void)
{
    static controller_instance self;
    controller_parameters p = controller_default_parameters;
    controller_input good, bad;
    controller_output first, out;
    controller_state before;
    int step;
    good.position_m = 1e-5f; good.velocity_m_per_s = 0.01f;
    (void)controller_init(&self, &p);
    for (step = 0; step < 100; step++) { (void)controller_step(&self, &good, &first); }
    before = self.state;
    bad = good; bad.position_m = NAN;
    printf("%d ", controller_step(&self, &bad, &out)); printf("%g ", (double)out.force_n);
    bad.position_m = INFINITY;
    printf("%d ", controller_step(&self, &bad, &out)); printf("%g ", (double)out.force_n);
    bad.position_m = -1001.0f;
    printf("%d ", controller_step(&self, &bad, &out)); printf("%g ", (double)out.force_n);
    bad.position_m = 999.0f; bad.velocity_m_per_s = 9999.0f;
    printf("%d ", controller_step(&self, &good, &out));
    self.state = before;
    printf("%d | ", out.force_n != 0.0f);
    p.reference_duration_s = 0.0f;
    printf("%d %d ", controller_set_parameters(&self, &p), controller_first_invalid(&p));
    p = controller_default_parameters; p.controller_gains_kp_n_per_m = NAN;
    printf("%d ", controller_init(&self, &p));
    printf("%d | ", self.parameters.controller_gains_kp_n_per_m
        == controller_default_parameters.controller_gains_kp_n_per_m);
    p = controller_default_parameters; p.controller_gains_kp_n_per_m *= 2;
    controller_reset(&self);
    for (step = 0; step < 3; step++) { (void)controller_step(&self, &good, &first); }
    controller_reset(&self);
    printf("%d ", controller_set_parameters(&self, &p));
    for (step = 0; step < 3; step++) { (void)controller_step(&self, &good, &out); }
    printf("%d\\n", out.force_n < first.force_n);
    return 0;
}
"""


@pytest.mark.parametrize("real", REALS)
def test_bad_inputs_and_parameters_are_refused(real: str, tmp_path: Path) -> None:
    folder = exported(BASE, "controller", real, tmp_path)
    (folder / "check.c").write_text(
        CHECK if real == "float" else re.sub(r"(?<=[.\d]\d)f", "", CHECK)
    )
    flags = ("-Wno-double-promotion", "-Wno-float-equal", "-Wno-unused-value")
    program = compile_c(folder, ["controller.c", "check.c"], "check", *flags)
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    assert done.stdout == "1 0 1 0 2 0 0 1 | 3 2 3 1 | 0 1\n"


def test_a_refused_sample_moves_nothing(tmp_path: Path) -> None:
    folder = exported(BASE, "controller", "double", tmp_path)
    text = """
    #include "controller.h"
    #include <math.h>
    #include <string.h>
    int main(void)
    {
        static controller_instance self;
        controller_state before;
        controller_input in = {1e-5, 0.1};
        controller_output out;
        (void)controller_init(&self, &controller_default_parameters);
        (void)controller_step(&self, &in, &out);
        before = self.state;
        in.velocity_m_per_s = NAN;
        (void)controller_step(&self, &in, &out);
        return memcmp(&before, &self.state, sizeof before);
    }
    """
    (folder / "still.c").write_text(text)
    program = compile_c(folder, ["controller.c", "still.c"], "still")
    assert subprocess.run([program], check=False).returncode == 0


def test_undefined_behavior_is_not_met(tmp_path: Path) -> None:
    """Under the sanitizers, on wild inputs and parameters."""
    folder = exported(PLANTS["axis"], "plant", "double", tmp_path)
    flags = ("-fsanitize=undefined,address,float-cast-overflow", "-fno-sanitize-recover=all", "-O1")
    text = """
    #include "plant.h"
    #include <float.h>
    int main(void)
    {
        static plant_instance self;
        plant_parameters p = plant_default_parameters;
        plant_output out;
        int n;
        p.seed = 0xFFFFFFFFFFFFFFFFu; p.run = 0xFFFFFFFFFFFFFFFFu;
        p.disturbance_hold_s = DBL_MAX; p.timing_control_period_s = 1e-300;
        if (plant_init(&self, &p, &out) != PLANT_OK) { return 1; }
        self.state.draws.count = 0xFFFFFFFEu;
        for (n = 0; n < 1000; n++) {
            plant_input in;
            in.feed_m_per_s = (n % 3) * 9e3 - 9e3;
            self.state.draws.next_redraw = 0u;
            (void)plant_step(&self, &in, &out);
        }
        return 0;
    }
    """
    (folder / "wild.c").write_text(text)
    program = compile_c(folder, ["plant.c", "wild.c"], "wild", *flags)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


# --- interface ------------------------------------------------------------------------------------


def test_the_interface_describes_every_member(tmp_path: Path) -> None:
    for what in WHATS:
        folder = exported(PLANTS["axis_stack_sensed"], what, "double", tmp_path / what)
        told = json.loads((folder / "interface.json").read_text())
        header = (folder / f"{what}.h").read_text()
        for group in ("parameters", "inputs", "outputs", "states"):
            for one in told[group]:
                assert f"    {what}_real {one['name']};" in header
                assert one["description"] and one["unit"]
        periods = [one for one in told["parameters"] if one["path"] == "timing.control_period_s"]
        assert periods[0]["unit"] == "s" and periods[0]["minimum_excluded"]


def test_parameters_are_those_of_the_scenario(tmp_path: Path) -> None:
    folder = exported(PLANTS["axis_stack_sensed"], "loop", "double", tmp_path)
    told = json.loads((folder / "interface.json").read_text())
    by_path = {one["path"]: one for one in told["parameters"]}
    assert by_path["sensors.position.noise_rms_m"]["unit"] == "m"
    assert by_path["sensors.force.noise_rms_n"]["unit"] == "N"
    assert by_path["actuator.tip.hysteresis_share"]["maximum_excluded"]
    assert by_path["joint.stiction_n"]["default"] == 450.0
    scenario = PLANTS["axis_stack_sensed"]
    for path, one in by_path.items():
        if one["default"] != "Infinity":
            assert np.isfinite(one["default"])
            scenario = scenario.with_({path: one["default"]})


def test_what_nothing_reads_is_not_there(tmp_path: Path) -> None:
    def inputs(name: str, **changes: object) -> list[str]:
        scenario = CONTROLLERS[name].with_(**changes)
        folder = exported(scenario, "controller", "double", tmp_path / name / str(len(changes)))
        told = json.loads((folder / "interface.json").read_text())
        return [one["name"] for one in told["inputs"]]

    assert inputs("ramp", watch=None) == ["position_m"]
    assert inputs("ramp") == ["position_m", "force_n"]
    assert inputs("steady_feed") == ["position_m"]
    assert inputs("pid_error_sensor_off") == ["position_m", "velocity_m_per_s"]
    assert inputs("pid_error_position_difference_off") == ["position_m"]
    assert inputs("pid_error_position_difference_off", watch=NERVOUS) == ["position_m", "force_n"]


# --- errors ---------------------------------------------------------------------------------------


def test_what_is_not_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="what: 'motor' is not one of controller, plant"):
        bk.export_c(BASE, what="motor", out=tmp_path)
    with pytest.raises(ScenarioError, match="real: 'half' is not one of float, double"):
        bk.export_c(BASE, real="half", out=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_number_that_float_can_not_hold_is_refused(tmp_path: Path) -> None:
    tiny = BASE.with_({"joint.stribeck_velocity_m_per_s": 1e-60})
    message = r"joint\.stribeck_velocity_m_per_s: 1e-60 is 0\.0 as float.*real = double"
    with pytest.raises(ScenarioError, match=message):
        bk.export_c(tiny, what="plant", real="float", out=tmp_path)
    bk.export_c(tiny, what="plant", real="double", out=tmp_path)
