"""Tune a method: evaluation after evaluation, each on the disk before the next begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from breakaway.ask.durable.finished import SUMMARY
from breakaway.ask.durable.journal import Journal
from breakaway.ask.durable.manifest import MANIFEST, manifest_with
from breakaway.ask.durable.progress import Progress
from breakaway.ask.durable.records import Records
from breakaway.ask.durable.resume import prepared
from breakaway.ask.durable.runner import Runner
from breakaway.ask.tuning.evaluation import (
    Evaluation,
    Laws,
    evaluate,
    is_feasible,
    pareto_front,
    recommended,
    run_laws,
)
from breakaway.ask.tuning.problem import EVALUATIONS_MAX, Tuning
from breakaway.ask.tuning.result import TuningResult, open_tuning
from breakaway.ask.tuning.scores import laws_as_json, laws_of_json
from breakaway.ask.tuning.search import Search
from breakaway.ask.tuning.summary import Found
from breakaway.ask.tuning.writing import EVALUATIONS, UNSEEN, write_end
from breakaway.base.arguments import check_arguments, check_whole
from breakaway.base.reading import is_there
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.model.scenario.method import Method

START = "start"
"""What stands for the method as it was among the evaluations that are scored."""


@dataclass(frozen=True, kw_only=True)
class TuningProgress(Progress):
    """How far a tuning is; its runs are parts, of which the last ones are on unseen parts."""

    evaluations_done: int
    """Evaluations that are finished, including those found on disk."""
    evaluations_max: int
    """Evaluations in all."""
    best: Mapping[str, float] = field(default_factory=dict)
    """Objectives of the evaluation that would be recommended now, on training parts; empty at
    first."""


def tune(
    tuning: Tuning,
    *,
    out: str | Path,
    evaluations: int | None = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Callable[[TuningProgress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> TuningResult:
    """Tune a method on training parts into a folder, and score what was found on unseen ones.

    Every evaluation is on the disk before the next begins. A tuning that was interrupted, in
    whatever way, continues with ``resume``, also with more evaluations than before, and all files
    have the same bytes as those of a tuning that was never interrupted, on any number of threads.

    Parameters
    ----------
    tuning : Tuning
        What is asked.
    out : str or Path
        The folder; made if it is missing.
    evaluations : int, optional
        How many methods are tried. Left out: as the tuning says.
    resume : bool, optional
        Whether to continue the tuning that the folder holds; a new one is started otherwise.
    threads : int, optional
        Left out: one for each processor. The results do not depend on it.
    progress : callable, optional
        Called about 20 times a second with a `TuningProgress`.
    notice : callable, optional
        Called with a sentence when evaluations on disk are damaged and computed again.

    Returns
    -------
    TuningResult

    Raises
    ------
    StudyError
        optuna is not installed, an option is not valid, or the folder holds another tuning;
        nothing has run then.
    OutputError
        The folder cannot be written, or the disk is full; finished evaluations stay.
    KeyboardInterrupt
        Ctrl-C; finished evaluations stay.

    Examples
    --------
    >>> import tempfile
    >>> import breakaway as bk
    >>> parts = bk.load_population("seized_parts").model_copy(update={"duration_s": 0.01})
    >>> tuning = bk.Tuning(
    ...     population=parts,
    ...     method="steady_feed",
    ...     objectives=["strict_share"],
    ...     tune={"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
    ...     training_runs=4,
    ...     test_runs={"first": 100, "runs": 4},
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     bk.tune(tuning, out=folder, evaluations=2).summary["evaluations"]
    2

    """
    check_arguments(tune, locals(), StudyError)
    thread_count(threads)
    folder = Path(out)
    asked = _asked(tuning, evaluations)
    search = Search(asked)
    if resume:
        _check_found(folder, asked)
    with prepared(folder, manifest_of(asked), resume=resume) as journal:
        runner = _EvaluationRunner(asked, journal, threads, progress, notice)
        write_end(runner.run(search), journal)
    return open_tuning(folder)


def _asked(tuning: Tuning, evaluations: int | None) -> Tuning:
    """Give the tuning with as many evaluations as are asked for."""
    if evaluations is None:
        return tuning
    check_whole("evaluations", evaluations, StudyError, 1, EVALUATIONS_MAX)
    return tuning.model_copy(update={"evaluations": evaluations})


def _check_found(folder: Path, tuning: Tuning) -> None:
    """Raise if the folder holds more evaluations than are asked for."""
    if not is_there(folder / MANIFEST):
        return
    found = len(Records(folder, EVALUATIONS, manifest_of(tuning)["identity"]).read())
    if found > tuning.evaluations:
        raise StudyError(
            f"evaluations: {tuning.evaluations} is less than the {found} that {folder} holds; give "
            f"at least {found}, or another folder"
        )


def manifest_of(tuning: Tuning) -> dict[str, Any]:
    """Give what determines the results of a tuning; how many evaluations is not part of it."""
    asked = tuning.model_dump(mode="json", exclude={"evaluations"})
    return manifest_with(asked, ["numpy", "optuna", "scipy"])


class _EvaluationRunner:
    """Runs evaluations and scores, but for those that are on disk."""

    def __init__(
        self,
        tuning: Tuning,
        journal: Journal,
        threads: int | None,
        progress: Callable[[TuningProgress], None] | None,
        notice: Callable[[str], None] | None,
    ) -> None:
        self._tuning, self._journal, self._threads = tuning, journal, threads
        self._progress = progress
        self._evaluations, self._scored = (
            Records(journal.folder, name, journal.identity) for name in (EVALUATIONS, UNSEEN)
        )
        self._done: list[Evaluation] = []
        self._best: dict[str, float] = {}
        self._runner = Runner(
            journal,
            "tuning",
            runs_max=tuning.evaluations * self._runs_of(tuning.training),
            progress=self._tell,
            notice=notice,
        )

    def run(self, search: Search) -> Found:
        """Run what is not on disk, and give all."""
        kept = self._evaluations.intact(self._runner.say)
        if len(kept) < self._tuning.evaluations:
            self._journal.remove(SUMMARY)  # it is not finished any more
        for number in range(self._tuning.evaluations):
            evaluation = self._evaluation(number, search.ask(), kept)
            search.tell(evaluation)
            self._done.append(evaluation)
            self._note_best(evaluation)
        return self._scored_on_unseen()

    def _evaluation(
        self, number: int, numbers: dict[str, float], kept: list[dict[str, Any]]
    ) -> Evaluation:
        self._runner.doing = f"evaluation {number + 1} of {self._tuning.evaluations}"
        runs = self._runs_of(self._tuning.training)
        if number < len(kept):
            if (kept[number]["number"], kept[number]["numbers"]) == (number, numbers):
                self._runner.count(runs, found=True)
                return Evaluation.of_json(kept[number])
            self._runner.say(
                f"{self._evaluations.path.name}: evaluation {number} is a different one; it and "
                "all that follow are computed again"
            )
            del kept[number:]
            self._evaluations.replace(kept)
        evaluation = evaluate(self._tuning, number, numbers, self._threads, self._runner.report)
        self._evaluations.append(evaluation.as_json())
        self._runner.count(runs)
        return evaluation

    def _note_best(self, evaluation: Evaluation) -> None:
        if self._progress and is_feasible(self._tuning, evaluation):
            best = recommended(self._tuning, pareto_front(self._tuning, self._done))
            self._best = {name: best.worst[name].value for name in self._tuning.objectives}

    def _scored_on_unseen(self) -> Found:
        tuning, unseen = self._tuning, self._tuning.test_runs.numbers
        front = pareto_front(tuning, self._done)
        same = [e for e in self._done if e.numbers == tuning.start and e.laws is not None]
        parts = (len(front) + 1) * self._runs_of(unseen)
        self._runner.runs_max += parts + (0 if same else self._runs_of(tuning.training))
        kept = self._scored.intact(self._runner.say)
        asked: list[dict[str, Any]] = []

        def scored(of: int | str, method: Method, on: str, runs: range, doing: str) -> Laws:
            key = {"of": of, "on": on}
            self._runner.doing = doing
            record = next((r for r in kept if r | key == r), None)
            if record is None:
                laws = run_laws(tuning, method, runs, self._threads, self._runner.report)
                record = key | {"laws": laws_as_json(laws)}
                self._scored.append(record)
            self._runner.count(self._runs_of(runs), found=record in kept)
            asked.append(record)
            return laws_of_json(record["laws"])

        start_unseen = scored(START, tuning.method, "unseen", unseen, "the start on unseen parts")
        start_training = (same[0].laws if same else None) or scored(
            START, tuning.method, "training", tuning.training, "the start on training parts"
        )
        of_front = {
            e.number: scored(
                e.number,
                tuning.tuned(e.numbers),
                "unseen",
                unseen,
                f"evaluation {e.number} on unseen parts",
            )
            for e in front
        }
        self._scored.replace(asked)
        best = recommended(tuning, front) if front else None
        return Found(tuning, self._done, front, best, start_training, start_unseen, of_front)

    def _runs_of(self, parts: range) -> int:
        return len(parts) * len(self._tuning.laws)

    def _tell(self, at: Progress) -> None:
        if self._progress:
            self._progress(
                TuningProgress(
                    **vars(at),
                    evaluations_done=len(self._done),
                    evaluations_max=self._tuning.evaluations,
                    best=self._best,
                )
            )
