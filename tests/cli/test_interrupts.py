"""A Ctrl-C ends long work also where a library loses the exception."""

import subprocess
import sys

import pytest

LOST = """
import signal
from breakaway.cli.interrupts import note_interrupts, raise_if_interrupted
from breakaway.cli.progress import counted, shown_progress
from breakaway.ask.durable.progress import Progress
note_interrupts()
raise_if_interrupted()
try:
    signal.raise_signal(signal.{name})
except KeyboardInterrupt:
    print("lost")
at = Progress(runs_done=1, runs_found=0, runs_max=9, doing="grid")
for shown, told in ((shown_progress, (at,)), (counted, (1, 9))):
    try:
        with shown({words}) as report:
            report(*told)
    except KeyboardInterrupt:
        print("heeded")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_lost_interrupt_is_heeded_at_the_next_report(name: str) -> None:
    script = LOST.format(name=name, words='*("fitting", "starts")[: len(told) * 2 - 2]')
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60
    )
    assert (done.stdout, done.stderr) == ("lost\nheeded\nheeded\n", "")


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP"])
def test_an_ignored_interrupt_stays_ignored(name: str) -> None:
    script = (
        "import signal\n"
        "from breakaway.cli.interrupts import note_interrupts, raise_if_interrupted\n"
        f"signal.signal(signal.{name}, signal.SIG_IGN)\n"
        "note_interrupts()\n"
        f"signal.raise_signal(signal.{name})\n"
        "raise_if_interrupted()\n"
        "print('on')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60
    )
    assert (done.stdout, done.stderr) == ("on\n", "")
