"""Identify mass and friction of the EMPS benchmark and compare them with the published figures."""

import sys
from pathlib import Path

from breakaway.measure.identification import identify_inertia_friction
from breakaway.measure.logs import read_log

DEFAULT = Path(__file__).parents[2] / "../shared/data/emps/DATA_EMPS.mat"

# Janot, Gautier, Brunot, Workshop on Nonlinear System Identification Benchmarks, 2019
SYMMETRIC = {
    "mass_kg": 95.1089,
    "viscous_n_s_per_m": 203.5034,
    "coulomb_n": 20.3935,
    "offset_n": -3.1648,
    "relative_force_error_percent": 4.08,
}
ASYMMETRIC = {
    "mass_kg": 95.154,
    "viscous_positive_n_s_per_m": 166.71,
    "viscous_negative_n_s_per_m": 240.42,
    "coulomb_positive_n": 20.144,
    "coulomb_negative_n": 20.628,
    "relative_force_error_percent": 3.11,
}


def main() -> None:
    """Print the table for the file named by the first argument, or for the default."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else DEFAULT
    if not path.is_file():
        print(f"skipped: there is no {path.name}; README.md says where it comes from")
        return
    fit = identify_inertia_friction(read_log(path, format="emps"))
    for title, result, published in (
        ("symmetric", fit.symmetric, SYMMETRIC),
        ("asymmetric", fit.asymmetric, ASYMMETRIC),
    ):
        print(f"{title:30} {'identified':>12} {'std. error':>12} {'published':>12}")
        for name, value in published.items():
            error = result.standard_error.get(name)
            shown = "" if error is None else f"{error:.4f}"
            print(f"{name:30} {getattr(result, name):12.4f} {shown:>12} {value:12.4f}")
        print()
    for note in fit.notes:
        print(f"- {note}")


if __name__ == "__main__":
    main()
