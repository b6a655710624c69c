"""Compare friction laws on a tribometer's log: fit the first 35 s, predict the rest."""

import argparse
from pathlib import Path

import breakaway as bk
from breakaway.show.report.identification import save_identification_report

DEFAULT = Path(__file__).parents[2] / "../shared/data/tribometer/tribometer.csv"
FITTED_S = 35.0


def main() -> None:
    """Print the laws and what the log does not tell, and write a report with --out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", type=Path, nargs="?", default=DEFAULT)
    parser.add_argument("--out", type=Path, help="HTML report to write")
    asked = parser.parse_args()
    if not asked.log.is_file():
        print(f"skipped: there is no {asked.log.name}; README.md says where it comes from")
        return
    log = bk.read_log(asked.log)
    rest = (FITTED_S, float(log.t_s[-1]) + 1.0)
    compared = bk.compare_laws(log, held_out=rest, starts=4)
    print(f"{'law':16} {'fitted, N':>10} {'predicted, N':>13}  pays")
    for one in compared:
        print(
            f"{one.fit.law.label:16} {one.fit.rms_error:10.4f} {one.held_out_error:13.4f}  "
            f"{'yes' if one.pays else 'no'}: {one.because}"
        )
    best = next(one.fit for one in reversed(compared) if one.pays)
    for estimate in best.estimates:
        ends = f"{estimate.low:.4g} to {estimate.high:.4g}"
        print(f"{estimate.name:20} {estimate.value:12.5g}  95 % interval {ends}")
    for verdict in best.verdicts:
        if not verdict.identifiable:
            print(f"not identifiable: {verdict.parameter}, {verdict.because}")
            print(f"    what would determine it: {verdict.remedy}")
    if asked.out is not None:
        predicted = best.predict(spans=[rest])
        samples = best.posterior(2000)
        save_identification_report(
            asked.out, best, posterior=samples, compared=compared, held_out=predicted
        )
        print(f"wrote {asked.out}")


if __name__ == "__main__":
    main()
