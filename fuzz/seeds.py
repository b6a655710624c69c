"""Good files for each target, which its inputs are made from."""

from __future__ import annotations

import tempfile
from importlib.resources import files
from pathlib import Path

import numpy as np
import tomli_w
from tests.logs.conftest import WRITERS

import breakaway as bk
from fuzz.targets import TARGETS, StudyFolder

SUFFIXES = {
    "csv": (".csv",),
    "parquet": (".parquet",),
    "mat": (".mat",),
    "hdf5": (".h5",),
    "tdms": (".tdms",),
    "mdf": (".mf4",),
    "mcap": (".mcap",),
}
PRESETS = {"scenario": "", "population": "populations", "method": "methods", "stack": "stacks"}
MAPPING = {
    "channels": {
        "position_m": {"from": "x", "unit": "mm", "sign": -1},
        "force_n": {"from": "f", "unit": "V", "scale": 2.5, "time": "t"},
    },
    "time": {"from": "t", "unit": "ms"},
    "csv": {"delimiter": ";", "decimal": ",", "skip_rows": 1, "units_row": True},
}
STUDY = {
    "kind": "sweep",
    "scenario": "paper_as_computed",
    "runs": 3,
    "sweep": {"grid": {"joint.stiction_n": [400.0, 450.0]}},
}
TUNING = {
    "population": "seized_parts",
    "method": "steady_feed",
    "objectives": ["strict_share", "median_time_to_release_s"],
    "tune": {"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
}


def seeds(name: str) -> list[bytes]:
    """Give good contents for a target."""
    kind, _, rest = name.partition("_")
    if name == "log_csv_layout":
        rows = "".join(f"{k};{k / 7:.4f};1.5\n".replace(".", ",") for k in range(12))
        mapping = tomli_w.dumps(MAPPING).replace("\n\n", "\n")
        return [f"{mapping}\n\nhead\nt;x;f\nms;mm;V\n{rows}".encode()]
    if kind == "log":
        return [_written(file) for file in WRITERS if file.endswith(SUFFIXES[rest])]
    if kind == "study":
        target = TARGETS[name]
        assert isinstance(target, StudyFolder)
        with tempfile.TemporaryDirectory() as folder:
            return [target.seed(Path(folder))]
    if rest in PRESETS:
        presets = files("breakaway.model.presets").joinpath(*PRESETS[rest].split())
        return [p.read_bytes() for p in presets.iterdir() if p.name.endswith(".toml")]
    plain = {"study": STUDY, "tuning": TUNING, "mapping": MAPPING}
    return [tomli_w.dumps(plain[rest]).encode()] if rest in plain else [_joint()]


def _joint() -> bytes:
    t_s = np.arange(4000) / 1000.0
    v = 0.3 * np.cos(3 * t_s) + 0.35 * np.cos(7 * t_s + 1)
    a = -0.9 * np.sin(3 * t_s) - 2.45 * np.sin(7 * t_s + 1)
    x = 0.1 * np.sin(3 * t_s) + 0.05 * np.sin(7 * t_s + 1)
    log = bk.Log(t_s=t_s, position_m=x, force_n=5.0 * a + 20.0 * v + 4.0 * np.sign(v))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "joint.toml"
        bk.JointFile.from_fit(bk.identify_inertia_friction(log), log).save(path)
        return path.read_bytes()


def _written(file: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file
        WRITERS[file](path)
        return path.read_bytes()


def write_seeds(name: str, folder: Path) -> Path:
    """Write the good contents of a target into a folder."""
    folder.mkdir(parents=True)
    for number, content in enumerate(seeds(name)):
        (folder / f"seed_{number}").write_bytes(content)
    return folder
