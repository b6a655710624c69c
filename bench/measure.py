"""Measure speed and memory, print the figures and write bench/results.json.

Absolute times depend on the machine; ratios within one run do not. `make bench` calls this.
"""

from __future__ import annotations

import json
import platform
import re
import resource
import subprocess
import sys
import tempfile
import timeit
from pathlib import Path

ROOT = Path(__file__).parents[1]
SIMULATED_S = 0.5


def kernel() -> dict[str, float]:
    """The core's loop, and the same loop reduced by hand, in wall seconds per simulated second."""
    command = ["cargo", "bench", "--quiet", "--locked", "-p", "breakaway-batch"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    fastest_s = {}
    for name in ("single_run", "bare_equations_by_hand", "lanes_of_32_runs"):
        row = next(line for line in done.stdout.splitlines() if name in line)
        fastest, unit = re.findall(r"([\d.]+) (ns|µs|ms|s)\b", row)[0]
        fastest_s[name] = float(fastest) * {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}[unit]
    single, bare = fastest_s["single_run"], fastest_s["bare_equations_by_hand"]
    return {
        "single_run_wall_s_per_simulated_s": single / SIMULATED_S,
        "bare_equations_wall_s_per_simulated_s": bare / SIMULATED_S,
        "single_run_over_bare_equations": single / bare,
        "lanes_wall_s_per_simulated_s_and_run": fastest_s["lanes_of_32_runs"] / 32 / SIMULATED_S,
    }


def call_overhead() -> dict[str, float]:
    """What a call from Python costs beyond the loop: a run of one control period."""
    import breakaway as bk

    scenario = bk.load_scenario("paper_as_computed")
    paper = scenario.with_({"trace.every_samples": 0})
    one = paper.with_({"timing.duration_s": scenario.timing.control_period_s})
    repeat = 7
    short = min(timeit.repeat(lambda: bk.simulate(one), number=500, repeat=repeat)) / 500
    long = min(timeit.repeat(lambda: bk.simulate(paper), number=20, repeat=repeat)) / 20
    return {
        "python_call_overhead_us": short * 1e6,
        "python_run_wall_s_per_simulated_s": long / SIMULATED_S,
    }


def import_time() -> dict[str, float]:
    """`import breakaway`, and an interpreter that imports nothing."""

    def median_s(code: str) -> float:
        times = timeit.repeat(
            lambda: subprocess.run([sys.executable, "-c", code], check=True), number=1, repeat=9
        )
        return sorted(times)[4]

    bare = median_s("pass")
    return {
        "import_breakaway_s": median_s("import breakaway") - bare,
        "import_and_load_scenario_s": median_s(
            "import breakaway as bk; bk.load_scenario('paper_as_computed')"
        )
        - bare,
    }


def commands() -> dict[str, float]:
    """Wall time and peak memory of whole commands."""
    program = str(Path(sys.executable).with_name("breakaway"))
    with tempfile.TemporaryDirectory() as folder:
        run = [program, "run", "paper_as_computed", "--out", f"{folder}/run"]
        start = timeit.default_timer()
        subprocess.run(run, check=True, capture_output=True)
        run_s = timeit.default_timer() - start
        # Only this child has finished so far, but for those of import_time, which are smaller.
        peak_mib = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        start = timeit.default_timer()
        subprocess.run(
            [program, "reproduce", "--out", f"{folder}/paper"], check=True, capture_output=True
        )
        reproduce_s = timeit.default_timer() - start
    return {
        "run_with_outputs_s": run_s,
        "run_peak_memory_mib": peak_mib,
        "reproduce_s": reproduce_s,
    }


LIMITS = {
    "single_run_wall_s_per_simulated_s": 3.5e-3,
    "single_run_over_bare_equations": 1.4,
    "python_call_overhead_us": 200.0,
    "import_breakaway_s": 0.3,
    "run_peak_memory_mib": 200.0,
    "reproduce_s": 20.0,
}
"""What the project aims for; 1.4 is 3.5e-3 over the 2.5e-3 of a hand-written kernel."""


def main() -> None:
    """Measure everything; commands first, because peak memory is that of all children so far."""
    figures = {**import_time(), **commands(), **call_overhead(), **kernel()}
    print(f"{'figure':44s} {'measured':>12s} {'aim':>10s}")
    for name, value in figures.items():
        aim = LIMITS.get(name)
        verdict = "" if aim is None else f"{aim:10.3g}  {'met' if value <= aim else 'NOT met'}"
        print(f"{name:44s} {value:12.4g} {verdict}")
    results = {"machine": platform.processor() or platform.machine(), "figures": figures}
    (ROOT / "bench" / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
