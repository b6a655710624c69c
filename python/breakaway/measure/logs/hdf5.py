"""Read a log from an HDF5 file, which MATLAB 7.3 files are too."""

from __future__ import annotations

import math
import zlib
from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.base.reading import open_regular
from breakaway.errors import LogError
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.hdf5_types import is_opaque
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.raw import (
    DEFLATE_RATIO,
    RawFile,
    channel_side,
    check_claim,
    guarded,
    need,
    no_vector,
)

DEEPEST_GROUP = 8
MOST_OBJECTS = 10_000
"""Limits on groups within groups, and on all groups and arrays of a file."""

TEXT_CLASSES = ("char", "cell", "struct", "string", "function_handle")
"""MATLAB classes whose arrays hold numbers that are none."""

DEFLATE, SHUFFLE, FLETCHER, LZF = 1, 2, 3, 32000
FILTERS = {DEFLATE: DEFLATE_RATIO, SHUFFLE: 1, FLETCHER: 1, LZF: 88}
"""Filter that is read -> the most that it compresses. HDF5 would load the code of one that it does
not know from a folder of plugins."""

PACKING = ("scale_factor", "add_offset", "_FillValue", "missing_value")
"""Attributes of packed numbers, and of what stands for none."""

NONE = np.zeros(0, dtype=np.intp)

CHECKSUM = 4
"""Bytes that Fletcher 32 adds to a chunk."""

MATLAB_PLACES = ("#refs#", "#subsystem#")
"""Groups in which MATLAB keeps the content of cells and objects."""


@dataclass(frozen=True)
class _Array:
    """An array that can be read, or one member of a table; how its numbers were packed."""

    dataset: Any
    member: str = ""
    factor: float = 1.0
    offset: float = 0.0
    missing: tuple[float, ...] = ()
    """What stands for no value, among the packed numbers."""
    part: tuple[slice | int, ...] = ()
    """Which part of the array it is; empty for all of it."""


