"""Read big logs with breakaway and with the library of the format, side by side.

Each reading has a process of its own, so that its peak memory is its own; imports do not count
as time. `python -m bench.logs` prints the table, `make bench` takes its figures.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv

TURNS = 3
"""Readings of each; the least counts, since whatever else the machine does only adds."""

WANTED = """
import breakaway.measure.logs
WANTED = {"channels": {"position_m": {"from": "position_m"}, "force_n": {"from": "force_n"}}}
"""
OURS = "log = breakaway.measure.logs.read_log(path, WANTED)"
"""What is imported and timed of ours, where two channels and their time are wanted."""

PROGRAM = r"""
import json, re, resource, sys
from pathlib import Path
{imports}
path = sys.argv[1]
begin = resource.getrusage(resource.RUSAGE_SELF)
{code}
end = resource.getrusage(resource.RUSAGE_SELF)
peak = re.search(r"VmHWM:\s+(\d+)", Path("/proc/self/status").read_text())
seconds = end.ru_utime - begin.ru_utime + end.ru_stime - begin.ru_stime
print(json.dumps(dict(cpu_s=seconds, peak_mib=int(peak[1]) / 1024)))
"""


@dataclass(frozen=True)
class Row:
    """A file, and how it is read by others and by us."""

    name: str
    """Of the figures."""
    file: str
    write: Callable[[Path], None]
    imports: str
    """Modules of the library."""
    theirs: str
    """What is timed of the library; the file is ``path``."""
    cpu_aim: float
    memory_aim: float
    ours: str = OURS


def write_csv(path: Path) -> None:
    """Write 200 MB: 4,000,000 rows of 6 numbers."""
    rows, random = 4_000_000, np.random.default_rng(1)
    columns = {"t_s": np.arange(rows) / 1e4}
    for name in ("position_m", "force_n", "temperature_degc", "pressure_pa", "spare"):
        columns[name] = np.round(random.normal(0.0, 10.0, rows), 5)
    pyarrow.csv.write_csv(pa.table(columns), path)


ROWS = [
    Row(
        "csv_200_mb",
        "log.csv",
        write_csv,
        "import pyarrow.csv",
        "options = pyarrow.csv.ConvertOptions(include_columns=['t_s', 'position_m', 'force_n'])\n"
        "table = pyarrow.csv.read_csv(path, convert_options=options)\n"
        "columns = [column.to_numpy() for column in table.columns]",
        cpu_aim=2.0,
        memory_aim=1.5,
    ),
]


def one_reading(path: Path, imports: str, code: str) -> dict[str, float]:
    """CPU seconds and peak memory in MiB of one reading, in a process of its own."""
    program = PROGRAM.format(imports=imports, code=code)
    command = [sys.executable, "-c", program, str(path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    figures: dict[str, float] = json.loads(done.stdout)
    return figures


def measure(row: Row, folder: Path) -> dict[str, float]:
    """Read a file by turns; return the figures of both, and ours over theirs."""
    path = folder / row.file
    row.write(path)
    readers = {"ours": (WANTED, row.ours), "theirs": (row.imports, row.theirs)}
    best: dict[str, float] = {}
    for _ in range(TURNS):
        for who, (imports, code) in readers.items():
            for what, value in one_reading(path, imports, code).items():
                name = f"{row.name}_{who}_{what}"
                best[name] = min(best.get(name, float("inf")), value)
    path.unlink()
    for what, word in (("cpu_s", "cpu"), ("peak_mib", "memory")):
        ours, theirs = best[f"{row.name}_ours_{what}"], best[f"{row.name}_theirs_{what}"]
        best[f"{row.name}_{word}_over_library"] = ours / theirs
    return best


def logs() -> dict[str, float]:
    """Measure every row."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: value for row in ROWS for name, value in measure(row, Path(folder)).items()}


AIMS = {f"{row.name}_cpu_over_library": ("<=", row.cpu_aim) for row in ROWS} | {
    f"{row.name}_memory_over_library": ("<=", row.memory_aim) for row in ROWS
}
"""What the project aims for."""

if __name__ == "__main__":
    for name, value in logs().items():
        print(f"{name:48s} {value:12.4g}")
