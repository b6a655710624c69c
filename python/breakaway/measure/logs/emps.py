"""The layout of the EMPS benchmark's MATLAB file."""

from __future__ import annotations

import numpy as np

from breakaway.errors import LogError
from breakaway.measure.logs.assemble import column, present
from breakaway.measure.logs.channel import named
from breakaway.measure.logs.mapping import Mapping, parse_mapping
from breakaway.measure.logs.raw import RawFile

REQUIRED = ("t", "qm", "vir", "gtau")


def is_emps(raw: RawFile) -> bool:
    """Whether a MATLAB file holds the variables of the benchmark."""
    return all(name in raw for name in REQUIRED)


def emps_layout(raw: RawFile) -> Mapping:
    """Return the mapping of a log of the Electro-Mechanical Positioning System.

    ::

        force_n = gtau * vir

    with ``vir`` the drive signal in V and ``gtau`` the drive gain in N/V. ``t`` is the time
    in s, ``qm`` the measured and ``qg`` (optional) the reference position in m. A force that
    acts on the carriage beside the motor's is not part of ``force_n``.

    Source: A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of EMPS",
    Workshop on Nonlinear System Identification Benchmarks, 2019.

    Raises
    ------
    LogError
        A variable is missing, or ``gtau`` is not a finite scalar other than 0.

    """
    with named(raw.path.name):
        for name in REQUIRED:
            if name not in raw:
                raise LogError(
                    f"variable '{name}' is missing; {present(raw, name)}; the EMPS layout needs "
                    f"{', '.join(REQUIRED)}: write a mapping for another layout"
                )
        gain = column(raw, "gtau").values
    if gain.size != 1 or not np.isfinite(gain[0]) or gain[0] == 0.0:
        raise LogError(
            f"{raw.path.name}: variable 'gtau' is {np.array2string(gain, threshold=4)}; it must "
            "be one finite drive gain in N/V, not 0"
        )
    channels = {
        "position_m": {"from": "qm", "unit": "m"},
        "force_n": {"from": "vir", "unit": "V", "scale": float(gain[0])},
    }
    if "qg" in raw:
        channels["reference_m"] = {"from": "qg", "unit": "m"}
    time = {"from": "t", "unit": "s"}
    raw.listed.pop("gtau")
    raw.history = ("force_n = gtau * vir (EMPS)",)
    return parse_mapping({"channels": channels, "time": time}, raw.path.name)
