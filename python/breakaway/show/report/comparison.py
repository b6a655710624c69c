"""The page of a comparison: methods side by side, and the worst part of each in motion."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from breakaway._core import __version__
from breakaway.model.scenario.laws import LAW_WORDS
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.variation import VARIATION_WORDS
from breakaway.model.units import unit_of
from breakaway.run.trials import Case
from breakaway.show.plots.comparison import Course
from breakaway.show.report.page import inline_svg, render

Row = Mapping[str, Any]


@dataclass(frozen=True)
class ShownFigure:
    """A figure of the page."""

    key: str
    """Its name, unique on the page."""
    title: str
    """What it is, in a sentence."""
    caption: str
    """What to see in it."""
    svg: Path
    """Its file."""
    method: str = ""
    """Name of the method that it is about; none for figures of all."""
    case: Case | None = None
    """What it is under; none for figures of all."""

    @property
    def drawing(self) -> Markup:
        """The drawing for the inside of the page.

        Without its metadata, remarks and indents, and without names of pictures of points: those of
        pictures that are the same are the same, and nothing refers to them. Paths to a hundredth of
        a point.
        """
        svg = str(inline_svg(self.svg))
        svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
        svg = re.sub(r"\s+", " ", svg)
        svg = re.sub(r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), svg)
        return Markup(re.sub(r' id="[^"]*-image[0-9a-f]+"', "", svg))  # of our own making


@dataclass(frozen=True)
class Column:
    """A column of the table."""

    heading: str
    """What it is."""
    unit: str
    """Its unit."""
    keys: tuple[str, ...]
    """Keys of what a cell says, and of what it says below, as far as their best is marked."""
    show: Callable[[Row], tuple[str, str]]
    """What a cell says, and what it says in small print below."""


def comparison_page(
    *,
    population: PartPopulation,
    methods: Sequence[Method],
    cases: Sequence[Case],
    runs: int,
    seed: int,
    table: Sequence[Row],
    result: Sequence[str],
    notes: Sequence[str],
    figures: Sequence[ShownFigure],
    courses: Mapping[Case, Mapping[str, Course]],
) -> str:
    """Write the page of a comparison, as self-contained HTML.

    Parameters
    ----------
    population : PartPopulation
        Where the parts are from.
    methods : sequence of Method
        What was tried on them.
    cases : sequence of Case
        Friction laws of their joints, with how their friction varies.
    runs : int
        How many parts.
    seed : int
        Seed of the draws.
    table : sequence of mapping
        A row for each case and method.
    result, notes : sequence of str
        What was found, and what to know before trusting it.
    figures : sequence of ShownFigure
        Figures, those of single methods after those of all.
    courses : mapping
        Case -> name of a method -> how its worst part came out.

    Returns
    -------
    str
        A page that needs no other file and no network.

    """
    return render(
        "comparison.html.j2",
        version=__version__,
        population=population,
        methods=methods,
        cases=cases,
        laws=len({case.law for case in cases}),
        variations=list(dict.fromkeys(case.variation for case in cases)),
        variation_words=VARIATION_WORDS,
        case_words={case: _words(case, cases) for case in cases},
        runs=runs,
        seed=seed,
        tables=[_table(case, table) for case in cases],
        result=result,
        notes=notes,
        overview=[figure for figure in figures if not figure.method],
        singles={
            method.name: [figure for figure in figures if figure.method == method.name]
            for method in methods
        },
        courses=Markup(_json(courses)),
    )


def _words(case: Case, cases: Sequence[Case]) -> str:
    """Name a case: by its law alone, where friction varies in the same way in all of them."""
    same = len({one.variation for one in cases}) == 1
    return LAW_WORDS[case.law] if same else case.words


def _table(case: Case, rows: Sequence[Row]) -> dict[str, Any]:
    """Give a case's table: headings, and cells with what is best in their column."""
    of_case = [row for row in rows if Case(row["law"], row["variation"]) == case]
    columns = [c for c in COLUMNS if c.unit not in STACK_UNITS or _any(of_case, c.keys)]
    return {
        "case": case,
        "headings": [(column.heading, column.unit) for column in columns],
        "rows": [
            {
                "method": row["method"],
                "cells": [
                    {"texts": column.show(row), "best": _bests(row, column)} for column in columns
                ],
            }
            for row in of_case
        ],
    }


def _any(rows: Sequence[Row], keys: Sequence[str]) -> bool:
    return any(row[key] is not None for row in rows for key in keys)


