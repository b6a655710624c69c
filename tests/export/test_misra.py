"""The rules of MISRA C:2012 that fire, as cppcheck finds them without the rules' texts."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from tests.export.kinds import CONTROLLERS, PLANTS

import breakaway as bk

ADVISORY = {"2.5", "8.7", "12.1", "19.2"}
"""All are advisory; docs/export.md says why they stay. None is required or mandatory."""

EXPORTS = (
    (CONTROLLERS["two_step_half_sine"], "controller", "float"),
    (CONTROLLERS["vibrated_feed"], "controller", "float"),
    (PLANTS["axis_stack_sensed"], "loop", "double"),
    (PLANTS["axis"], "plant", "float"),
    (PLANTS["gms"], "plant", "float"),
)


def has_the_addon() -> bool:
    if shutil.which("cppcheck") is None:
        return False
    done = subprocess.run(
        ["cppcheck", "--addon=misra", "--quiet", "--errorlist"], capture_output=True, check=False
    )
    return done.returncode == 0


@pytest.mark.skipif(not has_the_addon(), reason="needs cppcheck with its MISRA addon")
def test_no_required_rule_fires(tmp_path: Path) -> None:
    fired: set[str] = set()
    for place, (scenario, what, real) in enumerate(EXPORTS):
        folder = tmp_path / str(place)
        bk.export_c(scenario, what=what, real=real, out=folder)
        done = subprocess.run(
            ["cppcheck", "--addon=misra", "--std=c99", "--enable=style,warning", f"{what}.c"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=True,
        )
        fired |= set(re.findall(r"\[misra-c2012-([0-9.]+)\]", done.stderr))
        assert "error:" not in done.stderr
        assert "warning:" not in done.stderr
    assert fired == ADVISORY
    page = (Path(__file__).parents[2] / "docs/export.md").read_text()
    for rule in fired:
        assert f"| {rule} |" in page
