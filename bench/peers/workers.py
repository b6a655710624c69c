"""Runs shared out over processes, for peers without threads of their own."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
from functools import cache
from multiprocessing.connection import Connection

import numpy as np

from .case import Prepare, Simulate
from .loop import FloatArray, Loop

CONTEXT = multiprocessing.get_context("spawn")


def cores() -> list[int]:
    """The cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def keep_to(chosen: set[int]) -> None:
    """Keep to some cores where the system can do that; libraries then start as few threads."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, chosen)


def shared_out(prepare: Prepare) -> Prepare:
    """The same simulation by one process for each thread, each with its share of the runs."""

    def prepare_all(loop: Loop, threads: int) -> Simulate:
        links = processes(threads)
        ask(links, [(prepare, share) for share in loop.shared_out(threads)])
        return lambda: np.concatenate(ask(links, [None] * threads))

    return prepare_all


@cache
def processes(count: int) -> list[Connection]:
    """One for each core, started once and for all."""
    links = []
    for core in cores()[:count]:
        link, theirs = CONTEXT.Pipe()
        CONTEXT.Process(target=_serve, args=(theirs, core), daemon=True).start()
        theirs.close()
        links.append(link)
    return links


def ask(links: list[Connection], tasks: list[tuple[Prepare, Loop] | None]) -> list[FloatArray]:
    """Sends every process its task, and then waits for all."""
    for link, task in zip(links, tasks, strict=True):
        link.send(task)
    return [link.recv() for link in links]


def _serve(link: Connection, core: int) -> None:
    """Prepares what it is sent, and simulates it whenever it is sent nothing."""
    keep_to({core})
    with contextlib.suppress(EOFError):
        while True:
            task = link.recv()
            if task is not None:
                prepare, loop = task
                simulate = prepare(loop, 1)
            link.send(simulate())
