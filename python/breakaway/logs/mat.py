"""Read a log from a MATLAB file."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

from scipy.io import loadmat, whosmat

from breakaway.logs.budget import Budget
from breakaway.logs.hdf5 import read_matlab_hdf5
from breakaway.logs.mat5 import decode
from breakaway.logs.raw import RawFile, check_size, guarded


def read_mat(path: Path, budget: Budget) -> RawFile:
    """Read the vectors of a MATLAB file of version 4 to 7.3.

    The fields of a structure are channels by the name ``structure.field``; structures within
    structures are not read. Files of version 7.3 are HDF5, which needs h5py.

    Raises
    ------
    LogError
        The file is damaged, or h5py is missing for version 7.3.

    """
    with path.open("rb") as file:
        head = file.read(520)
    if head.startswith((b"MATLAB 7.3", b"\x89HDF")) or head[512:516] == b"\x89HDF":
        return read_matlab_hdf5(path, budget)
    return _read(path, budget)


@guarded("a MATLAB file")
def _read(path: Path, budget: Budget) -> RawFile:
    raw, data = RawFile(path), path.read_bytes()
    if 0 in data[:4]:  # version 4 has no header, and a zero among its first bytes
        _decode_4(raw, data)
    else:
        decode(raw, data)
    return raw


def _decode_4(raw: RawFile, data: bytes) -> None:
    content: Any = io.BytesIO(data)  # which scipy reads, though its type stubs want a path
    for name, shape, _ in whosmat(content):
        check_size(raw.path, name, math.prod(int(n) for n in shape), len(data))
    content.seek(0)
    for name, value in loadmat(content).items():
        if not name.startswith("__"):
            raw.add(name, value, None)
