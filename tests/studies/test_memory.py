"""Memory does not grow with a study beyond the columns that it records."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

SCRIPT = """
import sys, tempfile
import breakaway as bk
from breakaway.ask.studies import run_study
from breakaway.ask.studies.files import parse_study
scenario = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 1e-4})
study = parse_study({
    "kind": "sweep", "scenario": scenario, "runs": int(sys.argv[1]), "metrics": ["peak_force_n"],
    "vary": {"joint.stiction_n": {"distribution": "uniform", "low": 400.0, "high": 500.0}},
})
with tempfile.TemporaryDirectory() as folder:
    done = run_study(study, out=folder, threads=1)
    assert done.dataset.count_rows() == study.runs
status = open("/proc/self/status").read()  # ru_maxrss would count the parent before exec, too
print(int(status.partition("VmHWM:")[2].split()[0]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_grows_by_less_than_200_bytes_per_run():
    few, many = 20_000, 120_000
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
    requested = 8 + 8 + 1  # the varied number, the metric, the outcome
    assert (peak[1] - peak[0]) / (many - few) <= requested + 200
    assert peak[1] < 2**30
