"""Read a log from an HDF5 file, which MATLAB 7.3 files are too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from breakaway.errors import LogError
from breakaway.logs.budget import Budget
from breakaway.logs.hdf5_types import is_opaque
from breakaway.logs.raw import DEFLATE_RATIO, RawFile, check_size, guarded, need

DEEPEST_GROUP = 8
MOST_OBJECTS = 10_000
"""Limits on groups within groups, and on all groups and arrays of a file."""

TEXT_CLASSES = ("char", "cell", "struct", "string", "function_handle")
"""MATLAB classes whose arrays hold numbers that are none."""


@guarded("an HDF5 file")
def read_hdf5(path: Path, budget: Budget) -> RawFile:
    """Read the one-dimensional arrays of an HDF5 file, whose names are their paths.

    The unit of an array is taken from its attribute ``unit`` or ``units``. The members of a
    table are channels. Links to other places are not followed.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    LogError
        h5py is missing, or the file is damaged.

    """
    return _read(path, budget, "/")


@guarded("a MATLAB 7.3 file")
def read_matlab_hdf5(path: Path, budget: Budget) -> RawFile:
    """Read a MATLAB 7.3 file, in which a point joins a structure and its field."""
    return _read(path, budget, ".")


def _read(path: Path, budget: Budget, separator: str) -> RawFile:
    h5py = need("h5py", "h5py", "hdf5", path, "HDF5")
    raw = RawFile(path)
    with h5py.File(path, "r") as file:
        for name, dataset in _datasets(h5py, path, file, separator):
            if is_opaque(h5py, dataset.id.get_type()):
                raw.unreadable[name] = "is of opaque data; it must be real numbers"
            else:
                _add(raw, name, dataset, separator)
    return raw


def _datasets(h5py: Any, path: Path, root: Any, separator: str) -> list[tuple[str, Any]]:  # noqa: ANN401
    """Return all arrays by their paths, level by level."""
    found, seen = [], 0
    level = [("", root)]
    for _ in range(DEEPEST_GROUP):
        below = []
        for prefix, group in level:
            for name in group:
                seen += 1
                if seen > MOST_OBJECTS:
                    raise LogError(f"{path.name}: holds more than {MOST_OBJECTS} objects")
                if name.startswith("#"):  # where MATLAB keeps the content of cells
                    continue
                if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                    continue
                item = group[name]
                if isinstance(item, h5py.Group):
                    below.append((prefix + name + separator, item))
                elif isinstance(item, h5py.Dataset):
                    found.append((prefix + name, item))
        level = below
    return found


def _add(raw: RawFile, name: str, dataset: Any, separator: str) -> None:  # noqa: ANN401
    if _text(dataset.attrs.get("MATLAB_class", "")) in TEXT_CLASSES:
        raw.unreadable[name] = "is text or a cell array; it must be a vector of real numbers"
        return
    if dataset.dtype.kind not in "fiubV":
        raw.unreadable[name] = f"is of type {dataset.dtype}; it must be real numbers"
        return
    if dataset.shape is None or max(dataset.shape, default=1) != dataset.size:
        raw.unreadable[name] = (
            f"is an array of shape {dataset.shape}; it must be a vector of real numbers"
        )
        return
    _check_storage(raw.path, name, dataset)
    unit = _text(dataset.attrs.get("unit", dataset.attrs.get("units", "")))
    values = np.asarray(dataset[()])
    for member in values.dtype.names or ():
        raw.add(name + separator + member, values[member], None)
    if values.dtype.names is None:
        raw.add(name, values, None, unit)


def _check_storage(path: Path, name: str, dataset: Any) -> None:  # noqa: ANN401
    """Refuse an array whose claimed size is not stored in the file."""
    stored = dataset.id.get_storage_size()
    ratio = DEFLATE_RATIO if dataset.chunks else 1
    check_size(path, name, dataset.size, ratio * stored / max(dataset.dtype.itemsize, 1))


def _text(value: Any) -> str:  # noqa: ANN401 - an attribute holds anything
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    return value if isinstance(value, str) else ""
