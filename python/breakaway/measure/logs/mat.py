"""Read a log from a MATLAB file."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path

from breakaway.base.reading import open_regular
from breakaway.measure.logs import mat4, mat5
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.hdf5 import open_matlab_hdf5
from breakaway.measure.logs.raw import RawFile, guarded


@contextmanager
def open_mat(path: Path, budget: Budget) -> Iterator[RawFile]:
    """Open a MATLAB file of version 4 to 7.3, whose channels are its vectors.

    Those of a matrix are ``log#1``, ``log#2`` and so on, along its shorter side. The fields of a
    structure are ``structure.field``, those of the second of several ``structure#2.field``; data
    beside their name have that name, as dSPACE and Simulink write them. Files of version 7.3 are
    HDF5, which needs h5py.

    Raises
    ------
    LogError
        The file is damaged, or h5py is missing for version 7.3.

    """
    with open_regular(path) as file:
        head = file.read(520)
    is_hdf5 = head.startswith((b"MATLAB 7.3", b"\x89HDF")) or head[512:516] == b"\x89HDF"
    with (open_matlab_hdf5 if is_hdf5 else _open)(path, budget) as raw:
        yield raw


@guarded("a MATLAB file")
def _open(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a file of version 4 to 7.2, whose names are known only once it is unpacked."""
    raw = RawFile(path)
    with open_regular(path) as stream:
        is_version_4 = 0 in stream.read(4)  # it has no header, and a zero among its first bytes
        (mat4 if is_version_4 else mat5).decode(raw, stream, budget)
    yield raw
