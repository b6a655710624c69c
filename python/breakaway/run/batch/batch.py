"""The results of many runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from breakaway._core import OUTCOMES
from breakaway.base.arguments import check_arguments
from breakaway.base.equality import ByValue
from breakaway.base.extras import pandas
from breakaway.base.one_line import OneLine, counted
from breakaway.errors import StudyError
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.units import unit_of
from breakaway.run.batch.columns import at_run
from breakaway.run.finished import Run

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False)
class Batch(OneLine, ByValue):
    """Many finished runs of one scenario, as columns: one value for each run."""

    scenario: Scenario
    """What the runs have in common; its controller's gains are numbers."""
    run_index: NDArray[np.uint64]
    """Number of each run among the runs of the scenario's seed."""
    varied: Mapping[str, NDArray[np.float64]]
    """The numbers that differ, by dotted path."""
    metrics: Mapping[str, NDArray[np.float64]]
    """The metrics that were asked for; NaN for what did not happen."""
    outcome_codes: NDArray[np.uint8] | None
    """Index of each run's outcome among the outcomes, if it was asked for."""

    def __repr__(self) -> str:
        said = [counted(len(self), "run")]
        if self.varied:
            said.append(f"{counted(len(self.varied), 'number')} varied")
        if self.outcome_codes is not None:
            freed = int(np.sum(self.outcome_codes == OUTCOMES.index("released")))
            said.append(f"{freed:,} released")
        return f"<batch of {self.scenario.name!r}: {', '.join(said)}>"

    def __len__(self) -> int:
        return len(self.run_index)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Give a column: a varied number, a metric, or ``outcome`` as texts."""
        columns = self.columns
        if name not in columns:
            raise KeyError(f"{name}: is not a column; the columns are {', '.join(columns)}")
        return columns[name]

    @property
    def columns(self) -> Mapping[str, NDArray[Any]]:
        """All columns by name: what differs first, then the metrics, then the outcome."""
        columns: dict[str, NDArray[Any]] = {**self.varied, **self.metrics}
        if self.outcome_codes is not None:
            columns["outcome"] = np.asarray(OUTCOMES)[self.outcome_codes]
        return columns

    def scenario_of(self, i: int) -> Scenario:
        """Give the scenario of the run in row ``i``.

        Parameters
        ----------
        i : int
            Row of the run.

        """
        check_arguments(Batch.scenario_of, locals(), StudyError)
        return at_run(self.scenario, self.varied, self._row(i))

    def replay(self, i: int, *, trace_every: int | None = None) -> Run:
        """Simulate the run in row ``i`` again, with its trace; its metrics are the same bits.

        Parameters
        ----------
        i : int
            Row of the run.
        trace_every : int, optional
            The trace keeps a row every so many samples. Left out: as the scenario says.

        Examples
        --------
        >>> import breakaway as bk
        >>> scenario = bk.load_scenario("paper_as_computed").with_({"disturbance.var": 0.1})
        >>> batch = bk.simulate_many(scenario, runs=3)
        >>> bool(batch.replay(2).metrics.iae_m_s == batch["iae_m_s"][2])
        True

        """
        check_arguments(Batch.replay, locals(), StudyError)
        from breakaway.run.simulation import simulate

        scenario = self.scenario_of(i)
        if trace_every is not None:
            scenario = scenario.with_({"trace.every_samples": trace_every})
        return simulate(scenario, run_index=int(self.run_index[self._row(i)]))

    def to_arrow(self) -> Any:  # noqa: ANN401 - pyarrow has no type stubs
        """Give the columns as a table of pyarrow, units in the metadata of its fields."""
        arrow: Any = import_module("pyarrow")
        columns: dict[str, Any] = {"run_index": arrow.array(self.run_index)}
        columns |= {name: arrow.array(values) for name, values in self.varied.items()}
        columns |= {name: arrow.array(values) for name, values in self.metrics.items()}
        if self.outcome_codes is not None:
            codes = arrow.array(self.outcome_codes.astype(np.int8))
            columns["outcome"] = arrow.DictionaryArray.from_arrays(codes, list(OUTCOMES))
        fields = [
            arrow.field(name, column.type, nullable=False, metadata={"unit": unit_of(name).symbol})
            for name, column in columns.items()
        ]
        about = {"scenario": self.scenario.name, "seed": str(self.scenario.seed)}
        return arrow.Table.from_arrays(
            list(columns.values()), schema=arrow.schema(fields, metadata=about)
        )

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is optional
        """Give the columns as a pandas DataFrame, by run number.

        Raises
        ------
        StudyError
            pandas is not installed.

        """
        return as_pandas(self.to_arrow()).set_index("run_index")

    def to_xarray(self) -> xarray.Dataset:
        """Give the columns as a dataset over ``run_index``, with units.

        Examples
        --------
        >>> import breakaway as bk
        >>> data = bk.simulate_many(
        ...     bk.load_scenario("paper_as_computed"), runs=2, metrics=["peak_force_n"]
        ... ).to_xarray()
        >>> data.peak_force_n.attrs["units"], data.sizes["run_index"]
        ('N', 2)

        """
        import xarray

        data = {
            name: ("run_index", values, {"units": unit_of(name).symbol})
            for name, values in self.columns.items()
        }
        attributes = {"scenario": self.scenario.name, "seed": self.scenario.seed}
        return xarray.Dataset(data, coords={"run_index": self.run_index}, attrs=attributes)

    def _row(self, i: int) -> int:
        if not -len(self) <= i < len(self):
            raise StudyError(f"row {i}: the batch has {len(self)} runs")
        return i % len(self)


def as_pandas(table: Any) -> Any:  # noqa: ANN401 - pyarrow has no type stubs, pandas is optional
    """Turn a table of pyarrow into a pandas DataFrame.

    Raises
    ------
    StudyError
        pandas is not installed.

    """
    pandas()
    return table.to_pandas()
