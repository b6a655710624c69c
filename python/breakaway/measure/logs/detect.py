"""Which format a log file has: by its first bytes, else by its suffix."""

from __future__ import annotations

from pathlib import Path

from breakaway.base.reading import open_regular
from breakaway.errors import LogError

MAGIC = {
    b"PAR1": "parquet",
    b"MATLAB ": "mat",
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"TDSm": "tdms",
    b"MDF     ": "mdf",
    b"UnFinMF ": "mdf",
    b"\x89MCAP0\r\n": "mcap",
    b"LabVIEW Measurem": "csv",
}

SUFFIXES = {
    ".csv": "csv",
    ".txt": "csv",
    ".tsv": "csv",
    ".lvm": "csv",
    ".asc": "csv",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".mat": "mat",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".hdf": "hdf5",
    ".tdms": "tdms",
    ".mf4": "mdf",
    ".mdf": "mdf",
    ".mcap": "mcap",
}


def detect(path: Path) -> str:
    """Return the format of a file.

    Raises
    ------
    LogError
        Neither its first bytes nor its suffix are known.

    """
    with open_regular(path) as file:
        head = file.read(16)
    for magic, name in MAGIC.items():
        if head.startswith(magic):
            is_matlab = name == "hdf5" and path.suffix.lower() == ".mat"
            return "mat" if is_matlab else name
    found = SUFFIXES.get(path.suffix.lower())
    if found is None:
        raise LogError(
            f"{path.name}: neither its first bytes nor its suffix '{path.suffix}' tell the format; "
            f"name it with --format (format=), one of {', '.join(dict.fromkeys(SUFFIXES.values()))}"
        )
    return found
