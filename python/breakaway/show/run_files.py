"""Writing a finished run: scenario, metrics, trace and figure, all of them or none."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from breakaway._core import __version__
from breakaway.base.output import output_folder, remove_inside
from breakaway.base.ownership import RUN
from breakaway.model.scenario.files import scenario_toml
from breakaway.model.units import unit_of
from breakaway.run.finished import Run

TRACE_FILES = ("trace.parquet", "trace.csv", "figure.png", "figure.svg")
"""Files of a run that has a trace."""
FILES = ("scenario.toml", "metrics.json", *TRACE_FILES)
"""All files that a run may have."""


def run_summary(run: Run) -> dict[str, Any]:
    """Outcome and figures of a run, as ``metrics.json`` holds them.

    Examples
    --------
    >>> import breakaway as bk
    >>> summary = run_summary(bk.simulate(bk.load_scenario("paper_as_computed")))
    >>> summary["outcome"], summary["seed"], round(summary["metrics"]["peak_force_n"])
    ('released', 0, 601)

    """
    return {
        "scenario": run.scenario.name,
        "outcome": str(run.outcome),
        "seed": run.seed,
        "run_index": run.run_index,
        "breakaway_version": __version__,
        "metrics": run.metrics.to_dict(),
    }


def write_run(run: Run, folder: str | Path) -> list[Path]:
    """Write ``scenario.toml``, ``metrics.json``, the trace and its figure to a folder.

    ``scenario.toml`` has every number explicit and reruns to the same bits. A run without a
    trace has neither ``trace.parquet``, ``trace.csv`` nor figures; those of an earlier run are
    removed from the folder, so that it never describes two runs.

    Parameters
    ----------
    run : Run
        What is written.
    folder : str or Path
        Where; made if it is missing.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OutputError
        The folder cannot be written, holds a result of another kind, or files of others under
        these names; or the disk is full. Nothing is half written.

    Examples
    --------
    >>> import tempfile
    >>> import breakaway as bk
    >>> run = bk.simulate(bk.load_scenario("paper_as_computed").with_({"trace.every_samples": 0}))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in write_run(run, folder)]
    ['scenario.toml', 'metrics.json']

    """
    with written_run(Path(folder)) as write:
        return write(run)


@contextmanager
def written_run(folder: Path) -> Iterator[Callable[[Run], list[Path]]]:
    """Give a function that writes a run to ``folder`` once the block ends.

    A folder that cannot be written is found before the block, and so before a long simulation.
    """
    written: list[str] = []

    def write(run: Run) -> list[Path]:
        _write_files(run, staging)
        written.extend(name for name in _names(run))
        return [folder / name for name in written]

    with output_folder(folder, RUN, FILES) as staging:
        yield write
    for name in TRACE_FILES:
        if written and name not in written:
            remove_inside(folder / name)


def _names(run: Run) -> list[str]:
    return list(FILES) if run.trace else [name for name in FILES if name not in TRACE_FILES]


def _write_files(run: Run, folder: Path) -> None:
    summary = json.dumps(run_summary(run), indent=2, allow_nan=False) + "\n"
    (folder / "metrics.json").write_text(summary, encoding="utf-8", newline="\n")
    (folder / "scenario.toml").write_text(_rerun_toml(run), encoding="utf-8", newline="\n")
    if not run.trace:
        return
    _write_trace(run, folder)
    from breakaway.drawing.run import plot_run
    from breakaway.drawing.style import save_figure

    figure = plot_run(run)
    for name in ("figure.png", "figure.svg"):
        save_figure(figure, folder / name)


def _rerun_toml(run: Run) -> str:
    scenario = run.scenario.model_copy(update={"breakaway_version": __version__, "seed": run.seed})
    how = "breakaway run scenario.toml"
    if run.run_index:
        how = f"breakaway.simulate(scenario, run_index={run.run_index})"
    return (
        f"# Every number explicit. Runs again to the same bits: {how}\n\n{scenario_toml(scenario)}"
    )


def _write_trace(run: Run, folder: Path) -> None:
    arrow: Any = import_module("pyarrow")  # has no type stubs
    fields = [
        arrow.field(name, arrow.float64(), nullable=False, metadata={"unit": unit_of(name).symbol})
        for name in run.trace
    ]
    about = {"scenario": run.scenario.name, "breakaway_version": __version__}
    trace = arrow.Table.from_arrays(
        [arrow.array(column) for column in run.trace.values()],
        schema=arrow.schema(fields, metadata=about),
    )
    import_module("pyarrow.parquet").write_table(trace, folder / "trace.parquet")
    csv: Any = import_module("pyarrow.csv")
    with (folder / "trace.csv").open("wb") as file:
        file.write((",".join(run.trace) + "\n").encode())  # which pyarrow would quote
        csv.write_csv(trace, file, csv.WriteOptions(include_header=False))
