"""Measure one peer on a number of threads and print what was found as JSON.

Called in a process of its own by `bench.peers`, so that no peer disturbs another:

    python -m bench.peers.measure numba_ 1
"""

from __future__ import annotations

import importlib
import json
import sys
import timeit
from collections.abc import Iterator
from typing import Any, Literal

from . import workers
from .case import Batch, Case, Prepare
from .loop import Loop, numbers

REPEATS = 3
ENOUGH_S = 0.5
"""Short simulations are repeated for as long as this, others `REPEATS` times; the fastest counts,
since whatever else the machine does only adds."""
CHECKED_RUNS = 3

Mode = Literal["single", "batch"]


def measure(prepare: Prepare, work: Batch, threads: int) -> dict[str, Any]:
    """Prepare once, simulate some times; what is prepared includes a first simulation."""
    loop = Loop(numbers(), tuple(range(work.runs)), work.duration_s)
    start = timeit.default_timer()
    simulate = prepare(loop, threads)
    iae_m_s = simulate()
    first_s = timeit.default_timer() - start
    times: list[float] = []
    while len(times) < REPEATS or sum(times) < ENOUGH_S:
        times += timeit.repeat(simulate, number=1, repeat=1)
    return {
        "wall_s_per_simulated_s_and_run": min(times) / work.duration_s / work.runs,
        "repeats": len(times),
        "prepare_s": max(0.0, first_s - min(times)),
        "iae_m_s": iae_m_s[:CHECKED_RUNS].tolist(),
    }


def works(case: Case, threads: int) -> Iterator[tuple[Mode, Prepare, Batch]]:
    """What is measured of a case: single run and batch on one thread, or the batch on all cores."""
    batch = case.batch
    if case.single_s is not None and threads == 1:
        alone = Batch(runs=1, duration_s=case.single_s, all_cores="threads")
        yield "single", case.first_run or case.prepare, alone
    if batch is None and case.single_s is not None and threads > 1:
        batch = Batch(runs=threads, duration_s=case.single_s, all_cores="processes")
    if batch is not None:
        in_processes = batch.all_cores == "processes" and threads > 1
        yield "batch", workers.shared_out(case.prepare) if in_processes else case.prepare, batch


def measure_case(case: Case, threads: int) -> Iterator[dict[str, Any]]:
    """Each measurement with what it is of; one that fails says why and leaves the others be."""
    for mode, prepare, work in works(case, threads):
        about = {
            "name": case.name,
            "integrates": case.integrates,
            "settings": case.settings,
            "rule": case.rule,
            "mode": mode,
            "threads": threads,
            "runs": work.runs,
            "duration_s": work.duration_s,
        }
        try:
            yield {**about, **measure(prepare, work, threads)}
        except Exception as error:
            yield {**about, "why": f"{type(error).__name__}: {error}".splitlines()[0]}


def main(module: str, threads: int) -> None:
    """Measure a module of this package; the last line printed is the result."""
    workers.keep_to(set(workers.cores()[-threads:]))
    start = timeit.default_timer()
    cases = importlib.import_module(f".{module}", __package__).CASES
    import_s = timeit.default_timer() - start
    found = [m for case in cases for m in measure_case(case, threads)]
    print(json.dumps([{"import_s": import_s, **m} for m in found]))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
