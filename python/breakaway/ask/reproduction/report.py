"""Reproduce the paper: simulate, compare, and write the report."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from breakaway._core import __version__
from breakaway.ask.reproduction.figures import ReproducedFigure, draw_all
from breakaway.ask.reproduction.findings import (
    Finding,
    misprints,
    simulated,
    table_1_and_table_2,
)
from breakaway.ask.reproduction.readings import READINGS
from breakaway.ask.reproduction.rows import Row
from breakaway.ask.reproduction.runs import Runs, simulate_all
from breakaway.ask.reproduction.survey import (
    CONFIDENCE,
    CONTROLS,
    NAMES,
    DisturbanceRange,
    FullSurvey,
)
from breakaway.ask.reproduction.tables import table_1, table_2
from breakaway.base.output import claim, output_folder
from breakaway.base.ownership import REPRODUCTION, refuse_links
from breakaway.drawing.style import save_figure
from breakaway.show.report.page import render

VERDICT = {True: "agrees", False: "differs", None: "not in the paper"}
"""What is said of a row."""


@dataclass(frozen=True)
class Reproduction:
    """A finished reproduction."""

    report_path: Path
    """The HTML report."""
    header: Sequence[str]
    """Column names of `table`."""
    table: Sequence[Sequence[str]]
    """The summary: finding, paper, ours, verdict."""


def reproduce(
    out: Path,
    progress: Callable[[str], None] = lambda _: None,
    full: FullSurvey | None = None,
) -> Reproduction:
    """Reproduce the paper's tables and figures into a folder.

    Writes ``report.html`` (self-contained), ``reproduction.json``, each figure as SVG and PNG, and
    the data of figure 10 as CSV; all of them or none.

    Parameters
    ----------
    out : Path
        The folder; made if it does not exist.
    progress : callable, optional
        Called with a few words before each part of the work.
    full : FullSurvey, optional
        Figure 10 from many runs, which are kept in the folder ``figure_10`` level by level; those
        that are there are not computed again. Left out: from few runs.

    Raises
    ------
    StudyError
        The folder holds figure 10 with other settings or of another version.
    OutputError
        The folder cannot be written, holds a result of another kind, files of others under these
        names, or a symbolic link in place of a folder of figure 10.

    """
    rows = [*table_1(), *table_2()]
    from_table_1 = table_2("paper_as_printed", key="table2_from_table1")
    ranges = None
    names = ("report.html", REPRODUCTION.marker)
    claim(out, REPRODUCTION, names)
    if full is not None:
        progress(f"figure 10: {len(full.levels)} levels x {full.seeds:,} runs of each control")
        refuse_links(out / "figure_10", *(out / "figure_10" / control for control in CONTROLS))
        ranges = full.run(out / "figure_10")
    with output_folder(out, REPRODUCTION, names) as staging:
        runs = simulate_all(progress, ranges)
        findings = [*misprints(), table_1_and_table_2(from_table_1), *simulated(runs)]
        progress("figures and report")
        figures = draw_all(runs)
        _save_figures(figures, staging)
        glance = _at_a_glance(rows, from_table_1, findings)
        page = _page(rows, from_table_1, findings, figures, glance, runs, staging)
        (staging / "report.html").write_text(page, encoding="utf-8")
        values = _json(rows + from_table_1, findings, figures, runs)
        (staging / "reproduction.json").write_text(
            json.dumps(values, indent=1, allow_nan=False), encoding="utf-8"
        )
    table = [[g.what, str(g.printed), str(g.ours), VERDICT[g.agrees]] for g in glance]
    return Reproduction(out / "report.html", ("finding", "paper", "ours", ""), table)


def _at_a_glance(
    rows: Sequence[Row], from_table_1: Sequence[Row], findings: Sequence[Finding]
) -> list[Row]:
    gains = [row for row in rows if row.key.startswith("table2.")]
    agree, agree_1 = (sum(row.agrees is True for row in group) for group in (gains, from_table_1))
    counted = [
        _glance_row(
            "18 gains of Table II, from the joint it implies",
            "18",
            f"{agree} within one unit of the last digit",
            agree == len(gains),
        ),
        _glance_row(
            "18 gains of Table II, from Table I as printed",
            "18",
            f"{agree_1} within one unit of the last digit",
            agree_1 == len(gains),
        ),
    ]
    return counted + [
        _glance_row(f.title, f.printed, f.brief, f.agrees) for f in findings if f.brief
    ]


def _glance_row(what: str, printed: str, ours: str, agrees: bool | None) -> Row:
    return Row(f"glance.{what}", what, printed, ours, "", agrees, "")


def _save_figures(figures: Sequence[ReproducedFigure], folder: Path) -> None:
    for figure in figures:
        for kind in ("svg", "png"):
            save_figure(figure.drawing, folder / f"{figure.key}.{kind}")
        if figure.table:
            _save_table(figure.table, folder / f"{figure.key}.csv")


def _save_table(table: Sequence[Mapping[str, object]], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


def _page(
    rows: Sequence[Row],
    from_table_1: Sequence[Row],
    findings: Sequence[Finding],
    figures: Sequence[ReproducedFigure],
    glance: Sequence[Row],
    runs: Runs,
    folder: Path,
) -> str:
    tables = [
        {
            "title": "Table I: parameters",
            "text": "Ours is what Table II implies; where it differs, Table I cannot be what "
            "the paper computed with.",
            "rows": [row for row in rows if row.key.startswith("table1.")],
        },
        {
            "title": "Table II: gains, in thousands, from the joint it implies",
            "text": "Pole placement with k_e = 3.6e7 N/m and c = 9000 N s/m.",
            "rows": [row for row in rows if row.key.startswith("table2.")],
        },
        {
            "title": "Table II: gains, in thousands, from Table I as printed",
            "text": "The same pole placement with k_e = 3.0e7 N/m and c = 1.6 k_e.",
            "rows": from_table_1,
        },
    ]
    return render(
        "reproduction.html.j2",
        version=__version__,
        rows=rows,
        verdict=VERDICT,
        glance=glance,
        figures=figures,
        tables=tables,
        findings=findings,
        seed=runs.oracle.seed,
        folder=folder,
        method=_method(),
        surveys=_surveys(runs),
        definition=_definition(runs.ranges["without_vibration"]),
    )


def _surveys(runs: Runs) -> dict[str, DisturbanceRange]:
    """Figure 10 and the readings of its loop, by what each is called."""
    figure_10 = {NAMES[control]: survey for control, survey in runs.ranges.items()}
    return figure_10 | {
        f"{NAMES[control]}, {READINGS[key].name}": survey
        for key, ranges in runs.readings.items()
        for control, survey in ranges.items()
    }


def _method() -> list[str]:
    return [
        "Reference: minimum jerk over 0.1 m in 0.5 s; control at 100 kHz with zero-order hold. The "
        "paper prints neither.",
        "Plant: linearly implicit midpoint, one step per control period; without vibration checked "
        "against Runge-Kutta at 0.1 µs. The bounded loop with vibration is chaotic: single runs "
        "depend on the step; medians over runs are what is quoted.",
        "Disturbance: joint force times 1 + var w, w uniform on [-1, 1], redrawn every 0.1 ms.",
        "Diverged: |e| above l_f / 2, |F| above 20 F_s0, or not a number. Released: within 1 µm of "
        "the end of the guide, since the reference ends there and is approached from below.",
    ]


def _definition(survey: DisturbanceRange) -> list[str]:
    """Say what figure 10 counts, and how."""
    return [
        f"Runs: {len(survey.var)} levels of var, run numbers 0 to {survey.runs - 1:,} at each. All "
        "levels and controls have the same draws w, so their differences are not blurred by other "
        "draws, and levels are not independent of each other. At var = 0 nothing is drawn: all "
        "runs are the same one.",
        "Disturbance: joint force times 1 + var w, w uniform on [-1, 1], redrawn every 0.1 ms and "
        "held between. The paper names neither law, rate, nor number of runs.",
        "A run ends as diverged (|e| above l_f / 2, |F| above 20 F_s0, or not a number), as "
        "released (within 1 µm of the end of the guide), or, at 0.5 s, as not released. The paper "
        "does not say what it calls unstable.",
        "IAE: integral of |e| over the 0.5 s of the run, quantiles over the runs that did not "
        "diverge, released or not.",
        f"Upper bounds: one-sided, Clopper and Pearson, at {100 * CONFIDENCE:g} % confidence, "
        "each level by itself.",
        "Vibration: as printed it diverges at every level, so its IAE is not drawn; what is "
        "drawn is the bounded reading, whose three additions are not in the paper.",
        "Force: the PID's output, in N. Equation (13) multiplies it by m₂; the last tables read it "
        "so, for the whole loop and for the dynamic gains alone, at a few levels.",
    ]


def _json(
    rows: Sequence[Row],
    findings: Sequence[Finding],
    figures: Sequence[ReproducedFigure],
    runs: Runs,
) -> dict[str, object]:
    values: dict[str, object] = {row.key: row.to_dict() for row in rows}
    values["findings"] = {finding.key: finding.to_dict() for finding in findings}
    values["figures"] = {
        figure.key: {"title": figure.title, "caption": figure.caption, "data": figure.data}
        for figure in figures
    }
    values["readings"] = {
        key: {control: survey.rows() for control, survey in ranges.items()}
        for key, ranges in runs.readings.items()
    }
    values["version"] = __version__
    return values
