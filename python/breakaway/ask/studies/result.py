"""A study's folder; only what is asked for is read."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from breakaway.ask.durable.finished import SUMMARY, DurableFolder, finished_names
from breakaway.ask.durable.manifest import STUDY
from breakaway.ask.durable.pieces import piece_name, pieces_in
from breakaway.ask.studies.manifest import StudyManifest
from breakaway.ask.studies.plans import plan_of
from breakaway.ask.studies.run_pieces import piece_schema
from breakaway.ask.studies.study import Study
from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine
from breakaway.base.reading import is_there
from breakaway.base.text import shown
from breakaway.errors import StudyError
from breakaway.run.batch.batch import as_pandas
from breakaway.run.batch.columns import at_run, with_nominal_controller
from breakaway.run.finished import Run


class StudyResult(OneLine, DurableFolder):
    """A study in a folder, finished or not. Runs are read when they are asked for."""

    _kind = STUDY
    _manifest_model = StudyManifest

    def __repr__(self) -> str:
        state = "finished" if self.finished else f"not finished, {self._kept}"
        asked = self.manifest["asked"]
        return f"<study {asked['name']!r}, {asked['kind']}, {state}>"

    @property
    def piece_files(self) -> list[Path]:
        """Files of the finished pieces, in their order."""
        return [self.folder / name for name in pieces_in(self.folder)]

    @property
    def _kept(self) -> str:
        return f"{len(self.piece_files)} pieces"

    @cached_property
    def study(self) -> Study:
        """What was asked."""
        from breakaway.ask.studies.files import parse_study

        return parse_study(self.manifest["asked"])

    @property
    def dataset(self) -> Any:  # noqa: ANN401 - pyarrow has no type stubs
        """The runs of the finished pieces as a dataset of pyarrow, of which nothing is read yet.

        Raises
        ------
        StudyError
            A piece is missing, or not as the study wrote it.

        """
        self._refuse_flawed_pieces()
        manifest = self.manifest
        schema = piece_schema(manifest["labels"], manifest["varied"], manifest["metrics"])
        return import_module("pyarrow.dataset").dataset(
            [str(path) for path in self.piece_files], schema=schema, format="parquet"
        )

    def _refuse_flawed_pieces(self) -> None:
        if is_there(self.folder / SUMMARY):
            names = finished_names(self._journal)
        else:
            names = [piece_name(number) for number in range(len(self.piece_files))]
            self._journal.reread()
        for name in names:
            self._journal.refuse_flawed(name)

    def scan(self, columns: Sequence[str] | None = None, filter: Any = None) -> Any:  # noqa: ANN401
        """Read some columns of the runs that pass a filter, as a table of pyarrow.

        Parameters
        ----------
        columns : sequence of str, optional
            Names of columns. Left out: all.
        filter : pyarrow.dataset.Expression, optional
            Such as ``pyarrow.dataset.field("outcome") == "diverged"``. Left out: all runs.

        Raises
        ------
        StudyError
            There is no such column, or a piece is missing or not as the study wrote it.

        """
        check_arguments(StudyResult.scan, locals(), StudyError)
        if not isinstance(filter, import_module("pyarrow.compute").Expression | None):
            raise StudyError(
                f"filter: {shown(filter)} is not an expression of pyarrow; give one, such as "
                "pyarrow.dataset.field('outcome') == 'diverged'"
            )
        known = [column["name"] for column in self.manifest["columns"]]
        for name in columns or ():
            if name not in known:
                raise StudyError(f"{name}: is not a column; the columns are {', '.join(known)}")
        wanted = None if columns is None else list(columns)
        return self.dataset.to_table(columns=wanted, filter=filter)

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is optional
        """Read all runs into a pandas DataFrame.

        Raises
        ------
        StudyError
            pandas is not installed.

        """
        return as_pandas(self.scan())

    def replay(self, point: int, run_index: int, *, trace_every: int | None = None) -> Run:
        """Simulate one run again, with its trace; its metrics are the same bits.

        Parameters
        ----------
        point : int
            Number of its point, as in the column ``point``.
        run_index : int
            Its run number, as in the column ``run_index``.
        trace_every : int, optional
            Every how many samples the trace keeps a row. Left out: as the scenario says.

        Raises
        ------
        StudyError
            There is no such run among the finished pieces.

        """
        from breakaway.run.simulation import simulate

        check_arguments(StudyResult.replay, locals(), StudyError)
        fields = import_module("pyarrow.dataset").field
        wanted = (fields("point") == point) & (fields("run_index") == run_index)
        labels, varied = self.manifest["labels"], self.manifest["varied"]
        table = self.scan([*labels, *varied], wanted)
        if table.num_rows != 1:
            raise StudyError(
                f"point {point}, run {run_index}: is not among the finished runs; look at the "
                "columns point and run_index"
            )
        found = table.to_pylist()[0]
        plan = plan_of(self.study)
        scenario = with_nominal_controller(plan.scenario_at({name: found[name] for name in labels}))
        placed = {path: np.array([found[path]]) for path in varied if isfinite(found[path])}
        scenario = at_run(scenario, placed, 0)
        if trace_every is not None:
            scenario = scenario.with_({"trace.every_samples": trace_every})
        return simulate(scenario, run_index=run_index)


def open_study(folder: str | Path) -> StudyResult:
    """Open a study's folder, finished or not; only its manifest is read.

    Parameters
    ----------
    folder : str or Path
        The folder that the study was run into.

    Returns
    -------
    StudyResult

    Raises
    ------
    StudyError
        The folder holds no study.

    Examples
    --------
    >>> open_study("nowhere")
    Traceback (most recent call last):
        ...
    breakaway.errors.StudyError: nowhere: holds no study (manifest.json is missing); give ...

    """
    return StudyResult(folder)
