"""Tune a method: trial after trial, each on the disk before the next begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from breakaway._core import __version__
from breakaway.ask.studies.folder import SUMMARY, prepared
from breakaway.ask.studies.manifest import FORMAT, MANIFEST, identity_of
from breakaway.ask.studies.pieces import Pieces
from breakaway.ask.tuning.evaluation import (
    Evaluation,
    Laws,
    evaluate,
    is_feasible,
    pareto_front,
    recommended,
    run_laws,
)
from breakaway.ask.tuning.problem import TRIALS_MAX, Tuning
from breakaway.ask.tuning.records import TRIALS, UNSEEN, Records
from breakaway.ask.tuning.result import TuningResult, open_tuning
from breakaway.ask.tuning.scores import laws_as_json, laws_of_json
from breakaway.ask.tuning.search import Search
from breakaway.ask.tuning.summary import Found
from breakaway.ask.tuning.writing import write_end
from breakaway.base.reading import is_there
from breakaway.base.threads import thread_count
from breakaway.errors import OutputError, StudyError
from breakaway.model.scenario.method import Method

START = "start"
"""What stands for the method as it was among the trials that are scored."""


@dataclass(frozen=True)
class TuningProgress:
    """How far a tuning is."""

    trials_done: int
    """Trials that are finished, those found on disk among them."""
    trials_max: int
    """Trials in all."""
    runs_done: int
    """Parts that are done, those found on disk among them."""
    runs_found: int
    """Parts that were found on disk, done by an earlier process."""
    runs_max: int
    """Parts in all, as far as is known: how many methods are scored on unseen ones, is not."""
    doing: str
    """What is run, in words."""
    best: Mapping[str, float] = field(default_factory=dict)
    """Objectives of the trial that would be recommended now, on training parts; maybe none yet."""


def tune(
    tuning: Tuning,
    out: str | Path,
    *,
    trials: int | None = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Callable[[TuningProgress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> TuningResult:
    """Tune a method on training parts into a folder, and score what was found on unseen ones.

    Every trial is on the disk before the next begins. A tuning that was ended, in whatever way,
    goes on with ``resume``, also with more trials than before, and all files are the same bytes
    as those of a tuning that was never ended, on any number of threads.

    Parameters
    ----------
    tuning : Tuning
        What is asked.
    out : str or Path
        The folder; made if it is missing.
    trials : int, optional
        How many methods are tried. Left out: as the tuning says.
    resume : bool, optional
        Whether to go on with the tuning that the folder holds. Without one, it begins.
    threads : int, optional
        Left out: one for each processor. The results do not depend on it.
    progress : callable, optional
        Called about 20 times a second with a `TuningProgress`.
    notice : callable, optional
        Called with a sentence when trials on disk are damaged and tried again.

    Returns
    -------
    TuningResult

    Raises
    ------
    StudyError
        optuna is not installed, or the folder holds another tuning; nothing has run then.
    OutputError
        The folder can not be written, or the disk is full; finished trials stay.
    KeyboardInterrupt
        Ctrl-C; finished trials stay.

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
    ...     bk.tune(tuning, folder, trials=2).summary["trials"]
    2

    """
    _check_counts(trials, threads)
    asked = tuning if trials is None else tuning.model_copy(update={"trials": trials})
    search = Search(asked)
    folder = Path(out)
    if resume:
        _check_found(folder, asked)
    with prepared(folder, manifest_of(asked), resume=resume) as pieces:
        runner = _Runner(asked, pieces, threads, progress, notice)
        try:
            write_end(runner.run(search), pieces)
        except OutputError as error:
            raise OutputError(f"{error}; finished trials stay: resume it to go on") from None
    return open_tuning(folder)


def _check_counts(trials: int | None, threads: int | None) -> None:
    thread_count(threads)
    if trials is None:
        return
    if isinstance(trials, bool) or not isinstance(trials, int) or not 1 <= trials <= TRIALS_MAX:
        raise StudyError(f"trials: {trials!r} is not a whole number >= 1 and <= {TRIALS_MAX}")


def _check_found(folder: Path, tuning: Tuning) -> None:
    """Raise if the folder holds more trials than are asked for."""
    if not is_there(folder / MANIFEST):
        return
    found = len(Records(folder, TRIALS, manifest_of(tuning)["identity"]).read())
    if found > tuning.trials:
        raise StudyError(
            f"trials: {tuning.trials} is less than the {found} that {folder} holds; give at least "
            f"{found}, or another folder"
        )


def manifest_of(tuning: Tuning) -> dict[str, Any]:
    """Give what determines the results of a tuning. How many trials it has is not part of it."""
    manifest = {
        "format": FORMAT,
        "breakaway_version": __version__,
        "libraries": {name: version(name) for name in ("numpy", "optuna", "scipy")},
        "study": tuning.model_dump(mode="json", exclude={"trials"}),
    }
    return manifest | {"identity": identity_of(manifest)}


class _Runner:
    """Runs trials and scores, but for those that are on disk."""

    def __init__(
        self,
        tuning: Tuning,
        pieces: Pieces,
        threads: int | None,
        progress: Callable[[TuningProgress], None] | None,
        notice: Callable[[str], None] | None,
    ) -> None:
        self._tuning, self._pieces, self._threads = tuning, pieces, threads
        self._progress, self._notice = progress, notice
        self._trials, self._scored = (
            Records(pieces.folder, name, pieces.identity) for name in (TRIALS, UNSEEN)
        )
        self._done: list[Evaluation] = []
        self._best: dict[str, float] = {}
        self._runs_done, self._runs_found = 0, 0
        self._runs_max = tuning.trials * self._runs_of(tuning.training)

    def run(self, search: Search) -> Found:
        """Run what is not on disk, and give all."""
        kept = self._intact(self._trials)
        if len(kept) < self._tuning.trials:
            self._pieces.remove(SUMMARY)  # it is not finished any more
        for number in range(self._tuning.trials):
            evaluation = self._evaluation(number, search.ask(), kept)
            search.tell(evaluation)
            self._done.append(evaluation)
            self._note_best(evaluation)
        return self._scored_on_unseen()

    def _intact(self, records: Records) -> list[dict[str, Any]]:
        """Give the records of a file, after what is damaged was taken off."""
        kept = records.read()
        if len(kept) < records.lines():
            self._say(
                f"{records.path.name}: line {len(kept) + 1} was not finished, or is not as it was "
                "written; it and what follows is computed again"
            )
            records.replace(kept)
        return kept

    def _evaluation(
        self, number: int, numbers: dict[str, float], kept: list[dict[str, Any]]
    ) -> Evaluation:
        if number < len(kept):
            if (kept[number]["number"], kept[number]["numbers"]) == (number, numbers):
                found = Evaluation.of_json(kept[number])
                self._count(self._tuning.training, found=True)
                return found
            self._say(
                f"{self._trials.path.name}: trial {number} is another one; it and what follows is "
                "tried again"
            )
            del kept[number:]
            self._trials.replace(kept)
        self._doing = f"trial {number + 1} of {self._tuning.trials}"
        evaluation = evaluate(self._tuning, number, numbers, self._threads, self._report)
        self._trials.append(evaluation.as_json())
        self._count(self._tuning.training)
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
        self._runs_max += parts + (0 if same else self._runs_of(tuning.training))
        kept = self._intact(self._scored)
        asked: list[dict[str, Any]] = []

        def scored(of: int | str, method: Method, on: str, runs: range, doing: str) -> Laws:
            key = {"of": of, "on": on}
            record = next((r for r in kept if r | key == r), None)
            if record is None:
                self._doing = doing
                laws = run_laws(tuning, method, runs, self._threads, self._report)
                record = key | {"laws": laws_as_json(laws)}
                self._scored.append(record)
            self._count(runs, found=record in kept)
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
                f"trial {e.number} on unseen parts",
            )
            for e in front
        }
        self._scored.replace(asked)
        best = recommended(tuning, front) if front else None
        return Found(tuning, self._done, front, best, start_training, start_unseen, of_front)

    def _runs_of(self, parts: range) -> int:
        return len(parts) * len(self._tuning.laws)

    def _count(self, parts: range, *, found: bool = False) -> None:
        self._runs_done += self._runs_of(parts)
        self._runs_found += self._runs_of(parts) if found else 0
        if not found:
            self._report(0)

    def _report(self, runs: int) -> None:
        if self._progress:
            self._progress(
                TuningProgress(
                    trials_done=len(self._done),
                    trials_max=self._tuning.trials,
                    runs_done=self._runs_done + runs,
                    runs_found=self._runs_found,
                    runs_max=self._runs_max,
                    doing=self._doing,
                    best=self._best,
                )
            )

    def _say(self, sentence: str) -> None:
        if self._notice:
            self._notice(sentence)
