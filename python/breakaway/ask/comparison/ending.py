"""The end of a comparison in its folder: table, figures, page, and last its summary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from breakaway._core import __version__
from breakaway.ask.comparison.asked import KIND, Asked
from breakaway.ask.comparison.courses import Courses, courses_of
from breakaway.ask.comparison.table import Trials
from breakaway.ask.comparison.trial_pieces import trial_schema
from breakaway.ask.durable.documents import as_csv, as_json
from breakaway.ask.durable.finished import SUMMARY
from breakaway.ask.durable.journal import PIECES, Journal
from breakaway.ask.durable.manifest import manifest_with
from breakaway.ask.studies.plan import Row
from breakaway.base.output import output_folder
from breakaway.base.ownership import STUDY
from breakaway.drawing.style import save_figure
from breakaway.model.scenario.variation import VARIATION_WORDS, VariationKind
from breakaway.run.trials import TRIAL_METRICS, Case
from breakaway.show.plots.comparison import Cloud, plot_course, plot_scatter, plot_shares
from breakaway.show.report.comparison import ShownFigure, comparison_page

PAGE, TABLE, ASKED = "index.html", "table.csv", "comparison.toml"


def manifest_of(asked: Asked) -> dict[str, Any]:
    """Give what determines the results of a comparison, and what they look like."""
    return manifest_with(
        asked.model_dump(mode="json"),
        ["numpy", "scipy"],
        seed=asked.seed,
        metrics=list(TRIAL_METRICS),
        columns=[
            {"name": f.name, "type": str(f.type), "unit": f.metadata[b"unit"].decode()}
            for f in trial_schema()
        ],
    )


def ended(journal: Journal) -> bool:
    """Whether a folder has everything that the end writes, as it was written."""
    names = [name for name in journal.names() if not name.startswith(f"{PIECES}/")]
    return SUMMARY in names and all(journal.flaw(name) is None for name in names)


def write_end(
    asked: Asked,
    trials: Trials,
    table: Sequence[Row],
    result: Sequence[str],
    notes: Sequence[str],
    journal: Journal,
) -> None:
    """Write table, figures, page and the comparison itself, and last the summary."""
    courses = courses_of(trials)
    with output_folder(journal.folder, STUDY) as staging:
        (staging / TABLE).write_text(as_csv(table), encoding="utf-8", newline="")
        (staging / ASKED).write_text(asked.toml(), encoding="utf-8", newline="\n")
        figures = _draw(asked, trials, table, courses, staging)
        page = comparison_page(
            population=asked.population,
            methods=asked.methods,
            cases=asked.cases,
            runs=asked.runs,
            seed=asked.seed,
            table=table,
            result=result,
            notes=notes,
            figures=figures,
            courses={
                case: {name: found.worst for name, found in by_method.items()}
                for case, by_method in courses.items()
            },
        )
        (staging / PAGE).write_text(page, encoding="utf-8", newline="\n")
        files = journal.note_staged(staging)
    summary = {
        "kind": KIND,
        "population": asked.population.name,
        "methods": asked.names,
        "laws": asked.laws,
        "variations": asked.variations,
        "runs": asked.runs,
        "seed": asked.seed,
        "breakaway_version": __version__,
        "result": list(result),
        "notes": list(notes),
        "table": list(table),
        "files": files,
    }
    journal.write(SUMMARY, as_json(summary))


def _draw(
    asked: Asked,
    trials: Trials,
    table: Sequence[Row],
    courses: Mapping[Case, Mapping[str, Courses]],
    folder: Path,
) -> list[ShownFigure]:
    """Draw and save every figure, and give what the page shows of them."""
    shown = [
        _saved(
            "shares",
            plot_shares(table),
            folder,
            "How many parts come out, and how gently.",
            "Share of the parts, with its 95 % interval (Clopper and Pearson); all methods try "
            "the same parts.",
        ),
        *(_drawn_clouds(asked, trials, variation, folder) for variation in asked.variations),
    ]
    for case, by_method in courses.items():
        for place, (name, found) in enumerate(by_method.items()):
            figure = plot_course(found.median, found.worst)
            shown.append(
                _saved(
                    f"course_{place + 1}_{case.key}",
                    figure,
                    folder,
                    f"{name}, {case.words}.",
                    "Force and position of the part in the middle by its largest jump, of those "
                    "that came free; of the part with the largest jump; and of that part around "
                    "its worst slip, which is shaded. Dashed: the force that would break the joint "
                    "loose where the part is. Where the tip of a feed axis is behind the part, it "
                    "does not push.",
                    method=name,
                    case=case,
                )
            )
    return shown


def _drawn_clouds(
    asked: Asked, trials: Trials, variation: VariationKind, folder: Path
) -> ShownFigure:
    """Draw every part of every method and law, with one variation."""
    limits = asked.population.gentle, asked.population.strict
    clouds = [
        Cloud(
            case=case,
            method=name,
            peak=trial.metrics["peak_over_breakaway"],
            jump_m=trial.metrics["largest_jump_m"],
            released=trial.released,
            gentle=trial.within(trial.population.gentle),
        )
        for case, by_method in trials.items()
        for name, trial in by_method.items()
        if case.variation == variation
    ]
    return _saved(
        f"jump_against_peak_{variation}",
        plot_scatter(clouds, *limits),
        folder,
        f"Jump against peak force, part by part; friction {VARIATION_WORDS[variation]}.",
        "Each point is a part: its largest jump over its largest force as a multiple of its own "
        "breakaway force. Boxes: the gentle and, dashed, the strict limits; points within may "
        "still fail by their velocity. Crosses: parts left in place.",
    )


def _saved(
    key: str,
    figure: Figure,
    folder: Path,
    title: str,
    caption: str,
    method: str = "",
    case: Case | None = None,
) -> ShownFigure:
    for suffix in ("svg", "png"):
        save_figure(figure, folder / f"{key}.{suffix}")
        figure.set_layout_engine("none")  # it is laid out by now
    return ShownFigure(key, title, caption, folder / f"{key}.svg", method, case)
