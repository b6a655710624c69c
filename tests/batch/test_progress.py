"""A batch tells how far it is, can be stopped, and leaves the interpreter to others."""

import signal
import subprocess
import sys
import threading
import time
from itertools import pairwise

import pytest

import breakaway as bk


class EnoughError(Exception):
    """What a user's own code raises."""


@pytest.mark.parametrize("runs", [1, 7, 500])
@pytest.mark.parametrize("threads", [1, 2, 5])
def test_progress_rises_to_the_end(quick, runs, threads):
    calls = []
    bk.simulate_many(quick, runs, threads=threads, progress=lambda *told: calls.append(told))
    done = [d for d, _ in calls]
    assert {total for _, total in calls} == {runs}
    assert done == sorted(done)
    assert done[0] >= 0 and done[-1] == runs


def test_progress_is_told_on_the_way(quick):
    """In the thread that asked for the batch; many times, if the batch takes its time."""
    calls, threads = [], set()

    def progress(done, total):
        calls.append((done, total))
        threads.add(threading.get_ident())
        if 0 < done < total:
            raise EnoughError

    longer = quick.with_({"timing.duration_s": 1.0, "disturbance.var": 0.01})
    with pytest.raises(EnoughError):
        bk.simulate_many(longer, 100_000, threads=2, progress=progress, metrics=["iae_m_s"])
    assert threads == {threading.get_ident()}
    assert [done for done, _ in calls[:-1]] == [0] * (len(calls) - 1)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("error", [EnoughError, KeyboardInterrupt, SystemExit])
def test_what_progress_raises_ends_the_batch(endless, error, threads):
    """Within a run, for it would take longer than anybody waits."""

    def progress(_done, _total):
        raise error

    with pytest.raises(error):
        bk.simulate_many(endless, 1000, threads=threads, progress=progress)


def test_what_progress_raises_at_the_very_end_is_raised(quick):
    def progress(done, total):
        if done == total:
            raise EnoughError

    with pytest.raises(EnoughError):
        bk.simulate_many(quick, 3, progress=progress)


def test_progress_that_can_not_be_called(quick):
    with pytest.raises(TypeError):
        bk.simulate_many(quick, 3, progress=lambda: None)


INTERRUPTED = """
import os, signal, threading
import breakaway as bk
scenario = bk.load_scenario("paper_as_computed").with_(
    {"timing.duration_s": 1000.0, "trace.every_samples": 0}
)
timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
timer.start()
try:
    bk.simulate_many(scenario, 1000)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to send to oneself")
def test_ctrl_c_without_progress():
    """A batch that nobody watches asks, too."""
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=120
    )
    assert (done.stdout, done.stderr, done.returncode) == ("interrupted\n", "", 0)


def test_ctrl_c_is_heard_in_progress(endless):
    calls = []

    def progress(done, _total):
        calls.append(done)
        if len(calls) == 2:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        bk.simulate_many(endless, 1000, progress=progress)
    assert len(calls) == 2


def test_other_threads_go_on(endless):
    """Between two calls of progress, another thread gets the interpreter many times.

    Were it not for them, it would only while progress is told.
    """
    stop, counts, ticks = threading.Event(), [], 0

    def tick():
        nonlocal ticks
        while not stop.is_set():
            time.sleep(1e-4)  # gives the interpreter up, and needs it again
            ticks += 1

    def progress(_done, _total):
        counts.append(ticks)
        if any(later - before >= 10 for before, later in pairwise(counts)):
            raise EnoughError
        if len(counts) > 200:
            pytest.fail(f"the other thread hardly went on: {counts}")

    other = threading.Thread(target=tick)
    other.start()
    try:
        with pytest.raises(EnoughError):
            bk.simulate_many(endless, 1000, threads=1, progress=progress)
    finally:
        stop.set()
        other.join()


def test_batches_in_several_threads(quick):
    """Each has its own results."""
    results = {}

    def work(seed):
        results[seed] = bk.simulate_many(quick.with_(seed=seed), 100, threads=2)

    workers = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for seed in range(4):
        alone = bk.simulate_many(quick.with_(seed=seed), 100)
        assert (alone["iae_m_s"] == results[seed]["iae_m_s"]).all()
