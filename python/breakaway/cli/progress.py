"""How far long work is, shown on a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from breakaway.base.text import visible
from breakaway.cli.interrupts import raise_if_interrupted

if TYPE_CHECKING:
    from breakaway.ask.durable.progress import Progress


@contextmanager
def shown_progress(name: str = "") -> Iterator[Callable[[Progress], None]]:
    """Show on a terminal how far runs are: bar, runs, rate, time left; in pipes nothing.

    The bar is there while runs are under way and not between, where other lines may be printed. A
    Ctrl-C that was lost on the way is heeded at the next report, shown or not.
    """
    if not sys.stderr.isatty():
        yield lambda _at: raise_if_interrupted()
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=None),
        TextColumn("{task.percentage:>3.0f} %  {task.fields[told]}", markup=False),
    )
    bar = Bar(*columns, console=Console(stderr=True), transient=True)
    task = bar.add_task("", total=None, told="")
    began = time.monotonic()

    def report(at: Progress) -> None:
        raise_if_interrupted()
        told = progress_in_words(at, time.monotonic() - began)
        doing = visible(f"{name}: {at.doing}" if name else at.doing)
        bar.update(task, completed=at.runs_done, total=at.runs_max, description=doing, told=told)
        bar.start() if at.runs_done < at.runs_max else bar.stop()

    try:
        yield report
    finally:
        bar.stop()


@contextmanager
def counted(doing: str, units: str) -> Iterator[Callable[[int, int], None]]:
    """Show on a terminal how many of how many are done; in pipes nothing."""
    if not sys.stderr.isatty():
        yield lambda _done, _total: raise_if_interrupted()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn(units, markup=False),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(doing, total=None)

        def report(done: int, total: int) -> None:
            raise_if_interrupted()
            bar.update(task, completed=done, total=total)

        yield report


def progress_in_words(at: Progress, elapsed_s: float) -> str:
    """Say how many runs are done, how fast, and how long the rest takes at most.

    Runs that were found on disk do not count into the rate.

    Examples
    --------
    >>> from breakaway.ask.durable.progress import Progress
    >>> at = Progress(runs_done=3000, runs_found=1000, runs_max=9000, doing="grid")
    >>> progress_in_words(at, 20.0)
    '3000 of 9000 runs, 100 runs/s, 1 min 00 s left'

    """
    told = f"{at.runs_done} of {at.runs_max} runs"
    computed = at.runs_done - at.runs_found
    if computed <= 0 or elapsed_s <= 0.0:
        return told
    rate = computed / elapsed_s
    left_s = round((at.runs_max - at.runs_done) / rate)
    minutes, seconds = divmod(left_s, 60)
    hours, minutes = divmod(minutes, 60)
    left = f"{hours} h {minutes:02} min" if hours else f"{minutes} min {seconds:02} s"
    speed = f"{rate:,.0f}" if rate >= 10.0 else f"{rate:.2g}"
    return f"{told}, {speed} runs/s, {left if hours or minutes else f'{seconds} s'} left"
