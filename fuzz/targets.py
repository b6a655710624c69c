"""What is fuzzed: each target takes bytes as a file of others would hold them.

A target may raise a `BreakawayError` of one line. Anything else that leaves it is a fault: another
exception, a file written outside its folder, a program or a connection that was started.
"""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import breakaway as bk
from breakaway.ask.studies.sweep import SweepPlan
from breakaway.errors import BreakawayError
from breakaway.measure.logs.mapping import load_mapping

MEMORY_BYTES = 256 * 2**20
"""What a log may take here."""

Target = Callable[[bytes, Path], None]
"""Takes the content of a file, and an empty folder to put it into."""


def read_log_as(format: str) -> Target:
    """Read the bytes as a log of a format."""

    def target(content: bytes, folder: Path) -> None:
        path = folder / "log"
        path.write_bytes(content)
        bk.read_log(path, format=format, memory_bytes=MEMORY_BYTES)

    return target


def load_with(load: Callable[[Path], object]) -> Target:
    """Load the bytes as a TOML file."""

    def target(content: bytes, folder: Path) -> None:
        path = folder / "file.toml"
        path.write_bytes(content)
        load(path)

    return target


def read_csv_layout(content: bytes, folder: Path) -> None:
    """Read a CSV log whose first line is a mapping in TOML."""
    mapping, _, table = content.partition(b"\n\n")
    (folder / "log.toml").write_bytes(mapping)
    (folder / "log.csv").write_bytes(table)
    bk.read_log(folder / "log.csv", memory_bytes=MEMORY_BYTES)


class StudyFolder:
    """One file of a finished study holds the bytes; the study is opened, read and gone on with.

    Figures are left out: they take seconds, and read no file.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._study = bk.SweepStudy(
            scenario="paper_as_computed",
            changes={"timing.duration_s": 0.005, "disturbance.var": 0.1},
            runs=4,
            sweep={"grid": {"joint.stiction_n": [400.0, 450.0]}},
        )
        self._whole: dict[str, bytes] = {}
        self._expected: list[float] = []

    def seed(self, folder: Path) -> bytes:
        """Run the study once, and give what the file holds."""
        self._expected = self._peaks(self._run(folder))
        paths = [path for path in folder.rglob("*") if path.is_file()]
        self._whole = {str(path.relative_to(folder)): path.read_bytes() for path in paths}
        return self._whole[self._name]

    def __call__(self, content: bytes, folder: Path) -> None:
        """Put the bytes in the place of the file."""
        out = folder / "study"
        for name, whole in (self._whole | {self._name: content}).items():
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            (out / name).write_bytes(whole)
        try:
            opened = bk.open_study(out)
            _ = opened.summary if opened.finished else opened.scan()
        except BreakawayError as error:
            check_line(error)
        result = self._run(out, resume=True)
        assert self._peaks(result) == self._expected, "a changed piece was believed"

    def _run(self, folder: Path, resume: bool = False) -> bk.StudyResult:
        with patch.object(SweepPlan, "draw_figures", lambda *_: {}):
            return bk.run_study(self._study, out=folder, threads=1, resume=resume)

    @staticmethod
    def _peaks(result: bk.StudyResult) -> list[float]:
        peaks: list[float] = result.scan(columns=["peak_force_n"])["peak_force_n"].to_pylist()
        return peaks


TOML = {
    "scenario": bk.load_scenario,
    "population": bk.load_population,
    "method": bk.load_method,
    "stack": bk.load_stack,
    "study": bk.load_study,
    "tuning": bk.load_tuning,
    "joint": bk.JointFile.load,
    "mapping": lambda path: load_mapping(path, path.with_suffix(".csv")),
}
"""What a TOML file may be -> what loads it."""

LOGS = ("csv", "parquet", "mat", "hdf5", "tdms", "mdf", "mcap")

TARGETS: dict[str, Target] = {
    **{f"log_{name}": read_log_as(name) for name in LOGS},
    "log_csv_layout": read_csv_layout,
    **{f"toml_{name}": load_with(load) for name, load in TOML.items()},
    "study_manifest": StudyFolder("manifest.json"),
    "study_summary": StudyFolder("summary.json"),
    "study_piece": StudyFolder("pieces/piece-000000.parquet"),
}
"""Names of targets -> what is done with the bytes."""


def run(target: Target, content: bytes, folder: Path) -> None:
    """Give bytes to a target in an empty folder, and raise where it does what none may do."""
    scratch = folder / "scratch"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    with watched(scratch) as seen:
        try:
            target(content, scratch)
        except BreakawayError as error:
            check_line(error)
    if seen:
        raise AssertionError(f"did what no file may make it do: {seen[:3]}")


def check_line(error: BreakawayError) -> None:
    """Raise unless a message is short enough to be read."""
    assert 0 < len(str(error)) < 20_000, f"a message of {len(str(error))} characters"


WRITING = {"os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.link", "os.symlink", "os.truncate"}
STARTING = {"subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "socket.connect"}


@contextmanager
def watched(scratch: Path) -> Iterator[list[str]]:
    """Note what is written outside a folder, and what is started."""
    if not _WATCH.hooked:
        sys.addaudithook(_WATCH)
        _WATCH.hooked = True
    _WATCH.scratch, _WATCH.seen = str(scratch.resolve()), []
    try:
        yield _WATCH.seen
    finally:
        _WATCH.scratch = None


class _Watch:
    """An audit hook; one for the process, since hooks cannot be taken out."""

    hooked = False
    scratch: str | None = None
    seen: list[str]

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self.scratch is None:
            return
        if event in STARTING:
            self.seen.append(f"{event} {arguments[:1]}")
        elif event in WRITING or (event == "open" and _writes(arguments)):
            paths = arguments[:1] if event == "open" else arguments[:2]
            places = [Path(os.fsdecode(p)).resolve() for p in paths if isinstance(p, str | bytes)]
            self.seen += [f"{event} {p}" for p in places if not p.is_relative_to(self.scratch)]


_WATCH = _Watch()


def _writes(arguments: tuple[Any, ...]) -> bool:
    flags = arguments[2] if len(arguments) > 2 and isinstance(arguments[2], int) else 0
    return bool(flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
