"""Run a comparison: trial by trial, each file written as it finishes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from breakaway.ask.comparison.asked import Asked, ask
from breakaway.ask.comparison.ending import ended, manifest_of, write_end
from breakaway.ask.comparison.findings import notes_of, sentences_of
from breakaway.ask.comparison.table import Trials, case_of, table_of
from breakaway.ask.comparison.trial_pieces import (
    TrialPiece,
    pieces_of,
    read_trial,
    trial_as_bytes,
)
from breakaway.ask.durable.journal import Journal
from breakaway.ask.durable.progress import Progress
from breakaway.ask.durable.resume import prepared
from breakaway.ask.durable.runner import Runner
from breakaway.ask.studies.plan import Row
from breakaway.base.arguments import check_arguments
from breakaway.base.equality import ByValue
from breakaway.base.one_line import OneLine, counted
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import PartPopulation
from breakaway.run.trials import Case, Trial, run_trial

DRAWING = "figures and page"
"""What is done, in words, once all parts are tried."""


@dataclass(frozen=True, eq=False)
class Comparison(OneLine, ByValue):
    """A finished comparison: what each method did to the same parts, and what that shows."""

    asked: Asked
    """Everything needed to run it again."""
    trials: Trials
    """Case (a law with a variation) -> name of a method -> what it did, part by part."""
    table: Sequence[Row]
    """A row for each case and method."""
    result: Sequence[str]
    """What it shows, in sentences."""
    notes: Sequence[str]
    """What to know before trusting them."""
    folder: Path | None
    """Its folder; None where it was not written."""

    def __repr__(self) -> str:
        asked = self.asked
        methods, laws = counted(len(asked.names), "method"), counted(len(asked.laws), "law")
        variations = counted(len(asked.variations), "variation")
        each = f"{counted(asked.runs, 'part')} each"
        return f"<comparison on {asked.population.name!r}: {methods}, {laws}, {variations}, {each}>"

    def row(self, law: str, method: str, *, variation: str | None = None) -> Row:
        """Give the row of a method in a case.

        Parameters
        ----------
        law : str
            Friction law, as it was asked for.
        method : str
            Name of a method.
        variation : str, optional
            How friction varies, as it was asked for. Left out: the first that was.

        Raises
        ------
        StudyError
            There is no such row.

        """
        check_arguments(Comparison.row, locals(), StudyError)
        case = self._case(law, method, variation)
        return next(r for r in self.table if (case_of(r), r["method"]) == (case, method))

    def trial(self, law: str, method: str, *, variation: str | None = None) -> Trial:
        """Give what a method did in a case, part by part.

        Parameters
        ----------
        law : str
            Friction law, as it was asked for.
        method : str
            Name of a method.
        variation : str, optional
            How friction varies, as it was asked for. Left out: the first that was.

        Raises
        ------
        StudyError
            There is no such trial.

        """
        check_arguments(Comparison.trial, locals(), StudyError)
        return self.trials[self._case(law, method, variation)][method]

    def _case(self, law: str, method: str, variation: str | None) -> Case:
        asked = self.asked
        how = asked.variations[0] if variation is None else variation
        for case in asked.cases:
            if (case.law, case.variation) == (law, how) and method in asked.names:
                return case
        raise StudyError(
            f"{law}, {how}, {method}: was not compared; the laws are {', '.join(asked.laws)}, the "
            f"variations {', '.join(asked.variations)}, the methods {', '.join(asked.names)}"
        )


def compare_methods(
    population: str | Path | PartPopulation,
    methods: Sequence[str | Path | Method] | str | None = None,
    *,
    joint: str | Path | JointFile | None = None,
    laws: Sequence[str] | str | None = None,
    variations: Sequence[str] | str | None = None,
    runs: int | range | None = None,
    seed: int | None = None,
    baselines: Sequence[str] | str | None = None,
    allow_training_parts: bool | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Callable[[Progress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> Comparison:
    """Try methods of extraction on the same parts, under several friction laws and variations.

    With a folder, ``manifest.json`` comes first, then the pieces as they finish (Parquet), then
    ``table.csv``, figures, the page ``index.html``, ``comparison.toml``, and last
    ``summary.json``. A comparison that was interrupted, in whatever way, continues with ``resume``:
    finished files are read and not computed again, and in the end all files have the same bytes.
    The results do not depend on threads.

    Parameters
    ----------
    population : str, Path or PartPopulation
        Where the parts are from: a preset's name, a TOML file, or the population itself. A
        ``comparison.toml`` of a folder holds a whole comparison; other arguments then override it.
    methods : sequence, optional
        Names of presets, TOML files, or methods. Left out: every preset.
    joint : str, Path or JointFile, optional
        A joint, or the path of its file, laid over the population by `lay_over`: the parts are the
        joints that it draws.
    laws : sequence of str, optional
        Friction laws of the joints; single parts are shown under the first. Left out: ``lugre``,
        ``elasto_plastic`` and ``gms``.
    variations : sequence of str, optional
        How friction varies, each with every law: ``field`` (along the way), ``part`` (from part to
        part), ``none`` and ``paper_random_factor`` (anew in time, as in the paper). Left out: as
        the population says, and nothing else.
    runs : int or range, optional
        How many parts each method tries in each case, or the numbers of these parts. Left out:
        the first 10,000.
    seed : int, optional
        Seed of parts, disturbances and noise. Left out: 0.
    baselines : sequence of str, optional
        Names of the methods whose best one all others are measured against. Left out: each method
        is measured against the best of all others.
    allow_training_parts : bool, optional
        Whether a method may be compared on parts that it was tuned on (its ``tuned_on``), which
        the result then says first. Left out: such a comparison is refused.
    out : str or Path, optional
        The folder; made if it is missing. Left out: nothing is written.
    resume : bool, optional
        Whether to continue a comparison that the folder holds.
    threads : int, optional
        Left out: one for each processor.
    progress : callable, optional
        Called about 20 times a second with a `Progress`. What it raises ends the comparison.
    notice : callable, optional
        Called with a sentence when a file is computed again because it is damaged, edited or from
        another comparison.

    Returns
    -------
    Comparison

    Raises
    ------
    StudyError
        A law, a variation or a number is not valid, a method was tuned on some of the parts, or the
        folder holds another comparison; nothing has run.
    ScenarioError
        There is no such population or method, or it is not valid.
    OutputError
        The folder cannot be written, or the disk is full; finished files stay.
    KeyboardInterrupt
        Ctrl-C; finished files stay.

    Examples
    --------
    >>> import breakaway as bk
    >>> done = bk.compare_methods("seized_parts", ["paper_pid"], laws=["lugre"], runs=4)
    >>> done.row("lugre", "paper_pid")["released"]
    4

    """
    check_arguments(compare_methods, locals(), StudyError)
    thread_count(threads)
    asked = ask(
        population,
        methods,
        joint=joint,
        laws=laws,
        variations=variations,
        runs=runs,
        seed=seed,
        baselines=baselines,
        allow_training_parts=allow_training_parts,
    )
    folder = None if out is None else Path(out)
    with _held(folder, asked, resume=resume) as journal:
        runner = Runner(
            journal,
            "comparison",
            runs_max=len(asked.cases) * len(asked.methods) * asked.runs,
            progress=progress,
            notice=notice,
        )
        done = _concluded(asked, _trials_of(asked, runner, folder, threads), folder)
        if journal is not None:
            if runner.runs_found < runner.runs_done or not ended(journal):
                runner.doing = DRAWING
                runner.report()
                write_end(asked, done.trials, done.table, done.result, done.notes, journal)
            journal.settle(journal.names())
    return done


@contextmanager
def _held(folder: Path | None, asked: Asked, *, resume: bool) -> Iterator[Journal | None]:
    """Check every method before anything runs, hold the folder, and give its journal."""
    for case in asked.cases:
        for method in asked.methods:
            _check(asked, method, case)
    if folder is None:
        yield None
        return
    with prepared(folder, manifest_of(asked), resume=resume) as journal:
        yield journal


def _check(asked: Asked, method: Method, case: Case) -> None:
    """Raise unless a method and a case make a scenario."""
    empty = {name: np.array([value]) for name, value in asked.population.nominal.items()}
    how = (case.law, case.variation)
    Trial(asked.population, method, *how, asked.seed, range(1), empty, {}).scenario(0)


def _concluded(asked: Asked, trials: Trials, folder: Path | None) -> Comparison:
    table = table_of(trials, asked.baselines)
    return Comparison(
        asked=asked,
        trials=trials,
        table=table,
        result=sentences_of(asked, trials, table),
        notes=notes_of(asked),
        folder=folder,
    )


def _trials_of(asked: Asked, runner: Runner, folder: Path | None, threads: int | None) -> Trials:
    """Give all trials, by case and name of the method, piece by piece; what is on disk is read."""
    found: dict[Case, dict[str, list[Trial]]] = {}
    for piece in pieces_of(asked):
        name = runner.next_piece()
        runner.doing = f"{piece.method.name}, {piece.case.law}, {piece.case.variation}"
        if folder is not None and runner.found(name, len(piece.runs), f"{len(piece.runs)} parts"):
            trial = read_trial(folder / name, asked, piece)
        else:
            trial = _computed(asked, piece, name, runner, threads)
        found.setdefault(piece.case, {}).setdefault(piece.method.name, []).append(trial)
    runner.pieces_alone()
    return MappingProxyType(
        {
            case: MappingProxyType({name: _joined(trials) for name, trials in by_method.items()})
            for case, by_method in found.items()
        }
    )


def _computed(
    asked: Asked, piece: TrialPiece, name: str, runner: Runner, threads: int | None
) -> Trial:
    trial = run_trial(
        asked.population,
        piece.method,
        law=piece.case.law,
        variation=piece.case.variation,
        runs=piece.runs,
        seed=asked.seed,
        threads=threads,
        progress=lambda done, _: runner.report(done),
    )
    runner.keep(name, len(piece.runs), lambda: trial_as_bytes(trial))
    return trial


def _joined(trials: Sequence[Trial]) -> Trial:
    """Put the pieces of a trial together."""
    first, last = trials[0], trials[-1]
    if first is last:
        return first
    return Trial(
        population=first.population,
        method=first.method,
        law=first.law,
        variation=first.variation,
        seed=first.seed,
        runs=range(first.runs.start, last.runs.stop),
        parts={n: np.concatenate([t.parts[n] for t in trials]) for n in first.parts},
        metrics={n: np.concatenate([t.metrics[n] for t in trials]) for n in first.metrics},
    )
