"""Float against double over a loop's course: ``python -m breakaway.export.precision``."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

from breakaway.export.vectors import reference
from breakaway.model.scenario import load_scenario
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import resolve


@dataclass(frozen=True)
class Difference:
    """Difference of one output between the real types."""

    output: str
    largest: float
    """Largest magnitude of the difference, in the unit of the output."""
    scale: float
    """Largest magnitude of the output in double."""


def float_differences(scenario: Scenario) -> list[Difference]:
    """Run a loop in float and in double, and compare its outputs over the whole course.

    Examples
    --------
    >>> import breakaway as bk
    >>> short = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 0.01})
    >>> [one.output for one in float_differences(short)][0]
    'reference_m'

    """
    resolved = resolve(scenario)
    inputs = np.zeros((resolved.samples, 3))
    double = reference(resolved, "loop", "double", inputs)
    single = reference(resolved, "loop", "float", inputs)
    differences = []
    for name, exact in double.items():
        if np.any(exact != 0.0):
            largest = float(np.max(np.abs(single[name] - exact)))
            differences.append(Difference(name, largest, float(np.max(np.abs(exact)))))
    return differences


def main() -> None:
    """Print the differences for each scenario that is named."""
    for name in sys.argv[1:] or ["paper_as_computed"]:
        print(f"{name}: largest difference of float from double, and the output's largest value")
        for one in float_differences(load_scenario(name)):
            print(f"  {one.output:28} {one.largest:10.2e} {one.scale:10.3g}")


if __name__ == "__main__":
    main()
