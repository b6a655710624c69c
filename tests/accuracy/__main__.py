"""How far metrics are from converged ones: ``python -m tests.accuracy --cases N --seed S``.

Random hostile scenarios at their default steps against references of 50 times as many, and where
it knows the equations against an independent solver in C; then peaks of impacts against their
closed form. 0 if all errors are as small as they are meant to be, 1 if not. ``--case NUMBER`` shows
one case alone.
"""

from __future__ import annotations

import argparse
import multiprocessing
import signal
import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.accuracy.alone import show_alone
from tests.accuracy.impacts import strike_all
from tests.accuracy.independent import build
from tests.accuracy.reach import missed
from tests.accuracy.scenarios import draw_case
from tests.accuracy.table import report, report_impacts
from tests.accuracy.verdict import Verdict, judge

from breakaway.base.threads import usable_processors


def main() -> int:
    """Run the set, or one case of it."""
    given = _arguments()
    with TemporaryDirectory() as folder:
        return _run(given, build(Path(folder)))


def _run(given: argparse.Namespace, solver: Path | None) -> int:
    if solver is None:
        print("no C compiler (cc): nothing is compared with the independent solver")
    if given.case is not None:
        show_alone(draw_case(given.seed, given.case), solver)
        return 0
    try:
        verdicts = _judge_all(given, solver)
    except KeyboardInterrupt:
        print("\ninterrupted", file=sys.stderr)
        return 130
    impacts = list(strike_all())
    print("\n".join([*report(verdicts, given.seed), "", *report_impacts(impacts)]))
    lines = list(missed(verdicts, impacts))
    print("\n" + "\n".join(f"missed: {line}" for line in lines) if lines else "\nall is reached")
    return 1 if lines else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.accuracy", description=__doc__)
    parser.add_argument("--cases", type=int, default=95, help="how many cases")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", type=int, default=0, help="seed of the set")
    parser.add_argument("--case", type=int, help="show this case alone")
    parser.add_argument("--workers", type=int, default=usable_processors(), help="processes")
    return parser.parse_args()


def _judge_all(given: argparse.Namespace, solver: Path | None) -> list[Verdict]:
    verdicts, numbers = [], range(given.first, given.first + given.cases)
    judge_one = partial(_judge_one, given.seed, solver)
    with multiprocessing.Pool(given.workers, _leave_interrupts) as pool:
        for verdict in pool.imap_unordered(judge_one, numbers):
            verdicts.append(verdict)
            _show(f"{len(verdicts)} of {len(numbers)}, last {verdict.number}: {verdict.kind}")
    _show("")
    return sorted(verdicts, key=lambda v: v.number)


def _leave_interrupts() -> None:
    """Ctrl-C is for the process that waits for the others, and ends them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _show(progress: str) -> None:
    if sys.stderr.isatty():
        print(f"\r{progress}\033[K", end="", file=sys.stderr, flush=True)


def _judge_one(seed: int, solver: Path | None, number: int) -> Verdict:
    return judge(draw_case(seed, number), solver)


if __name__ == "__main__":
    sys.exit(main())
