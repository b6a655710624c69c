"""Matrices by column, structures within structures, Simulink's and dSPACE's own ones."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from tests.logs.recorders import printed_mapping

from breakaway.errors import LogError
from breakaway.measure.logs import list_channels, read_log

T_S = np.arange(200) / 100.0
X_M, F_N = 1e-3 * np.sin(T_S), np.cos(T_S)


def mapping(time: str, position: str, force: str) -> dict[str, Any]:
    return {
        "time": {"from": time, "unit": "s"},
        "channels": {
            "position_m": {"from": position, "unit": "m"},
            "force_n": {"from": force, "unit": "N"},
        },
    }


def check(path: Path, *names: str) -> None:
    log = read_log(path, mapping(*names))
    np.testing.assert_array_equal(log.t_s, T_S)
    np.testing.assert_array_equal(log.position_m, X_M)
    np.testing.assert_array_equal(log.force_n, F_N)


@pytest.mark.parametrize("version", ["4", "5"])
@pytest.mark.parametrize("lies", [False, True])
def test_a_matrix_has_its_channels_along_its_shorter_side(
    tmp_path: Path, version: str, lies: bool
) -> None:
    path = tmp_path / "rig.mat"
    matrix = np.column_stack([T_S, X_M, F_N])
    scipy.io.savemat(path, {"log": matrix.T if lies else matrix}, format=version)
    check(path, "log#1", "log#2", "log#3")
    np.testing.assert_array_equal(scipy.io.loadmat(path)["log"], matrix.T if lies else matrix)


@pytest.mark.parametrize("lies", [False, True])
def test_a_matrix_of_hdf5_has_them_too(tmp_path: Path, lies: bool) -> None:
    path = tmp_path / "rig.h5"
    matrix = np.column_stack([T_S, X_M, F_N])
    with h5py.File(path, "w") as file:
        file.create_dataset("rig/log", data=matrix.T if lies else matrix, chunks=True)
    check(path, "log#1", "log#2", "log#3")
    listed = {one.name: one.samples for one in list_channels(path).channels}
    assert listed == {"rig/log#1": 200, "rig/log#2": 200, "rig/log#3": 200}


def test_a_square_matrix_does_not_tell_and_a_whole_one_is_no_channel(tmp_path: Path) -> None:
    path = tmp_path / "rig.mat"
    scipy.io.savemat(path, {"log": np.column_stack([T_S, X_M]), "square": np.eye(20)})
    with pytest.raises(LogError, match=r"several columns 'log'.* such as 'log#2'"):
        read_log(path, mapping("log", "log", "log"))
    with pytest.raises(LogError, match=r"'square': is an array of shape \(20, 20\)"):
        read_log(path, mapping("log#1", "square", "log#2"))


def test_structures_within_structures_are_read(tmp_path: Path) -> None:
    path = tmp_path / "rig.mat"
    scipy.io.savemat(path, {"log": {"t": T_S, "rig": {"drive": {"x": X_M}, "cell": {"f": F_N}}}})
    check(path, "log.t", "log.rig.drive.x", "log.rig.cell.f")


def test_signals_of_simulink_have_their_labels(tmp_path: Path) -> None:
    """A structure with time, as To Workspace and scopes write it."""
    signals = np.zeros((2,), dtype=[("values", object), ("label", object), ("dimensions", object)])
    signals[0] = (X_M.reshape(-1, 1), "Position", 1.0)
    signals[1] = (F_N.reshape(-1, 1), "", 1.0)
    path = tmp_path / "out.mat"
    scipy.io.savemat(path, {"out": {"time": T_S, "signals": signals, "blockName": "m/Scope"}})
    check(path, "out.time", "out.signals.Position", "out.signals#2.values")


def test_signals_of_dspace_have_their_names(tmp_path: Path) -> None:
    """A capture of ControlDesk: one axis X, and signals Y with their names."""
    signals = np.zeros((2,), dtype=[("Name", object), ("Data", object), ("Unit", object)])
    signals[0] = ("Model Root/Rig/x", X_M, "m")
    signals[1] = ("Model Root/Rig/F", F_N, "N")
    path = tmp_path / "rec.mat"
    scipy.io.savemat(path, {"rec": {"X": {"Name": "t", "Data": T_S}, "Y": signals}})
    check(path, "rec.X.t", "rec.Y.Model Root/Rig/x", "rec.Y.Model Root/Rig/F")
    listed = [one.name for one in list_channels(path).channels if not one.unreadable]
    assert listed == ["rec.X.t", "rec.Y.Model Root/Rig/x", "rec.Y.Model Root/Rig/F"]


def test_the_mapping_for_simulink_works_as_printed(tmp_path: Path) -> None:
    signals = np.zeros((2,), dtype=[("values", object), ("label", object)])
    signals[0], signals[1] = (1e3 * X_M, "Position"), (1e-3 * F_N, "Force")
    path = tmp_path / "rig.mat"
    scipy.io.savemat(path, {"out": {"time": T_S, "signals": signals}}, do_compression=True)
    log = read_log(path, printed_mapping("Simulink"))
    np.testing.assert_allclose(log.position_m, X_M, atol=1e-15)
    np.testing.assert_allclose(log.force_n, F_N, atol=1e-12)


def test_the_mapping_for_dspace_works_as_printed(tmp_path: Path) -> None:
    signals = np.zeros((2,), dtype=[("Name", object), ("Data", object)])
    signals[0] = ("Model Root/Rig/Position", 1e3 * X_M)
    signals[1] = ("Model Root/Rig/Force", 1e-3 * F_N)
    path = tmp_path / "rec.mat"
    scipy.io.savemat(path, {"rec": {"X": {"Name": "Time", "Data": T_S}, "Y": signals}})
    log = read_log(path, printed_mapping("dSPACE"))
    np.testing.assert_allclose(log.position_m, X_M, atol=1e-15)
    np.testing.assert_allclose(log.force_n, F_N, atol=1e-12)
