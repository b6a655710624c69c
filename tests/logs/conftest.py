"""Small files of every format, all of one motion, written by the format's own library."""

import json
import logging
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import asammdf
import h5py
import mcap.writer
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

ROWS = 200
T_S = np.arange(ROWS) / 100.0
POSITION_M = 0.05 * np.sin(2 * T_S)
FORCE_N = 40.0 * np.cos(2 * T_S)


def write_csv(path: Path) -> None:
    table = np.column_stack([T_S, POSITION_M, FORCE_N])
    np.savetxt(path, table, "%.17g", ",", header="t_s,position_m,force_n", comments="")


def write_parquet(path: Path) -> None:
    pq.write_table(pa.table({"t_s": T_S, "position_m": POSITION_M, "force_n": FORCE_N}), path)


def write_mat(path: Path, **options: Any) -> None:
    savemat(path, {"t_s": T_S, "position_m": POSITION_M, "force_n": FORCE_N}, **options)


def write_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["t_s"], file["position_m"], file["force_n"] = T_S, POSITION_M, FORCE_N


def write_chunked_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name, values in (("t_s", T_S), ("position_m", POSITION_M), ("force_n", FORCE_N)):
            file.create_dataset(name, data=values, chunks=(64,), compression="gzip")


def write_mat73(path: Path) -> None:
    """Write the layout of MATLAB 7.3: HDF5 behind a header of 512 bytes, arrays as matrices."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("t_s", T_S), ("position_m", POSITION_M), ("force_n", FORCE_N)):
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))


def write_tdms(path: Path) -> None:
    waveform = {"wf_start_offset": 0.0, "wf_increment": 0.01}
    channels = [
        ChannelObject("Rig", "position", POSITION_M, waveform | {"unit_string": "m"}),
        ChannelObject("Rig", "force", FORCE_N, waveform | {"unit_string": "N"}),
    ]
    with TdmsWriter(path) as writer:
        writer.write_segment(channels)


def write_mdf(path: Path, compression: int = 0) -> None:
    logging.disable(logging.CRITICAL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with asammdf.MDF(version="4.10") as file:
            signals = [
                asammdf.Signal(POSITION_M, T_S, unit="m", name="position"),
                asammdf.Signal(FORCE_N, T_S, unit="N", name="force"),
            ]
            file.append(signals)
            file.save(path, overwrite=True, compression=compression)
    logging.disable(logging.NOTSET)


def write_mcap(path: Path) -> None:
    with path.open("wb") as stream:
        writer = mcap.writer.Writer(stream)
        writer.start()
        channel = writer.register_channel("rig", "json", 0)
        for t_s, x, force in zip(T_S, POSITION_M, FORCE_N, strict=True):
            stamp = round(t_s * 1e9) + 1_700_000_000_000_000_000
            data = json.dumps({"position_m": x, "force_n": force, "state": "on"}).encode()
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()


WRITERS: dict[str, Callable[[Path], None]] = {
    "small.csv": write_csv,
    "small.parquet": write_parquet,
    "small.mat": write_mat,
    "v4.mat": lambda path: write_mat(path, format="4"),
    "packed.mat": lambda path: write_mat(path, do_compression=True),
    "v73.mat": write_mat73,
    "small.h5": write_hdf5,
    "chunked.h5": write_chunked_hdf5,
    "small.tdms": write_tdms,
    "small.mf4": write_mdf,
    "packed.mf4": lambda path: write_mdf(path, compression=2),
    "small.mcap": write_mcap,
}


@pytest.fixture(scope="session", params=list(WRITERS))
def every_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a file of each kind in turn."""
    path: Path = tmp_path_factory.mktemp("formats") / request.param
    WRITERS[request.param](path)
    return path


@pytest.fixture(scope="session")
def motion() -> dict[str, np.ndarray]:
    """What the files of `every_file` hold."""
    return {"t_s": T_S, "position_m": POSITION_M, "force_n": FORCE_N}
