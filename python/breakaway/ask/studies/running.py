"""Run a study: part by part, each written as it finishes, so that nothing finished is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from breakaway._core import __version__
from breakaway.ask.studies.folder import SUMMARY, as_csv, as_json, prepared
from breakaway.ask.studies.manifest import manifest_of
from breakaway.ask.studies.part_files import found, part_name, remove_beyond
from breakaway.ask.studies.parts import Parts, Piece, label_types, laid_out
from breakaway.ask.studies.pieces import Pieces
from breakaway.ask.studies.plan import Plan, PointRuns, Summary
from breakaway.ask.studies.plans import plan_of
from breakaway.ask.studies.points import Point
from breakaway.ask.studies.result import StudyResult, open_study
from breakaway.ask.studies.study import (
    Study,
)
from breakaway.base.output import output_folder
from breakaway.base.ownership import STUDY
from breakaway.base.threads import thread_count
from breakaway.errors import OutputError


@dataclass(frozen=True)
class StudyProgress:
    """How far a study is."""

    runs_done: int
    """Runs that are done, those found on disk among them."""
    runs_found: int
    """Runs that were found on disk, done by an earlier process."""
    runs_max: int
    """Most runs that the study may take; a bisection may need fewer."""
    doing: str
    """What is run, in words."""


def run_study(
    study: Study,
    out: str | Path,
    *,
    resume: bool = False,
    threads: int | None = None,
    progress: Callable[[StudyProgress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> StudyResult:
    """Run a study into a folder, or go on with it.

    The folder receives ``manifest.json`` first, then the parts as they finish, then the summary,
    its tables and figures. A study that was ended, in whatever way, goes on with ``resume``:
    finished parts are read and not computed again, and all files are the same bytes as those of a
    study that was never ended.

    Parameters
    ----------
    study : SweepStudy, RobustnessStudy, SensitivityStudy, CompareStudy or AgreementStudy
        What is asked.
    out : str or Path
        The folder; made if it is missing.
    resume : bool, optional
        Whether to go on with a study that the folder holds. Without one, it begins.
    threads : int, optional
        Left out: one for each processor. The results do not depend on it.
    progress : callable, optional
        Called about 20 times a second with a `StudyProgress`.
    notice : callable, optional
        Called with a sentence when a part that is not the one that was written, be it damaged,
        edited or of another study, is computed again.

    Returns
    -------
    StudyResult

    Raises
    ------
    StudyError
        The study contradicts itself, or the folder holds another one; nothing has run then.
    OutputError
        The folder can not be written, or the disk is full; finished parts stay.
    KeyboardInterrupt
        Ctrl-C; finished parts stay.

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
    ...     run_study(study, folder).summary["result"]
    ['0 of 20 runs released, at 1 point of 20 each']

    """
    thread_count(threads)
    plan = plan_of(study)
    for point in plan.points:
        point.check()
    folder = Path(out)
    with prepared(folder, manifest_of(study, plan), resume=resume) as pieces:
        runner = _Runner(study, plan, pieces, threads, progress, notice)
        try:
            summary = plan.conduct(runner.run)
            names = runner.parts_alone()
            names += _write_end(study, plan, summary, runner.runs_done, pieces)
            pieces.settle(names)
        except OutputError as error:
            raise OutputError(f"{error}; finished parts stay: resume it to go on") from None
    return open_study(folder)


class _Runner:
    """Runs points in parts, numbered as they come; what is on disk already is not run."""

    def __init__(
        self,
        study: Study,
        plan: Plan,
        pieces: Pieces,
        threads: int | None,
        progress: Callable[[StudyProgress], None] | None,
        notice: Callable[[str], None] | None,
    ) -> None:
        self.runs_done = 0
        self._study, self._plan, self._threads = study, plan, threads
        self._pieces = pieces
        self._parts = Parts(pieces, label_types(plan.points), plan.varied, study.recorded)
        self._progress, self._notice = progress, notice
        self._runs_found = 0
        self._next_part = 0
        self._next_point = 0
        self._doing = ""

    def run(self, points: Sequence[Point], doing: str) -> list[PointRuns]:
        """Run points to their end."""
        self._doing = doing
        first = self._next_point
        self._next_point += len(points)
        shares: list[list[tuple[int, Piece]]] = [[] for _ in points]
        for layout in laid_out(points, first, self._study.runs_per_part):
            self._finish(layout, [points[piece.point - first] for piece in layout])
            for piece in layout:
                shares[piece.point - first].append((self._next_part, piece))
            self._next_part += 1
        return [PointRuns(p, share, self._parts) for p, share in zip(points, shares, strict=True)]

    def parts_alone(self) -> list[str]:
        """Remove parts that do not belong to the study, and give the names of those that do."""
        remove_beyond(self._pieces, self._next_part, "study", self._say)
        return [part_name(number) for number in range(self._next_part)]

    def _finish(self, layout: Sequence[Piece], points: Sequence[Point]) -> None:
        """See that a part is on disk."""
        runs = sum(len(piece.rows) for piece in layout)
        number = self._next_part
        if found(self._pieces, number, f"{runs} runs", self._say):
            self._runs_found += runs
            self.runs_done += runs
            self._report(0)
            return
        self._compute(number, layout, points)

    def _compute(self, number: int, layout: Sequence[Piece], points: Sequence[Point]) -> None:
        batches = []
        before = 0
        for piece, point in zip(layout, points, strict=True):
            batch = point.simulate(
                piece.rows,
                metrics=self._study.recorded,
                threads=self._threads,
                progress=self._reporter(before),
            )
            before += len(piece.rows)
            batches.append((piece, point, batch))
            self._report(before)
        self._parts.write(number, batches)
        self.runs_done += before

    def _reporter(self, before: int) -> Callable[[int, int], None]:
        return lambda done, _: self._report(before + done)

    def _report(self, in_part: int) -> None:
        if self._progress:
            self._progress(
                StudyProgress(
                    runs_done=self.runs_done + in_part,
                    runs_found=self._runs_found,
                    runs_max=self._plan.runs_max,
                    doing=self._doing,
                )
            )

    def _say(self, sentence: str) -> None:
        if self._notice:
            self._notice(sentence)


def _write_end(study: Study, plan: Plan, summary: Summary, runs: int, pieces: Pieces) -> list[str]:
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
    with output_folder(pieces.folder, STUDY) as staging:
        for name, rows in summary.tables.items():
            (staging / f"{name}.csv").write_text(as_csv(rows), encoding="utf-8", newline="")
        how = "# The whole study, its scenario within. Runs again: breakaway study study.toml\n\n"
        text = how + tomli_w.dumps(study.model_dump(exclude_none=True))
        (staging / "study.toml").write_text(text, encoding="utf-8", newline="\n")
        for name, figure in plan.draw_figures(study, summary).items():
            _save(figure, staging / name)
        names = pieces.note_staged(staging)
    pieces.write(SUMMARY, as_json(content))
    return [*names, SUMMARY]


def _save(figure: Any, path: Path) -> None:  # noqa: ANN401 - a figure of matplotlib
    from breakaway.show.plots.style import save_figure

    for suffix in (".png", ".svg"):
        save_figure(figure, path.with_suffix(suffix))