def _bests(row: Row, column: Column) -> list[bool]:
    """Whether what a cell says, and what it says below, are the best of the column."""
    best = str(row["best"]).split(";")
    return [key in best for key in column.keys] + [False] * (2 - len(column.keys))


def _share(name: str) -> Column:
    def show(row: Row) -> tuple[str, str]:
        low, high = 100.0 * row[f"{name}_low"], 100.0 * row[f"{name}_high"]
        return f"{100.0 * row[f'{name}_share']:.4g}", f"{low:.3g} to {high:.3g}"

    return Column(name, "%", (f"{name}_share",), show)


def _alone(name: str, heading: str) -> Column:
    return Column(
        heading, "%", (f"{name}_share",), lambda row: (f"{100.0 * row[f'{name}_share']:.4g}", "")
    )


def _spread(name: str, heading: str, power: int = 0) -> Column:
    def show(row: Row) -> tuple[str, str]:
        factor = 10.0**-power
        return _digits(row[f"{name}_median"], factor), _digits(row[f"{name}_p99"], factor)

    unit = unit_of(name).prefixed(power) or "1"
    return Column(heading, unit, (f"{name}_median", f"{name}_p99"), show)


def _single(name: str, heading: str, counted: str = "") -> Column:
    key, unit = f"{name}_median", counted or unit_of(name).shown
    return Column(heading, unit, (key,), lambda row: (_digits(row[key], 1.0), ""))


def _digits(value: float | None, factor: float) -> str:
    if value is None:
        return "–"
    digits = f"{value * factor:.3g}"
    return f"{float(digits):,.0f}" if "e+" in digits else digits


def _against(row: Row) -> tuple[str, str]:
    if row["against"] is None:
        return "–", ""
    p = row["gentle_p"]
    told = "p < 1e-12" if p < 1e-12 else f"p = {p:.2g}"
    ours, theirs = row["gentle_only_this"], row["gentle_only_other"]
    return row["against"], f"{ours:,} against {theirs:,}, {told}"


STACK_UNITS = ("cycles", "A", "W")
"""Units of the columns that only a piezo stack has."""
COLUMNS = (
    _share("released"),
    _share("gentle"),
    _share("strict"),
    _alone("force", "within force"),
    _alone("jump", "within jump"),
    _alone("velocity", "within velocity"),
    _spread("time_to_release_s", "time to release"),
    _spread("largest_jump_m", "largest jump", -3),
    _spread("peak_over_breakaway", "peak / breakaway"),
    _spread("release_velocity_m_per_s", "release velocity"),
    _spread("largest_impact_work_j", "largest impact"),
    _spread("impulse_n_s", "impulse"),
    Column("best other", "gentle parts that only one frees", (), _against),
    _single("stack_cycles", "stack", "cycles"),
    _single("rms_current_a", "RMS current"),
    _single("stack_loss_w", "stack loss"),
)
"""Columns of the table; a spread's cell says the median, and the 99 % quantile below."""


def _json(courses: Mapping[Case, Mapping[str, Course]]) -> str:
    """Give what the animation needs, as JSON that is safe within a page."""
    content = [
        {
            "case": case.key,
            "method": name,
            "part": course.run_index,
            "released": course.released,
            "length_mm": round(1e3 * course.length_m, 4),
            "mass_kg": round(course.mass_kg, 4),
            "stiction_n": round(course.stiction_n, 2),
            "jump_mm": round(1e3 * course.jump_m, 5),
            "peak": round(course.peak_over_breakaway, 4),
            "slip_s": [round(time, 7) for time in course.slip_s],
            "whole": _columns(course.whole, 6),
            "slip": _columns(course.slip, 7),
        }
        for case, by_method in courses.items()
        for name, course in by_method.items()
    ]
    text = json.dumps(content, separators=(",", ":"), allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


POSITIONS = {"x": "position_m", "drive": "feed_m", "tool": "tool_m", "tip": "tip_m"}
"""Name of a position in the animation -> its column, in mm there."""


def _columns(columns: Mapping[str, Any], places: int) -> dict[str, list[float]]:
    return {
        "t": [round(float(v), places) for v in columns["t_s"]],
        "f": [round(float(v), 1) for v in columns["force_n"]],
        "b": [round(float(v), 1) for v in columns["breakaway_n"]],
        **{
            key: [round(1e3 * float(v), 5) for v in columns[name]]
            for key, name in POSITIONS.items()
            if name in columns
        },
    }
