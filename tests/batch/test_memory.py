"""Memory does not grow with a batch beyond the columns that were asked for."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

SCRIPT = """
import sys
import breakaway as bk
scenario = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 1e-3})
vary = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0)}
batch = bk.simulate_many(scenario, int(sys.argv[1]), vary=vary, metrics=["iae_m_s"])
assert len(batch["iae_m_s"]) == int(sys.argv[1])
status = open("/proc/self/status").read()  # ru_maxrss would count the parent before exec, too
print(int(status.partition("VmHWM:")[2].split()[0]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_grows_by_less_than_200_bytes_per_run():
    few, many = 200_000, 400_000
    peak = [
        1024
        * int(
            subprocess.run(
                [sys.executable, "-c", SCRIPT, str(runs)],
                capture_output=True,
                text=True,
                check=True,
            ).stdout
        )
        for runs in (few, many)
    ]
    requested = 8 + 8 + 8  # the run's number, the metric, the number that differs
    growth = (peak[1] - peak[0]) / (many - few)
    assert 8 <= growth <= requested + 200


@pytest.mark.skipif(sys.platform != "linux", reason="limits the address space")
def test_a_batch_beyond_a_limit_of_the_memory_is_an_error():
    script = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (2**33, 2**33));"
        "import breakaway as bk; bk.simulate_many(bk.load_scenario('paper_as_computed'), 10**8)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 1  # it was the end of the process
    assert "StudyError: runs: 100,000,000 need " in done.stderr
