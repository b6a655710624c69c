"""A controller on the emulated processor against the core: bits, instructions, bytes, the loop."""

from __future__ import annotations

import hashlib
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tests.firmware import tools
from tests.firmware.cases import STEPS, Case, expected_of, inputs_of, read_by

import breakaway as bk
from breakaway.export.recording import Recording, record
from breakaway.export.vectors import reference
from breakaway.run.resolution import resolve

LOGGED_STEPS = 6000
"""Steps whose instructions are also counted one by one in the emulator's log."""


@dataclass(frozen=True)
class Measured:
    """What a controller does on the processor."""

    case: Case
    first_difference: int | None
    """The first step with an output of other bits than the core's."""
    digest: str
    distinct: int
    """How many different outputs there are, the reference apart."""
    instructions: NDArray[np.uint16]
    """Of each step, from its first to its return."""
    sizes: tools.Sizes

    @property
    def passed(self) -> bool:
        """Whether the bits agree and the limit is kept."""
        limit = self.case.limit
        fits = limit is None or int(self.instructions.max()) <= limit
        return (
            self.first_difference is None and fits and self.distinct > 1 and self.sizes.static == 0
        )


def exported(case: Case, folder: Path) -> Recording:
    """Export a controller in float."""
    bk.export_c(case.scenario, what="controller", real="float", out=folder)
    return record(resolve(case.scenario), "controller", "float")


def measure(case: Case, folder: Path) -> Measured:
    """Step a controller on the emulated processor, and compare every output with the core."""
    recording = exported(case, folder)
    inputs = inputs_of(recording, case.episode)
    firmware = tools.cross_compile(folder, "measure", f"-DEPISODE={case.episode}u")
    given = tools.emulate(firmware, read_by(recording, inputs).tobytes(), *tools.ICOUNT)
    expected = expected_of(recording, inputs, case.episode)
    if len(given) != expected.nbytes + 2 * STEPS:
        raise tools.ProofError(f"{case.name}: {len(given)} bytes came back")
    commands = [n for n, one in enumerate(recording.outputs) if one.name != "reference_m"]
    outputs = np.frombuffer(given[: expected.nbytes], np.float32).reshape(expected.shape)
    return Measured(
        case=case,
        first_difference=first_difference(outputs, expected),
        digest=hashlib.sha256(outputs.tobytes()).hexdigest()[:16],
        distinct=len(np.unique(outputs[:, commands], axis=0)),
        instructions=np.frombuffer(given[expected.nbytes :], np.uint16),
        sizes=tools.sizes(folder),
    )


def first_difference(ours: NDArray[np.float32], theirs: NDArray[np.float32]) -> int | None:
    """Find the first row whose bits differ; all NaN are alike."""
    same = ours.view(np.uint32) == theirs.view(np.uint32)
    rows = np.flatnonzero(~(same | (np.isnan(ours) & np.isnan(theirs))).all(axis=1))
    return int(rows[0]) if len(rows) else None


def logged_instructions(case: Case, folder: Path) -> int:
    """Count the instructions of the first steps one by one, in the emulator's log."""
    recording = exported(case, folder)
    firmware = tools.cross_compile(folder, "in_the_loop")
    listed = tools.run("arm-none-eabi-nm", "-S", firmware).splitlines()
    start, size = next(line.split()[:2] for line in listed if line.endswith(" controller_step"))
    log = folder / "instructions.log"
    options = ("-d", "exec,nochain", "-dfilter", f"0x{start}+0x{size}", "-D", str(log))
    given = read_by(recording, inputs_of(recording, case.episode))[:LOGGED_STEPS].tobytes()
    tools.emulate(firmware, given, *options, *tools.one_instruction_at_a_time())
    with log.open("rb") as lines:
        return sum(line.startswith(b"Trace") for line in lines)


@dataclass(frozen=True)
class Closed:
    """The processor in the loop with the plant."""

    case: Case
    samples: int
    iae_m_s: float
    core_iae_m_s: float
    """Of the run that is all core, in f32."""
    double_iae_m_s: float
    """Of `bk.simulate`, in f64."""
    first_difference: int | None
    """The first sample whose command or position differs from that of the run that is all core."""
    first_plant_difference: int | None
    """The first sample whose plant differs from the core's under the same commands."""

    @property
    def passed(self) -> bool:
        """Whether everything has the same bits."""
        differs = (self.first_difference, self.first_plant_difference)
        return differs == (None, None) and self.iae_m_s == self.core_iae_m_s


LOOP = ("command_force_n", "reference_m", "position_m", "velocity_m_per_s")
PLANT = ("position_m", "velocity_m_per_s", "bristle_m", "applied_force_n", "joint_force_n")


