"""Find the breakaway of ten pneumatic seals, and how it differs from seal to seal."""

import argparse
from pathlib import Path

from breakaway.drawing.style import save_figure
from breakaway.errors import LogError
from breakaway.measure.identification.events import BreakawayReport, find_breakaway_events
from breakaway.measure.identification.population import fit_population
from breakaway.measure.logs import Log, read_log
from breakaway.show.plots.events import plot_breakaway, plot_breakaway_ratios

DEFAULT = Path(__file__).parents[2] / "../shared/data/seals"

# A peak counts as seen if a tenth of the fall to the sliding level was recorded before the gap.
PASSED_SHARE = 0.1


def row(report: BreakawayReport) -> str:
    """Give the row of a run: its first event, or why it has none."""
    name = report.name.removesuffix(".csv")
    if not report.events:
        return f"{name:14} {'; '.join(report.refused)}"
    event = report.events[0]
    rate = "-" if event.loading_rate_n_per_s is None else f"{event.loading_rate_n_per_s:.0f}"
    bound = "yes" if event.is_lower_bound else "no"
    return (
        f"{name:14} {event.breakaway_force_n:10.2f} {bound:>6} "
        f"{event.sliding_force_n:9.2f} {event.breakaway_over_sliding:6.2f} "
        f"{1e3 * event.presliding_displacement_m:14.3f} {rate:>9} "
        f"{report.offset_n:9.2f} {100 * event.fallen_share:9.0f}"
    )


def table(reports: list[BreakawayReport]) -> None:
    """Print a row for each run."""
    print(
        f"{'run':14} {'breakaway':>10} {'lower':>6} {'sliding':>9} {'ratio':>6} "
        f"{'presliding':>14} {'loading':>9} {'offset':>9} {'fallen':>9}"
    )
    print(f"{'':14} {'N':>10} {'bound':>6} {'N':>9} {'':6} {'mm':>14} {'N/s':>9} {'N':>9} {'%':>9}")
    for report in reports:
        print(row(report))


def population(reports: list[BreakawayReport]) -> None:
    """Print how breakaway differs from run to run, or why that cannot be told."""
    try:
        found = fit_population(reports)
    except LogError as error:
        print(f"no population: {error}")
        return
    for name, fit in found.fits.items():
        values = []
        for parameter, value in fit.parameters.items():
            low, high = fit.interval[parameter]
            values.append(f"{parameter} {value:.3g} ({low:.3g} to {high:.3g})")
        print(f"{name:27} {', '.join(values)}; {fit.seen} seen, {fit.censored} lower bounds")
    for note in (*found.notes, *(f"refused: {reason}" for reason in found.refused)):
        print(f"- {note}")


def figures(logs: list[Log], reports: list[BreakawayReport], folder: Path) -> None:
    """Write a figure of each start, and one of all ratios."""
    folder.mkdir(parents=True, exist_ok=True)
    for log, report in zip(logs, reports, strict=True):
        save_figure(plot_breakaway(log, report), folder / f"{Path(report.name).stem}.svg")
    save_figure(plot_breakaway_ratios(reports), folder / "ratios.svg")


def main() -> None:
    """Print table and population of the runs in a folder, and write figures with --out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=DEFAULT)
    parser.add_argument("--out", type=Path, help="folder for the figures")
    asked = parser.parse_args()
    paths = sorted(asked.folder.glob("*.csv"))
    if not paths:
        print("skipped: there are no runs of the seals; README.md says where they come from")
        return
    logs = [read_log(path).using(force_n="friction_n") for path in paths]
    print("strict: a gap before half of the fall makes a lower bound")
    strict = [find_breakaway_events(log) for log in logs]
    table(strict)
    population(strict)
    print(f"\na peak counts as seen once {100 * PASSED_SHARE:.0f} % of the fall was recorded")
    lenient = [find_breakaway_events(log, passed_share=PASSED_SHARE) for log in logs]
    table(lenient)
    population(lenient)
    if asked.out is not None:
        figures(logs, lenient, asked.out)


if __name__ == "__main__":
    main()
