"""Read the EMPS benchmark's MATLAB file."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat

from breakaway.errors import LogError
from breakaway.logs.log import Array, Log, missing, read_bytes

REQUIRED = ("t", "qm", "vir", "gtau")


def read_emps(path: Path) -> Log:
    """Read a log of the Electro-Mechanical Positioning System.

    ::

        force_n = gtau * vir

    with ``vir`` the drive signal in V and ``gtau`` the drive gain in N/V. ``t`` is the time
    in s, ``qm`` the measured and ``qg`` (optional) the reference position in m.

    Source: A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of EMPS",
    Workshop on Nonlinear System Identification Benchmarks, 2019.

    Parameters
    ----------
    path : Path
        A MATLAB file of version 4 to 7 (not 7.3, which is HDF5).

    Returns
    -------
    Log
        With the names of all other variables in ``ignored_columns``. A force that acts on the
        carriage beside the motor's is one of these: it is not part of ``force_n``.

    Raises
    ------
    LogError
        The file is missing, empty, no such MATLAB file, lacks a variable, or a variable is not
        a real vector (``gtau``: a finite scalar that is not 0); and as `Log` says.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from scipy.io import savemat
    >>> t = np.arange(50) / 1000.0
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "small.mat"
    ...     savemat(path, {"t": t, "qm": 0.1 * t, "vir": np.ones(50), "gtau": 35.0})
    ...     read_emps(path).force_n[:2]
    array([35., 35.])

    """
    data = read_bytes(path)
    variables = _variables(path, data)
    for name in REQUIRED:
        if name not in variables:
            raise missing(path, "variable", name, sorted(variables))
    gain = _vector(path, variables, "gtau")
    if gain.size != 1 or not np.isfinite(gain[0]) or gain[0] == 0.0:
        raise LogError(
            f"{path.name}: variable 'gtau' is {np.array2string(gain, threshold=4)}; it must be "
            "one finite drive gain in N/V, not 0"
        )
    used = (*REQUIRED, "qg")
    force_v = _vector(path, variables, "vir")
    with np.errstate(over="ignore", invalid="ignore"):  # Log refuses what is not finite
        force_n = gain[0] * force_v
    return Log(
        t_s=_vector(path, variables, "t"),
        position_m=_vector(path, variables, "qm"),
        force_n=force_n,
        reference_m=_vector(path, variables, "qg") if "qg" in variables else None,
        source=path,
        sha256=hashlib.sha256(data).hexdigest(),
        ignored_columns=tuple(sorted(set(variables) - set(used))),
    )


def _variables(path: Path, data: bytes) -> dict[str, Any]:
    if data.startswith((b"MATLAB 7.3", b"\x89HDF")):
        raise LogError(
            f"{path.name}: is a MATLAB 7.3 (HDF5) file; save it with `save(name, '-v7')` in MATLAB"
        )
    content: Any = io.BytesIO(data)  # which scipy reads, though its type stubs want a path
    try:
        found = loadmat(content)
    except Exception as error:  # scipy raises a dozen unrelated types for a damaged file
        raise LogError(
            f"{path.name}: is not a MATLAB file of version 4 to 7 ({type(error).__name__}: "
            f"{error}); read a table of numbers with format='csv'"
        ) from None
    return {name: value for name, value in found.items() if not name.startswith("__")}


def _vector(path: Path, variables: dict[str, Any], name: str) -> Array:
    value = np.asarray(variables[name])
    if (
        value.dtype.kind not in "fiu"
        or value.size == 0
        or max(value.shape, default=1) != value.size
    ):
        raise LogError(
            f"{path.name}: variable '{name}' is an array of type {value.dtype} and shape "
            f"{value.shape}; it must be a vector of real numbers"
        )
    return value.reshape(-1).astype(np.float64)
