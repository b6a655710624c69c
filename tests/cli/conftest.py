"""A runner for the command line, as it runs in a pipe; and logs and joints to feed it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from breakaway.cli.app import app
from breakaway.measure.identification import JointFile, identify_inertia_friction
from breakaway.measure.logs import Log, read_log

PLAIN = {"NO_COLOR": "1", "_TYPER_FORCE_DISABLE_TERMINAL": "1", "TERMINAL_WIDTH": "100"}


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    """Run the command with arguments; gives exit_code, stdout and stderr."""
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    runner = CliRunner()

    def _call(*args: object) -> Any:
        result = runner.invoke(app, [str(arg) for arg in args], env=PLAIN)
        assert result.exception is None or isinstance(result.exception, SystemExit), result
        return result

    return _call


@pytest.fixture
def log_csv(tmp_path: Path) -> Path:
    """Give a log of a part of 1 kg with 300 N of Coulomb and 25 N s/m of viscous friction."""
    t_s = np.arange(5000) / 1000.0
    v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    a = -1.5 * np.sin(5 * t_s) - 0.4 * np.sin(2 * t_s)
    x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    force = 3.0 * a + 25.0 * v + 300.0 * np.sign(v) + 2.0
    path = tmp_path / "motor.csv"
    np.savetxt(
        path,
        np.column_stack([t_s, x, force]),
        delimiter=",",
        header="t_s,position_m,force_n",
        comments="",
        fmt="%.17g",
    )
    return path


@pytest.fixture
def joint_toml(log_csv: Path, tmp_path: Path) -> Path:
    log: Log = read_log(log_csv)
    path = tmp_path / "joint.toml"
    JointFile.from_fit(identify_inertia_friction(log), log).save(path)
    return path