@guarded("an HDF5 file")
def open_hdf5(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open an HDF5 file, whose channels are its one-dimensional arrays by their paths.

    The unit of an array is taken from its attribute ``unit`` or ``units``. The members of a
    table are channels. Numbers that are packed by ``scale_factor`` and ``add_offset``, as in
    netCDF, are unpacked. No other file is opened: neither links, nor virtual arrays, nor external
    storage, nor plugins for filters are followed.

    Parameters
    ----------
    path : Path
        The file.
    budget : Budget
        What it may take.

    Raises
    ------
    LogError
        h5py is missing, the file is damaged, or takes more than it may.

    """
    yield from _open(path, budget, "/")


@guarded("a MATLAB 7.3 file")
def open_matlab_hdf5(path: Path, budget: Budget) -> Generator[RawFile, None, None]:
    """Open a MATLAB 7.3 file, in which a point joins a structure and its field."""
    yield from _open(path, budget, ".")


def _open(path: Path, budget: Budget, separator: str) -> Generator[RawFile, None, None]:
    h5py = need("h5py", "h5py", "hdf5", path, "HDF5")
    raw = RawFile(path)
    with open_regular(path) as stream, h5py.File(stream, "r") as file:
        arrays: dict[str, _Array] = {}
        for name, dataset in _datasets(h5py, raw, file, separator):
            reason = _elsewhere(dataset) or _no_numbers(h5py, dataset) or _unwritten(dataset)
            if reason:
                raw.refuse(name, reason)
            else:
                _list(h5py, raw, arrays, name, dataset, separator)

        def read(wanted: list[str]) -> None:
            for name in wanted:
                _ask(raw.path, budget, name, arrays[name])
            for name in wanted:
                _read(raw, name, arrays[name])

        raw.read = read
        yield raw


def _list(
    h5py: Any,  # noqa: ANN401
    raw: RawFile,
    arrays: dict[str, _Array],
    name: str,
    dataset: Any,  # noqa: ANN401
    separator: str,
) -> None:
    """List an array, or the members of a table."""
    fields = dataset.dtype.fields
    if fields is None:
        unit = _attribute(h5py, dataset, "unit") or _attribute(h5py, dataset, "units")
        packed, length = _packed(h5py, dataset), max(dataset.shape, default=1)
        for full, part in _parts(name, dataset):
            raw.list(ListedChannel(full, unit, str(dataset.dtype), length))
            arrays[full] = replace(packed, part=part)
        return
    for member, (kind, *_) in fields.items():
        full = name + separator + member
        if reason := no_vector(kind, (1,)):
            raw.refuse(full, reason)
        else:
            raw.list(ListedChannel(full, "", str(kind), dataset.size))
            arrays[full] = _Array(dataset, member)


def _parts(name: str, dataset: Any) -> list[tuple[str, tuple[slice | int, ...]]]:  # noqa: ANN401
    """Give the channels of an array with their names: itself, or those of a matrix."""
    side = channel_side(dataset.dtype, dataset.shape)
    if side is None:
        return [(name, ())]
    whole = slice(None)
    return [
        (side.name(name, place), (whole, place) if side.axis else (place, whole))
        for place in range(dataset.shape[side.axis])
    ]


def _packed(h5py: Any, dataset: Any) -> _Array:  # noqa: ANN401
    """Return an array with what its attributes say of how its numbers were packed.

    Source: NetCDF Climate and Forecast Metadata Conventions, packed data and missing data.
    """
    named = {one: _numbers(h5py, dataset, one) for one in PACKING}
    (factor,) = named["scale_factor"][:1] or (1.0,)
    (offset,) = named["add_offset"][:1] or (0.0,)
    return _Array(dataset, "", factor, offset, (*named["_FillValue"], *named["missing_value"]))


def _datasets(h5py: Any, raw: RawFile, root: Any, separator: str) -> Iterator[tuple[str, Any]]:  # noqa: ANN401
    """Give all arrays by their paths, level by level; note what is not followed."""
    seen = 0
    level = [("", root)]
    for depth in range(DEEPEST_GROUP):
        below = []
        for prefix, group in level:
            for name in group:
                seen += 1
                if seen > MOST_OBJECTS:
                    raise LogError(
                        f"{raw.path.name}: holds more than {MOST_OBJECTS:,} objects, the limit: "
                        "export fewer"
                    )
                if name in MATLAB_PLACES:
                    continue
                link = group.get(name, getlink=True)
                if not isinstance(link, h5py.HardLink):
                    raw.refuse(prefix + name, _link(h5py, link))
                    continue
                item = group[name]
                if isinstance(item, h5py.Dataset):
                    yield prefix + name, item
                elif not isinstance(item, h5py.Group):
                    continue
                elif depth + 1 < DEEPEST_GROUP:
                    below.append((prefix + name + separator, item))
                else:
                    reason = f"lies deeper than {DEEPEST_GROUP} groups; move it up"
                    raw.refuse(prefix + name, reason)
        level = below


def _link(h5py: Any, link: Any) -> str:  # noqa: ANN401
    if isinstance(link, h5py.ExternalLink):
        return "is a link to another file; links are not followed: name that file"
    return "is a link; links are not followed: name what it leads to"


def _elsewhere(dataset: Any) -> str:  # noqa: ANN401
    """Say why reading an array would need more than the file, or nothing."""
    plan = dataset.id.get_create_plist()
    if plan.get_external_count():
        return "is kept in another file (external storage), which is not opened: export its values"
    if dataset.is_virtual:
        return "is kept in other arrays (virtual), which are not opened: export its values"
    filters = _filters(dataset)
    for number in filters:
        if number not in FILTERS or filters.count(number) > 1 or {DEFLATE, LZF} <= {*filters}:
            return (
                f"goes through filter {number} of HDF5; only deflate or LZF, shuffle and Fletcher "
                "32 are read, each once: export it so, or without filters"
            )
    if DEFLATE in filters and SHUFFLE in filters[filters.index(DEFLATE) :]:
        return "is deflated before it is shuffled; export it the other way around"
    return ""


def _filters(dataset: Any) -> list[int]:  # noqa: ANN401
    plan = dataset.id.get_create_plist()
    return [plan.get_filter(place)[0] for place in range(plan.get_nfilters())]


def _no_numbers(h5py: Any, dataset: Any) -> str:  # noqa: ANN401
    """Say why an array is no vector of real numbers, or nothing; members of tables come later."""
    if is_opaque(h5py, dataset.id.get_type()):
        return "is of opaque data; it must be real numbers"
    try:
        kind = dataset.dtype
    except (TypeError, ValueError) as error:
        return f"is of a type that is not known ({error}); it must be real numbers"
    if h5py.check_ref_dtype(kind) is not None:
        return "is of references to other places; it must be real numbers"
    if _attribute(h5py, dataset, "MATLAB_class") in TEXT_CLASSES:
        return "is text or a cell array; it must be a vector of real numbers"
    if dataset.shape is None:
        return "is empty; it must be a vector of real numbers"
    if channel_side(kind, dataset.shape):
        return ""
    return no_vector(np.dtype(float) if kind.names else kind, dataset.shape)


def _unwritten(dataset: Any) -> str:  # noqa: ANN401
    """Say whether an array has values that were never written: HDF5 makes them up, mostly as 0."""
    if dataset.chunks is None:
        told, written = 1, int(dataset.id.get_storage_size() > 0)
    else:
        sizes = zip(dataset.shape, dataset.chunks, strict=True)
        told = math.prod(-(-size // chunk) for size, chunk in sizes)
        written = dataset.id.get_num_chunks()
    if written >= told:
        return ""
    return (
        f"was never written in full: the file has {written:,} of {told:,} pieces, and no values "
        "for the others; record it again, or export it up to there"
    )


def _ask(path: Path, budget: Budget, name: str, one: _Array) -> None:
    """Ask for the memory of an array, which the file must be able to hold."""
    dataset = one.dataset
    claimed = dataset.size * dataset.dtype.itemsize
    ratio = math.prod(FILTERS[number] for number in _filters(dataset))
    check_claim(path, f"'{name}'", claimed, ratio * dataset.id.get_storage_size())
    passing = 0 if dataset.dtype == np.float64 else claimed
    if dataset.chunks is not None:
        passing += _chunk_bytes(path, name, dataset)
    budget.take(f"'{name}'", 8 * dataset.size, passing)


def _chunk_bytes(path: Path, name: str, dataset: Any) -> int:  # noqa: ANN401
    """Return what the largest chunk of an array takes while it is unpacked.

    HDF5 unpacks a chunk whole, whatever its size turns out to be.
    """
    most: int = math.prod(dataset.chunks) * dataset.dtype.itemsize
    filters = _filters(dataset)
    chunks: list[Any] = []
    dataset.id.chunk_iter(chunks.append)
    if DEFLATE in filters:
        packed = [c for c in chunks if not c.filter_mask >> filters.index(DEFLATE) & 1]
        for chunk in packed:
            stored = dataset.id.read_direct_chunk(chunk.chunk_offset)[1]
            inflate = zlib.decompressobj()
            inflate.decompress(stored, most + CHECKSUM)
            if not inflate.eof:
                raise LogError(
                    f"{path.name}: a chunk of '{name}' does not hold the {most} bytes that it "
                    "claims; it is damaged: export the log again"
                )
    largest: int = max((chunk.size for chunk in chunks), default=0)
    return max(most, largest * FILTERS[LZF] if LZF in filters else largest)


def _read(raw: RawFile, name: str, one: _Array) -> None:
    if one.member:
        raw.add(name, one.dataset.fields([one.member])[()][one.member], None)
        return
    values = one.dataset[one.part]
    lacking = np.flatnonzero(np.isin(values, one.missing)) if one.missing else NONE
    if lacking.size:
        raw.give_up(
            name,
            f"row {lacking[0] + 1}: is missing, as _FillValue or missing_value says, and so are "
            f"{lacking.size - 1} others; every row must have a value: cut these rows out",
        )
    elif (one.factor, one.offset) == (1.0, 0.0):
        raw.add(name, values, None)
    else:
        raw.add(name, one.factor * values + one.offset, None)


def _numbers(h5py: Any, dataset: Any, name: str) -> tuple[float, ...]:  # noqa: ANN401
    """Return the finite numbers of an attribute, none where it has others or is missing."""
    if name not in dataset.attrs or is_opaque(h5py, dataset.attrs.get_id(name).get_type()):
        return ()
    try:
        values = np.asarray(dataset.attrs[name], dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        return ()
    return tuple(values[np.isfinite(values)].tolist())


def _attribute(h5py: Any, dataset: Any, name: str) -> str:  # noqa: ANN401
    """Return an attribute that is one text, or an empty one."""
    if name not in dataset.attrs or is_opaque(h5py, dataset.attrs.get_id(name).get_type()):
        return ""
    try:
        value = dataset.attrs[name]
    except (TypeError, ValueError):  # of a type that h5py does not know
        return ""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    return value if isinstance(value, str) else ""
