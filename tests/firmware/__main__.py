"""Prove the exported controllers on an emulated Cortex-M4F: ``python -m tests.firmware``."""

from __future__ import annotations

import sys
from pathlib import Path
from subprocess import TimeoutExpired
from tempfile import TemporaryDirectory

from tests.firmware import tools
from tests.firmware.cases import STEPS, cases
from tests.firmware.proof import (
    LOGGED_STEPS,
    Closed,
    Measured,
    close_the_loop,
    logged_instructions,
    measure,
)

ROW = "{:36} {:30} {:>6} {:>17} {:>7} {:>6} {:>5} {:>5}"
BYTES = "{:36} {:>6} {:>11} {:>8} {:>6} {:>6} {:>6}  {}"
LOOP = "{:36} {:>8} {:>24} {:>24} {:>12} {:>6}"


def main() -> int:
    """Run everything; 0 if all is as it should be."""
    try:
        tools.check_tools()
        with TemporaryDirectory() as name:
            return 0 if _prove(Path(name)) else 1
    except (tools.ProofError, TimeoutExpired) as error:
        print(f"firmware: {error}", file=sys.stderr)
        return 2


def _prove(folder: Path) -> bool:
    found = [measure(case, folder / case.name) for case in cases()]
    _print_steps(found)
    _print_bytes(found)
    agreed = _count_again(found[0], folder / "logged")
    closed = [
        close_the_loop(case, folder / "closed" / case.name) for case in cases() if case.in_the_loop
    ]
    _print_loops(closed)
    passed = agreed and all(one.passed for one in found) and all(one.passed for one in closed)
    print("\nall as it should be" if passed else "\nNOT as it should be")
    return passed


def _print_steps(found: list[Measured]) -> None:
    print(
        f"Exported controllers in float on a Cortex-M4F (QEMU, mps2-an386, -icount shift=0), "
        f"{STEPS} steps each.\nBits: same as the core's f32, or the first step that differs. "
        f"Digest: SHA-256 of all outputs.\nValues: different outputs, reference apart. "
        f"Then instructions of a step, from its first to its return,\nchecks of the inputs "
        f"included.\n"
    )
    print(
        ROW.format("controller", "what it is", "bits", "digest", "values", "mean", "most", "limit")
    )
    for one in found:
        bits = "same" if one.first_difference is None else str(one.first_difference)
        mean, most = f"{one.instructions.mean():.1f}", int(one.instructions.max())
        limit = one.case.limit or "-"
        print(
            ROW.format(
                one.case.name, one.case.what, bits, one.digest, one.distinct, mean, most, limit
            )
        )


def _print_bytes(found: list[Measured]) -> None:
    print(
        "\nBytes. Flash: code and constants. RAM of an instance: parameters, what is derived from "
        "them, state.\nStatic: data and zeros besides. Stack: of a step. Library: functions that "
        "the linker has to bring.\n"
    )
    heads = ("flash", "parameters", "derived", "state", "static", "stack", "library")
    print(BYTES.format("controller", *heads))
    for one in found:
        held = one.sizes
        numbers = (held.flash, held.parameters, held.derived, held.state, held.static, held.stack)
        print(BYTES.format(one.case.name, *numbers, ", ".join(held.library) or "none"))


def _count_again(first: Measured, folder: Path) -> bool:
    """Compare the count by time with the count of the emulator's log of single instructions."""
    logged = logged_instructions(first.case, folder)
    timed = int(first.instructions[:LOGGED_STEPS].sum(dtype=int))
    print(
        f"\n{first.case.name}, first {LOGGED_STEPS} steps: {timed} instructions by time, {logged} "
        f"in the log of single instructions"
    )
    return logged == timed


def _print_loops(closed: list[Closed]) -> None:
    print(
        "\nProcessor in the loop: the controller on the Cortex-M4F, the plant on the host, in "
        "float.\nBits: command, reference, position and velocity of every sample as in the core's "
        "own run in f32,\nand the plant as the core's under the same commands. A run that "
        "diverges ends there, as a simulation does.\n"
    )
    heads = ("samples", "IAE, m s", "IAE of the core in f32", "in f64", "bits")
    print(LOOP.format("scenario", *heads))
    for one in closed:
        differs = [n for n in (one.first_difference, one.first_plant_difference) if n is not None]
        numbers = (repr(one.iae_m_s), repr(one.core_iae_m_s), f"{one.double_iae_m_s:.6e}")
        bits = min(differs) if differs else "same"
        print(LOOP.format(one.case.name, one.samples, *numbers, bits))


if __name__ == "__main__":
    sys.exit(main())
