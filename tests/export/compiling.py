"""Exported code that is compiled and fed with rows of numbers."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import breakaway as bk
from breakaway.export.recording import Recording, record
from breakaway.export.vectors import COLUMNS, reference
from breakaway.run.resolution import resolve

FLAGS = (
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-Wfloat-conversion",
    "-Werror",
    "-ffp-contract=off",
)

DRIVER = """
#include "{prefix}.h"
#include <stdio.h>
int main(void)
{{
    static {prefix}_instance self;
    {prefix}_parameters parameters = {prefix}_default_parameters;
    {prefix}_output output;
    {declare}
    {run}
    if ({prefix}_init(&self, &parameters{first}) != 0) {{ return 1; }}
    {show}
    while ({more}) {{
        (void){prefix}_step(&self, {input}&output);
        (void)fwrite(&output, sizeof output, 1, stdout);
    }}
    return 0;
}}
"""


@dataclass(frozen=True)
class Compiled:
    """Exported code with a driver."""

    recording: Recording
    program: Path

    @property
    def number(self) -> type[np.floating]:
        return np.float32 if self.recording.real == "float" else np.float64

    def run(self, inputs: np.ndarray) -> np.ndarray:
        """Outputs of consecutive steps from rest, one row each; a plant shows one row more."""
        what = self.recording.what
        columns = [COLUMNS[what].index(one.name) for one in self.recording.inputs]
        rows = (
            inputs[:, columns].astype(self.number) if columns else np.zeros((len(inputs), 1), "b")
        )
        done = subprocess.run([self.program], input=rows.tobytes(), capture_output=True, check=True)
        return np.frombuffer(done.stdout, self.number).reshape(-1, len(self.recording.outputs))

    def expected(self, inputs: np.ndarray, run: int = 0) -> np.ndarray:
        """What the core gives for them."""
        recording = self.recording
        with np.errstate(over="ignore"):
            given = reference(recording.scenario, recording.what, recording.real, inputs, run)
            columns = [given[one.name] for one in recording.outputs]
            return np.column_stack(columns).astype(self.number)


def same_bits(ours: np.ndarray, theirs: np.ndarray) -> bool:
    """Whether all bits are the same; all NaN are alike."""
    word = np.uint32 if ours.dtype == np.float32 else np.uint64
    same = ours.view(word) == theirs.view(word)
    return ours.shape == theirs.shape and bool((same | (np.isnan(ours) & np.isnan(theirs))).all())


def compile_c(folder: Path, sources: list[str], program: str, *flags: str) -> Path:
    """Compile strictly."""
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs gcc")
    command = [compiler, *FLAGS, *flags, *sources, "-lm", "-o", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / program


def compiled(
    scenario: bk.Scenario, what: str, real: str, folder: Path, *, run: int = 0, flags: str = "-O1"
) -> Compiled:
    """Export a part of a scenario, and compile it with a driver that reads and writes rows."""
    bk.export_c(scenario, what=what, out=folder, real=real)
    recording = record(resolve(scenario), what, real)
    reads = bool(recording.inputs)
    draws = "draw" in recording.signals
    text = DRIVER.format(
        prefix=what,
        declare=f"{what}_input input;" if reads else "char input;",
        run=f"parameters.run = {run}u;" if draws else "",
        first=", &output" if what == "plant" else "",
        show="(void)fwrite(&output, sizeof output, 1, stdout);" if what == "plant" else "",
        more="fread(&input, sizeof input, 1, stdin) == 1",
        input="&input, " if reads else "",
    )
    (folder / "driver.c").write_text(text)
    return Compiled(recording, compile_c(folder, [f"{what}.c", "driver.c"], "driver", flags))
