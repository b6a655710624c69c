"""Run a study: piece by piece, each written as it finishes, so that nothing finished is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import tomli_w

from breakaway._core import __version__
from breakaway.ask.durable.documents import as_csv, as_json
from breakaway.ask.durable.finished import SUMMARY
from breakaway.ask.durable.journal import Journal
from breakaway.ask.durable.progress import Progress
from breakaway.ask.durable.resume import prepared
from breakaway.ask.durable.runner import Runner
from breakaway.ask.studies.manifest import manifest_of
from breakaway.ask.studies.plan import Plan, PointRuns, Summary
from breakaway.ask.studies.plans import plan_of
from breakaway.ask.studies.points import Point
from breakaway.ask.studies.result import StudyResult, open_study
from breakaway.ask.studies.run_pieces import RunPieces, Stretch, label_types, laid_out
from breakaway.ask.studies.study import Study
from breakaway.base.arguments import check_arguments
from breakaway.base.output import output_folder
from breakaway.base.ownership import STUDY
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.run.batch.batch import Batch


def run_study(
    study: Study,
    *,
    out: str | Path,
    resume: bool = False,
    threads: int | None = None,
    progress: Callable[[Progress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> StudyResult:
    """Run a study into a folder, or continue it.

    The folder receives ``manifest.json`` first, then the pieces as they finish, then the summary,
    its tables and figures. A study that was interrupted, in whatever way, continues with
    ``resume``: finished pieces are read and not computed again, and all files have the same bytes
    as those of a study that was never interrupted.

    Parameters
    ----------
    study : SweepStudy, RobustnessStudy, SensitivityStudy, CompareStudy or AgreementStudy
        What is asked.
    out : str or Path
        The folder; made if it is missing.
    resume : bool, optional
        Whether to continue a study that the folder holds; a new one is started otherwise.
    threads : int, optional
        Left out: one for each processor. The results do not depend on it.
    progress : callable, optional
        Called about 20 times a second with a `Progress`.
    notice : callable, optional
        Called with a sentence when a piece is computed again because it is damaged, edited or from
        another study.

    Returns
    -------
    StudyResult

    Raises
    ------
    StudyError
        The study contradicts itself, an option is not valid, or the folder holds another study;
        nothing has run then.
    OutputError
        The folder cannot be written, or the disk is full; finished pieces stay.
    KeyboardInterrupt
        Ctrl-C; finished pieces stay.

    Examples
    --------
    >>> import tempfile
    >>> import breakaway as bk
    >>> study = bk.SweepStudy(
    ...     scenario="paper_as_computed",
    ...     changes={"disturbance.var": 0.1, "timing.duration_s": 0.01},
    ...     runs=20,
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run_study(study, out=folder).summary["result"]
    ['0 of 20 runs released, at 1 point of 20 each']

    """
    check_arguments(run_study, locals(), StudyError)
    thread_count(threads)
    folder = Path(out)
    plan = plan_of(study)
    for point in plan.points:
        point.check()
    with prepared(folder, manifest_of(study, plan), resume=resume) as journal:
        runner = Runner(journal, "study", runs_max=plan.runs_max, progress=progress, notice=notice)
        summary = plan.conduct(_PointRunner(study, plan, runner, folder, threads).run)
        names = runner.pieces_alone()
        names += _write_end(study, plan, summary, runner.runs_done, journal)
        journal.settle(names)
    return open_study(folder)


class _PointRunner:
    """Runs points in pieces, numbered as they come; what is on disk already is not run."""

    def __init__(
        self, study: Study, plan: Plan, runner: Runner, folder: Path, threads: int | None
    ) -> None:
        self._study, self._runner, self._threads = study, runner, threads
        self._pieces = RunPieces(folder, label_types(plan.points), plan.varied, study.recorded)
        self._next_point = 0

    def run(self, points: Sequence[Point], doing: str) -> list[PointRuns]:
        """Run points to their end."""
        self._runner.doing = doing
        first = self._next_point
        self._next_point += len(points)
        places: list[list[tuple[str, Stretch]]] = [[] for _ in points]
        for layout in laid_out(points, first, self._study.runs_per_piece):
            piece = self._runner.next_piece()
            self._finish(piece, [(stretch, points[stretch.point - first]) for stretch in layout])
            for stretch in layout:
                places[stretch.point - first].append((piece, stretch))
        return [PointRuns(p, place, self._pieces) for p, place in zip(points, places, strict=True)]

    def _finish(self, piece: str, layout: Sequence[tuple[Stretch, Point]]) -> None:
        """See that a piece is on disk."""
        runs = sum(len(stretch.rows) for stretch, _ in layout)
        if not self._runner.found(piece, runs, f"{runs} runs"):
            batches = self._computed(layout)
            self._runner.keep(piece, runs, lambda: self._pieces.as_bytes(batches))

    def _computed(
        self, layout: Sequence[tuple[Stretch, Point]]
    ) -> list[tuple[Stretch, Point, Batch]]:
        batches = []
        before = 0
        for stretch, point in layout:
            batch = point.simulate(
                stretch.rows,
                metrics=self._study.recorded,
                threads=self._threads,
                progress=self._reporter(before),
            )
            before += len(stretch.rows)
            batches.append((stretch, point, batch))
            self._runner.report(before)
        return batches

    def _reporter(self, before: int) -> Callable[[int, int], None]:
        return lambda done, _: self._runner.report(before + done)


def _write_end(
    study: Study, plan: Plan, summary: Summary, runs: int, journal: Journal
) -> list[str]:
    """Write tables, figures, the study itself, and last the summary, which says that it is done.

    Give the names of the files.
    """
    content = {
        "kind": study.kind,
        "name": study.name,
        "scenario": study.base.name,
        "seed": study.base.seed,
        "runs": runs,
        "breakaway_version": __version__,
        "result": summary.result,
        "notes": summary.notes,
        **summary.facts,
        "tables": summary.tables,
    }
    with output_folder(journal.folder, STUDY) as staging:
        for name, rows in summary.tables.items():
            (staging / f"{name}.csv").write_text(as_csv(rows), encoding="utf-8", newline="")
        how = "# The whole study, its scenario within. Runs again: breakaway study study.toml\n\n"
        text = how + tomli_w.dumps(study.model_dump(exclude_none=True))
        (staging / "study.toml").write_text(text, encoding="utf-8", newline="\n")
        for name, figure in plan.draw_figures(study, summary).items():
            _save(figure, staging / name)
        names = journal.note_staged(staging)
    journal.write(SUMMARY, as_json(content))
    return [*names, SUMMARY]


def _save(figure: Any, path: Path) -> None:  # noqa: ANN401 - a figure of matplotlib
    from breakaway.drawing.style import save_figure

    for suffix in (".png", ".svg"):
        save_figure(figure, path.with_suffix(suffix))
