"""The compiled core of breakaway."""

from collections.abc import Mapping, Sequence
from typing import Any

__version__: str

def run_one(
    job: Mapping[str, Any],
) -> tuple[str, dict[str, float], dict[str, bytes]]: ...
def impose(
    joint: Mapping[str, Any],
    start_m: float,
    period_s: float,
    velocities_m_per_s: Sequence[float],
) -> list[bytes]: ...
def breakaway_force(joint: Mapping[str, Any], position_m: float) -> float: ...
