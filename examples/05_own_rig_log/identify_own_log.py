"""Make a rig's log, identify the joint, and run a study on joints drawn from what is known."""

import csv
import tempfile
from pathlib import Path

from rig import Truth, measured

import breakaway as bk

MAPPING = """
[time]
from = "time [ms]"
unit = "ms"

[channels.position_m]
from = "encoder"
unit = "mm"

[channels.force_n]
from = "load cell"
unit = "kN"
sign = -1
"""

STUDY = """
kind = "sweep"
name = "drawn joints"
scenario = "paper_as_computed"
joint = "joint.toml"
runs = 200

[sweep.grid]
"disturbance.var" = [0.0, 0.2]
"""

TRUTH = Truth(
    coulomb_n=320.0,
    viscous_n_s_per_m=150.0,
    stiction_ratio=1.3,
    stribeck_velocity_m_per_s=0.01,
    stiffness_n_per_m=1.6e7,
    damping_n_s_per_m=3e3,
    offset_n=5.0,
    top_speed_m_per_s=0.05,
    force_noise_n=3.0,
    force_quantum_n=0.2,
    position_quantum_m=1e-7,
)


def written(log: bk.Log, folder: Path) -> Path:
    """Write the log as a rig's software might: other units, other signs, other names."""
    path = folder / "rig.csv"
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time [ms]", "encoder", "load cell"])
        for t_s, x_m, force_n in zip(log.t_s, log.position_m, log.force_n, strict=True):
            rows.writerow([float(1e3 * t_s), float(1e3 * x_m), float(-1e-3 * force_n)])
    path.with_suffix(".toml").write_text(MAPPING)
    return path


def main() -> None:
    """Print truth and estimates side by side."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        log = bk.read_log(written(measured(TRUTH, 0), folder))
        for line in (*log.history, *log.findings):
            print(f"- {line}")
        found = bk.identify(log, law="lugre", starts=4)
        print(f"{'parameter':28} {'truth':>12} {'estimate':>12}  95 % interval")
        for one in found.estimates:
            ends = f"{one.low:.5g} to {one.high:.5g}" if one.identifiable else one.remark
            print(f"{one.name:28} {getattr(TRUTH, one.name):12.5g} {one.value:12.5g}  {ends}")
        bk.JointFile.from_identification(found).save(folder / "joint.toml")
        (folder / "study.toml").write_text(STUDY)
        done = bk.run_study(bk.load_study(folder / "study.toml"), out=folder / "study")
        print("\n".join(done.summary["result"]))


if __name__ == "__main__":
    main()
