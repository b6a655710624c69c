"""Fit LuGre to the EMPS record in closed loop, and predict a lap that was not fitted."""

import argparse
from pathlib import Path

import breakaway as bk
from breakaway.measure.identification.verdicts import stiction_peak
from breakaway.show.report.identification import save_identification_report

DEFAULT = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"

# The rig's own controller (Janot, Gautier, Brunot 2019); its gains times the drive's N/V.
DRIVE_N_PER_V = 35.15065
CASCADE = bk.Cascade(
    position_gain_per_s=160.18,
    velocity_gain_n_s_per_m=243.45 * DRIVE_N_PER_V,
    force_limit_n=10.0 * DRIVE_N_PER_V,
)
LAPS = [(0.0, 6.24), (6.24, 12.48), (12.48, 18.72)]
LAP_4 = (18.72, 24.85)


def shown(found: bk.Identification) -> None:
    """Print the parameters with their intervals, and what the log says of stiction."""
    for one in found.estimates:
        told = "" if one.identifiable else f"  ({one.remark})"
        print(
            f"{one.name:30} {one.value:12.5g}  95 % interval {one.low:.4g} to {one.high:.4g}{told}"
        )
    print(stiction_peak({one.name: one for one in found.estimates}, found.verdicts))


def main() -> None:
    """Print the hold-out error and the closed-loop force error, and write a report with --out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", type=Path, nargs="?", default=DEFAULT)
    parser.add_argument("--out", type=Path, help="HTML report to write")
    asked = parser.parse_args()
    if not asked.log.is_file():
        print(f"skipped: there is no {asked.log.name}; README.md says where it comes from")
        return
    log = bk.read_log(asked.log)
    settings = {"law": "lugre", "asymmetric": True, "motion": "closed_loop", "controller": CASCADE}
    laps = bk.identify(log, repeats=LAPS, starts=4, **settings)
    free = laps.predict(spans=[LAP_4], motion="free")
    shown(laps)
    print(f"lap 4 in free run, fitted on laps 1 to 3: {1e3 * free.rms_error:.2f} mm RMS")
    whole = bk.identify(log, starts=4, **settings)
    print(f"closed-loop force error, whole record: {whole.relative_error_percent:.2f} %")
    if asked.out is not None:
        samples = laps.posterior(2000)
        save_identification_report(asked.out, laps, posterior=samples, held_out=free)
        print(f"wrote {asked.out}")


if __name__ == "__main__":
    main()
