"""Read a log from a MATLAB file."""

from __future__ import annotations

from pathlib import Path

from breakaway.base.reading import open_regular
from breakaway.measure.logs import mat4, mat5
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.hdf5 import read_matlab_hdf5
from breakaway.measure.logs.raw import RawFile, guarded


def read_mat(path: Path, budget: Budget) -> RawFile:
    """Read the vectors of a MATLAB file of version 4 to 7.3.

    The fields of a structure are channels by the name ``structure.field``; structures within
    structures are not read. Files of version 7.3 are HDF5, which needs h5py.

    Raises
    ------
    LogError
        The file is damaged, or h5py is missing for version 7.3.

    """
    with open_regular(path) as file:
        head = file.read(520)
    if head.startswith((b"MATLAB 7.3", b"\x89HDF")) or head[512:516] == b"\x89HDF":
        return read_matlab_hdf5(path, budget)
    return _read(path, budget)


@guarded("a MATLAB file")
def _read(path: Path, budget: Budget) -> RawFile:
    raw = RawFile(path)
    with open_regular(path) as stream:
        is_version_4 = 0 in stream.read(4)  # it has no header, and a zero among its first bytes
        (mat4 if is_version_4 else mat5).decode(raw, stream, budget)
    return raw
