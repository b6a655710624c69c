"""How far metrics are from converged ones: ``python -m tests.accuracy --cases N --seed S``.

Random hostile scenarios at their default steps against references of 50 times as many. 0 if the
errors are as small as they are meant to be, 1 if not. ``--case NUMBER`` shows one case alone.
"""

from __future__ import annotations

import argparse
import multiprocessing
import signal
import sys
from functools import partial

from tests.accuracy.alone import show_alone
from tests.accuracy.reach import missed
from tests.accuracy.scenarios import draw_case
from tests.accuracy.table import report
from tests.accuracy.verdict import Verdict, judge

from breakaway.base.threads import usable_processors


def main() -> int:
    """Run the set, or one case of it."""
    given = _arguments()
    if given.case is not None:
        show_alone(draw_case(given.seed, given.case))
        return 0
    try:
        verdicts = _judge_all(
            given.seed, range(given.first, given.first + given.cases), given.workers
        )
    except KeyboardInterrupt:
        print("\ninterrupted", file=sys.stderr)
        return 130
    print("\n".join(report(verdicts, given.seed)))
    lines = list(missed(verdicts))
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


def _judge_all(seed: int, numbers: range, workers: int) -> list[Verdict]:
    verdicts = []
    with multiprocessing.Pool(workers, _leave_interrupts) as pool:
        for verdict in pool.imap_unordered(partial(_judge_one, seed), numbers):
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


def _judge_one(seed: int, number: int) -> Verdict:
    return judge(draw_case(seed, number))


if __name__ == "__main__":
    sys.exit(main())
