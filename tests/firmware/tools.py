"""The cross compiler and the emulator: how they are called, and what to install."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent
TARGET = HERE / "target"
STRICT = (
    *("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion"),
    *("-Werror", "-ffp-contract=off"),
)
CORTEX_M4F = ("-O2", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
MACHINE = (
    *("-machine", "mps2-an386", "-cpu", "cortex-m4", "-nographic"),
    *("-monitor", "none", "-serial", "none"),
)
SEMIHOSTING = ("-semihosting-config", "enable=on,target=native")
ICOUNT = ("-icount", "shift=0")

NEWLIB = "libnewlib-arm-none-eabi"
PACKAGES = {
    "arm-none-eabi-gcc": f"gcc-arm-none-eabi {NEWLIB}",
    "qemu-system-arm": "qemu-system-arm",
    "gcc": "gcc",
}
"""Program -> the Debian packages that bring it."""


class ProofError(Exception):
    """What keeps the firmware from being proven, in words for the user."""


def check_tools() -> None:
    """Say what to install where a program is missing."""
    missing = [program for program in PACKAGES if shutil.which(program) is None]
    packages = " ".join(PACKAGES[program] for program in missing)
    if "arm-none-eabi-gcc" not in missing and not _has_newlib():
        missing, packages = [*missing, "newlib"], f"{packages} {NEWLIB}".strip()
    if missing:
        raise ProofError(
            f"{', '.join(missing)} not found. On Debian or Ubuntu:\n"
            f"    sudo apt-get install --no-install-recommends {packages}"
        )


def _has_newlib() -> bool:
    """Whether the cross compiler finds its C library: it prints a path, or the bare name."""
    return "/" in run("arm-none-eabi-gcc", *CORTEX_M4F, "-print-file-name=libm.a")


def run(*command: str | Path) -> str:
    """Run a tool and give what it prints."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ProofError(f"{command[0]} failed:\n{done.stderr or done.stdout}")
    return done.stdout


def cross_compile(folder: Path, program: str, *options: str) -> Path:
    """Build the exported controller in a folder with one of the target's programs."""
    compiler = ("arm-none-eabi-gcc", *STRICT, *CORTEX_M4F)
    firmware = folder / f"{program}.elf"
    code = folder / "controller.o"
    run(*compiler, "-fstack-usage", "-c", folder / "controller.c", "-o", code)
    sources = [TARGET / f"{name}.c" for name in ("start", "semihosting", program)]
    linker_script = ("-nostartfiles", "-T", TARGET / "mps2_an386.ld")
    run(*compiler, *linker_script, *options, f"-I{folder}", code, *sources, "-o", firmware)
    return firmware


@dataclass(frozen=True)
class Sizes:
    """Bytes that a controller takes."""

    flash: int
    """Code and constants."""
    static: int
    """Data and zeros of its own: 0."""
    parameters: int
    derived: int
    state: int
    stack: int
    """Of a step, with what it calls."""
    library: tuple[str, ...]
    """Functions that it calls and does not bring: of libm or the compiler."""


def sizes(folder: Path) -> Sizes:
    """Read the sizes of a compiled controller."""
    text, data, bss = run("arm-none-eabi-size", folder / "controller.o").split()[6:9]
    members = ("parameters", "derived", "state")
    source = folder / "sizes.c"
    source.write_text(
        '#include "controller.h"\n'
        + "".join(f"char {name}[sizeof(controller_{name})];\n" for name in members)
    )
    compiled = folder / "sizes.o"
    run("arm-none-eabi-gcc", *CORTEX_M4F, "-c", source, "-o", compiled)
    listed = re.findall(r"^\S+ (\S+) \S (\w+)$", run("arm-none-eabi-nm", "-S", compiled), re.M)
    bytes_of = {name: int(size, 16) for size, name in listed}
    missing = run("arm-none-eabi-nm", "--undefined-only", folder / "controller.o").split()[1::2]
    return Sizes(
        flash=int(text),
        static=int(data) + int(bss),
        **{name: bytes_of[name] for name in members},
        stack=_stack_of_a_step(folder / "controller.su"),
        library=tuple(missing),
    )


def _stack_of_a_step(usage: Path) -> int:
    """Add the frames of the step and of all helpers that the compiler left as functions."""
    others = ("first_invalid", "set_parameters", "reset", "init", "derive")
    total = 0
    for line in usage.read_text().splitlines():
        where, size, _ = line.split("\t")
        name = where.split(":")[3].removeprefix("controller_").split(".")[0]
        total += 0 if name in others else int(size)
    return total


def emulator(firmware: Path, *options: str) -> list[str]:
    """Compose the command that runs a program on the emulated processor."""
    return ["qemu-system-arm", *MACHINE, *SEMIHOSTING, *options, "-kernel", str(firmware)]


def emulate(firmware: Path, given: bytes, *options: str) -> bytes:
    """Run a program on the emulated processor: bytes in, bytes out."""
    command = emulator(firmware, *options)
    done = subprocess.run(command, input=given, capture_output=True, check=False, timeout=100)
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace")
        raise ProofError(f"{firmware.name} ended with {done.returncode}\n{said}")
    return done.stdout


@cache
def one_instruction_at_a_time() -> tuple[str, ...]:
    """Name the emulator's option that translates each instruction alone."""
    found = re.search(r"version (\d+)\.(\d+)", run("qemu-system-arm", "--version"))
    if found is None:
        raise ProofError("qemu-system-arm does not tell its version")
    if (int(found[1]), int(found[2])) < (8, 1):
        return ("-singlestep",)
    return ("-accel", "tcg,one-insn-per-tb=on")
