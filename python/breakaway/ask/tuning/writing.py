"""The files of a finished tuning."""

from __future__ import annotations

import re
from pathlib import Path

import tomli_w

from breakaway.ask.durable.documents import as_csv, as_json
from breakaway.ask.durable.finished import SUMMARY
from breakaway.ask.durable.journal import PIECES, Journal
from breakaway.ask.tuning.evaluation import Evaluation
from breakaway.ask.tuning.problem import Tuning
from breakaway.ask.tuning.summary import Found, Row, content_of, evaluation_rows, pareto_rows
from breakaway.base.output import output_folder
from breakaway.base.ownership import STUDY
from breakaway.base.text import toml_comment
from breakaway.model.scenario.method import Method, TrainingParts
from breakaway.model.scenario.variation import VARIATION_WORDS

EVALUATIONS, UNSEEN = RECORDS = (f"{PIECES}/evaluations.jsonl", f"{PIECES}/unseen.jsonl")
"""Finished evaluations, and scores on unseen parts."""
BEST = "best.toml"
"""The recommended method."""
POINT = re.compile(r"best\.toml|pareto_\d{2,}\.toml")
"""Files that a point of the front can have."""


def write_end(found: Found, journal: Journal) -> None:
    """Write tables, methods, figures, and last the summary, which says that it is done."""
    content = content_of(found)
    methods = {found.file(evaluation): evaluation for evaluation in found.front}
    if found.best is not None:
        methods[BEST] = found.best
    with output_folder(journal.folder, STUDY) as staging:
        (staging / "evaluations.csv").write_text(
            as_csv(evaluation_rows(found)), "utf-8", newline=""
        )
        (staging / "pareto.csv").write_text(as_csv(pareto_rows(found)), "utf-8", newline="")
        for name, evaluation in methods.items():
            text = method_toml(found, evaluation, name)
            (staging / name).write_text(text, "utf-8", newline="\n")
        _draw(found, staging, content)
        names = journal.note_staged(staging)
    for name in journal.names():
        if POINT.fullmatch(name) and name not in methods:  # of fewer evaluations than now
            journal.remove(name)
    for name in RECORDS:
        journal.note_written(name)
    journal.write(SUMMARY, as_json(content))
    journal.settle([*names, *RECORDS, SUMMARY])


def method_toml(found: Found, evaluation: Evaluation, file: str) -> str:
    """Give a method of the front as a TOML file that says where it comes from."""
    tuning = found.tuning
    method = tuning.tuned(evaluation.numbers)
    place = "" if file == BEST else f"_{file[7:-5]}"
    unseen = found.worst(found.unseen[evaluation.number])
    said = [
        f"# {toml_comment(tuning.method.name)}, tuned on {tuning.training_runs} parts of "
        f"{toml_comment(tuning.population.name)}, laws {', '.join(tuning.laws)}, "
        f"friction {VARIATION_WORDS[tuning.variation]}:",
        f"# evaluation {evaluation.number} of {len(found.evaluations)}.",
        "# Training and unseen scores:",
        *(
            f"#   {name} {evaluation.worst[name].value:.5g}, {unseen[name].value:.5g}"
            for name in tuning.objectives
        ),
    ]
    tuned = {
        "name": f"{method.name}_tuned{place}",
        "tuned_on": [*method.tuned_on, _training_parts(tuning)],
    }
    named = Method.parse(method.model_copy(update=tuned).model_dump())
    values = {key: v for key, v in named.model_dump(exclude_none=True).items() if v != {}}
    return "\n".join(said) + "\n\n" + tomli_w.dumps(values)


def _training_parts(tuning: Tuning) -> TrainingParts:
    return TrainingParts(
        population=tuning.population.name,
        seed=tuning.seed,
        first=tuning.training.start,
        runs=len(tuning.training),
    )


def _draw(found: Found, staging: Path, content: Row) -> None:
    from breakaway.drawing.style import save_figure
    from breakaway.show.plots.tuning import plot_history, plot_pareto, plot_slices

    tuning, rows = found.tuning, evaluation_rows(found)
    start = found.worst(found.start_training)
    before = {name: start[name].value for name in tuning.objectives}
    less = {kind.name: not kind.more_is_better for kind in tuning.objective_kinds}
    figures = {"history": plot_history(tuning.name, rows, less)}
    for name in tuning.objectives:
        spans = {path: (s.low, s.high, s.log) for path, s in tuning.tune.items()}
        figures[f"slices_{name}"] = plot_slices(tuning.name, rows, name, spans)
    if len(less) > 1:
        figures["pareto"] = plot_pareto(tuning.name, rows, content["front"], less, before)
    for name, figure in figures.items():
        save_figure(figure, staging / f"{name}.png")
        figure.set_layout_engine("none")  # the layout stays: finding it takes longer than drawing
        save_figure(figure, staging / f"{name}.svg")
