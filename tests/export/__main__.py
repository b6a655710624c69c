"""``python -m tests.export --steps N``: every kind, each over N random steps, against the core."""

from __future__ import annotations

import argparse
import tempfile
from itertools import product
from pathlib import Path

from tests.export import test_bits
from tests.export.kinds import CONTROLLERS, LOOPS, PLANTS, VARYING


def main() -> None:
    """Run the checks of `test_bits` with more steps. The first bit that differs raises."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=1_000_000)
    steps: int = parser.parse_args().steps
    test_bits.CONTROLLER_STEPS = test_bits.PLANT_STEPS = test_bits.LOOP_STEPS = steps
    done = 0
    for check, kinds in (
        (test_bits.test_controllers, CONTROLLERS),
        (test_bits.test_plants, PLANTS),
        (test_bits.test_loops, LOOPS),
    ):
        for name, real in product(kinds, test_bits.REALS):
            with tempfile.TemporaryDirectory() as folder:
                check(name, real, Path(folder))
            done += 1
            print(
                f"{check.__name__[5:-1]} {name}, {real}: {steps} steps, the same bits", flush=True
            )
    for name, what in product(VARYING, ("plant", "loop")):
        with tempfile.TemporaryDirectory() as folder:
            test_bits.test_varying_friction(name, what, Path(folder))
        done += 1
        print(f"varying friction {name}, {what}: {steps} steps, the same bits", flush=True)
    print(f"{done} kinds and types, {done * steps} steps, the same bits")


if __name__ == "__main__":
    main()
