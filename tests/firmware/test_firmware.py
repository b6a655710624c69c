"""The proof says what it lacks, finds what differs, and the page's path to the emulator works."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.firmware import tools
from tests.firmware.cases import cases
from tests.firmware.proof import first_difference, measure

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


def lacks_tools() -> bool:
    try:
        tools.check_tools()
    except tools.ProofError:
        return True
    return False


def test_it_says_what_to_install(tmp_path: Path) -> None:
    places = os.pathsep.join([str(ROOT), str(ROOT / "python"), *sys.path])
    done = subprocess.run(
        [sys.executable, "-m", "tests.firmware"],
        cwd=ROOT,
        env={"PATH": str(tmp_path), "PYTHONPATH": places},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert "apt-get install" in done.stderr
    assert "gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_first_difference_is_found() -> None:
    ours = np.zeros((5, 2), np.float32)
    theirs = ours.copy()
    assert first_difference(ours, theirs) is None
    ours[4, 0] = theirs[4, 0] = np.nan
    theirs[4, 0] = -theirs[4, 0]
    assert first_difference(ours, theirs) is None
    theirs[3, 1] = -0.0
    theirs[4, 0] = 1.0
    assert first_difference(ours, theirs) == 3


needs_tools = pytest.mark.skipif(lacks_tools(), reason="needs the cross compiler and the emulator")


@needs_tools
def test_arithmetic_that_differs_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the compiler may fuse what is not written as fused, the bits are others."""
    (case,) = (one for one in cases() if one.name == "fm_half_sine")
    monkeypatch.setattr(tools, "CORTEX_M4F", (*tools.CORTEX_M4F, "-ffp-contract=fast"))
    assert measure(case, tmp_path).first_difference is not None


@needs_tools
def test_the_path_of_the_page_works_as_written(tmp_path: Path) -> None:
    page = (ROOT / "docs/export.md").read_text()
    blocks = re.findall(r"^```sh\n(.*?)^```$", page, re.M | re.S)
    (script,) = (block for block in blocks if "qemu-system-arm" in block)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    program = shutil.which("breakaway", path=str(Path(sys.executable).parent))
    assert program is not None
    paths = os.pathsep.join([str(Path(program).parent), os.environ["PATH"]])
    done = subprocess.run(
        ["sh", "-e", "-c", script],
        cwd=tmp_path,
        env={**os.environ, "PATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("300 passed, 0 failed\n")
