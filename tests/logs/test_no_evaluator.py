"""Nothing in a log is run, unpickled, imported, or opened beside it, whatever the format.

See docs/adr/0015-files-of-others.md.
"""

import os
import subprocess
import sys
from pathlib import Path

import asammdf
import h5py
import numpy as np
import pytest
from asammdf.blocks import v4_constants as v4c
from asammdf.blocks.v4_blocks import ChannelConversion
from tests.logs.conftest import WRITERS, write_hdf5
from tests.logs.mdf_files import write

import breakaway

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
FORMULAS = {
    "understood.mf4": "X1*10^2",
    "unknown.mf4": "marker(X1)",
    "operator.mf4": "X1 & 3",
}


def happened(reader: str, warm: Path, folder: Path) -> list[str]:
    """Return what is printed while the files of a folder are read in a process of its own."""
    package = str(Path(breakaway.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-m", "tests.logs.watched", reader, str(warm), str(folder)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": package},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [line for line in done.stdout.splitlines() if line]


def write_formula(path: Path, formula: str) -> None:
    """Write a log whose force is 0, 1, 2 and so on, converted by a formula."""
    conversion = ChannelConversion(conversion_type=v4c.CONVERSION_TYPE_ALG, formula=formula)
    t_s, raw = np.arange(20) / 100.0, np.arange(20, dtype=np.uint8)
    signals = [
        asammdf.Signal(t_s, t_s, unit="m", name="position_m"),
        asammdf.Signal(raw, t_s, unit="N", name="force_n", conversion=conversion),
    ]
    write(path.parent, signals).rename(path)


def write_opaque(path: Path) -> None:
    """Write a log with data whose type is told by a text, on its own and in a table."""
    write_hdf5(path)
    with h5py.File(path, "r+") as file:
        kind = h5py.h5t.create(h5py.h5t.OPAQUE, 8)
        kind.set_tag(b"NUMPY:(2,)f4")
        table = h5py.h5t.create(h5py.h5t.COMPOUND, 8)
        table.insert(b"member", 0, kind)
        rows = h5py.h5s.create_simple((4,))
        h5py.h5d.create(file.id, b"opaque", kind, rows)
        h5py.h5d.create(file.id, b"table", table, rows)


def test_reading_does_nothing_but_read(tmp_path: Path) -> None:
    warm, folder = tmp_path / "warm", tmp_path / "folder"
    for place in (warm, folder):
        place.mkdir()
        for name, write_one in WRITERS.items():
            write_one(place / name)
        for name, formula in FORMULAS.items():
            write_formula(place / name, formula)
        write_opaque(place / "opaque.h5")
    printed = happened("ours", warm, folder)
    assert [line for line in printed if line.startswith("event: ")] == []
    last = printed[len(printed) // 2 :]
    assert "understood.mf4: 600 N" in last
    assert any("its formula 'marker(X1)' is not applied" in line for line in last)
    assert any("its formula 'X1 & 3' is not applied" in line for line in last)
    assert sum(line.endswith(": 39.7123 N") for line in last) == len(WRITERS) + 1


@pytest.mark.parametrize("event", ["compile", "exec", "pickle.find_class"])
def test_the_watch_sees_what_it_is_for(tmp_path: Path, event: str) -> None:
    warm, folder = tmp_path / "warm", tmp_path / "folder"
    for place, formula in ((warm, "X1 + 1"), (folder, "X1 + 2")):
        place.mkdir()
        write_formula(place / "force.mf4", formula)
    printed = happened("pickle" if "pickle" in event else "asammdf", warm, folder)
    assert any(line.startswith(f"event: force.mf4: {event} ") for line in printed)