def close_the_loop(case: Case, folder: Path) -> Closed:
    """Let the emulated processor control the plant over a whole run."""
    exported(case, folder)
    resolved = resolve(case.scenario)
    bk.export_c(case.scenario, what="plant", real="float", out=folder)
    plant = record(resolved, "plant", "float")
    names = ["command_force_n", "reference_m", *(one.name for one in plant.outputs)]
    loop = _until_it_diverges(
        resolved, reference(resolved, "loop", "float", np.zeros((resolved.samples, 3)))
    )
    samples = len(loop["position_m"])
    rows = _run_both(folder, samples).reshape(-1, len(names))
    ours = dict(zip(names, rows.T, strict=True))
    commands = np.zeros((samples, 3))
    commands[:, 0] = ours["command_force_n"]
    alone = reference(resolved, "plant", "float", commands)
    return Closed(
        case=case,
        samples=samples,
        iae_m_s=_iae(resolved, ours["reference_m"], ours["position_m"]),
        core_iae_m_s=_iae(resolved, loop["reference_m"], loop["position_m"]),
        double_iae_m_s=float(bk.simulate(case.scenario).metrics.iae_m_s),
        first_difference=_difference_of(ours, loop, LOOP, 0),
        first_plant_difference=_difference_of(ours, alone, PLANT, 1),
    )


def _run_both(folder: Path, samples: int) -> NDArray[np.float32]:
    """Connect the emulator and the plant by two pipes, and read the record of the plant."""
    firmware = tools.cross_compile(folder, "in_the_loop")
    plant, kept = folder / "plant_in_the_loop", folder / "loop.f32"
    sources = [folder / "plant.c", tools.HERE / "host" / "plant_in_the_loop.c"]
    run_on_host = ("gcc", *tools.STRICT, "-D_POSIX_C_SOURCE=200809L", "-O2", f"-I{folder}")
    tools.run(*run_on_host, *sources, "-lm", "-o", plant)
    pipe = subprocess.PIPE
    processor = subprocess.Popen(tools.emulator(firmware, *tools.ICOUNT), stdin=pipe, stdout=pipe)
    command = [str(plant), str(samples), str(kept)]
    with processor:
        try:
            done = subprocess.run(
                command, stdin=processor.stdout, stdout=processor.stdin, check=False, timeout=100
            )
        except subprocess.TimeoutExpired:
            processor.kill()
            raise
    if done.returncode != 0 or processor.returncode != 0:
        raise tools.ProofError(
            f"the loop broke: plant {done.returncode}, processor {processor.returncode}"
        )
    return np.fromfile(kept, np.float32)


def _difference_of(
    ours: dict[str, NDArray[np.float32]],
    core: dict[str, NDArray[np.float64]],
    names: tuple[str, ...],
    skipped: int,
) -> int | None:
    """Compare columns; the core shows `skipped` rows before the first step."""
    theirs = np.column_stack([core[name][skipped:] for name in names]).astype(np.float32)
    mine = np.column_stack([ours[name] for name in names])
    return first_difference(mine, theirs)


def _iae(
    scenario: bk.Scenario,
    reference_m: NDArray[np.float32] | NDArray[np.float64],
    position_m: NDArray[np.float32] | NDArray[np.float64],
) -> float:
    """IAE = sum of |r - x| T_s over the samples, of numbers in f32, summed in f64."""
    errors = _errors(reference_m, position_m)
    return float(errors.sum() * scenario.timing.control_period_s)


def _errors(
    reference_m: NDArray[np.float32] | NDArray[np.float64],
    position_m: NDArray[np.float32] | NDArray[np.float64],
) -> NDArray[np.float64]:
    """|r - x| at each sample; the loop's position is that of the period's end."""
    at_samples = np.concatenate([[0.0], position_m[:-1].astype(np.float64)])
    errors: NDArray[np.float64] = np.abs(reference_m.astype(np.float64) - at_samples)
    return errors


def _until_it_diverges(
    scenario: bk.Scenario, loop: dict[str, NDArray[np.float64]]
) -> dict[str, NDArray[np.float64]]:
    """Keep the samples that a simulation counts: up to an error or a force beyond its limit."""
    errors, forces = _errors(loop["reference_m"], loop["position_m"]), loop["command_force_n"]
    error_m, force_n = scenario.limits.diverged_error_m, scenario.limits.diverged_force_n
    if error_m is None or force_n is None:
        raise tools.ProofError(f"{scenario.name}: the limits are not resolved")
    beyond = np.flatnonzero(~((errors <= error_m) & (np.abs(forces) <= force_n)))
    kept = int(beyond[0]) if len(beyond) else len(errors)
    return {name: column[:kept] for name, column in loop.items()}
